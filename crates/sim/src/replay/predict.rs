//! Replays without a plant, and recordings at the times of measured data.

use super::inverse::InverseModel;
use super::steady::SteadyModel;
use crate::error::SimError;
use truecut_recording::{Header, Measured, Recording, UnknownName};
use truecut_scenario::{ProcessSpec, ReplayMode, Scenario};

/// What a replay without a plant predicts, at the times of the data it is given for.
#[derive(Debug, Clone, PartialEq)]
pub struct Prediction {
    /// Channels and notes.
    pub header: Header,
    /// One column for each channel, SI.
    pub columns: Vec<Vec<f64>>,
    /// The measured channels in the form that the prediction is to be compared with.
    pub measured: Measured,
}

/// Predicts the outputs of `measured` without running a plant: by inverse dynamics, or (mode "observe") every
/// channel by its mean. `None` for a scenario that has a plant to run.
///
/// # Errors
/// As [`InverseModel::new`] and [`SteadyModel::new`].
pub fn predict(scenario: &Scenario, measured: &Measured) -> Result<Option<Prediction>, SimError> {
    let ProcessSpec::Replay(replay) = &scenario.process else {
        return Ok(None);
    };
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
            (model.predict(&[])?, model.measured().clone(), note)
        }
    };
    let mut notes = measured.notes.clone();
    notes.push(note);
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

/// A channel of a recording at other times, by cubic interpolation between its rows; NaN outside the
/// recording, as after a run that diverged.
///
/// # Errors
/// A channel that is not there; the nearest one is named.
pub fn sample_at(
    recording: &Recording,
    channel: &str,
    time_s: &[f64],
) -> Result<Vec<f64>, UnknownName> {
    let values = recording.channel(channel)?;
    let rows = &recording.time_s;
    let mut from = 0;
    let at = |&t: &f64| {
        let last = rows.len().saturating_sub(1);
        let slack = 1e-9 * t.abs().max(1e-3);
        if rows.is_empty() || t < rows[0] - slack || t > rows[last] + slack {
            return f64::NAN;
        }
        while from + 1 < last && rows[from + 1] <= t {
            from += 1;
        }
        let start = from.saturating_sub(1).min(rows.len().saturating_sub(4));
        let end = (start + 4).min(rows.len());
        lagrange(&rows[start..end], &values[start..end], t)
    };
    Ok(time_s.iter().map(at).collect())
}

/// The polynomial through the points.
fn lagrange(x: &[f64], y: &[f64], at: f64) -> f64 {
    (0..x.len())
        .map(|i| {
            let others = (0..x.len()).filter(|j| *j != i);
            y[i] * others.map(|j| (at - x[j]) / (x[i] - x[j])).product::<f64>()
        })
        .sum()
}
