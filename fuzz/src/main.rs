//! Fuzzes readers for as long as one has time.

use std::alloc::System;
use std::path::PathBuf;
use std::process::ExitCode;
use std::time::{Duration, Instant};

use cap::Cap;
use clap::Parser;
use truecut_fuzz::campaign::{self, Tally};
use truecut_fuzz::program::Desk;
use truecut_fuzz::readers::{READERS, Reader, reader};

#[global_allocator]
static MEMORY: Cap<System> = Cap::new(System, usize::MAX);

/// Damages files of the repository and gives them to the readers.
#[derive(Parser)]
struct Arguments {
    /// Readers by name [default: all]
    readers: Vec<String>,
    /// Seed of the cases
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// First case
    #[arg(long, default_value_t = 0)]
    first: u64,
    /// Most cases for each reader
    #[arg(long, default_value_t = u64::MAX)]
    cases: u64,
    /// Most time for each reader, s
    #[arg(long, default_value_t = 60.0)]
    seconds: f64,
    /// Gives the cases to this program, a process each, instead of to its readers here
    #[arg(long, value_name = "FILE")]
    program: Option<PathBuf>,
    /// Prints the first case instead of running any
    #[arg(long)]
    show: bool,
}

fn main() -> ExitCode {
    let arguments = Arguments::parse();
    let chosen: Vec<&Reader> = match arguments.readers.is_empty() {
        true => READERS.iter().collect(),
        false => (arguments.readers.iter())
            .map(|name| reader(name).unwrap_or_else(|| panic!("no reader \"{name}\"")))
            .collect(),
    };
    let desk = arguments.program.as_deref().map(Desk::new);
    let mut found = 0;
    for reader in chosen {
        if arguments.show {
            show(reader, arguments.seed, arguments.first);
            continue;
        }
        let ends = Instant::now() + Duration::from_secs_f64(arguments.seconds);
        let last = arguments.first.saturating_add(arguments.cases);
        let mut first = arguments.first;
        let stop = |_: &Tally| Instant::now() >= ends;
        loop {
            let ran = match &desk {
                Some(desk) => desk.run(reader, arguments.seed, first..last, stop),
                None => campaign::run(reader, arguments.seed, first..last, &MEMORY, stop),
            };
            match ran {
                Ok(tally) => {
                    println!("{}: {tally}", reader.name);
                    break;
                }
                Err(finding) => {
                    println!("{finding}");
                    found += 1;
                    first = finding.number + 1;
                }
            }
        }
    }
    ExitCode::from(u8::from(found > 0))
}

fn show(reader: &Reader, seed: u64, number: u64) {
    let seeds = (reader.seeds)();
    let files: Vec<&[u8]> = seeds.iter().map(|seed| seed.bytes.as_slice()).collect();
    let (index, bytes) = campaign::made(&files, seed, number);
    println!("{}", seeds[index].path.display());
    println!("{}", String::from_utf8_lossy(&bytes));
}
