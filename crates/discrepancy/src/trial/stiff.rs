//! Bases that hardly give: their mode is so fast that a run would take hundreds of times the steps.
//!
//! What such a base changes is its quasi-static tilt, proportional to the compliance. Below the least compliance that the search
//! simulates, the change is therefore taken in proportion from there.

use truecut_scenario::effect::{Effect, EffectKind, Target};
use truecut_sim::reduced_step_s;

use super::Trial;
use crate::model::{Columns, PredictError};

/// Halvings and doublings that are tried.
const TRIES: i32 = 40;

impl Trial {
    /// For each axis, the least base compliance whose run is not refused for its step.
    pub(super) fn least_compliances(&self) -> Vec<(Target, f64)> {
        let compliances = self
            .candidates
            .iter()
            .filter(|c| c.kind == EffectKind::BaseCompliance && self.shortest_step_s > 0.0);
        compliances
            .map(|candidate| {
                let fits = |value: f64| {
                    let effect = Effect {
                        kind: candidate.kind,
                        target: candidate.target.clone(),
                        values: vec![value],
                    };
                    let step =
                        self.scenario.with_effects(&[effect]).ok().and_then(|s| {
                            reduced_step_s(&s, Some(&self.measured), &self.robots).ok()
                        });
                    step.is_some_and(|step| step >= self.shortest_step_s)
                };
                let typical = candidate.scale[0];
                let mut least = typical;
                let direction = if fits(typical) { 0.5 } else { 2.0 };
                for _ in 0..TRIES {
                    if direction < 1.0 && !fits(least * direction) {
                        break;
                    }
                    least *= direction;
                    if direction > 1.0 && fits(least) {
                        break;
                    }
                }
                (candidate.target.clone(), least)
            })
            .collect()
    }

    /// The reduced prediction; where the base is too stiff to be simulated, in proportion from the least compliance.
    pub(super) fn extrapolated(
        &self,
        nominal: &[f64],
        effects: &[Effect],
        until_s: Option<f64>,
    ) -> Result<Columns, PredictError> {
        let stiff = effects.iter().position(|effect| {
            effect.kind == EffectKind::BaseCompliance && effect.values[0] < self.least(effect)
        });
        let Some(index) = stiff else {
            return self.forward(nominal, effects, self.reduced(), until_s);
        };
        let mut raised = effects.to_vec();
        let least = self.least(&effects[index]);
        let share = effects[index].values[0] / least;
        raised[index].values[0] = least;
        let with = self.extrapolated(nominal, &raised, until_s)?;
        raised.remove(index);
        let without = self.extrapolated(nominal, &raised, until_s)?;
        let columns = with.iter().zip(&without);
        Ok(columns
            .map(|(with, without)| {
                let pairs = with.iter().zip(without);
                pairs.map(|(a, b)| b + share * (a - b)).collect()
            })
            .collect())
    }

    fn least(&self, effect: &Effect) -> f64 {
        let known = self.stiff.iter().find(|(t, _)| *t == effect.target);
        known.map_or(0.0, |(_, least)| *least)
    }
}
