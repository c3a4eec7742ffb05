//! `truecut compare`: a simulation against measured data.

mod figures;
mod text;

use std::path::Path;

use truecut::data;
use truecut::outputs::write_file;
use truecut_discrepancy::compare::{CompareError, Comparison, compare_recordings};
use truecut_discrepancy::spikes;
use truecut_discrepancy::trial::{begins_in_motion, for_comparison};
use truecut_recording::{Measured, Recording};
use truecut_scenario::Scenario;
use truecut_sim::run::{Claims, Run};
use truecut_sim::{Robots, estimates};

use crate::args::CompareArguments;
use crate::failure::Failure;
use crate::page::{self, MOST_POINTS, Page, REPORT};
use crate::progress::{PatientBar, Progress};
use crate::waiting::told;

use crate::exit_status::ExitStatus;

/// Output folder below that of the scenario, and the report in it.
const FOLDER: &str = "compare";
const ANSWER: &str = "compare.json";

/// Runs the scenario, compares it with its data, prints the table, writes report and figures.
pub fn compare(arguments: &CompareArguments) -> Result<ExitStatus, Failure> {
    let scenario = &arguments.common.load(&arguments.scenario)?;
    if scenario.sweep.is_some() {
        let text = "a sweep cannot be compared with data: only single runs can";
        return Err(scenario.problem("sweep", text).into());
    }
    let bar = PatientBar::new(1, "{msg:12} {elapsed}");
    let read = || data::measured(scenario, arguments.data.as_deref());
    let measured = told(&bar, "reading", read)?;
    drop(bar);
    let finished = Progress::of_one("running", |progress| {
        let run = Run {
            measured: Some(&measured),
            claims: Claims::Ignore,
            progress,
            ..Run::of(scenario)
        };
        run.execute()
    })?;
    let (simulated, whole) = (finished.recording, finished.compared.unwrap_or(measured));
    if !simulated.outcome.reached_end() {
        let outcome = crate::text::outcome(&simulated.outcome);
        crate::print(&format!("{}\n  {outcome}\n", scenario.name))?;
        return Ok(ExitStatus::of_outcome(&simulated.outcome));
    }
    let turning = scenario.process.facts().rate_rad_s;
    let turning = turning.map(|rad_s| rad_s / std::f64::consts::TAU);
    let spindle_hz = arguments.rpm.map(|rpm| rpm / 60.0).or(turning);
    let bar = PatientBar::new(1, "{msg:12} {elapsed}");
    let (spiky, measured, compared) = told(&bar, "comparing", || {
        let spiky = spikes::notes(scenario, &whole);
        let measured = for_comparison(scenario, whole);
        let compared = compare_recordings(&simulated, &measured, spindle_hz);
        (spiky, measured, compared)
    });
    let mut comparison = compared.map_err(|error| refused(scenario, &measured, &error))?;
    let assumed = estimates(scenario, &Robots::new());
    (comparison.notes).extend(assumed.map_err(|error| Failure::sim(scenario, error))?);
    comparison.notes.extend(spiky);
    (comparison.notes).extend(begins_in_motion(scenario, &measured));
    let folder = arguments.out.join(scenario.stem()).join(FOLDER);
    let written = told(&bar, "writing", || -> Result<_, Failure> {
        let written = write(&folder, &comparison, &simulated, &measured)?;
        let page = page(scenario, &comparison, &simulated, &measured);
        write_file(&folder.join(REPORT), page.html().as_bytes())?;
        Ok(written)
    })?;
    drop(bar);
    crate::print(&text::printed(&scenario.name, &comparison, &written))?;
    Ok(ExitStatus::Good)
}

/// The error, reported at the key of the scenario that caused it.
fn refused(scenario: &Scenario, measured: &Measured, error: &CompareError) -> Failure {
    let message = format!("{}: {error}", measured.source);
    let channels = scenario.data.as_ref().map(|data| &data.mapping.channels);
    let place = |name: &str| channels?.iter().position(|one| one.channel == name);
    let key = match error {
        CompareError::Unknown { .. } => "channel",
        CompareError::Unit { .. } | CompareError::Dimension { .. } => "unit",
        _ => "column",
    };
    match error.channel().and_then(place) {
        Some(index) => scenario
            .problem(&format!("data.channel.{index}.{key}"), message)
            .into(),
        None => scenario.problem("data", message).into(),
    }
}

/// The comparison as a page.
fn page(
    scenario: &Scenario,
    comparison: &Comparison,
    simulated: &Recording,
    measured: &Measured,
) -> Page {
    let mut page = Page::new("compare", &scenario.name);
    page.told(&text::printed(&scenario.name, comparison, &[]));
    let figures = comparison.channels.iter();
    let figures =
        figures.map(|one| figures::channel(comparison, one, simulated, measured, MOST_POINTS));
    page.figures("Measured and simulated", figures);
    page.text(page::reproduce("truecut compare", scenario));
    page
}

/// Writes the answer and a figure for each channel; returns the files, answer first.
fn write(
    folder: &Path,
    comparison: &Comparison,
    simulated: &Recording,
    measured: &Measured,
) -> Result<Vec<std::path::PathBuf>, Failure> {
    match std::fs::remove_dir_all(folder) {
        Err(error) if error.kind() != std::io::ErrorKind::NotFound => {
            return Err(Failure::at(folder, error));
        }
        _ => {}
    }
    let report = folder.join(ANSWER);
    write_file(&report, crate::text::json(comparison)?.as_bytes())?;
    let mut written = vec![report];
    for channel in &comparison.channels {
        let path = folder.join(format!("{}.svg", channel.channel));
        let figure = figures::channel(comparison, channel, simulated, measured, figures::POINTS);
        write_file(&path, figure.to_svg().as_bytes())?;
        written.push(path);
    }
    Ok(written)
}
