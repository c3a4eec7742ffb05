//! What the diagnosis needs of a simulation: nominal parameters, candidate effects, predictions.

use thiserror::Error;
use truecut_recording::ChannelSpec;
use truecut_scenario::UncertainSpec;
use truecut_scenario::effect::{Effect, EffectKind, ParameterInfo, Target};

/// One value per sample, for each channel.
pub type Columns = Vec<Vec<f64>>;

/// An effect that the model could have.
#[derive(Debug, Clone, PartialEq)]
pub struct Candidate {
    /// What it is.
    pub kind: EffectKind,
    /// What it acts on.
    pub target: Target,
    /// Whether its parameters are those of a rotary joint.
    pub rotary: bool,
    /// For each parameter, a typical distance from its neutral value: SI, positive.
    pub scale: Vec<f64>,
}

/// A variation of the experiment that could be made instead.
#[derive(Debug, Clone, PartialEq)]
pub struct Experiment {
    /// One line: what would be done differently.
    pub description: String,
    /// Keys of the scenario and the values that they would take, as they are written in the file.
    pub overrides: Vec<(String, String)>,
}

/// A law without a name that may be looked for.
#[derive(Debug, Clone, PartialEq)]
pub struct CurveCandidate {
    /// Its scale is that of any of its values.
    pub candidate: Candidate,
    /// The ends over which it is given.
    pub ends: [f64; 2],
    /// What none of its values is below: all friction together never drives a joint.
    pub least: f64,
}

/// Another set-up than the scenario's.
#[derive(Debug, Clone, PartialEq)]
pub struct SetUp {
    /// What would be otherwise, and the keys to look at.
    pub told: String,
    /// What the nominal model predicts then, with the friction that fits best.
    pub predicted: Columns,
}

/// A simulation that could not be run to its end.
#[derive(Debug, Clone, PartialEq, Error)]
#[error("{0}")]
pub struct PredictError(pub String);

/// A simulation of the measured experiment.
///
/// Predictions are full forward simulations from the measured inputs: no measured output enters
/// them.
pub trait Model: Sync {
    /// The predicted outputs, in order.
    fn channels(&self) -> &[ChannelSpec];

    /// Nominal parameters that may be refitted before structure is blamed.
    fn nominal(&self) -> &[UncertainSpec];

    /// The effects that may be looked for.
    fn candidates(&self) -> Vec<Candidate>;

    /// The parameters of a candidate, with the bounds within which they are looked for.
    fn parameters(&self, candidate: &Candidate) -> Vec<ParameterInfo> {
        candidate.kind.parameters().to_vec()
    }

    /// Sizes of a candidate of one parameter, in order, from each of which to the next no mode of
    /// the machine moves by more than `step_hz`; for one whose signature is ringing. Empty where
    /// it moves none.
    fn sizes_by_mode(&self, _candidate: &Candidate, _step_hz: f64) -> Vec<f64> {
        Vec::new()
    }

    /// The slowest mode of the nominal machine, Hz.
    fn slowest_mode_hz(&self) -> Option<f64> {
        None
    }

    /// Curves that may show what no candidate explains.
    fn curves(&self) -> Vec<CurveCandidate> {
        Vec::new()
    }

    /// Candidates, by their number, that each add to the outputs in proportion to their sizes, and
    /// of which all may be there at once.
    fn additive(&self) -> Vec<usize> {
        Vec::new()
    }

    /// Candidates, by their number, that are looked for beside causes found alone, all at once at
    /// the end: by itself each is too much like a friction.
    fn late(&self) -> Vec<usize> {
        Vec::new()
    }

    /// One column for each channel, at the samples of the data.
    ///
    /// # Errors
    /// A run that fails, e.g. because it diverges at these values. The search treats it as a step
    /// not to be taken.
    fn predict(&self, nominal: &[f64], effects: &[Effect]) -> Result<Columns, PredictError>;

    /// As [`Model::predict`] for the first samples; those after them are not looked at, and may be
    /// anything finite.
    ///
    /// # Errors
    /// As [`Model::predict`].
    fn predict_first(
        &self,
        samples: usize,
        nominal: &[f64],
        effects: &[Effect],
    ) -> Result<Columns, PredictError> {
        let _ = samples;
        self.predict(nominal, effects)
    }

    /// Whether effects are such as a machine may have. Predictions are made for others as well, so
    /// that a fit passes by them, but none may end there.
    fn may_be(&self, effects: &[Effect]) -> bool {
        let _ = effects;
        true
    }

    /// Whether the machine runs steadily by itself: that a prediction stands still is then no lack
    /// of excitation.
    fn is_steady(&self) -> bool {
        false
    }

    /// What is to be doubted about the data, whatever is named.
    fn doubt(&self) -> Option<String> {
        None
    }

    /// Other set-ups that people mistake for one another: which way the arm hangs, how fast the
    /// clock of the data is.
    fn set_ups(&self) -> Vec<SetUp> {
        Vec::new()
    }

    /// Other possible experiments, to distinguish causes.
    fn experiments(&self) -> Vec<Experiment> {
        Vec::new()
    }

    /// What the outputs would be in another experiment, at the sampling interval of the data.
    ///
    /// # Errors
    /// A run that fails.
    fn predict_experiment(
        &self,
        experiment: &Experiment,
        nominal: &[f64],
        effects: &[Effect],
    ) -> Result<Columns, PredictError> {
        let _ = (nominal, effects);
        Err(PredictError(format!(
            "the model cannot predict the experiment `{}`",
            experiment.description
        )))
    }
}
