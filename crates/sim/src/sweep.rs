//! Sweeps: one scenario at many values of one or two of its keys, as independent jobs.
//!
//! A [`Job`] holds all that it needs, runs alone and gives one [`Row`]; who runs the jobs, and in which
//! order, is the caller's business (threads here, a cluster elsewhere).

use crate::cell::{Cell, RunEnd};
use crate::error::SimError;
use truecut_recording::{Recorder, Recording, Unit};
use truecut_scenario::{BisectSpec, Scenario, SweepSpec};

/// One combination of the axes' values.
#[derive(Debug, Clone)]
pub struct Job {
    scenario: Scenario,
    sweep: SweepSpec,
    /// Keys and values, as for `--set`.
    pub overrides: Vec<(String, String)>,
}

/// One value of a row.
#[derive(Debug, Clone, PartialEq)]
pub struct Entry {
    /// Key of an axis, or name of a column.
    pub name: String,
    /// SI for columns; in the key's own unit for axes and for the threshold searched for.
    pub value: f64,
    /// Unit of columns; `None` where the key's own unit applies.
    pub unit: Option<Unit>,
}

/// What one job gives: its axis values, the threshold found (if one is searched), its columns.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Row {
    pub values: Vec<Entry>,
}

impl Row {
    /// The value of a name, if the row has it.
    pub fn get(&self, name: &str) -> Option<f64> {
        (self.values.iter().find(|v| v.name == name)).map(|v| v.value)
    }
}

/// All jobs of a scenario's sweep, the last axis running fastest; none without a sweep.
pub fn jobs(scenario: &Scenario) -> Vec<Job> {
    let Some(sweep) = &scenario.sweep else {
        return Vec::new();
    };
    let mut combinations: Vec<Vec<(String, String)>> = vec![Vec::new()];
    for axis in &sweep.axes {
        combinations = combinations
            .iter()
            .flat_map(|before| {
                axis.values.iter().map(move |value| {
                    let mut next = before.clone();
                    next.push((axis.key.clone(), number(*value)));
                    next
                })
            })
            .collect();
    }
    combinations
        .into_iter()
        .map(|overrides| Job {
            scenario: scenario.clone(),
            sweep: sweep.clone(),
            overrides,
        })
        .collect()
}

/// A number as TOML reads it back, to the last bit. Whole numbers stay whole for keys that count.
fn number(value: f64) -> String {
    if value.fract() == 0.0 && value.abs() < 1e15 {
        format!("{value:.0}")
    } else {
        format!("{value:?}")
    }
}

/// Runs one job.
///
/// # Errors
/// What makes a scenario unfit to run at these values, or a column that its recording does not have.
pub fn run_job(job: &Job) -> Result<Row, SimError> {
    let mut row = Row::default();
    for (key, value) in &job.overrides {
        row.values.push(Entry {
            name: key.clone(),
            value: value.parse().unwrap_or(f64::NAN),
            unit: None,
        });
    }
    let recording = match &job.sweep.bisect {
        Some(bisect) => {
            let (value, recording) = search(job, bisect)?;
            row.values.push(Entry {
                name: bisect.name.clone(),
                value,
                unit: None,
            });
            recording
        }
        None => record(&job.scenario, &job.overrides)?,
    };
    for column in &job.sweep.columns {
        let metric = column.metric.evaluate(&recording)?;
        row.values.push(Entry {
            name: column.name.clone(),
            value: metric.value,
            unit: Some(metric.unit),
        });
    }
    Ok(row)
}

/// Bisects for the smallest value at which the metric meets its limit, and gives the run there. The metric
/// is taken to fall as the key rises. If even the upper end does not meet the limit the value is NaN; if
/// the lower end does, it is the lower end.
fn search(job: &Job, bisect: &BisectSpec) -> Result<(f64, Recording), SimError> {
    let at = |value: f64| -> Result<(bool, Recording), SimError> {
        let mut overrides = job.overrides.clone();
        overrides.push((bisect.key.clone(), format!("{value:?}")));
        let recording = record(&job.scenario, &overrides)?;
        let metric = bisect.metric.evaluate(&recording)?;
        Ok((metric.value <= bisect.limit, recording))
    };
    let (mut low, mut high) = (bisect.from, bisect.to);
    let (holds_high, mut best) = at(high)?;
    if !holds_high {
        return Ok((f64::NAN, best));
    }
    let (holds_low, recording) = at(low)?;
    if holds_low {
        return Ok((low, recording));
    }
    while high - low > bisect.tolerance * high.abs() {
        let middle = 0.5 * (low + high);
        let (holds, recording) = at(middle)?;
        if holds {
            high = middle;
            best = recording;
        } else {
            low = middle;
        }
    }
    Ok((high, best))
}

/// Runs a scenario with overrides and keeps the recording in memory.
///
/// # Errors
/// As [`Cell::build`]; and a scenario that the overrides break.
pub fn record(scenario: &Scenario, overrides: &[(String, String)]) -> Result<Recording, SimError> {
    let scenario = scenario.with_overrides(overrides)?;
    let cell = Cell::build(&scenario)?;
    let mut recorder = Recorder::new(cell.header(), Vec::new())?;
    let RunEnd {
        scalars,
        profiles,
        outcome,
    } = cell.run(&mut recorder, &|_| {})?;
    let (recording, sinks) = recorder.finish(scalars, profiles, outcome)?;
    sinks.close(&recording, &[])?;
    Ok(recording)
}
