//! The files of a run: recording, stream, viewer's file and summary, in a folder named like the
//! scenario.

use std::fs::File;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

use truecut_files::{room_bytes, write_whole};
use truecut_recording::{Chunk, ClaimResult, PartMesh, Recording, Sink, SinkError, Summary};
use truecut_scenario::Scenario;
use truecut_sim::run::{Extent, RunError};
use truecut_sim::sweep::SweepTable;
use truecut_telemetry::{
    Background, Column, FileError, IpcSink, ParquetSink, Reason, RrdSink, StoredRows, Values,
    write_columns,
};

use crate::maps::{MAP_MESH, MAP_TABLE, MAP_TEXT, MapSink};
use crate::shown::{Shown, ShownSink};
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
    shown: Arc<Mutex<Shown>>,
}

const RECORDING: &str = "recording.parquet";
const STREAM: &str = "recording.arrows";
const VIEWER: &str = "recording.rrd";
/// The workpiece as it is left, of a process that keeps it as a body.
pub const PART: &str = "part.stl";
/// The same with its errors.
pub const PART_ERROR: &str = "part.ply";
/// The run as a page, for people.
pub const REPORT: &str = "run.html";
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
        Ok(Outputs {
            files,
            rrd,
            shown: Arc::default(),
        })
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
        let all = [
            VIEWER, RECORDING, MAP_TABLE, MAP_TEXT, MAP_MESH, REPORT, SUMMARY,
        ];
        let main = if self.rrd { VIEWER } else { RECORDING };
        let may_be = |name: &str| [MAP_TABLE, MAP_TEXT, MAP_MESH, REPORT].contains(&name);
        let written = |name: &&'static str| {
            *name != main
                && (self.rrd || *name != VIEWER)
                && (!may_be(name) || self.path(name).is_file())
        };
        all.into_iter().filter(written).collect()
    }

    /// Sinks that take the rows during the run, on a thread of their own.
    pub fn sinks(&self) -> Vec<Box<dyn Sink + Send>> {
        let mut sinks: Vec<Box<dyn Sink + Send>> = vec![
            Box::new(IpcSink::new(self.path(STREAM))),
            Box::new(ParquetSink::new(self.files.path(RECORDING))),
            Box::new(MapSink::new(|name| self.files.path(name))),
            Box::new(ShownSink::new(Arc::clone(&self.shown))),
        ];
        if self.rrd {
            sinks.push(Box::new(RrdSink::new(self.files.path(VIEWER))));
        }
        vec![Box::new(Background::new(sinks))]
    }

    /// Refuses a run whose rows the disk has no room for, before its first step: for
    /// [`Run::before`](truecut_sim::run::Run::before). What Parquet and the viewer's file take
    /// beside them depends on the rows.
    ///
    /// # Errors
    /// Rows that take more than is free.
    pub fn check_room(&self, extent: &Extent) -> Result<(), SinkError> {
        match room_bytes(self.files.folder()) {
            Ok(Some(free)) => self.fits(extent, free),
            // Whatever cannot be asked shows when it is written to.
            Ok(None) | Err(_) => Ok(()),
        }
    }

    fn fits(&self, extent: &Extent, free_bytes: u64) -> Result<(), SinkError> {
        if extent.bytes() <= free_bytes {
            return Ok(());
        }
        let (rows, channels) = (extent.rows, extent.channels);
        let text = format!(
            "{rows} rows of {channels} channels take {} while the run goes on, but {} are free on the disk; \
             raise run.record_interval_ms, or give another folder by --out",
            size(extent.bytes()),
            size(free_bytes)
        );
        Err(SinkError::new(
            self.path(STREAM).display().to_string(),
            "begin",
            text,
        ))
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

    /// Writes the workpiece as it is left: `part.stl`, its surface in millimetres, and `part.ply`,
    /// the same with what is left beyond the target at each corner, um, for viewers that colour by
    /// a `quality`.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn write_part(&self, part: &PartMesh) -> Result<(), FileError> {
        write_file(&self.files.path(PART), &part.to_stl())?;
        write_file(&self.files.path(PART_ERROR), &part.to_ply())
    }

    /// The rows of a run whose sinks have taken them, a channel at a time.
    ///
    /// # Errors
    /// A Parquet file that cannot be read: none of [`Outputs::sinks`] was closed.
    pub fn rows(&self) -> Result<StoredRows, FileError> {
        StoredRows::open(&self.files.path(RECORDING))
    }

    /// What was seen of a run whose sinks have taken it, for its page.
    pub fn shown(&self) -> Shown {
        let shown = self.shown.lock().unwrap_or_else(PoisonError::into_inner);
        shown.clone()
    }

    /// Writes `run.html`.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn write_report(&self, html: &str) -> Result<(), FileError> {
        write_file(&self.files.path(REPORT), html.as_bytes())
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
        self.files.publish(&[
            VIEWER, RECORDING, STREAM, MODEL, COMPARISON, MAP_TABLE, MAP_TEXT, MAP_MESH, PART,
            PART_ERROR, REPORT, SUMMARY,
        ])
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
    write_whole(&text, |file| sweep_csv(table, file)).map_err(|error| failed(&text, error))?;
    files.publish(&[&[SWEEP_TEXT], served, &[SWEEP]].concat())?;
    Ok(files.folder().join(SWEEP))
}

fn sweep_csv(table: &SweepTable, file: &mut File) -> std::io::Result<()> {
    let mut writer = csv::Writer::from_writer(file);
    let names = table
        .columns
        .iter()
        .map(|column| match &column.unit.symbol[..] {
            "" | "1" => column.name.to_string(),
            unit => format!("{} ({unit})", column.name),
        });
    writer.write_record(names.chain([SWEEP_OUTCOME.to_owned()]))?;
    for (index, row) in table.rows.iter().enumerate() {
        let fields = row.iter().map(|value| match value.is_nan() {
            true => String::new(),
            false => value.to_string(),
        });
        let outcome = table.fault(index).unwrap_or("completed").to_owned();
        writer.write_record(fields.chain([outcome]))?;
    }
    writer.flush()
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

/// Bytes as people say them.
pub fn size(bytes: u64) -> String {
    let bytes = bytes as f64;
    match bytes {
        ..1e6 => format!("{:.1} kB", bytes / 1e3),
        ..1e9 => format!("{:.1} MB", bytes / 1e6),
        _ => format!("{:.2} GB", bytes / 1e9),
    }
}

fn failed(path: &Path, error: std::io::Error) -> FileError {
    FileError {
        path: path.to_owned(),
        reason: Reason::Io(error),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rows that fit are taken to the byte; those that do not are refused with what they take and
    /// what is free.
    #[test]
    fn rows_that_the_disk_cannot_hold_are_refused_before_the_run() {
        let file = concat!(
            env!("CARGO_MANIFEST_DIR"),
            "/../../scenarios/arm/free_decay.toml"
        );
        let scenario = Scenario::load(file.as_ref(), &[]).unwrap();
        let folder = tempfile::tempdir().unwrap();
        let outputs = Outputs::prepare(folder.path(), &scenario, false).unwrap();
        let told = std::sync::Mutex::new(Vec::new());
        let run = truecut_sim::run::Run {
            engine: truecut_sim::run::Engine::REDUCED,
            before: &|extent| {
                told.lock().unwrap().push(*extent);
                outputs.check_room(extent)
            },
            ..truecut_sim::run::Run::of(&scenario)
        };
        let recording = run.execute().unwrap().recording;
        // The run that a claim refers to writes nothing.
        assert!(
            scenario
                .claims
                .iter()
                .any(|claim| claim.relative_to.is_some())
        );
        let told = told.into_inner().unwrap();
        let [extent] = told[..] else {
            panic!("once, of the run itself: {told:?}");
        };
        assert_eq!(extent.rows, recording.time_s.len());
        assert_eq!(extent.channels, recording.columns.len());
        let bytes = 8 * (recording.time_s.len() * (recording.columns.len() + 1)) as u64;
        assert_eq!(extent.bytes(), bytes);
        assert!(outputs.fits(&extent, bytes).is_ok());
        let told = outputs.fits(&extent, bytes - 1).unwrap_err().to_string();
        assert!(told.contains("recording.arrows: cannot begin: "), "{told}");
        assert!(
            told.contains(&size(bytes)) && told.contains("record_interval_ms"),
            "{told}"
        );
    }
}
