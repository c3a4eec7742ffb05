//! Sweeps: the jobs of a scenario run in parallel, their rows, and the claims about them.

use std::path::Path;
use std::sync::Mutex;

use rayon::prelude::*;
use truecut_recording::{ClaimResult, Unit, UserUnit};
use truecut_scenario::{Scenario, SweepClaim};
use truecut_sim::sweep::{Job, jobs, run_job};

use crate::failure::Failure;
use crate::progress::Progress;
use crate::sweep_output;
use crate::verdict::Verdict;

/// The results of a sweep: a row for each job.
pub struct SweepTable {
    pub columns: Vec<Column>,
    /// Values in the unit of their column.
    pub rows: Vec<Vec<f64>>,
}

/// A column of a sweep's results.
pub struct Column {
    pub name: String,
    /// Unit of the values.
    pub unit: UserUnit,
    /// Whether the values are those of an axis, rather than results.
    pub is_axis: bool,
}

/// Runs a sweep with progress, prints its table and writes `sweep.parquet` and `sweep.svg`.
pub fn run_and_write(scenario: &Scenario, out: &Path) -> Result<Verdict, Failure> {
    let progress = Progress::new(1, "sweeping");
    let bar = progress.run();
    let table = run(scenario, &|part| bar.set(part))?;
    drop(bar);
    drop(progress);
    let claims = table.claims(scenario);
    let text = sweep_output::write(scenario, &table, &claims, out)?;
    crate::print(&text)?;
    let all_hold = claims.iter().all(|claim| claim.holds);
    Ok(if all_hold {
        Verdict::Good
    } else {
        Verdict::ClaimFailed
    })
}

/// Runs every job of a sweep. `progress` is told the part done.
pub fn run(scenario: &Scenario, progress: &(dyn Fn(f64) + Sync)) -> Result<SweepTable, Failure> {
    check_first(scenario)?;
    let columns = columns(scenario);
    let jobs: Vec<Job> = jobs(scenario);
    let count = jobs.len() as f64;
    let done = Mutex::new(0.0);
    let rows = jobs
        .par_iter()
        .map(|job| {
            let row = run_job(job).map_err(|error| Failure::sim(scenario, error))?;
            if let Ok(mut done) = done.lock() {
                *done += 1.0;
                progress(*done / count);
            }
            // What a run gives is SI; axes and a threshold that is searched for are in their key's unit.
            let value = |column: &Column| {
                let entry = row.values.iter().find(|entry| entry.name == column.name);
                entry.map_or(f64::NAN, |entry| match entry.unit {
                    Some(_) => column.unit.from_si(entry.value),
                    None => entry.value,
                })
            };
            Ok(columns.iter().map(value).collect())
        })
        .collect::<Result<Vec<Vec<f64>>, Failure>>()?;
    Ok(SweepTable { columns, rows })
}

/// Finds mistakes in the metrics before the first run.
fn check_first(scenario: &Scenario) -> Result<(), Failure> {
    let cell = truecut_sim::Cell::build(scenario).map_err(|error| Failure::sim(scenario, error))?;
    Ok(scenario.check_claims(&cell.header())?)
}

fn columns(scenario: &Scenario) -> Vec<Column> {
    let Some(sweep) = &scenario.sweep else {
        return Vec::new();
    };
    let axes = sweep.axes.iter().map(|axis| Column {
        name: axis.key.clone(),
        unit: axis.unit.clone(),
        is_axis: true,
    });
    let result = |name: &str, unit: &UserUnit| Column {
        name: name.to_owned(),
        unit: unit.clone(),
        is_axis: false,
    };
    let bisect = sweep
        .bisect
        .iter()
        .map(|bisect| result(&bisect.name, &bisect.key_unit));
    let others = sweep
        .columns
        .iter()
        .map(|column| result(&column.name, &column.unit));
    axes.chain(bisect).chain(others).collect()
}

impl SweepTable {
    /// The index of a column.
    pub fn index(&self, name: &str) -> Option<usize> {
        self.columns
            .iter()
            .position(|column| column.name == name && !column.is_axis)
    }

    /// The sweep's claims, judged over all rows; the value shown is that of the worst row.
    pub fn claims(&self, scenario: &Scenario) -> Vec<ClaimResult> {
        let claims = scenario.sweep.iter().flat_map(|sweep| &sweep.claims);
        claims.map(|claim| self.judge(claim)).collect()
    }

    fn judge(&self, claim: &SweepClaim) -> ClaimResult {
        let column = self.index(&claim.column);
        let over = claim.over.as_ref().map(|name| self.index(name));
        let value = |row: &Vec<f64>| -> f64 {
            let si = |index: Option<usize>| {
                index.map_or(f64::NAN, |index| {
                    row[index] * self.columns[index].unit.si_factor
                })
            };
            over.map_or(si(column), |over| si(column) / si(over))
        };
        let unit = match (column, over) {
            (Some(index), None) => self.columns[index].unit.clone(),
            _ => UserUnit::from(Unit::One),
        };
        let bound = |bound: Option<f64>| bound.map(|bound| bound * unit.si_factor);
        let (min, max) = (bound(claim.min), bound(claim.max));
        // How far a value is outside its bounds; a value that does not exist is outside of everything.
        let excess = |value: f64| {
            let below = min.map_or(f64::NEG_INFINITY, |min| min - value);
            let above = max.map_or(f64::NEG_INFINITY, |max| value - max);
            if value.is_nan() {
                f64::INFINITY
            } else {
                below.max(above)
            }
        };
        let worst = self
            .rows
            .iter()
            .map(value)
            .max_by(|a, b| excess(*a).total_cmp(&excess(*b)));
        let worst = worst.filter(|value| value.is_finite());
        let holds = worst.is_some_and(|value| excess(value) <= 0.0);
        let metric = match &claim.over {
            Some(over) => format!("{} / {over}", claim.column),
            None => claim.column.clone(),
        };
        ClaimResult {
            name: claim.name.clone(),
            metric,
            value: worst,
            unit: unit.unit,
            min,
            max,
            holds,
            reason: claim.reason.clone(),
            shown: shown(&unit, worst, min, max),
            note: worst.is_none().then(|| "a row has no value".to_owned()),
        }
    }
}

fn shown(unit: &UserUnit, worst: Option<f64>, min: Option<f64>, max: Option<f64>) -> String {
    let value = worst.map_or_else(|| "no value".to_owned(), |value| unit.show(value));
    let bounds = match (min, max) {
        (Some(min), Some(max)) => format!("{} to {}", unit.show(min), unit.show(max)),
        (Some(min), None) => format!("at least {}", unit.show(min)),
        (None, Some(max)) => format!("at most {}", unit.show(max)),
        (None, None) => String::new(),
    };
    format!("worst row {value}, {bounds}")
}
