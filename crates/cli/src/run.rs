//! `truecut run`: runs scenarios, judges their claims, writes recordings.

use std::time::Instant;

use rayon::prelude::*;
use truecut_recording::{ClaimResult, Recording};
use truecut_scenario::Scenario;

use crate::args::RunPlan;
use crate::execute::{Executed, Runs, execute};
use crate::failure::Failure;
use crate::judge::{judge, verdict};
use crate::outputs::Outputs;
use crate::progress::{Progress, RunProgress};
use crate::sweep;
use crate::text;
use crate::verdict::Verdict;

/// What there is to say about a scenario that has run.
struct Told {
    text: String,
    verdict: Verdict,
}

/// Runs every scenario of the plan; sweeps after the single runs, since each of them fills all cores.
pub fn run(plan: RunPlan) -> Result<Verdict, Failure> {
    let (sweeps, singles): (Vec<&Scenario>, Vec<&Scenario>) = plan
        .scenarios
        .iter()
        .partition(|scenario| scenario.sweep.is_some());
    let runs = Runs::default();
    let progress = Progress::new(singles.len(), "running");
    let told: Vec<Result<Told, Failure>> = singles
        .par_iter()
        .map(|scenario| run_one(scenario, &plan, &runs, &progress.run()))
        .collect();
    drop(progress);
    let mut all = Verdict::Good;
    for told in told {
        let told = told?;
        crate::print(&told.text)?;
        all = all.and(told.verdict);
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
) -> Result<Told, Failure> {
    let outputs = Outputs::prepare(&plan.out, scenario, plan.rrd)?;
    let started = Instant::now();
    let executed = execute(scenario, plan.data.as_deref(), outputs.sinks(), progress)?;
    let wall_s = started.elapsed().as_secs_f64();
    let Executed {
        recording,
        sinks,
        time_step_s,
    } = executed;
    let claims = judge(scenario, &recording, runs, progress)?;
    sinks
        .close(&recording, &claims)
        .map_err(|error| Failure::message(error.to_string()))?;
    outputs.write_end(&recording, &claims)?;
    let text = tell(scenario, &recording, &claims, &outputs, time_step_s, wall_s);
    Ok(Told {
        text,
        verdict: verdict(&recording.outcome, &claims),
    })
}

fn tell(
    scenario: &Scenario,
    recording: &Recording,
    claims: &[ClaimResult],
    outputs: &Outputs,
    time_step_s: f64,
    wall_s: f64,
) -> String {
    let simulated_s = recording.time_s.last().copied().unwrap_or(0.0);
    let mut text = format!(
        "{}\n  {}: {} simulated in {}, step {}, {} rows\n",
        scenario.name,
        text::outcome(&recording.outcome),
        text::seconds(simulated_s),
        text::seconds(wall_s),
        text::show(truecut_recording::Unit::Second, time_step_s),
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
