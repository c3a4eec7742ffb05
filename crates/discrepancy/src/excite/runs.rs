//! Runs along a motion, and differences between predictions.

use truecut_plan::motion::excitation::SampledMotion;
use truecut_recording::{Measured, Outcome};
use truecut_scenario::Scenario;
use truecut_scenario::effect::Effect;
use truecut_sim::SimError;
use truecut_sim::run::{Engine, Run};

use super::model::{Jacobian, Kind, Model};
use super::unknowns::What;
use crate::trial::sampling;

/// Predicts the outputs of a scenario with effects, `[channel][row]`.
type Predict<'a> = dyn Fn(&Scenario, &[Effect]) -> Result<Vec<Vec<f64>>, SimError> + 'a;

impl Model {
    /// Derivatives of runs along a motion.
    pub(super) fn forward(
        &self,
        scenario: &Scenario,
        measured: &Measured,
    ) -> Result<Jacobian, SimError> {
        let predict = |varied: &Scenario, effects: &[Effect]| {
            self.run(&varied.with_effects(effects)?, measured)
        };
        let mut all = Vec::with_capacity(self.names.len());
        self.differences(scenario, &predict, &mut all)?;
        let outputs: Vec<Vec<f64>> = predict(scenario, &self.unknowns.effects)?;
        // A planned motion is measured throughout, data at hand where they are valid.
        let valid = |name: &str| measured.outputs().find(|one| one.spec.name == name);
        let counts = (self.outputs.iter().zip(&outputs))
            .map(|(own, column)| match valid(&own.spec.name) {
                Some(channel) if channel.valid.len() == column.len() => channel.valid.clone(),
                _ => vec![true; column.len()],
            })
            .collect();
        Ok(Jacobian {
            columns: all,
            counts,
            outputs,
            noise_share: 1.0,
        })
    }

    /// The outputs of a run at the times of its data.
    fn run(&self, scenario: &Scenario, measured: &Measured) -> Result<Vec<Vec<f64>>, SimError> {
        let names: Vec<&str> = self
            .outputs
            .iter()
            .map(|one| one.spec.name.as_str())
            .collect();
        let run = Run {
            measured: Some(measured),
            robots: Some(&self.robots),
            engine: Engine::REDUCED,
            ..Run::of(scenario)
        };
        let rows = run.rows(&names, None)?;
        if rows.outcome != Outcome::Completed {
            let message = format!("a run along the motion: {}", rows.outcome);
            return Err(SimError::scenario("process.replay", message));
        }
        let at = |column: &Vec<f64>| sampling::at(&rows.time_s, column, &measured.time_s);
        Ok(rows.columns.iter().map(at).collect())
    }

    /// The outputs along a motion as the scenario predicts them, without filters.
    ///
    /// # Errors
    /// A run that fails.
    pub fn predicted(
        &self,
        motion: &SampledMotion,
        times_s: &[f64],
    ) -> Result<Vec<Vec<f64>>, SimError> {
        match &self.kind {
            Kind::Inverse(model) => model.in_motion(motion, times_s).predict(&[]),
            Kind::Forward => self.run(&self.placed(motion), &self.measured(motion, times_s)),
        }
    }

    /// Central differences by the unknowns beside those of `[fit]`; one-sided where a bound is
    /// near.
    pub(super) fn differences(
        &self,
        scenario: &Scenario,
        predict: &Predict<'_>,
        all: &mut Vec<Vec<Vec<f64>>>,
    ) -> Result<(), SimError> {
        let effects = &self.unknowns.effects;
        for (extra, step) in self.unknowns.extra.iter().zip(&self.steps) {
            let at = |value: f64| match &extra.what {
                What::Key(key) => {
                    let varied = scenario.with_values(&[(key, value)])?;
                    // Those of the file may be what is varied.
                    let mut own = varied.effects.clone();
                    let same = |a: &Effect, b: &Effect| a.kind == b.kind && a.target == b.target;
                    own.retain(|one| !effects.iter().any(|other| same(one, other)));
                    own.extend_from_slice(effects);
                    predict(&varied, &own)
                }
                What::Effect { effect, parameter } => {
                    let mut varied = effects.clone();
                    varied[*effect].values[*parameter] = value;
                    predict(scenario, &varied)
                }
            };
            let (least, most) = match &extra.what {
                What::Key(_) => (f64::NEG_INFINITY, f64::INFINITY),
                What::Effect { effect, parameter } => {
                    let info = &effects[*effect].kind.parameters()[*parameter];
                    (info.min, info.max)
                }
            };
            let [low, high] = [extra.value - step, extra.value + step];
            let [low, high] = [low.max(least), high.min(most)];
            let (mut ahead, behind) = (at(high)?, at(low)?);
            for (ahead, behind) in ahead.iter_mut().flatten().zip(behind.iter().flatten()) {
                *ahead = (*ahead - behind) / (high - low);
            }
            all.push(ahead);
        }
        Ok(())
    }
}
