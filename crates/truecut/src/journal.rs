//! Sweeps that go on where they were stopped: each row is on the disk as soon as it is done.

use std::collections::BTreeMap;
use std::fs::File;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};

use serde::{Deserialize, Serialize};
use truecut_files::{read_text, watched};
use truecut_recording::{Outcome, SinkError};
use truecut_scenario::Scenario;
use truecut_sim::run::{Run, RunError};
use truecut_sim::sweep::{Fault, Sweep, SweepTable, TableRow};
use truecut_telemetry::{FileError, Reason};

use crate::outputs;
use crate::staged::Staged;

/// The rows that are done, a line of JSON each, below a line that says of which sweep.
const JOURNAL: &str = "sweep.rows.jsonl";

/// The files of a sweep, in a folder named like its scenario. A sweep that was stopped, by
/// whatever, leaves the rows that were done in `sweep.rows.jsonl`; the next one of the same
/// scenario, with the same files and the same version, takes them over.
pub struct SweepOutputs<'a> {
    scenario: &'a Scenario,
    files: Staged,
    kept: BTreeMap<usize, TableRow>,
    journal: Mutex<File>,
    done: AtomicUsize,
}

/// The first line.
#[derive(Serialize, Deserialize, PartialEq)]
struct Head {
    sweep: String,
    /// Of the scenario as it runs, the files that it reads and the version.
    identity: String,
}

/// A row that is done.
#[derive(Serialize, Deserialize)]
struct Line {
    row: usize,
    /// As texts, since JSON has neither infinity nor a number that is none.
    values: Vec<String>,
    fault: Option<(Outcome, String)>,
}

impl<'a> SweepOutputs<'a> {
    /// Makes the folder below `out`, locks it, and looks for the rows of a sweep that was stopped.
    ///
    /// # Errors
    /// What makes the scenario unfit to run; a folder that cannot be written to, or into which
    /// another program is writing.
    pub fn prepare(out: &Path, scenario: &'a Scenario) -> Result<SweepOutputs<'a>, RunError> {
        let (checked, read) = watched(|| Run::of(scenario).check());
        checked?;
        let files = Staged::begin(&out.join(scenario.stem())).map_err(unwritten)?;
        let mut digest = DefaultHasher::new();
        (scenario.effective_text(), read, env!("CARGO_PKG_VERSION")).hash(&mut digest);
        let head = Head {
            sweep: scenario.name.clone(),
            identity: format!("{:016x}", digest.finish()),
        };
        let path = files.folder().join(JOURNAL);
        let kept = kept(&path, &head);
        let journal = begin(&path, &head, &kept).map_err(|error| unwritten_at(&path, error))?;
        Ok(SweepOutputs {
            scenario,
            files,
            done: kept.len().into(),
            kept,
            journal: Mutex::new(journal),
        })
    }

    /// How many rows an earlier sweep has left.
    pub fn kept(&self) -> usize {
        self.kept.len()
    }

    /// How many rows are on the disk.
    pub fn done(&self) -> usize {
        self.done.load(Ordering::Relaxed)
    }

    /// Runs the rows that are left, until `stop` is set. `progress` is told the part of all rows
    /// that is done, 0 to 1.
    ///
    /// # Errors
    /// As [`Sweep::execute`]; a row that cannot be written.
    pub fn run(
        &self,
        progress: &(dyn Fn(f64) + Sync),
        stop: Option<&AtomicBool>,
    ) -> Result<SweepTable, RunError> {
        let sweep = Sweep {
            kept: Some(&self.kept),
            done: &|index, row| self.keep(index, row),
            progress,
            stop,
            ..Sweep::of(self.scenario)
        };
        sweep.execute()
    }

    /// Writes the table, as [`outputs::write_sweep`]; the rows kept apart have served.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn finish(self, table: &SweepTable) -> Result<PathBuf, FileError> {
        outputs::publish_sweep(&self.files, self.scenario, table, &[JOURNAL])
    }

    fn keep(&self, index: usize, row: &TableRow) -> Result<(), RunError> {
        let mut file = self.journal.lock().unwrap_or_else(PoisonError::into_inner);
        append(&mut file, index, row)
            .map_err(|error| unwritten_at(&self.files.folder().join(JOURNAL), error))?;
        self.done.fetch_add(1, Ordering::Relaxed);
        Ok(())
    }
}

/// The rows that were done of the same sweep. A line that was torn is none.
fn kept(path: &Path, head: &Head) -> BTreeMap<usize, TableRow> {
    let text = read_text(path).unwrap_or_default();
    let mut lines = text.lines();
    let is_same = |line| serde_json::from_str::<Head>(line).is_ok_and(|found| found == *head);
    if !lines.next().is_some_and(is_same) {
        return BTreeMap::new();
    }
    lines
        .filter_map(|line| serde_json::from_str::<Line>(line).ok()?.row())
        .collect()
}

/// A journal anew, with the rows that are kept.
fn begin(path: &Path, head: &Head, kept: &BTreeMap<usize, TableRow>) -> std::io::Result<File> {
    let mut file = truecut_files::fresh(path)?;
    writeln!(file, "{}", serde_json::to_string(head)?)?;
    for (index, row) in kept {
        append(&mut file, *index, row)?;
    }
    Ok(file)
}

/// A line at once, so that a kill tears at most the last.
fn append(file: &mut File, index: usize, row: &TableRow) -> std::io::Result<()> {
    let line = Line {
        row: index,
        values: row.values.iter().map(f64::to_string).collect(),
        fault: (row.fault.as_ref()).map(|it| (it.outcome.clone(), it.why.clone())),
    };
    file.write_all(format!("{}\n", serde_json::to_string(&line)?).as_bytes())
}

impl Line {
    fn row(self) -> Option<(usize, TableRow)> {
        let values = self.values.iter().map(|value| value.parse().ok());
        let row = TableRow {
            values: values.collect::<Option<Vec<f64>>>()?,
            fault: (self.fault).map(|(outcome, why)| Fault { outcome, why }),
        };
        Some((self.row, row))
    }
}

fn unwritten(error: FileError) -> RunError {
    let target = error.path.display().to_string();
    RunError::Sink(SinkError::new(target, "write", error.reason))
}

fn unwritten_at(path: &Path, error: std::io::Error) -> RunError {
    unwritten(FileError {
        path: path.to_owned(),
        reason: Reason::Io(error),
    })
}
