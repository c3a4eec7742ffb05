//! One combination of a sweep's values, run alone.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use crate::engine::Engine;
use crate::error::SimError;
use crate::robots::Robots;
use crate::run::{Run, taken};
use truecut_recording::{Outcome, Recording, Unit};
use truecut_scenario::{BisectSpec, Scenario, SweepSpec};

/// One combination of the axes' values.
#[derive(Debug, Clone)]
pub struct Job {
    /// One for all jobs: its text holds the values of the axes, so that copies would take memory as
    /// the square of their number.
    scenario: Arc<Scenario>,
    sweep: Arc<SweepSpec>,
    /// Read once for all jobs.
    robots: Arc<Robots>,
    engine: Engine,
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
pub struct SweepRow {
    pub values: Vec<Entry>,
    /// What is wrong with the run that the columns are of. If it did not come to its end, the
    /// threshold and every column are NaN, since a metric over a part of a run is no result.
    pub fault: Option<Fault>,
}

/// A run that did not come to its end, or that fails all the same.
#[derive(Debug, Clone, PartialEq)]
pub struct Fault {
    pub outcome: Outcome,
    /// Which run it was, and how it ended.
    pub why: String,
}

impl Fault {
    /// Whether the run did not come to its end.
    pub fn ended_early(&self) -> bool {
        !self.outcome.reached_end()
    }

    fn of(recording: &Recording, which: &str) -> Option<Fault> {
        let outcome = &recording.outcome;
        (*outcome != Outcome::Completed).then(|| Fault {
            outcome: outcome.clone(),
            why: format!("{which}{outcome}"),
        })
    }
}

impl SweepRow {
    /// The value of a name, if the row has it.
    pub fn get(&self, name: &str) -> Option<f64> {
        (self.values.iter().find(|v| v.name == name)).map(|v| v.value)
    }
}

/// All jobs of a scenario's sweep in rapier, in the order of its rows; none without a sweep.
pub fn jobs(scenario: &Scenario) -> Vec<Job> {
    let jobs = Jobs::of(scenario, Engine::Rapier);
    let count = scenario.sweep.as_ref().map_or(0, SweepSpec::count);
    (0..count).map(|row| jobs.job(row)).collect()
}

/// The jobs of a sweep, each made when it is asked for: as texts, all of them take more memory than
/// the table of their results.
pub(super) struct Jobs(Option<Job>);

impl Jobs {
    pub fn of(scenario: &Scenario, engine: Engine) -> Jobs {
        Jobs(scenario.sweep.as_ref().map(|sweep| Job {
            scenario: Arc::new(of_a_row(scenario, sweep)),
            sweep: Arc::new(sweep.clone()),
            robots: Arc::new(Robots::new()),
            engine,
            overrides: Vec::new(),
        }))
    }

    /// The job of a row below [`SweepSpec::count`].
    ///
    /// # Panics
    /// If there is no sweep.
    pub fn job(&self, row: usize) -> Job {
        let mut job = self.0.clone().expect("a sweep");
        let keys = job.sweep.axes.iter().map(|axis| axis.key.clone());
        job.overrides = keys
            .zip(job.sweep.values(row).into_iter().map(number))
            .collect();
        job
    }
}

/// The scenario that rows override. Each would draw the whole list of rows anew, and take time as
/// the square of their number: a row draws the shortest list that there may be.
fn of_a_row(scenario: &Scenario, sweep: &SweepSpec) -> Scenario {
    let shortest = [("sweep.sample.count".to_owned(), "2".to_owned())];
    let drawn = (sweep.is_sampled).then(|| scenario.with_overrides(&shortest).ok());
    drawn.flatten().unwrap_or_else(|| scenario.clone())
}

/// A number as TOML reads it back, to the last bit. Whole numbers stay whole for keys that count.
fn number(value: f64) -> String {
    if value.fract() == 0.0 && value.abs() < 1e15 {
        format!("{value:.0}")
    } else {
        format!("{value:?}")
    }
}

/// Runs one job. `progress` is told the part done, from 0 to 1; it never falls.
///
/// # Errors
/// What makes a scenario unfit to run at these values, or a column that its recording does not
/// have.
pub fn run_job(job: &Job, progress: &dyn Fn(f64)) -> Result<SweepRow, SimError> {
    run_job_until(job, progress, None)
}

/// The same, unless it is stopped: the row's fault then is that its run was interrupted.
pub(super) fn run_job_until(
    job: &Job,
    progress: &dyn Fn(f64),
    stop: Option<&AtomicBool>,
) -> Result<SweepRow, SimError> {
    row(job, progress, stop).map_err(|error| of_row(job, error))
}

/// An error that says in which of many rows it came; what overrides have made invalid names the key
/// already.
fn of_row(job: &Job, error: SimError) -> SimError {
    let SimError::Scenario { key, message } = error else {
        return error;
    };
    if job.overrides.is_empty() {
        return SimError::Scenario { key, message };
    }
    let values = job.overrides.iter();
    let values: Vec<String> = values
        .map(|(key, value)| format!("`{key}` = {value}"))
        .collect();
    SimError::Scenario {
        key,
        message: format!("{message} (in the sweep's row with {})", values.join(", ")),
    }
}

fn row(job: &Job, progress: &dyn Fn(f64), stop: Option<&AtomicBool>) -> Result<SweepRow, SimError> {
    let mut row = SweepRow::default();
    for (key, value) in &job.overrides {
        row.values.push(Entry {
            name: key.clone(),
            value: value.parse().unwrap_or(f64::NAN),
            unit: None,
        });
    }
    let recording = match &job.sweep.bisect {
        Some(bisect) => {
            let (value, last) = search(job, bisect, progress, stop)?;
            row.values.push(Entry {
                name: bisect.name.clone(),
                value,
                unit: None,
            });
            row.fault = last.fault;
            last.recording
        }
        None => {
            let recording = record(job, &job.overrides, progress, stop)?;
            row.fault = Fault::of(&recording, "");
            recording
        }
    };
    let ended_early = row.fault.as_ref().is_some_and(Fault::ended_early);
    for (index, column) in job.sweep.columns.iter().enumerate() {
        let table = format!("sweep.column.{index}");
        let metric = taken(&table, &column.metric, &column.unit, &recording)?;
        row.values.push(Entry {
            name: column.name.clone(),
            value: if ended_early { f64::NAN } else { metric.value },
            unit: Some(metric.unit),
        });
    }
    Ok(row)
}

/// Bisects for the smallest value at which the metric meets its limit, and gives the run there, or
/// that which stopped the search. The metric is taken to fall as the key rises. If even the upper
/// end does not meet the limit the value is NaN; if the lower end does, it is the lower end. A
/// trial that ends early ends the search without a threshold: nothing is known of the metric there.
fn search(
    job: &Job,
    bisect: &BisectSpec,
    progress: &dyn Fn(f64),
    stop: Option<&AtomicBool>,
) -> Result<(f64, SearchRun), SimError> {
    let halvings = ((bisect.to - bisect.from) / (bisect.tolerance * bisect.to.abs())).log2();
    let most = halvings.max(0.0).ceil() + 2.0;
    let made = std::cell::Cell::new(0.0);
    let run_at = |value| {
        let tell = |part| progress((made.get() + part) / most);
        let tried = search_run(job, bisect, value, &tell, stop);
        made.set(made.get() + 1.0);
        tried
    };
    let (mut low, mut high) = (bisect.from, bisect.to);
    let mut best = run_at(high)?;
    if best.ended_early() || !best.meets_limit {
        return Ok((f64::NAN, best));
    }
    let lowest = run_at(low)?;
    if lowest.ended_early() {
        return Ok((f64::NAN, lowest));
    }
    if lowest.meets_limit {
        return Ok((low, lowest));
    }
    while high - low > bisect.tolerance * high.abs() {
        let middle = 0.5 * (low + high);
        let tried = run_at(middle)?;
        if tried.ended_early() {
            return Ok((f64::NAN, tried));
        }
        if tried.meets_limit {
            high = middle;
            best = tried;
        } else {
            low = middle;
        }
    }
    Ok((high, best))
}

/// One run of a search.
struct SearchRun {
    meets_limit: bool,
    recording: Recording,
    fault: Option<Fault>,
}

impl SearchRun {
    fn ended_early(&self) -> bool {
        self.fault.as_ref().is_some_and(Fault::ended_early)
    }
}

fn search_run(
    job: &Job,
    bisect: &BisectSpec,
    value: f64,
    progress: &dyn Fn(f64),
    stop: Option<&AtomicBool>,
) -> Result<SearchRun, SimError> {
    let mut overrides = job.overrides.clone();
    overrides.push((bisect.key.clone(), format!("{value:?}")));
    let recording = record(job, &overrides, progress, stop)?;
    let metric = taken("sweep.bisect", &bisect.metric, &bisect.unit, &recording)?;
    Ok(SearchRun {
        meets_limit: metric.value <= bisect.limit,
        fault: Fault::of(
            &recording,
            &format!("the trial at {} = {value} ", bisect.key),
        ),
        recording,
    })
}

/// Runs a job's scenario with overrides and keeps the recording in memory.
fn record(
    job: &Job,
    overrides: &[(String, String)],
    progress: &dyn Fn(f64),
    stop: Option<&AtomicBool>,
) -> Result<Recording, SimError> {
    Run {
        overrides: overrides.to_vec(),
        engine: job.engine,
        robots: Some(&job.robots),
        progress,
        stop,
        ..Run::of(&job.scenario)
    }
    .recording()
}
