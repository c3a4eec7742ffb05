//! `truecut compare`: what the simulation gets wrong against measured data.

mod figures;
mod tell;

use std::path::Path;

use truecut_discrepancy::compare::{CompareError, Comparison, compare_recordings};
use truecut_recording::{Measured, Outcome, Recording};
use truecut_scenario::Scenario;

use crate::args::ComparePlan;
use crate::data;
use crate::failure::Failure;
use crate::outputs::write_file;
use crate::progress::Progress;
use crate::text;
use crate::verdict::Verdict;

/// The folder below that of the scenario, and the file in it that says all.
const FOLDER: &str = "compare";
const REPORT: &str = "compare.json";

/// Runs the scenario beside its data, prints the table and writes report and figures.
pub fn compare(plan: &ComparePlan) -> Result<Verdict, Failure> {
    let scenario = &plan.scenario;
    if scenario.sweep.is_some() {
        let text = "a sweep cannot be compared with data: only single runs can";
        return Err(scenario.problem("sweep", text).into());
    }
    let measured = data::needed(scenario, plan.data.as_deref())?;
    let progress = Progress::new(1, "running");
    let (simulated, measured) = data::simulate(scenario, measured, &progress.run())?;
    drop(progress);
    if simulated.outcome != Outcome::Completed {
        let outcome = text::outcome(&simulated.outcome);
        crate::print(&format!("{}\n  {outcome}\n", scenario.name))?;
        return Ok(Verdict::Diverged);
    }
    let spindle_hz = plan.spindle_hz.or_else(|| data::spindle_hz(scenario));
    let comparison = compare_recordings(&simulated, &measured, spindle_hz)
        .map_err(|error| refused(scenario, &measured, &error))?;
    let folder = plan.out.join(scenario.stem()).join(FOLDER);
    let written = write(&folder, &comparison, &simulated, &measured)?;
    crate::print(&tell::tell(&scenario.name, &comparison, &written))?;
    Ok(Verdict::Good)
}

/// The fault, at the key of the scenario that it is about.
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

/// Writes the report and a figure for each channel; the files, the report first.
fn write(
    folder: &Path,
    comparison: &Comparison,
    simulated: &Recording,
    measured: &Measured,
) -> Result<Vec<std::path::PathBuf>, Failure> {
    match std::fs::remove_dir_all(folder) {
        Err(error) if error.kind() != std::io::ErrorKind::NotFound => {
            return Err(Failure::message(format!("{}: {error}", folder.display())));
        }
        _ => {}
    }
    let report = folder.join(REPORT);
    let json = serde_json::to_string_pretty(comparison)
        .map_err(|error| Failure::message(format!("{REPORT}: {error}")))?;
    write_file(&report, format!("{json}\n").as_bytes())?;
    let mut written = vec![report];
    for channel in &comparison.channels {
        let path = folder.join(format!("{}.svg", channel.channel));
        let figure = figures::channel(comparison, channel, simulated, measured);
        write_file(&path, figure.to_svg().as_bytes())?;
        written.push(path);
    }
    Ok(written)
}
