//! Runs one scenario, and keeps recordings that several claims refer to.

use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

use truecut_recording::{OpenSinks, Outcome, Recorder, Recording, Sink};
use truecut_scenario::Scenario;
use truecut_sim::Cell;
use truecut_sim::replay::predict::{Prediction, predict};

use crate::data;
use crate::failure::Failure;
use crate::progress::RunProgress;

/// A run that has ended, with its sinks still open for the claims.
pub struct Executed {
    pub recording: Recording,
    pub sinks: OpenSinks,
    pub time_step_s: f64,
}

/// Runs a scenario into `sinks`. `data` names the measured data, if not the scenario does. `progress` is told
/// the part done, from 0 to 1.
pub fn execute(
    scenario: &Scenario,
    data: Option<&Path>,
    sinks: Vec<Box<dyn Sink + Send>>,
    progress: &RunProgress,
) -> Result<Executed, Failure> {
    let failed = |error| Failure::sim(scenario, error);
    let measured = data::measured(scenario, data)?;
    if let Some(measured) = &measured
        && let Some(prediction) = predict(scenario, measured).map_err(failed)?
    {
        return record(scenario, prediction, sinks);
    }
    let cell = Cell::build_with_data(scenario, measured.as_ref()).map_err(failed)?;
    let mut header = cell.header();
    header
        .notes
        .extend(measured.map(|measured| measured.notes).unwrap_or_default());
    // A slip in a claim must not cost the run.
    scenario.check_claims(&header)?;
    scenario.check_bands(cell.row_interval_s())?;
    let time_step_s = cell.time_step_s();
    let sink_failed = |error| failed(truecut_sim::SimError::Sink(error));
    let mut recorder = Recorder::new(header, sinks).map_err(sink_failed)?;
    let end = cell
        .run(&mut recorder, &|part| progress.set(part))
        .map_err(failed)?;
    let finished = recorder.finish(end.scalars, end.profiles, end.outcome);
    let (recording, sinks) = finished.map_err(sink_failed)?;
    Ok(Executed {
        recording,
        sinks,
        time_step_s,
    })
}

/// Records what was predicted without a plant.
fn record(
    scenario: &Scenario,
    prediction: Prediction,
    sinks: Vec<Box<dyn Sink + Send>>,
) -> Result<Executed, Failure> {
    let failed = |error| Failure::sim(scenario, truecut_sim::SimError::Sink(error));
    scenario.check_claims(&prediction.header)?;
    let mut recorder = Recorder::new(prediction.header, sinks).map_err(failed)?;
    let mut row = Vec::with_capacity(prediction.columns.len());
    for (k, time_s) in prediction.measured.time_s.iter().enumerate() {
        row.clear();
        row.extend(prediction.columns.iter().map(|column| column[k]));
        recorder.push_row(*time_s, &row).map_err(failed)?;
    }
    let finished = recorder.finish(Vec::new(), Vec::new(), Outcome::Completed);
    let (recording, sinks) = finished.map_err(failed)?;
    Ok(Executed {
        recording,
        sinks,
        time_step_s: prediction.measured.interval_s(),
    })
}

/// Recordings in memory, each made once: several claims may refer to the same run.
#[derive(Default)]
pub struct Runs {
    made: Mutex<HashMap<(PathBuf, String), Arc<Slot>>>,
}

/// Empty until the run has ended; locked while it goes on, so that a second asker waits for it.
type Slot = Mutex<Option<Arc<Recording>>>;

impl Runs {
    /// The recording of a scenario, without outputs.
    pub fn get(
        &self,
        scenario: &Scenario,
        progress: &RunProgress,
    ) -> Result<Arc<Recording>, Failure> {
        let slot = {
            let path = scenario.path();
            let path = path.canonicalize().unwrap_or_else(|_| path.to_owned());
            let key = (path, scenario.effective_text());
            let mut made = self.made.lock().unwrap_or_else(PoisonError::into_inner);
            Arc::clone(made.entry(key).or_default())
        };
        let mut slot = slot.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(recording) = &*slot {
            return Ok(Arc::clone(recording));
        }
        let Executed {
            recording, sinks, ..
        } = execute(scenario, None, Vec::new(), progress)?;
        sinks
            .close(&recording, &[])
            .map_err(|error| Failure::sim(scenario, truecut_sim::SimError::Sink(error)))?;
        let recording = Arc::new(recording);
        *slot = Some(Arc::clone(&recording));
        Ok(recording)
    }
}
