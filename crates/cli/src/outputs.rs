//! Where a run writes, and what.

use std::path::{Path, PathBuf};

use truecut_recording::{ClaimResult, Recording, Sink, Summary};
use truecut_scenario::Scenario;
use truecut_telemetry::{Background, IpcSink, ParquetSink, RrdSink};

use crate::failure::Failure;

/// The files of one scenario, in a folder named like it.
pub struct Outputs {
    folder: PathBuf,
    rrd: bool,
}

const RECORDING: &str = "recording.parquet";
const STREAM: &str = "recording.arrows";
const VIEWER: &str = "recording.rrd";
const SUMMARY: &str = "summary.json";
/// The robot for MuJoCo, and how the two engines compare: what a cross-check adds.
pub const MODEL: &str = "model.xml";
pub const COMPARISON: &str = "crosscheck.json";

impl Outputs {
    /// Makes the folder, and removes what an earlier run left there: what is in it afterwards is of this run.
    pub fn prepare(out: &Path, scenario: &Scenario, rrd: bool) -> Result<Outputs, Failure> {
        let outputs = Outputs {
            folder: out.join(scenario.stem()),
            rrd,
        };
        let failed = |path: &Path, error| Failure::message(format!("{}: {error}", path.display()));
        std::fs::create_dir_all(&outputs.folder).map_err(|error| failed(&outputs.folder, error))?;
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

    /// The file that shows most: for the viewer if there is one.
    pub fn main_file(&self) -> PathBuf {
        self.path(if self.rrd { VIEWER } else { RECORDING })
    }

    /// What else lies beside the main file.
    pub fn other_files(&self) -> Vec<&'static str> {
        let all = [VIEWER, RECORDING, STREAM, SUMMARY];
        let main = if self.rrd { VIEWER } else { RECORDING };
        let written = |name: &&'static str| *name != main && (self.rrd || *name != VIEWER);
        all.into_iter().filter(written).collect()
    }

    /// What takes the rows while the run is under way.
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

    /// Writes the summary; the sinks write the rest.
    pub fn write_end(&self, recording: &Recording, claims: &[ClaimResult]) -> Result<(), Failure> {
        let summary = serde_json::to_string_pretty(&Summary::new(recording, claims))
            .map_err(|error| Failure::message(format!("{SUMMARY}: {error}")))?;
        write_file(&self.path(SUMMARY), format!("{summary}\n").as_bytes())
    }
}

/// Writes a file, and makes its folder.
pub fn write_file(path: &Path, content: &[u8]) -> Result<(), Failure> {
    let folder = path
        .parent()
        .filter(|folder| !folder.as_os_str().is_empty());
    folder
        .map_or(Ok(()), std::fs::create_dir_all)
        .and_then(|()| std::fs::write(path, content))
        .map_err(|error| Failure::message(format!("{}: {error}", path.display())))
}
