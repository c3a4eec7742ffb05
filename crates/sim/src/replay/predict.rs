//! Replays without a plant.

use super::inverse::InverseModel;
use super::steady::SteadyModel;
use crate::error::SimError;
use crate::estimates::estimates;
use crate::robots::Robots;
use truecut_recording::{Header, Measured};
use truecut_scenario::{ProcessSpec, ReplayMode, Scenario};

/// What a replay without a plant predicts, at the times of the data it is given for.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Prediction {
    /// Channels and notes.
    pub header: Header,
    /// One column for each channel, SI.
    pub columns: Vec<Vec<f64>>,
    /// The measured channels in the form that the prediction is to be compared with.
    pub measured: Measured,
}

/// Predicts the outputs of `measured` without running a plant: by inverse dynamics, or (mode
/// "observe") every channel by its mean. `None` for a scenario that has a plant to run.
///
/// # Errors
/// As [`InverseModel::new`] and [`SteadyModel::new`].
pub(crate) fn predict(
    scenario: &Scenario,
    measured: &Measured,
) -> Result<Option<Prediction>, SimError> {
    let ProcessSpec::Replay(replay) = &scenario.process else {
        return Ok(None);
    };
    let mut assumed = None;
    let (columns, compared, note) = match replay.mode {
        ReplayMode::Forward => return Ok(None),
        ReplayMode::Observe => {
            let model = SteadyModel::new(scenario, measured)?;
            let note = "nothing is simulated: every channel is predicted by its mean".to_owned();
            (model.predict(&[])?, model.measured().clone(), note)
        }
        ReplayMode::Inverse {
            differentiate_cutoff_hz,
            compare_cutoff_hz,
        } => {
            let model = InverseModel::new(scenario, measured)?;
            let note = format!(
                "inverse dynamics: coordinates smoothed at {differentiate_cutoff_hz} Hz and differentiated, drive \
                 forces at {compare_cutoff_hz} Hz, Butterworth of order 4, forward and backward"
            );
            assumed = estimates(scenario, &Robots::new())?;
            (model.predict(&[])?, model.measured().clone(), note)
        }
    };
    let mut notes = measured.notes.clone();
    notes.push(note);
    notes.extend(assumed);
    notes.extend(scenario.notes());
    let header = Header {
        scenario_name: scenario.name.clone(),
        scenario_text: scenario.effective_text(),
        channels: compared
            .channels
            .iter()
            .map(|channel| channel.spec.clone())
            .collect(),
        notes,
        ..Header::default()
    };
    Ok(Some(Prediction {
        header,
        columns,
        measured: compared,
    }))
}
