//! `truecut run`: runs scenarios, judges their claims, writes recordings.

use rayon::prelude::*;
use truecut::data;
use truecut::outputs::Outputs;
use truecut_recording::Unit;
use truecut_scenario::Scenario;
use truecut_sim::run::{Finished, Run, Runs};

use crate::args::RunPlan;
use crate::exit_status::ExitStatus;
use crate::failure::Failure;
use crate::progress::{Progress, RunProgress};
use crate::sweep;
use crate::text;

/// Printed text and exit status of a scenario that has run.
struct Report {
    text: String,
    status: ExitStatus,
}

/// Runs every scenario of the plan; sweeps after the single runs, since each of them fills all
/// cores.
pub fn run(plan: RunPlan) -> Result<ExitStatus, Failure> {
    let (sweeps, singles): (Vec<&Scenario>, Vec<&Scenario>) = plan
        .scenarios
        .iter()
        .partition(|scenario| scenario.sweep.is_some());
    let runs = Runs::default();
    let progress = Progress::new(singles.len(), "running");
    let reports: Vec<Result<Report, Failure>> = singles
        .par_iter()
        .map(|scenario| run_one(scenario, &plan, &runs, &progress.run()))
        .collect();
    drop(progress);
    let mut all = ExitStatus::Good;
    for report in reports {
        let report = report?;
        crate::print(&report.text)?;
        all = all.and(report.status);
    }
    for scenario in sweeps {
        all = all.and(sweep::run_and_write(scenario, &plan.out)?);
    }
    Ok(all)
}

fn run_one(
    scenario: &Scenario,
    plan: &RunPlan,
    runs: &Runs,
    progress: &RunProgress,
) -> Result<Report, Failure> {
    let outputs = Outputs::prepare(&plan.out, scenario, plan.rrd)?;
    let measured = data::replayed_from(scenario, plan.data.as_deref())?;
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
    Ok(Report {
        text: printed(scenario, &finished, &outputs),
        status: ExitStatus::of_run(&finished.recording.outcome, &finished.claims),
    })
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
    for note in &recording.header.notes {
        text.push_str(&format!("  note: {note}\n"));
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
    text.push_str(&format!(
        "\n  {}   (look at it: truecut view; beside it: {})\n\n",
        outputs.main_file().display(),
        outputs.other_files().join(", ")
    ));
    text
}
