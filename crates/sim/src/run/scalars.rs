//! Scalars that claims and sweeps name, before the run: a slip in a name or a unit must not cost
//! it.

use truecut_recording::{ClaimFault, Metric, MetricSpec, Recording, Scalar, Unit, UserUnit};
use truecut_scenario::{Scenario, SweepSpec};

use crate::cell::Cell;
use crate::error::SimError;

/// Scalars that a run has only where there is something to tell.
const SOMETIMES: [&str; 1] = ["plant.torque_saturated"];

/// Whether a metric is a scalar that a run has from its first step on, or never.
fn is_foreseen(metric: &MetricSpec) -> bool {
    match metric {
        MetricSpec::Scalar { name } => !SOMETIMES.contains(&name.as_str()),
        MetricSpec::Reduced { .. } => false,
    }
}

/// Whether a claim names a scalar that can be looked for before the run.
pub(super) fn are_claimed(scenario: &Scenario) -> bool {
    let mut claims = scenario.claims.iter();
    claims.any(|claim| is_foreseen(&claim.metric))
}

/// Whether a sweep does.
pub(super) fn are_swept(scenario: &Scenario) -> bool {
    let mut metrics = scenario.sweep.iter().flat_map(SweepSpec::metrics);
    metrics.any(is_foreseen)
}

/// The scalars of a run of a scenario, by a run of one step; their values say nothing.
pub(super) fn made(scenario: &Scenario, cell: Cell) -> Vec<Scalar> {
    let mut scalars = cell.scalars_made();
    if scenario.cell.is_some() {
        scalars.push(Scalar::new("cell.clearance", Unit::Metre, f64::NAN, ""));
    }
    scalars
}

/// Checks claims and sweep by the scalars that a run will have.
///
/// # Errors
/// A scalar that the run will not have, or a unit of another dimension.
pub(super) fn check(scenario: &Scenario, scalars: Vec<Scalar>) -> Result<(), SimError> {
    let made = Recording {
        scalars,
        ..Recording::default()
    };
    for (index, claim) in scenario.claims.iter().enumerate() {
        if !is_foreseen(&claim.metric) {
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
    for (table, metric, unit) in scenario.sweep.iter().flat_map(SweepSpec::metrics_at) {
        if is_foreseen(metric) {
            taken(&table, metric, unit, &made)?;
        }
    }
    Ok(())
}

/// A metric of a sweep from a recording; `table` is the path of its table.
///
/// # Errors
/// A metric that the recording does not have; a unit of another dimension.
pub(crate) fn taken(
    table: &str,
    spec: &MetricSpec,
    unit: &UserUnit,
    recording: &Recording,
) -> Result<Metric, SimError> {
    let metric = spec.evaluate(recording).map_err(|error| match spec {
        MetricSpec::Scalar { .. } => {
            SimError::scenario(format!("{table}.scalar"), error.to_string())
        }
        MetricSpec::Reduced { .. } => error.into(),
    })?;
    if metric.unit == unit.unit {
        return Ok(metric);
    }
    let accepted: Vec<&str> = metric.unit.accepted_symbols().collect();
    let message = format!(
        "unit \"{}\" does not fit {spec}; accepted: {}",
        unit.symbol,
        accepted.join(", ")
    );
    Err(SimError::scenario(format!("{table}.unit"), message))
}
