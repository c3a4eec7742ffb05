//! `truecut run`: runs scenarios, judges their claims, writes recordings.

use rayon::prelude::*;
use truecut::data;
use truecut::outputs::Outputs;
use truecut_recording::Unit;
use truecut_scenario::Scenario;
use truecut_sim::run::{Finished, Run, Runs};

use crate::args::RunArguments;
use crate::exit_status::ExitStatus;
use crate::failure::Failure;
use crate::progress::{Progress, RunProgress};
use crate::sweep;
use crate::text;

/// Runs every scenario given; sweeps after the single runs, since each of them fills all
/// cores.
pub fn run(arguments: &RunArguments) -> Result<ExitStatus, Failure> {
    let scenarios = arguments.load()?;
    let (sweeps, singles): (Vec<_>, Vec<_>) = scenarios
        .iter()
        .partition(|scenario| scenario.sweep.is_some());
    let runs = Runs::default();
    let progress = Progress::new(singles.len(), "running");
    let reports: Vec<Result<(String, ExitStatus), Failure>> = singles
        .par_iter()
        .map(|scenario| run_one(scenario, arguments, &runs, &progress.run()))
        .collect();
    drop(progress);
    let mut all = ExitStatus::Good;
    for report in reports {
        let (text, status) = report?;
        crate::print(&text)?;
        all = all.and(status);
    }
    for scenario in sweeps {
        all = all.and(sweep::run_and_write(scenario, &arguments.out)?);
    }
    Ok(all)
}

fn run_one(
    scenario: &Scenario,
    arguments: &RunArguments,
    runs: &Runs,
    progress: &RunProgress,
) -> Result<(String, ExitStatus), Failure> {
    let outputs = Outputs::prepare(&arguments.out, scenario, !arguments.no_rrd)?;
    let measured = data::replayed_from(scenario, arguments.data.as_deref())?;
    let finished = Run {
        measured: measured.as_ref(),
        read_data: Some(data::replayed),
        references: Some(runs),
        sinks: outputs.sinks(),
        progress: &|part| progress.set(part),
        ..Run::of(scenario)
    }
    .execute()?;
    outputs.write_summary(&finished.recording, &finished.claims)?;
    let status = ExitStatus::of_run(&finished.recording.outcome, &finished.claims);
    Ok((printed(scenario, &finished, &outputs), status))
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
    if !claims.is_empty() {
        let held = claims.iter().filter(|claim| claim.holds).count();
        text.push_str(&format!(
            "\n  {held} of {} claims hold\n{}",
            claims.len(),
            text::claims(claims)
        ));
    }
    text.push_str(&format!("\n{}", text::headline(&recording.scalars)));
    text.push_str(&format!(
        "\n  {}   (look at it: truecut view; beside it: {})\n\n",
        outputs.main_file().display(),
        outputs.other_files().join(", ")
    ));
    text
}
