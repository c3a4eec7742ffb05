//! Cases one after the other.

use std::alloc::System;
use std::fmt;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::PathBuf;
use std::time::{Duration, Instant};

use arbitrary::Unstructured;
use cap::Cap;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{RngCore, SeedableRng};

use crate::mutate::damaged;
use crate::readers::{Case, Reader};

/// Most memory that reading a file may take: this many times the file, and a fixed amount, bytes.
pub const TIMES_THE_FILE: usize = 8;
/// See [`TIMES_THE_FILE`].
pub const AND_BYTES: usize = 200 << 20;
/// Bytes of choices that a case is made of.
const CHOICES: usize = 96;

/// What a campaign came to.
#[derive(Debug, Clone, Default)]
pub struct Tally {
    pub cases: u64,
    /// Cases that were accepted.
    pub accepted: u64,
    /// The case that took longest, and how long.
    pub slowest: (u64, Duration),
}

impl Tally {
    pub(crate) fn note(&mut self, number: u64, took: Duration, is_accepted: bool) {
        self.cases += 1;
        self.accepted += u64::from(is_accepted);
        if took > self.slowest.1 {
            self.slowest = (number, took);
        }
    }
}

impl fmt::Display for Tally {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (number, took) = self.slowest;
        write!(
            f,
            "{} cases, {} accepted, slowest {:.3} s (case {number})",
            self.cases,
            self.accepted,
            took.as_secs_f64()
        )
    }
}

/// A case in which a reader panicked, or the program did what it may not.
#[derive(Debug)]
pub struct Finding {
    pub reader: &'static str,
    pub seed: u64,
    pub number: u64,
    /// The file, kept.
    pub file: PathBuf,
    pub what: String,
}

impl fmt::Display for Finding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (reader, seed, number) = (self.reader, self.seed, self.number);
        let file = self.file.display();
        write!(
            f,
            "{reader}, seed {seed}, case {number}: {} ({file})",
            self.what
        )
    }
}

/// Runs the cases `first..last` of a seed, until `stop` says so.
///
/// Each case lies in a file before it is read: what ends the process (memory beyond the limit,
/// a stack that overflows) leaves it there.
///
/// # Errors
/// The first case in which the reader panics.
pub fn run(
    reader: &Reader,
    seed: u64,
    cases: std::ops::Range<u64>,
    memory: &Cap<System>,
    stop: impl Fn(&Tally) -> bool,
) -> Result<Tally, Finding> {
    let seeds = (reader.seeds)();
    let files: Vec<&[u8]> = seeds.iter().map(|seed| seed.bytes.as_slice()).collect();
    let folder = tempfile::Builder::new()
        .prefix("truecut-fuzz-")
        .tempdir_in(scratch())
        .expect("a folder");
    let mut tally = Tally::default();
    for number in cases {
        if stop(&tally) {
            break;
        }
        let (index, bytes) = made(&files, seed, number);
        let case = Case {
            path: &seeds[index].path,
            bytes: &bytes,
            folder: folder.path(),
        };
        let name = case.path.file_name().expect("a file").to_string_lossy();
        let kept = folder
            .path()
            .join(format!("{}-{seed}-{number}-{name}", reader.name));
        std::fs::write(&kept, &bytes).expect("a file");
        let began = Instant::now();
        let allowed = TIMES_THE_FILE * bytes.len() + AND_BYTES;
        let limit = memory.allocated().saturating_add(allowed);
        memory.set_limit(limit).expect("a limit above what is held");
        let read = catch_unwind(AssertUnwindSafe(|| (reader.read)(&case)));
        memory.set_limit(usize::MAX).expect("no limit");
        let took = began.elapsed();
        let is_accepted = match read {
            Ok(said) => said.is_ok(),
            Err(panic) => {
                let file = folder.keep().join(kept.file_name().expect("a file"));
                let text = panic.downcast_ref::<String>().cloned();
                let text =
                    text.or_else(|| panic.downcast_ref::<&str>().map(|text| (*text).to_owned()));
                return Err(Finding {
                    reader: reader.name,
                    seed,
                    number,
                    file,
                    what: text.unwrap_or_default(),
                });
            }
        };
        std::fs::remove_file(&kept).expect("a file");
        tally.note(number, took, is_accepted);
    }
    Ok(tally)
}

/// Where cases lie while they are read: in memory, where a file system makes and takes away small
/// files ten times as fast as on a disk, unless another folder is asked for.
fn scratch() -> PathBuf {
    let memory = PathBuf::from("/dev/shm");
    match std::env::var_os("TMPDIR").is_none() && memory.is_dir() {
        true => memory,
        false => std::env::temp_dir(),
    }
}

/// The case of a number: which file it was made of, and its bytes.
#[must_use]
pub fn made(files: &[&[u8]], seed: u64, number: u64) -> (usize, Vec<u8>) {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    rng.set_stream(number);
    let mut choices = [0; CHOICES];
    rng.fill_bytes(&mut choices);
    // Where the choices run out, they go on as zeros.
    damaged(files, &mut Unstructured::new(&choices)).unwrap_or_default()
}
