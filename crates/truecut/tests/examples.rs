//! Every example runs, and finds what it asserts.

#[path = "../examples/chamfer.rs"]
mod chamfer;
#[path = "../examples/diagnose.rs"]
mod diagnose;
#[path = "../examples/own_process.rs"]
mod own_process;
#[path = "../examples/sweep.rs"]
mod sweep;

#[test]
fn chamfering_holds_at_a_higher_pressure() {
    chamfer::main().unwrap();
}

#[test]
fn the_sweep_meets_the_exact_condition() {
    sweep::main().unwrap();
}

#[test]
fn the_diagnosis_names_the_play_in_the_elbow() {
    diagnose::main().unwrap();
}

#[test]
fn a_process_of_ones_own_is_run_swept_and_recorded() {
    own_process::main().unwrap();
}

#[test]
fn every_example_is_run_here() {
    let here = include_str!("examples.rs");
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/examples");
    for entry in std::fs::read_dir(folder).unwrap() {
        let name = entry.unwrap().file_name().into_string().unwrap();
        assert!(here.contains(&format!("../examples/{name}")), "{name}");
    }
}
