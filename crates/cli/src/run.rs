//! `truecut run`: runs scenarios, judges their claims, writes recordings.

mod maps;
mod report;

use std::process::ExitCode;

use rayon::prelude::*;
use truecut::Engine;
use truecut::data;
use truecut::outputs::{Outputs, PART, PART_ERROR, size};
use truecut_recording::{Outcome, SinkError, Unit};
use truecut_scenario::Scenario;
use truecut_sim::run::{Extent, Finished, Keep, Run, RunError, Runs};

use crate::args::RunArguments;
use crate::exit_status::ExitStatus;
use crate::failure::Failure;
use crate::progress::{Progress, RunProgress};
use crate::signals::Signals;
use crate::sweep;
use crate::text;

/// From so many steps, and so many bytes, on a run tells beforehand what it will take: minutes, and
/// a part of the memory that is felt.
const MANY_STEPS: usize = 3_000_000;
const MANY_BYTES: u64 = 250_000_000;

/// Runs every scenario given; sweeps after the single runs, since each of them fills all cores. A
/// signal stops runs at a step: those of a single scenario with their files whole, those of sweeps
/// with the rows that were done. What has not begun then does not begin.
pub fn run(arguments: &RunArguments) -> Result<ExitCode, Failure> {
    let signals = Signals::catch()?;
    let scenarios = arguments.load()?;
    let (sweeps, singles): (Vec<_>, Vec<_>) = scenarios
        .iter()
        .partition(|scenario| scenario.sweep.is_some());
    let runs = Runs::default();
    let progress = Progress::new(singles.len(), "running");
    let reports: Vec<Result<(String, ExitStatus), Failure>> = singles
        .par_iter()
        .map(|scenario| match signals.came() {
            true => Ok((not_run(scenario), ExitStatus::Good)),
            false => run_one(scenario, arguments, &runs, &progress.run(), &signals),
        })
        .collect();
    drop(progress);
    let mut all = ExitStatus::Good;
    for report in reports {
        let (text, status) = report?;
        crate::print(&text)?;
        all = all.and(status);
    }
    for scenario in sweeps {
        if signals.came() {
            crate::print(&not_run(scenario))?;
            continue;
        }
        let status =
            sweep::run_and_write(scenario, Engine::Rapier, &arguments.out, signals.stop())?;
        all = all.and(status);
    }
    Ok(signals.exit_code().map_or(all.into(), ExitCode::from))
}

fn not_run(scenario: &Scenario) -> String {
    format!(
        "{}\n  not run: stopped by a signal before\n\n",
        scenario.name
    )
}

fn run_one(
    scenario: &Scenario,
    arguments: &RunArguments,
    runs: &Runs,
    progress: &RunProgress,
    signals: &Signals,
) -> Result<(String, ExitStatus), Failure> {
    let outputs = Outputs::prepare(&arguments.out, scenario, !arguments.no_rrd)?;
    let measured = data::replayed_from(scenario, arguments.data.as_deref())?;
    let finished = Run {
        measured: measured.as_ref(),
        read_data: Some(data::replayed),
        references: Some(runs),
        keep: Keep::Judged,
        sinks: outputs.sinks(),
        progress: &|part| progress.set(part),
        before: &|extent| may_begin(scenario, &outputs, extent),
        stop: Some(signals.stop()),
        ..Run::of(scenario)
    }
    .execute();
    let finished = match finished {
        // A slip in a claim does not cost the run.
        Err(RunError::Unjudged { error, recording }) => {
            outputs.finish(&recording, &[])?;
            eprintln!("  the run is kept: {}", outputs.main_file().display());
            return Err((*error).into());
        }
        other => other?,
    };
    if let Some(part) = &finished.part {
        outputs.write_part(part)?;
    }
    let html = report::html(scenario, &finished, &outputs.rows()?, &outputs.shown())?;
    outputs.write_report(&html)?;
    outputs.finish(&finished.recording, &finished.claims)?;
    let status = ExitStatus::of_run(&finished.recording.outcome, &finished.claims);
    Ok((printed(scenario, &finished, &outputs), status))
}

/// Tells what a run will take if that is much; refuses what the disk cannot hold.
fn may_begin(scenario: &Scenario, outputs: &Outputs, extent: &Extent) -> Result<(), SinkError> {
    outputs.check_room(extent)?;
    if extent.steps >= MANY_STEPS || extent.bytes() >= MANY_BYTES {
        eprintln!(
            "  {}: {} steps, {} rows of {} channels: {} on the disk while it runs, {} in memory",
            scenario.name,
            extent.steps,
            extent.rows,
            extent.channels,
            size(extent.bytes()),
            size(extent.memory_bytes())
        );
    }
    Ok(())
}

fn printed(scenario: &Scenario, finished: &Finished, outputs: &Outputs) -> String {
    let Finished {
        recording, claims, ..
    } = finished;
    let simulated_s = recording.time_s.last().copied().unwrap_or(0.0);
    let mut text = format!(
        "{}\n  {}: {} simulated in {}, step {}, {} rows\n",
        scenario.name,
        text::outcome(&recording.outcome),
        text::seconds(simulated_s),
        text::seconds(finished.build_s + finished.run_s),
        text::show(Unit::Second, finished.time_step_s),
        recording.time_s.len()
    );
    text.push_str(&text::notes(&recording.header.notes));
    if recording.outcome == Outcome::Interrupted && !scenario.claims.is_empty() {
        let count = scenario.claims.len();
        text.push_str(&format!("\n  claims not judged: {count}\n"));
    }
    if !claims.is_empty() {
        let held = claims.iter().filter(|claim| claim.holds).count();
        text.push_str(&format!(
            "\n  {held} of {} claims hold\n{}",
            claims.len(),
            text::claims(claims)
        ));
    }
    text.push_str(&format!("\n{}", text::headline(&recording.scalars)));
    let mut beside = outputs.other_files();
    if finished.part.is_some() {
        beside.extend([PART, PART_ERROR]);
    }
    text.push_str(&format!(
        "\n  {}   (look at it: truecut view; beside it: {})\n\n",
        outputs.main_file().display(),
        beside.join(", ")
    ));
    text
}
