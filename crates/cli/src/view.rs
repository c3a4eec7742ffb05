//! `truecut view`: opens the viewer, or lists the channels of a recording.

use std::path::{Path, PathBuf};
use std::process::Command;

use truecut_recording::{Chunk, Recording, Sink, Unit, reduce, significant};
use truecut_telemetry::{RrdSink, read_recording};

use crate::args::ViewArguments;
use crate::exit_status::ExitStatus;
use crate::failure::Failure;
use crate::text::{self, Align};

/// How to install the matching viewer.
const GET_VIEWER: &str = "pip install rerun-sdk==0.36.3";

/// Opens or lists the file.
pub fn view(arguments: &ViewArguments) -> Result<ExitStatus, Failure> {
    let file = &arguments.file;
    if file.is_dir() {
        let text = format!("{}: is a folder, not a recording", file.display());
        let help = "name a file in it: run.rrd opens in the viewer, run.parquet is listed";
        return Err(Failure::with_help(text, help));
    }
    if !file.exists() {
        return Err(Failure::at(file, "no such file"));
    }
    if file.extension().is_some_and(|extension| extension == "rrd") {
        return open(file);
    }
    let recording = read_recording(file).map_err(|error| Failure::message(error.to_string()))?;
    if arguments.rrd {
        // Never the name of the run's own file for the viewer, which has the scene, too.
        let mut target = file.clone().into_os_string();
        target.push(".rrd");
        let target = PathBuf::from(target);
        convert(&recording, &target)?;
        return crate::print(&format!("{}\n", target.display()));
    }
    crate::print(&list(file, &recording))
}

fn open(file: &Path) -> Result<ExitStatus, Failure> {
    let status = match Command::new("rerun").arg(file).status() {
        Ok(status) => status,
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => {
            let text = format!("{}: the viewer `rerun` is not on the PATH", file.display());
            return Err(Failure::with_help(
                text,
                format!("get it with `{GET_VIEWER}`"),
            ));
        }
        Err(error) => return Err(Failure::message(format!("the viewer `rerun`: {error}"))),
    };
    if status.success() {
        return Ok(ExitStatus::Good);
    }
    let help = format!("recordings need the viewer of `{GET_VIEWER}`");
    Err(Failure::with_help(
        format!("`rerun` ended with {status}"),
        help,
    ))
}

/// Writes a `.rrd` with the curves of a recording; the 3-D scene is only in the `.rrd` of the run
/// itself.
fn convert(recording: &Recording, target: &Path) -> Result<(), Failure> {
    let failed = |error: truecut_recording::SinkError| Failure::message(error.to_string());
    let mut sink = RrdSink::new(target);
    sink.begin(&recording.header).map_err(failed)?;
    let chunk = Chunk {
        time_s: &recording.time_s,
        columns: recording.columns.iter().map(Vec::as_slice).collect(),
        frames: &[],
    };
    sink.chunk(&chunk).map_err(failed)?;
    sink.finish(recording, &[]).map_err(failed)
}

/// A time without what rounding left of steps that were added up: whole nanoseconds.
fn shown_s(time_s: f64) -> f64 {
    (time_s * 1e9).round() / 1e9
}

fn list(file: &Path, recording: &Recording) -> String {
    let header = &recording.header;
    let span = match (recording.time_s.first(), recording.time_s.last()) {
        (Some(first), Some(last)) => format!("{} to {} s", shown_s(*first), shown_s(*last)),
        _ => "nothing".to_owned(),
    };
    let mut text = format!(
        "{}\n  {}: {}, {} rows, {span}\n",
        header.scenario_name,
        file.display(),
        text::outcome(&recording.outcome),
        recording.time_s.len()
    );
    text.push_str(&text::notes(&header.notes));
    let head = ["channel", "unit", "min", "max", "rms", "what"];
    let channels = header
        .channels
        .iter()
        .zip(&recording.columns)
        .map(|(channel, column)| {
            let unit = unit_of(channel.unit, column);
            let shown = |value: f64| significant(unit.from_si(value), 4);
            vec![
                channel.name.clone(),
                unit.symbol.clone(),
                shown(reduce::min(column)),
                shown(reduce::max(column)),
                shown(reduce::rms(&recording.time_s, column)),
                channel.description.clone(),
            ]
        });
    use Align::{Left, Right};
    let aligns = [Left, Left, Right, Right, Right, Left];
    let table = text::table(&aligns, &text::headed(&head, channels));
    text.push_str(&format!("\n{table}"));
    if !recording.scalars.is_empty() {
        text.push_str(&format!("\n{}", text::scalars(&recording.scalars)));
    }
    text
}

fn unit_of(unit: Unit, column: &[f64]) -> truecut_recording::UserUnit {
    text::reading_unit(unit, reduce::peak(column))
}
