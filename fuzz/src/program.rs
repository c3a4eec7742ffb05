//! The same cases through the program: its exit code, what it prints, its memory.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use tempfile::TempDir;

use crate::campaign::{Finding, Tally, made};
use crate::readers::Reader;
use crate::seeds::{Seed, root};

/// Exit codes that the program's help tells of.
const DOCUMENTED: std::ops::RangeInclusive<i32> = 0..=8;
/// Address space of a process, KiB: what its threads and libraries reserve, and 1 GiB.
const ADDRESS_SPACE_KIB: u64 = 4 << 20;
/// Longest that a call may take, s; long runs are cut short by their arguments.
const LONGEST_S: u32 = 120;
/// What `timeout` exits with when it had to end the program.
const TIMED_OUT: i32 = 124;
/// Folders that scenarios of the repository name files in.
const COPIED: &[&str] = &["scenarios", "assets", "tests/invalid_input"];

/// A copy of what scenarios name files in, in which cases lie beside their seeds.
pub struct Desk {
    folder: TempDir,
    program: PathBuf,
}

impl Desk {
    /// For a program that is built.
    ///
    /// # Panics
    /// If the folders cannot be copied.
    #[must_use]
    pub fn new(program: &Path) -> Desk {
        let folder = tempfile::Builder::new()
            .prefix("truecut-fuzz-")
            .tempdir()
            .expect("a folder");
        for copied in COPIED {
            copy(&root().join(copied), &folder.path().join(copied));
        }
        let program = program.canonicalize().expect("the program");
        Desk { folder, program }
    }

    /// Runs the cases `first..last` of a seed, until `stop` says so.
    ///
    /// # Errors
    /// The first case that ends by a signal, with a code that is not documented, not in time, or
    /// prints control characters.
    pub fn run(
        &self,
        reader: &Reader,
        seed: u64,
        cases: std::ops::Range<u64>,
        stop: impl Fn(&Tally) -> bool,
    ) -> Result<Tally, Finding> {
        let seeds = (reader.seeds)();
        let files: Vec<&[u8]> = seeds.iter().map(|seed| seed.bytes.as_slice()).collect();
        let mut tally = Tally::default();
        for number in cases {
            if stop(&tally) {
                break;
            }
            let (index, bytes) = made(&files, seed, number);
            let path = self.place(&seeds[index], number);
            fs::write(&path, &bytes).expect("a file");
            for arguments in reader.commands {
                let began = std::time::Instant::now();
                let output = self.call(arguments, &path);
                tally.note(number, began.elapsed(), output.status.success());
                if let Err(fault) = judge(&output) {
                    let name = path.file_name().expect("a file");
                    let kept = std::env::temp_dir().join(name);
                    fs::copy(&path, &kept).expect("a copy");
                    return Err(Finding {
                        reader: reader.name,
                        seed,
                        number,
                        file: kept,
                        what: format!("{arguments:?}: {fault}"),
                    });
                }
            }
            fs::remove_file(&path).expect("the case");
        }
        Ok(tally)
    }

    /// Beside the seed, by another name with the same ending.
    fn place(&self, seed: &Seed, number: u64) -> PathBuf {
        let name = seed.path.file_name().expect("a file").to_string_lossy();
        let folder = match seed.path.strip_prefix(root()) {
            Ok(inside) => inside.parent().expect("a folder"),
            Err(_) => Path::new(""),
        };
        let folder = self.folder.path().join(folder);
        fs::create_dir_all(&folder).expect("a folder");
        folder.join(format!("case_{number}_{name}"))
    }

    fn call(&self, arguments: &[&str], case: &Path) -> Output {
        let robot = root().join("assets/robots/hp20/robot.urdf");
        let words = arguments.iter().map(|word| match *word {
            "ROBOT" => robot.clone().into_os_string(),
            other => other.replace("CASE", &case.to_string_lossy()).into(),
        });
        let limited =
            format!("ulimit -v {ADDRESS_SPACE_KIB}; exec timeout {LONGEST_S} \"$0\" \"$@\"");
        let mut command = Command::new("sh");
        command
            .arg("-c")
            .arg(limited)
            .arg(&self.program)
            .args(words);
        command
            .current_dir(self.folder.path())
            .env("RUST_BACKTRACE", "0");
        command.output().expect("the program")
    }
}

fn judge(output: &Output) -> Result<(), String> {
    let err = String::from_utf8_lossy(&output.stderr);
    match output.status.code() {
        Some(TIMED_OUT) => return Err(format!("not done in {LONGEST_S} s: {err}")),
        Some(code) if DOCUMENTED.contains(&code) => {}
        _ => return Err(format!("{}: {err}", output.status)),
    }
    let printed = [&output.stdout, &output.stderr].map(|bytes| String::from_utf8_lossy(bytes));
    let control = |c: &char| c.is_control() && !['\n', '\t', '\r'].contains(c);
    match printed.iter().flat_map(|text| text.chars()).find(control) {
        Some(found) => Err(format!("it prints {found:?}: {err}")),
        None => Ok(()),
    }
}

fn copy(from: &Path, to: &Path) {
    fs::create_dir_all(to).expect("a folder");
    for entry in fs::read_dir(from).expect("a folder") {
        let path = entry.expect("an entry").path();
        let target = to.join(path.file_name().expect("a name"));
        match path.is_dir() {
            true => copy(&path, &target),
            false => drop(fs::copy(&path, &target).expect("a copy")),
        }
    }
}
