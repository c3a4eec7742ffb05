//! Judges the claims of a run, with the other runs that they refer to.

use truecut_recording::{ClaimResult, ClaimSpec, Outcome, Recording, RunReference};
use truecut_scenario::Scenario;

use crate::execute::Runs;
use crate::failure::Failure;
use crate::progress::RunProgress;
use crate::verdict::Verdict;

/// Judges every claim of a scenario.
pub fn judge(
    scenario: &Scenario,
    recording: &Recording,
    runs: &Runs,
    progress: &RunProgress,
) -> Result<Vec<ClaimResult>, Failure> {
    let claims = scenario.claims.iter().enumerate();
    claims
        .map(|(index, claim)| judge_one(scenario, recording, index, claim, runs, progress))
        .collect()
}

fn judge_one(
    scenario: &Scenario,
    recording: &Recording,
    index: usize,
    claim: &ClaimSpec,
    runs: &Runs,
    progress: &RunProgress,
) -> Result<ClaimResult, Failure> {
    let reference = match &claim.relative_to {
        Some(reference) => {
            let other = referred(scenario, index, reference)?;
            Some(runs.get(&other, progress)?)
        }
        None => None,
    };
    claim
        .evaluate(recording, reference.as_deref())
        .map_err(|error| {
            // A scalar is known only after the run, so a wrong one is found here.
            let scalar = format!("claim.{index}.scalar");
            let key = if scenario.gives(&scalar) {
                scalar
            } else {
                format!("claim.{index}")
            };
            scenario.problem(&key, error.to_string()).into()
        })
}

/// The scenario that a claim refers to.
fn referred(
    scenario: &Scenario,
    index: usize,
    reference: &RunReference,
) -> Result<Scenario, Failure> {
    let Some(file) = &reference.scenario else {
        return Ok(scenario.with_overrides(&reference.overrides)?);
    };
    let path = scenario.folder().join(file);
    if !path.is_file() {
        let key = format!("claim.{index}.relative_to.scenario");
        let text = format!(
            "`{key}` is \"{file}\", but there is no file {}",
            path.display()
        );
        return Err(scenario.problem(&key, text).into());
    }
    Ok(Scenario::load(&path, &reference.overrides)?)
}

/// What a run and its claims come to.
pub fn verdict(outcome: &Outcome, claims: &[ClaimResult]) -> Verdict {
    let of_run = match outcome {
        Outcome::Completed => Verdict::Good,
        Outcome::Diverged { .. } | Outcome::Interrupted => Verdict::Diverged,
    };
    let all_hold = claims.iter().all(|claim| claim.holds);
    of_run.and(if all_hold {
        Verdict::Good
    } else {
        Verdict::ClaimFailed
    })
}
