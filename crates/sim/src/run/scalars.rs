//! Scalars that claims name, before the run: a slip in a name or a unit must not cost it.

use truecut_recording::{
    ClaimFault, Header, Measured, MetricSpec, Outcome, Recording, Scalar, Unit,
};
use truecut_scenario::Scenario;

use super::request::Run;
use crate::error::SimError;

/// Scalars that a run has only where there is something to tell.
const SOMETIMES: [&str; 1] = ["plant.torque_saturated"];
/// Steps from which on it is worth while to build the cell twice: a shorter run tells as soon.
const MANY_STEPS: usize = 10_000;

impl Run<'_> {
    /// Checks the claims on scalars by those of a run of one step.
    ///
    /// # Errors
    /// A claim on a scalar that the run will not have, or with a unit of another dimension.
    pub(super) fn check_scalars(
        &self,
        scenario: &Scenario,
        measured: Option<&Measured>,
        header: &Header,
        (steps, has_cell): (usize, bool),
    ) -> Result<(), SimError> {
        let is_asked = |claim: &truecut_recording::ClaimSpec| match &claim.metric {
            MetricSpec::Scalar { name } => !SOMETIMES.contains(&name.as_str()),
            MetricSpec::Reduced { .. } => false,
        };
        if steps < MANY_STEPS || !scenario.claims.iter().any(is_asked) {
            return Ok(());
        }
        let mut scalars = self.cell(scenario, measured)?.scalars_made();
        if has_cell {
            scalars.push(Scalar::new("cell.clearance", Unit::Metre, f64::NAN, ""));
        }
        let made = Recording {
            header: header.clone(),
            time_s: Vec::new(),
            columns: vec![Vec::new(); header.channels.len()],
            profiles: Vec::new(),
            scalars,
            outcome: Outcome::Completed,
        };
        for (index, claim) in scenario.claims.iter().enumerate() {
            if !is_asked(claim) {
                continue;
            }
            let other = claim.relative_to.as_ref().map(|_| &made);
            if let Err(error) = claim.evaluate(&made, other) {
                let key = match error.fault {
                    ClaimFault::Metric(_) => format!("claim.{index}.scalar"),
                    _ => format!("claim.{index}.unit"),
                };
                return Err(scenario.problem(&key, error.to_string()).into());
            }
        }
        Ok(())
    }
}
