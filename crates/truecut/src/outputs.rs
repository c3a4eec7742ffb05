//! The files of a run: recording, stream, viewer's file and summary, in a folder named like the
//! scenario.

use std::fs::{File, TryLockError};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use truecut_recording::{Chunk, ClaimResult, Recording, Sink, SinkError, Summary};
use truecut_scenario::Scenario;
use truecut_sim::run::RunError;
use truecut_sim::sweep::SweepTable;
use truecut_telemetry::{
    Background, Column, FileError, IpcSink, ParquetSink, Reason, RrdSink, Values, write_columns,
};

/// The files of one scenario, in a folder named like it.
///
/// ```
/// use truecut::{Engine, Outputs, Run, Scenario};
///
/// # let out = tempfile::tempdir()?;
/// # let out = out.path();
/// let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenarios/arm/free_decay.toml");
/// let scenario = Scenario::load(file.as_ref(), &[])?;
/// let outputs = Outputs::prepare(out, &scenario, false)?;
/// let run = Run { sinks: outputs.sinks(), engine: Engine::REDUCED, ..Run::of(&scenario) };
/// let run = run.execute()?;
/// outputs.write_summary(&run.recording, &run.claims)?;
/// assert!(out.join("free_decay/recording.parquet").is_file());
/// assert!(out.join("free_decay/summary.json").is_file());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct Outputs {
    folder: PathBuf,
    rrd: bool,
    /// The folder, locked for as long as something may be written into it.
    _lock: Option<Arc<File>>,
}

const RECORDING: &str = "recording.parquet";
const STREAM: &str = "recording.arrows";
const VIEWER: &str = "recording.rrd";
const SUMMARY: &str = "summary.json";
/// The robot for MuJoCo, written by a cross-check.
pub const MODEL: &str = "model.xml";
/// Comparison of the two engines, written by a cross-check.
pub const COMPARISON: &str = "crosscheck.json";

impl Outputs {
    /// Makes the folder below `out`, locks it against other runs, and removes files of earlier ones
    /// from it. With `rrd` a file for the viewer is written, too.
    ///
    /// # Errors
    /// A folder that cannot be made or into which another run is writing, a file that cannot be
    /// removed.
    pub fn prepare(out: &Path, scenario: &Scenario, rrd: bool) -> Result<Outputs, FileError> {
        let folder = out.join(scenario.stem());
        std::fs::create_dir_all(&folder).map_err(|error| failed(&folder, error))?;
        let outputs = Outputs {
            _lock: lock(&folder)?,
            folder,
            rrd,
        };
        for name in [RECORDING, STREAM, VIEWER, SUMMARY, MODEL, COMPARISON] {
            let path = outputs.path(name);
            match std::fs::remove_file(&path) {
                Err(error) if error.kind() != std::io::ErrorKind::NotFound => {
                    return Err(failed(&path, error));
                }
                _ => {}
            }
        }
        Ok(outputs)
    }

    /// A file of the folder.
    pub fn path(&self, name: &str) -> PathBuf {
        self.folder.join(name)
    }

    /// The Parquet file.
    pub fn recording(&self) -> PathBuf {
        self.path(RECORDING)
    }

    /// The main file: for the viewer if there is one, else the Parquet file.
    pub fn main_file(&self) -> PathBuf {
        self.path(if self.rrd { VIEWER } else { RECORDING })
    }

    /// The other files.
    pub fn other_files(&self) -> Vec<&'static str> {
        let all = [VIEWER, RECORDING, STREAM, SUMMARY];
        let main = if self.rrd { VIEWER } else { RECORDING };
        let written = |name: &&'static str| *name != main && (self.rrd || *name != VIEWER);
        all.into_iter().filter(written).collect()
    }

    /// Sinks that take the rows during the run, on a thread of their own.
    pub fn sinks(&self) -> Vec<Box<dyn Sink + Send>> {
        let mut sinks: Vec<Box<dyn Sink + Send>> = vec![
            Box::new(IpcSink::new(self.path(STREAM))),
            Box::new(ParquetSink::new(self.recording())),
        ];
        if self.rrd {
            sinks.push(Box::new(RrdSink::new(self.path(VIEWER))));
        }
        vec![Box::new(Background::new(sinks))]
    }

    /// Writes all files of a recording that is in memory; the viewer's file has curves only, since
    /// what is seen is not kept in memory.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn write(&self, recording: &Recording, claims: &[ClaimResult]) -> Result<(), RunError> {
        let chunk = Chunk {
            time_s: &recording.time_s,
            columns: recording.columns.iter().map(Vec::as_slice).collect(),
            frames: &[],
        };
        for mut sink in self.sinks() {
            (sink.begin(&recording.header))
                .and_then(|()| sink.chunk(&chunk))
                .and_then(|()| sink.finish(recording, claims))
                .map_err(RunError::Sink)?;
        }
        self.write_summary(recording, claims).map_err(|error| {
            let target = self.path(SUMMARY).display().to_string();
            RunError::Sink(SinkError::new(target, "write", error))
        })
    }

    /// Writes `summary.json`; the sinks write the rest.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn write_summary(
        &self,
        recording: &Recording,
        claims: &[ClaimResult],
    ) -> Result<(), FileError> {
        let path = self.path(SUMMARY);
        let summary = serde_json::to_string_pretty(&Summary::new(recording, claims))
            .map_err(|error| failed(&path, error.into()))?;
        write_file(&path, format!("{summary}\n").as_bytes())
    }
}

/// Name of the column of a sweep's table that says how a row's runs ended: `completed`, which did
/// not come to its end, and why, or which drive was overloaded.
pub const SWEEP_OUTCOME: &str = "outcome";

/// Writes a sweep's table as `sweep.parquet`, into a folder below `out` that is named like the
/// scenario: a column for each axis and result, its unit in the field's metadata, and how each
/// row's runs ended in the last. `sweep.csv` beside it has the same, units in its first line, a
/// value that is missing as an empty field. Returns the Parquet file. Equal tables give equal
/// bytes.
///
/// # Errors
/// A file or folder that cannot be written.
pub fn write_sweep(
    out: &Path,
    scenario: &Scenario,
    table: &SweepTable,
) -> Result<PathBuf, FileError> {
    let folder = out.join(scenario.stem());
    std::fs::create_dir_all(&folder).map_err(|error| failed(&folder, error))?;
    let results = table.columns.iter().enumerate().map(|(index, column)| {
        let values = table.rows.iter().map(|row| row[index]).collect();
        Column::numbers(&column.name, &column.unit.symbol, values)
    });
    let outcomes = 0..table.rows.len();
    let outcomes = outcomes.map(|row| table.fault(row).unwrap_or("completed"));
    let outcome = Column {
        name: SWEEP_OUTCOME,
        values: Values::Words(outcomes.collect()),
    };
    let columns: Vec<Column<'_>> = results.chain([outcome]).collect();
    let path = folder.join("sweep.parquet");
    write_columns(&path, &columns, &scenario.effective_text())?;
    let text = path.with_extension("csv");
    sweep_csv(table)
        .and_then(|bytes| std::fs::write(&text, bytes))
        .map_err(|error| failed(&text, error))?;
    Ok(path)
}

fn sweep_csv(table: &SweepTable) -> std::io::Result<Vec<u8>> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    let names = table
        .columns
        .iter()
        .map(|column| match &column.unit.symbol[..] {
            "" | "1" => column.name.to_string(),
            unit => format!("{} ({unit})", column.name),
        });
    writer.write_record(names.chain([SWEEP_OUTCOME.to_owned()]))?;
    for (index, row) in table.rows.iter().enumerate() {
        let fields = row.iter().map(|value| match value.is_finite() {
            true => value.to_string(),
            false => String::new(),
        });
        let outcome = table.fault(index).unwrap_or("completed").to_owned();
        writer.write_record(fields.chain([outcome]))?;
    }
    writer.into_inner().map_err(csv::IntoInnerError::into_error)
}

/// Writes a file, and makes its folder.
///
/// # Errors
/// A file or folder that cannot be written.
pub fn write_file(path: &Path, content: &[u8]) -> Result<(), FileError> {
    let folder = path
        .parent()
        .filter(|folder| !folder.as_os_str().is_empty());
    folder
        .map_or(Ok(()), std::fs::create_dir_all)
        .and_then(|()| std::fs::write(path, content))
        .map_err(|error| failed(path, error))
}

/// Locks a folder; `None` where the file system has no locks.
fn lock(folder: &Path) -> Result<Option<Arc<File>>, FileError> {
    let Ok(file) = File::open(folder) else {
        return Ok(None);
    };
    match file.try_lock() {
        Ok(()) => Ok(Some(Arc::new(file))),
        Err(TryLockError::WouldBlock) => {
            let because =
                "another run is writing into this folder: give --out another one, or wait";
            Err(failed(folder, std::io::Error::other(because)))
        }
        Err(TryLockError::Error(_)) => Ok(None),
    }
}

fn failed(path: &Path, error: std::io::Error) -> FileError {
    FileError {
        path: path.to_owned(),
        reason: Reason::Io(error),
    }
}
