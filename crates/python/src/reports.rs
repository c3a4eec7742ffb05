//! Comparisons and diagnoses, as dictionaries.

use std::num::NonZeroUsize;
use std::path::Path;

use pyo3::prelude::*;
use truecut::discrepancy::compare::{Comparison, compare_recordings};
use truecut::discrepancy::confirmed::Confirmed;
use truecut::discrepancy::diagnose::{Answer, Options, Progress, diagnose};
use truecut::discrepancy::spikes;
use truecut::discrepancy::trial::{Trial, for_comparison};
use truecut::{Claims, KeptModel, Run, RunError, data, scenario, sim};

use crate::attended::{Attended, attended};
use crate::errors::{of_run, plain};
use crate::values::of_serde;

/// Limits of a diagnosis.
pub struct Limits {
    pub runs: Option<NonZeroUsize>,
    pub causes: Option<NonZeroUsize>,
}

/// Why there is no report.
enum Refused {
    Run(RunError),
    Text(String),
}

impl From<RunError> for Refused {
    fn from(error: RunError) -> Refused {
        Refused::Run(error)
    }
}

fn told(py: Python<'_>, scenario: &scenario::Scenario, refused: &Refused) -> PyErr {
    match refused {
        Refused::Run(error) => of_run(py, scenario.path(), error),
        Refused::Text(text) => plain(py, text),
    }
}

/// A scenario beside measured data.
pub fn compared<'py>(
    py: Python<'py>,
    scenario: &scenario::Scenario,
    file: Option<&Path>,
    progress: Option<&Bound<'py, PyAny>>,
) -> PyResult<Bound<'py, PyAny>> {
    let compared = attended(py, progress, |attended| compare(scenario, file, attended))?;
    of_serde(py, &compared.map_err(|error| told(py, scenario, &error))?)
}

fn compare(
    scenario: &scenario::Scenario,
    file: Option<&Path>,
    attended: &Attended,
) -> Result<Comparison, Refused> {
    let measured = data::measured(scenario, file)?;
    let run = Run {
        measured: Some(&measured),
        claims: Claims::Ignore,
        progress: &|part| attended.tell(part),
        stop: Some(attended.stop()),
        ..Run::of(scenario)
    };
    let finished = run.execute()?;
    let (simulated, whole) = (finished.recording, finished.compared.unwrap_or(measured));
    if !simulated.outcome.reached_end() {
        return Err(Refused::Text(format!("the run {}", simulated.outcome)));
    }
    let turning = scenario.process.facts().rate_rad_s;
    let spindle_hz = turning.map(|rad_s| rad_s / std::f64::consts::TAU);
    let spiky = spikes::notes(scenario, &whole);
    let measured = for_comparison(scenario, whole);
    let comparison = compare_recordings(&simulated, &measured, spindle_hz);
    let mut comparison =
        comparison.map_err(|error| Refused::Text(format!("{}: {error}", measured.source)))?;
    let assumed = sim::estimates(scenario, &sim::Robots::new());
    let assumed = assumed.map_err(|error| RunError::of(scenario, error))?;
    comparison.notes.extend(assumed);
    comparison.notes.extend(spiky);
    Ok(comparison)
}

/// What a scenario lacks against measured data.
pub fn diagnosed<'py>(
    py: Python<'py>,
    scenario: &scenario::Scenario,
    file: Option<&Path>,
    limits: &Limits,
    progress: Option<&Bound<'py, PyAny>>,
) -> PyResult<Bound<'py, PyAny>> {
    let answer = attended(py, progress, |attended| {
        look_for_causes(scenario, file, limits, attended)
    })?;
    of_serde(
        py,
        &answer
            .map_err(|error| told(py, scenario, &error))?
            .diagnosis,
    )
}

fn look_for_causes(
    scenario: &scenario::Scenario,
    file: Option<&Path>,
    limits: &Limits,
    attended: &Attended,
) -> Result<Answer, Refused> {
    let data = data::measured(scenario, file)?;
    let trial = Trial::new(scenario, &data).map_err(|error| RunError::of(scenario, error))?;
    let failed = |error: std::io::Error| Refused::Text(error.to_string());
    // Predictions are kept beside it while the search goes on; it ends soon once it is stopped.
    let folder = tempfile::tempdir().map_err(failed)?;
    let runs = folder.path().join("runs");
    let model = KeptModel::new(&trial, &runs, "", Some(attended.stop())).map_err(failed)?;
    let mut options = Options::default();
    options.max_predictions = limits
        .runs
        .map_or(options.max_predictions, NonZeroUsize::get);
    options.max_effects = limits.causes.map_or(options.max_effects, NonZeroUsize::get);
    let tell = |now: Progress| {
        attended.tell(now.predictions as f64 / now.max_predictions.max(1) as f64);
    };
    let answer = diagnose(&model, &trial.observation, &options, &tell);
    let answer = answer.map_err(|error| Refused::Text(format!("{}: {error}", data.source)))?;
    Ok(Confirmed::of(&trial, answer).answer)
}
