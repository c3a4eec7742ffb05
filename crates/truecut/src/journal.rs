//! Sweeps that go on where they were stopped: each row is on the disk as soon as it is done.

use std::collections::BTreeMap;
use std::fs::File;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};

use truecut_recording::SinkError;
use truecut_scenario::Scenario;
use truecut_sim::run::{Engine, RunError};
use truecut_sim::sweep::{Sweep, SweepTable, TableRow};
use truecut_telemetry::{FileError, Reason};

use crate::outputs;
use crate::rows::{self, Head};
use crate::staged::Staged;

/// The rows that are done, a line of JSON each, below a line that says of which sweep.
const JOURNAL: &str = "sweep.rows.jsonl";

/// The files of a sweep, in a folder named like its scenario. A sweep that was stopped, by
/// whatever, leaves the rows that were done in `sweep.rows.jsonl`; the next one of the same
/// scenario, with the same files and the same version, takes them over.
pub struct SweepOutputs<'a> {
    scenario: &'a Scenario,
    engine: Engine,
    files: Staged,
    kept: BTreeMap<usize, TableRow>,
    journal: Mutex<File>,
    done: AtomicUsize,
}

impl<'a> SweepOutputs<'a> {
    /// Makes the folder below `out`, locks it, and looks for the rows of a sweep that was stopped.
    ///
    /// # Errors
    /// What makes the scenario unfit to run; a folder that cannot be written to, or into which
    /// another program is writing.
    pub fn prepare(
        out: &Path,
        scenario: &'a Scenario,
        engine: Engine,
    ) -> Result<SweepOutputs<'a>, RunError> {
        let head = Head::of(scenario, engine)?;
        let files = Staged::begin(&out.join(scenario.stem())).map_err(unwritten)?;
        let path = files.folder().join(JOURNAL);
        let kept = rows::of_sweep(&path, &head).unwrap_or_default();
        let journal = begin(&path, &head, &kept).map_err(|error| unwritten_at(&path, error))?;
        Ok(SweepOutputs {
            scenario,
            engine,
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
            engine: self.engine,
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
        rows::append(&mut file, index, row)
            .map_err(|error| unwritten_at(&self.files.folder().join(JOURNAL), error))?;
        self.done.fetch_add(1, Ordering::Relaxed);
        Ok(())
    }
}

/// A journal anew, with the rows that are kept.
fn begin(path: &Path, head: &Head, kept: &BTreeMap<usize, TableRow>) -> std::io::Result<File> {
    let mut file = truecut_files::fresh(path)?;
    rows::write(&mut file, head, kept)?;
    Ok(file)
}

pub(crate) fn unwritten(error: FileError) -> RunError {
    let target = error.path.display().to_string();
    RunError::Sink(SinkError::new(target, "write", error.reason))
}

pub(crate) fn unwritten_at(path: &Path, error: std::io::Error) -> RunError {
    unwritten(FileError {
        path: path.to_owned(),
        reason: Reason::Io(error),
    })
}
