//! All jobs of a sweep, run in parallel, as one table.

use std::cell::Cell;
use std::collections::BTreeMap;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};

use rayon::prelude::*;
use truecut_recording::{Outcome, UserUnit, short_number};
use truecut_scenario::Scenario;

use super::job::{Fault, Job, Jobs, SweepRow, run_job_until};
use crate::run::{Run, RunError};

/// The results of a sweep: a row for each job, the last axis running fastest.
#[derive(Debug, Clone, PartialEq)]
pub struct SweepTable {
    /// Axes first, then results.
    pub columns: Vec<Column>,
    /// Values in the unit of their column.
    pub rows: Vec<Vec<f64>>,
    /// For each row, what is wrong with that of its runs which its values are of.
    pub faults: Vec<Option<Fault>>,
}

/// A column of a sweep's results.
#[derive(Debug, Clone, PartialEq)]
pub struct Column {
    /// Key of an axis, or name of a result.
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

/// A row of the table as it is made.
#[derive(Debug, Clone, PartialEq)]
pub struct TableRow {
    /// Values in the unit of their column.
    pub values: Vec<f64>,
    /// What is wrong with that of its runs which the values are of.
    pub fault: Option<Fault>,
}

/// A sweep that is asked for.
///
/// ```no_run
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// # use truecut_scenario::Scenario;
/// use truecut_sim::sweep::Sweep;
///
/// let scenario = Scenario::load("sweep.toml".as_ref(), &[])?;
/// let table = Sweep {
///     done: &|index, row| Ok(println!("row {index}: {:?}", row.values)),
///     ..Sweep::of(&scenario)
/// }
/// .execute()?;
/// # Ok(()) }
/// ```
#[derive(Clone, Copy)]
pub struct Sweep<'a> {
    /// The scenario.
    pub scenario: &'a Scenario,
    /// Rows that were made before, by their number from 0; they are not run again.
    pub kept: Option<&'a BTreeMap<usize, TableRow>>,
    /// Called with every row as soon as it is made, from any thread; an error ends the sweep.
    pub done: &'a Done<'a>,
    /// Told the part done, from 0 to 1.
    pub progress: &'a (dyn Fn(f64) + Sync),
    /// Stops its runs at their next step once it is set; [`RunError::Stopped`] is the answer then.
    /// Rows that were done by that time have been told.
    pub stop: Option<&'a AtomicBool>,
}

/// What is called with a row's number and the row.
pub type Done<'a> = dyn Fn(usize, &TableRow) -> Result<(), RunError> + Sync + 'a;

/// Runs every job of a scenario's sweep. `progress` is told the part done, from 0 to 1.
///
/// # Errors
/// As [`Sweep::execute`].
pub fn sweep(scenario: &Scenario, progress: &(dyn Fn(f64) + Sync)) -> Result<SweepTable, RunError> {
    let sweep = Sweep {
        progress,
        ..Sweep::of(scenario)
    };
    sweep.execute()
}

impl<'a> Sweep<'a> {
    /// All rows of a scenario's sweep; nobody is told of them.
    pub fn of(scenario: &'a Scenario) -> Sweep<'a> {
        Sweep {
            scenario,
            kept: None,
            done: &|_, _| Ok(()),
            progress: &|_| (),
            stop: None,
        }
    }

    /// Runs the rows in parallel.
    ///
    /// # Errors
    /// Whatever makes the scenario unfit to run, as it is or in one of the rows; metrics that its
    /// runs do not have; what [`Sweep::done`] answers; [`Sweep::stop`].
    pub fn execute(&self) -> Result<SweepTable, RunError> {
        // Mistakes in the metrics are to be found before the first run.
        Run::of(self.scenario).check()?;
        let columns = columns(self.scenario);
        let jobs = Jobs::of(self.scenario);
        let parts = Parts {
            progress: self.progress,
            count: jobs.count as f64,
            done: Mutex::new(0.0),
        };
        let rows = (0..jobs.count).into_par_iter();
        let rows = rows
            .map(|index| self.row(index, &jobs.job(index), &columns, &parts))
            .collect::<Result<Vec<TableRow>, RunError>>()?;
        let mut table = SweepTable {
            columns,
            rows: Vec::new(),
            faults: Vec::new(),
        };
        for row in rows {
            table.rows.push(row.values);
            table.faults.push(row.fault);
        }
        Ok(table)
    }

    fn row(
        &self,
        index: usize,
        job: &Job,
        columns: &[Column],
        parts: &Parts,
    ) -> Result<TableRow, RunError> {
        let of_job = Cell::new(0.0);
        let advance = |part: f64| parts.add(part - of_job.replace(part));
        let kept = self.kept.and_then(|kept| kept.get(&index));
        if let Some(kept) = kept.filter(|row| row.values.len() == columns.len()) {
            advance(1.0);
            return Ok(kept.clone());
        }
        if self.stop.is_some_and(|stop| stop.load(Ordering::Relaxed)) {
            return Err(RunError::Stopped);
        }
        let made = run_job_until(job, &advance, self.stop);
        let made = made.map_err(|error| RunError::of(self.scenario, error))?;
        let outcome = made.fault.as_ref().map(|fault| &fault.outcome);
        if outcome == Some(&Outcome::Interrupted) {
            return Err(RunError::Stopped);
        }
        advance(1.0);
        let row = TableRow {
            values: values(columns, &made),
            fault: made.fault,
        };
        (self.done)(index, &row)?;
        Ok(row)
    }
}

/// How much of all rows is done.
struct Parts<'a> {
    progress: &'a (dyn Fn(f64) + Sync),
    count: f64,
    done: Mutex<f64>,
}

impl Parts<'_> {
    fn add(&self, part: f64) {
        if let Ok(mut done) = self.done.lock() {
            *done += part;
            (self.progress)(*done / self.count);
        }
    }
}

/// What a run gives is SI; axes and a threshold that is searched for are in their key's unit.
fn values(columns: &[Column], row: &SweepRow) -> Vec<f64> {
    let value = |column: &Column| {
        let entry = row.values.iter().find(|entry| entry.name == column.name);
        entry.map_or(f64::NAN, |entry| match entry.unit {
            Some(_) => column.unit.from_si(entry.value),
            None => entry.value,
        })
    };
    columns.iter().map(value).collect()
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
    /// The index of a result's column.
    pub fn index(&self, name: &str) -> Option<usize> {
        self.columns
            .iter()
            .position(|column| column.name == name && !column.is_axis)
    }

    /// In how many rows a run did not come to its end.
    pub fn count_unfinished(&self) -> usize {
        let faults = self.faults.iter().flatten();
        faults.filter(|fault| fault.ended_early()).count()
    }

    /// How the runs of a row ended, if not well.
    pub fn fault(&self, row: usize) -> Option<&str> {
        self.faults[row].as_ref().map(|fault| fault.why.as_str())
    }

    /// The row by the values of its axes: `mu = 0.1, bore_mm = 32`; its number where there are no
    /// axes.
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
}

#[cfg(test)]
mod tests {
    use super::*;
    use truecut_recording::Unit;

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
