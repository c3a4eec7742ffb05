//! Sweeps: the jobs of a scenario run in parallel, their rows, and the claims about them.

use std::path::Path;
use std::sync::Mutex;

use rayon::prelude::*;
use truecut_recording::{ClaimResult, Unit, UserUnit};
use truecut_scenario::{Scenario, SweepClaim};
use truecut_sim::sweep::{Job, jobs, run_job};

use crate::failure::Failure;
use crate::figure::short_number;
use crate::progress::Progress;
use crate::sweep_output;
use crate::verdict::Verdict;

/// The results of a sweep: a row for each job.
pub struct SweepTable {
    pub columns: Vec<Column>,
    /// Values in the unit of their column.
    pub rows: Vec<Vec<f64>>,
    /// For each row, which of its runs did not come to its end, and why.
    pub diverged: Vec<Option<String>>,
}

/// A column of a sweep's results.
pub struct Column {
    pub name: String,
    /// Unit of the values.
    pub unit: UserUnit,
    /// Whether the values are those of an axis, rather than results.
    pub is_axis: bool,
}

impl Column {
    /// The end of an axis' key, which is enough to know it by; the whole name of a result.
    pub fn short_name(&self) -> &str {
        let name = self.name.as_str();
        if !self.is_axis {
            return name;
        }
        // An entry of a list is known by its list: `release_n.0`.
        let parts = name
            .rsplit('.')
            .take_while(|part| part.parse::<usize>().is_ok());
        let last = parts.count();
        let start = name
            .rmatch_indices('.')
            .nth(last)
            .map_or(0, |(dot, _)| dot + 1);
        &name[start..]
    }
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
    Ok(table.verdict(&claims))
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
            let of_job = std::cell::Cell::new(0.0);
            let advance = |part: f64| {
                if let Ok(mut done) = done.lock() {
                    *done += part - of_job.replace(part);
                    progress(*done / count);
                }
            };
            let row = run_job(job, &advance).map_err(|error| Failure::sim(scenario, error))?;
            advance(1.0);
            // What a run gives is SI; axes and a threshold that is searched for are in their key's unit.
            let value = |column: &Column| {
                let entry = row.values.iter().find(|entry| entry.name == column.name);
                entry.map_or(f64::NAN, |entry| match entry.unit {
                    Some(_) => column.unit.from_si(entry.value),
                    None => entry.value,
                })
            };
            let values = columns.iter().map(value).collect();
            Ok((values, row.diverged))
        })
        .collect::<Result<Vec<(Vec<f64>, Option<String>)>, Failure>>()?;
    let (rows, diverged) = rows.into_iter().unzip();
    Ok(SweepTable {
        columns,
        rows,
        diverged,
    })
}

/// Finds mistakes in the metrics before the first run.
fn check_first(scenario: &Scenario) -> Result<(), Failure> {
    let cell = truecut_sim::Cell::build(scenario).map_err(|error| Failure::sim(scenario, error))?;
    scenario.check_bands(cell.row_interval_s())?;
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

    /// What the sweep comes to: a run that did not come to its end weighs more than a claim that fails.
    pub fn verdict(&self, claims: &[ClaimResult]) -> Verdict {
        let of_claims = if claims.iter().all(|claim| claim.holds) {
            Verdict::Good
        } else {
            Verdict::ClaimFailed
        };
        let of_runs = if self.count_diverged() == 0 {
            Verdict::Good
        } else {
            Verdict::Diverged
        };
        of_runs.and(of_claims)
    }

    /// In how many rows a run diverged.
    pub fn count_diverged(&self) -> usize {
        self.diverged.iter().flatten().count()
    }

    /// How many rows there are, and how many of them diverged.
    pub fn count(&self) -> String {
        match (self.rows.len(), self.count_diverged()) {
            (rows, 0) => format!("{rows} rows"),
            (rows, diverged) => format!("{rows} rows, ✗ {diverged} diverged"),
        }
    }

    /// The row by the values of its axes: `mu = 0.1, bore_mm = 32`; its number where there are no axes.
    pub fn row_name(&self, row: usize) -> String {
        let axes = self.columns.iter().zip(&self.rows[row]);
        let axes: Vec<String> = axes
            .filter(|(column, _)| column.is_axis)
            .map(|(column, value)| format!("{} = {}", column.short_name(), short_number(*value)))
            .collect();
        if axes.is_empty() {
            return format!("row {}", row + 1);
        }
        axes.join(", ")
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
        let values: Vec<f64> = self.rows.iter().map(value).collect();
        let row = (0..values.len()).max_by(|a, b| {
            excess(values[*a])
                .total_cmp(&excess(values[*b]))
                .then(b.cmp(a))
        });
        let worst = row.map(|row| values[row]).filter(|value| value.is_finite());
        let holds = worst.is_some_and(|value| excess(value) <= 0.0);
        let row_name = row.map_or_else(|| "no row".to_owned(), |row| self.row_name(row));
        let why = row.and_then(|row| self.diverged[row].clone());
        let note =
            (worst.is_none()).then(|| why.unwrap_or_else(|| "the row has no value".to_owned()));
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
            shown: shown(&unit, &row_name, worst, min, max),
            note,
        }
    }
}

fn shown(
    unit: &UserUnit,
    row: &str,
    worst: Option<f64>,
    min: Option<f64>,
    max: Option<f64>,
) -> String {
    let value = worst.map_or_else(|| "no value".to_owned(), |value| unit.show(value));
    let bounds = match (min, max) {
        (Some(min), Some(max)) => format!("{} to {}", unit.show(min), unit.show(max)),
        (Some(min), None) => format!("at least {}", unit.show(min)),
        (None, Some(max)) => format!("at most {}", unit.show(max)),
        (None, None) => String::new(),
    };
    format!("worst row {value} at {row}, {bounds}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_axis_is_known_by_the_end_of_its_key() {
        let column = |name: &str, is_axis| Column {
            name: name.to_owned(),
            unit: UserUnit::from(Unit::One),
            is_axis,
        };
        assert_eq!(
            column("process.chamfer.foot.friction.mu", true).short_name(),
            "mu"
        );
        assert_eq!(
            column("process.load.release_n.0", true).short_name(),
            "release_n.0"
        );
        assert_eq!(
            column("paper, eq. (27)", false).short_name(),
            "paper, eq. (27)"
        );
    }
}
