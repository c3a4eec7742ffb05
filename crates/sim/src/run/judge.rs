//! The claims of a run, with the other runs that they refer to.

use std::sync::Arc;

use truecut_recording::{ClaimResult, ClaimSpec, Outcome, Recording, RunReference};
use truecut_scenario::Scenario;

use super::error::RunError;
use super::request::{Claims, Keep, Run};
use super::runs::Runs;

impl Run<'_> {
    /// Judges the claims on a recording of this run that there is already.
    ///
    /// # Errors
    /// A claim that cannot be judged, or whose reference cannot run or is stopped.
    pub fn judge(&self, recording: &Recording) -> Result<Vec<ClaimResult>, RunError> {
        self.judge_in(&*self.resolved()?, recording)
    }

    pub(super) fn judge_in(
        &self,
        scenario: &Scenario,
        recording: &Recording,
    ) -> Result<Vec<ClaimResult>, RunError> {
        let own = Runs::default();
        let runs = self.references.unwrap_or(&own);
        let claims = scenario.claims.iter().enumerate();
        claims
            .map(|(index, claim)| self.judge_one(scenario, recording, index, claim, runs))
            .collect()
    }

    fn judge_one(
        &self,
        scenario: &Scenario,
        recording: &Recording,
        index: usize,
        claim: &ClaimSpec,
        runs: &Runs,
    ) -> Result<ClaimResult, RunError> {
        let reference = match &claim.relative_to {
            Some(reference) => Some(self.referred(scenario, index, reference, runs)?),
            None => None,
        };
        // A part of the reference is none.
        let cut = |reference: &Arc<Recording>| reference.outcome == Outcome::Interrupted;
        if reference.as_ref().is_some_and(cut) {
            return Err(RunError::Stopped);
        }
        claim
            .evaluate(recording, reference.as_deref())
            .map_err(|error| {
                // A scalar that a run has only sometimes is missed here.
                let scalar = format!("claim.{index}.scalar");
                let key = if scenario.gives(&scalar) {
                    scalar
                } else {
                    format!("claim.{index}")
                };
                scenario.problem(&key, error.to_string()).into()
            })
    }

    /// The recording that a claim refers to.
    fn referred(
        &self,
        scenario: &Scenario,
        index: usize,
        reference: &RunReference,
        runs: &Runs,
    ) -> Result<Arc<Recording>, RunError> {
        let other = referred(scenario, index, reference)?;
        Run {
            scenario: &other,
            overrides: Vec::new(),
            measured: None,
            read_data: self.read_data,
            engine: self.engine,
            robots: self.robots,
            claims: Claims::Check,
            // Other claims may refer to it, and ask for other channels.
            keep: Keep::All,
            references: None,
            sinks: Vec::new(),
            progress: self.progress,
            // Its rows go nowhere.
            before: &|_| Ok(()),
            stop: self.stop,
        }
        .kept_in(runs)
    }

    /// The recording among those of `runs`, made now if it has not been. Its claims are checked
    /// unless they are ignored, and not judged; its sinks take nothing.
    ///
    /// # Errors
    /// As [`Run::execute`].
    pub fn kept_in(&self, runs: &Runs) -> Result<Arc<Recording>, RunError> {
        let scenario = self.resolved()?;
        runs.get(&scenario, self.engine, || {
            let run = Run {
                scenario: &scenario,
                overrides: Vec::new(),
                claims: match self.claims {
                    Claims::Ignore => Claims::Ignore,
                    Claims::Judge | Claims::Check => Claims::Check,
                },
                references: None,
                sinks: Vec::new(),
                ..*self
            };
            Ok(run.execute()?.recording)
        })
    }
}

/// The scenario that a claim refers to.
fn referred(
    scenario: &Scenario,
    index: usize,
    reference: &RunReference,
) -> Result<Scenario, RunError> {
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
    Ok(Scenario::load_with(
        scenario.processes(),
        &path,
        &reference.overrides,
    )?)
}
