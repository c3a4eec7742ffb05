//! Mode "observe": no plant. Every channel is predicted by its mean; where the spindle speed and the depth of cut are given, a cut's
//! forces follow the depth as it changes with the spindle's angle.

use truecut_recording::{ChannelSpec, Measured};
use truecut_scenario::effect::{Effect, EffectKind, Target};
use truecut_scenario::{ProcessSpec, Scenario, Turning};

use super::place;
use crate::error::SimError;

/// Predicts what a steady machine's channels are, without integrating anything.
#[derive(Debug, Clone)]
pub struct SteadyModel {
    measured: Measured,
    specs: Vec<ChannelSpec>,
    means: Vec<f64>,
    turning: Option<Turning>,
    effects: Vec<Effect>,
}

impl SteadyModel {
    /// Takes the mean of every output over its valid samples.
    ///
    /// # Errors
    /// Effects that play no part here.
    pub fn new(scenario: &Scenario, measured: &Measured) -> Result<SteadyModel, SimError> {
        let outputs = Measured {
            channels: measured.outputs().cloned().collect(),
            ..measured.clone()
        };
        let model = SteadyModel {
            specs: outputs
                .channels
                .iter()
                .map(|one| one.spec.clone())
                .collect(),
            means: outputs.channels.iter().map(mean).collect(),
            turning: match &scenario.process {
                ProcessSpec::Replay(replay) => replay.turning,
                _ => None,
            },
            effects: scenario.effects.clone(),
            measured: outputs,
        };
        model.predict(&[])?;
        Ok(model)
    }

    /// What is predicted, in order: the outputs.
    pub fn channels(&self) -> &[ChannelSpec] {
        &self.specs
    }

    /// The outputs.
    pub fn measured(&self) -> &Measured {
        &self.measured
    }

    /// Whether effects of a kind play a part here.
    pub fn supports(scenario: &Scenario, kind: EffectKind) -> bool {
        match kind {
            EffectKind::CuttingRunout => {
                matches!(&scenario.process, ProcessSpec::Replay(replay) if replay.turning.is_some())
            }
            EffectKind::SensorDrift => true,
            _ => false,
        }
    }

    /// The channels with the scenario's effects and further `effects`, which replace those of the same kind and target.
    ///
    /// # Errors
    /// An effect that plays no part here, or is on a channel that was not measured.
    pub fn predict(&self, effects: &[Effect]) -> Result<Vec<Vec<f64>>, SimError> {
        let times = &self.measured.time_s;
        let constant = |mean: &f64| vec![*mean; times.len()];
        let mut columns: Vec<Vec<f64>> = self.means.iter().map(constant).collect();
        let kept = (self.effects.iter()).filter(|own| {
            !effects
                .iter()
                .any(|e| e.kind == own.kind && e.target == own.target)
        });
        for effect in kept.chain(effects) {
            match (effect.kind, self.turning, &effect.target) {
                (EffectKind::CuttingRunout, Some(turning), _) => {
                    self.turn(turning, &effect.values, &mut columns);
                }
                (EffectKind::SensorDrift, _, Target::Channel(name)) => {
                    let Some(at) = self.specs.iter().position(|spec| spec.name == *name) else {
                        let message = format!("channel \"{name}\" is not among the outputs");
                        let place = place(&self.effects, effect, "channel");
                        return Err(SimError::scenario(place, message));
                    };
                    let (size, time_constant) = (effect.values[0], effect.values[1]);
                    for (value, t) in columns[at].iter_mut().zip(times) {
                        *value -= size * (-t / time_constant).exp_m1();
                    }
                }
                _ => {
                    let name = effect.kind.name();
                    let message = format!(
                        "\"{name}\" plays no part where nothing is simulated; sensor_drift does, and with spindle_rpm and \
                         depth_mm in [process.replay] cutting_runout"
                    );
                    let place = place(&self.effects, effect, "kind");
                    return Err(SimError::scenario(place, message));
                }
            }
        }
        Ok(columns)
    }

    /// A workpiece that turns about another axis than its own: the depth changes once per revolution, and the forces with it, each as
    /// its mean, since the chip's area is width times depth.
    fn turn(&self, turning: Turning, values: &[f64], columns: &mut [Vec<f64>]) {
        for (column, mean) in columns.iter_mut().zip(&self.means) {
            for (value, t) in column.iter_mut().zip(&self.measured.time_s) {
                let (sine, cosine) = (turning.spindle_rad_s * t).sin_cos();
                *value += mean * (values[0] * cosine + values[1] * sine) / turning.depth_m;
            }
        }
    }
}

fn mean(channel: &truecut_recording::MeasuredChannel) -> f64 {
    let pairs = channel.values.iter().zip(&channel.valid);
    let valid = pairs.filter(|(_, valid)| **valid);
    let (sum, count) = valid.fold((0.0, 0_usize), |(sum, n), (value, _)| (sum + value, n + 1));
    sum / count as f64
}
