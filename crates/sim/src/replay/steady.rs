//! Mode "observe": no plant. Every channel is predicted by its mean; where the spindle speed and
//! the depth of cut are given, a cut's forces follow the depth as it changes with the spindle's
//! angle.

use truecut_core::cutting;
use truecut_recording::{ChannelSpec, Measured};
use truecut_scenario::effect::{Effect, Target};
use truecut_scenario::{ProcessSpec, Scenario, Turning};

use super::{check_part, in_force, refused, sense};
use crate::effect::Effects;
use crate::error::SimError;

/// Predicts what a steady machine's channels are, without integrating anything.
#[derive(Debug, Clone)]
pub struct SteadyModel {
    measured: Measured,
    specs: Vec<ChannelSpec>,
    means: Vec<f64>,
    turning: Option<Turning>,
    scenario: Scenario,
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
            turning: turning(scenario),
            scenario: scenario.clone(),
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

    /// The channels with the scenario's effects and further `effects`, which replace those of the
    /// same kind and target.
    ///
    /// # Errors
    /// An effect that plays no part here, or is on a channel that was not measured.
    pub fn predict(&self, effects: &[Effect]) -> Result<Vec<Vec<f64>>, SimError> {
        let times = &self.measured.time_s;
        let constant = |mean: &f64| vec![*mean; times.len()];
        let mut columns: Vec<Vec<f64>> = self.means.iter().map(constant).collect();
        let all = in_force(&self.scenario.effects, effects);
        for effect in &all {
            self.check(effect)?;
        }
        let sum = Effects::sum(all, &[]);
        if let Some(turning) = self.turning {
            self.turn(turning, sum.cutting.runout_m, &mut columns);
        }
        sense(&sum, &self.specs, times, &mut columns);
        Ok(columns)
    }

    /// Refuses an effect that plays no part here, or is on a channel that was not measured.
    fn check(&self, effect: &Effect) -> Result<(), SimError> {
        check_part(&self.scenario, effect)?;
        if let Target::Channel(name) = &effect.target
            && self.specs.iter().all(|spec| spec.name != *name)
        {
            let message = format!("channel \"{name}\" is not among the outputs");
            return Err(refused(&self.scenario, effect, "channel", message));
        }
        Ok(())
    }

    /// A workpiece that turns about another axis than its own: the depth changes once per
    /// revolution, and the forces with it, each as its mean, since the chip's area is width times
    /// depth.
    fn turn(&self, turning: Turning, runout_m: [f64; 2], columns: &mut [Vec<f64>]) {
        if runout_m == [0.0; 2] {
            return;
        }
        for (column, mean) in columns.iter_mut().zip(&self.means) {
            for (value, t) in column.iter_mut().zip(&self.measured.time_s) {
                let deeper = cutting::runout_m(runout_m, turning.spindle_rad_s * t);
                *value += mean * deeper / turning.depth_m;
            }
        }
    }
}

fn turning(scenario: &Scenario) -> Option<Turning> {
    let ProcessSpec::Replay(replay) = &scenario.process else {
        return None;
    };
    replay.turning
}

fn mean(channel: &truecut_recording::MeasuredChannel) -> f64 {
    let pairs = channel.values.iter().zip(&channel.valid);
    let valid = pairs.filter(|(_, valid)| **valid);
    let (sum, count) = valid.fold((0.0, 0_usize), |(sum, n), (value, _)| (sum + value, n + 1));
    sum / count as f64
}
