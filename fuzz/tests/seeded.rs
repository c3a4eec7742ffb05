//! A part of the cases of every reader: no panic, no memory beyond the limit.

use std::alloc::System;
use std::sync::Mutex;

use cap::Cap;
use truecut_fuzz::campaign;
use truecut_fuzz::readers::{READERS, reader};

#[global_allocator]
static MEMORY: Cap<System> = Cap::new(System, usize::MAX);
/// The limit of memory is the process's: one campaign at a time.
static ONE: Mutex<()> = Mutex::new(());

const SEED: u64 = 20_261_126;

fn fuzzed(name: &str, cases: u64) {
    let _one = ONE
        .lock()
        .unwrap_or_else(std::sync::PoisonError::into_inner);
    let reader = reader(name).expect("a reader");
    let tally = campaign::run(reader, SEED, 0..cases, &MEMORY, |_| false)
        .unwrap_or_else(|finding| panic!("{finding}"));
    println!("{name}: {tally}");
    // Cases that are all refused, or all taken, try nothing.
    let share = tally.accepted as f64 / tally.cases as f64;
    assert!(share > 0.02 && share < 0.98, "{tally}");
}

macro_rules! readers {
    ($($name:ident: $cases:literal),* $(,)?) => {
        $(#[test]
        fn $name() {
            fuzzed(stringify!($name), $cases);
        })*

        #[test]
        fn every_reader_has_its_cases() {
            let here = [$(stringify!($name)),*];
            let all: Vec<&str> = READERS.iter().map(|reader| reader.name).collect();
            assert_eq!(here.as_slice(), all);
        }
    };
}

readers! {
    scenario: 500,
    ten_steps: 60,
    path_job: 1000,
    cell: 500,
    identification: 1000,
    patch: 1000,
    robot_file: 1000,
    urdf: 1000,
    xacro: 1000,
    mesh: 1000,
    table: 2000,
    log: 1000,
    telegrams: 1000,
    columns: 1000,
    recording: 1000,
    cam: 2000,
    program: 1000,
    material: 500,
    taught: 1000,
    yaml: 1000,
    sweep_rows: 300,
    sweep_part: 1000,
    predictions: 1000,
}
