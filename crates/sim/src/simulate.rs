//! A run in one call, for those who want its rows and nothing on disk.

use crate::cell::Cell;
use crate::error::SimError;
use crate::robots::Robots;
use truecut_recording::{ChannelSpec, Measured, Outcome};
use truecut_scenario::Scenario;

/// What integrates the arm.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Engine {
    /// The full model.
    Rapier,
    /// The arm linearised and exactly stepped: many times as fast.
    Reduced {
        /// Runs that need a shorter step are refused, s; 0 refuses none.
        shortest_step_s: f64,
    },
}

/// Columns of a run.
#[derive(Debug, Clone, PartialEq)]
pub struct Rows {
    /// The channels asked for, in the order of `columns`.
    pub channels: Vec<ChannelSpec>,
    /// Times, s.
    pub time_s: Vec<f64>,
    /// One column for each channel, SI.
    pub columns: Vec<Vec<f64>>,
    /// How the run ended.
    pub outcome: Outcome,
}

/// Runs a scenario, with its measured data if it has any, and keeps the channels named (all if none is
/// named). With data, rows come at the data's times as nearly as the steps allow. With `until_s` the run ends there, but for a few rows
/// more, so that whoever reads between rows finds neighbours.
///
/// # Errors
/// Whatever makes the scenario unfit to run; a channel that it does not have.
pub fn simulate(
    scenario: &Scenario,
    measured: Option<&Measured>,
    robots: &Robots,
    engine: Engine,
    channels: &[&str],
    until_s: Option<f64>,
) -> Result<Rows, SimError> {
    let mut cell = match engine {
        Engine::Rapier => Cell::build_with_data(&at_the_times(scenario, measured), measured)?,
        Engine::Reduced { shortest_step_s } => {
            let cell = reduced(scenario, measured, robots)?;
            if cell.time_step_s() < shortest_step_s {
                return Err(SimError::scenario(
                    "run.time_step_ms",
                    format!(
                        "the run needs steps of {:.3e} s, but {shortest_step_s:.3e} s is the shortest allowed",
                        cell.time_step_s()
                    ),
                ));
            }
            cell
        }
    };
    if let Some(until_s) = until_s {
        cell.end_after(until_s);
    }
    let all = cell.channels().to_vec();
    let kept: Vec<usize> = if channels.is_empty() {
        (0..all.len()).collect()
    } else {
        (channels.iter())
            .map(|name| cell.channel_index(name))
            .collect::<Result<_, _>>()?
    };
    let mut rows = Rows {
        channels: kept.iter().map(|i| all[*i].clone()).collect(),
        time_s: Vec::with_capacity(cell.rows()),
        columns: kept
            .iter()
            .map(|_| Vec::with_capacity(cell.rows()))
            .collect(),
        outcome: Outcome::Completed,
    };
    cell.keep_rows_only();
    let end = cell.run_rows(|time_s, row| {
        rows.time_s.push(time_s);
        for (column, index) in rows.columns.iter_mut().zip(&kept) {
            column.push(row[*index]);
        }
    });
    rows.outcome = end.outcome;
    Ok(rows)
}

/// The step that the reduced plant takes, s.
///
/// # Errors
/// Whatever makes the scenario unfit to run.
pub fn reduced_step_s(
    scenario: &Scenario,
    measured: Option<&Measured>,
    robots: &Robots,
) -> Result<f64, SimError> {
    Ok(reduced(scenario, measured, robots)?.time_step_s())
}

fn reduced(
    scenario: &Scenario,
    measured: Option<&Measured>,
    robots: &Robots,
) -> Result<Cell, SimError> {
    Cell::build_reduced_with_data(robots, &at_the_times(scenario, measured), measured)
}

/// The scenario with rows at the data's times.
fn at_the_times(scenario: &Scenario, measured: Option<&Measured>) -> Scenario {
    let mut scenario = scenario.clone();
    if let Some(measured) = measured {
        scenario.run.record_interval_s = Some(measured.interval_s());
    }
    scenario
}
