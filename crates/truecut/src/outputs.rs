//! The files of a run: recording, stream, viewer's file and summary, in a folder named like the
//! scenario.

use std::io::Write;
use std::path::{Path, PathBuf};

use truecut_files::write_whole;
use truecut_recording::{Chunk, ClaimResult, Recording, Sink, SinkError, Summary};
use truecut_scenario::Scenario;
use truecut_sim::run::RunError;
use truecut_sim::sweep::SweepTable;
use truecut_telemetry::{
    Background, Column, FileError, IpcSink, ParquetSink, Reason, RrdSink, Values, write_columns,
};

use crate::staged::Staged;

/// The files of one scenario, in a folder named like it. They get their places together, by
/// [`Outputs::finish`]; until then those of an earlier run stay. Only `recording.arrows` is there
/// while the run goes on, and stays if it is killed: every row up to then.
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
/// outputs.finish(&run.recording, &run.claims)?;
/// assert!(out.join("free_decay/recording.parquet").is_file());
/// assert!(out.join("free_decay/summary.json").is_file());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct Outputs {
    files: Staged,
    rrd: bool,
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
    /// Makes the folder below `out` and locks it against other runs. With `rrd` a file for the
    /// viewer is written, too.
    ///
    /// # Errors
    /// A folder that cannot be made or written to, that is a link, or into which another run is
    /// writing.
    pub fn prepare(out: &Path, scenario: &Scenario, rrd: bool) -> Result<Outputs, FileError> {
        let files = Staged::begin(&out.join(scenario.stem()))?;
        Ok(Outputs { files, rrd })
    }

    /// A file of the folder.
    pub fn path(&self, name: &str) -> PathBuf {
        self.files.folder().join(name)
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
        let all = [VIEWER, RECORDING, SUMMARY];
        let main = if self.rrd { VIEWER } else { RECORDING };
        let written = |name: &&'static str| *name != main && (self.rrd || *name != VIEWER);
        all.into_iter().filter(written).collect()
    }

    /// Sinks that take the rows during the run, on a thread of their own.
    pub fn sinks(&self) -> Vec<Box<dyn Sink + Send>> {
        let mut sinks: Vec<Box<dyn Sink + Send>> = vec![
            Box::new(IpcSink::new(self.path(STREAM))),
            Box::new(ParquetSink::new(self.files.path(RECORDING))),
        ];
        if self.rrd {
            sinks.push(Box::new(RrdSink::new(self.files.path(VIEWER))));
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
        self.finish(recording, claims).map_err(|error| {
            let target = self.path(SUMMARY).display().to_string();
            RunError::Sink(SinkError::new(target, "write", error))
        })
    }

    /// Writes `summary.json`, and gives all files their places: those of an earlier run go, the
    /// stream goes since the Parquet file has its rows. A summary is there only beside the files
    /// of its run.
    ///
    /// # Errors
    /// A file that cannot be written, replaced or removed.
    pub fn finish(&self, recording: &Recording, claims: &[ClaimResult]) -> Result<(), FileError> {
        let path = self.files.path(SUMMARY);
        let summary = serde_json::to_string_pretty(&Summary::new(recording, claims))
            .map_err(|error| failed(&path, error.into()))?;
        write_file(&path, format!("{summary}\n").as_bytes())?;
        self.files
            .publish(&[VIEWER, RECORDING, STREAM, MODEL, COMPARISON, SUMMARY])
    }
}

/// Name of the column of a sweep's table that says how a row's runs ended: `completed`, which did
/// not come to its end, and why, or why they fail all the same.
pub const SWEEP_OUTCOME: &str = "outcome";
const SWEEP: &str = "sweep.parquet";
const SWEEP_TEXT: &str = "sweep.csv";

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
    publish_sweep(
        &Staged::begin(&out.join(scenario.stem()))?,
        scenario,
        table,
        &[],
    )
}

/// The same into a folder that is held already; of the files in `served` an earlier sweep had use.
pub(crate) fn publish_sweep(
    files: &Staged,
    scenario: &Scenario,
    table: &SweepTable,
    served: &[&str],
) -> Result<PathBuf, FileError> {
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
    write_columns(&files.path(SWEEP), &columns, &scenario.effective_text())?;
    let text = files.path(SWEEP_TEXT);
    let bytes = sweep_csv(table).map_err(|error| failed(&text, error))?;
    write_file(&text, &bytes)?;
    files.publish(&[&[SWEEP_TEXT], served, &[SWEEP]].concat())?;
    Ok(files.folder().join(SWEEP))
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

/// Writes a file, and makes its folder. What the file held stays until the new content is on the
/// disk as a whole.
///
/// # Errors
/// A file or folder that cannot be written.
pub fn write_file(path: &Path, content: &[u8]) -> Result<(), FileError> {
    let folder = path
        .parent()
        .filter(|folder| !folder.as_os_str().is_empty());
    folder
        .map_or(Ok(()), std::fs::create_dir_all)
        .and_then(|()| write_whole(path, |file| file.write_all(content)))
        .map_err(|error| failed(path, error))
}

fn failed(path: &Path, error: std::io::Error) -> FileError {
    FileError {
        path: path.to_owned(),
        reason: Reason::Io(error),
    }
}
