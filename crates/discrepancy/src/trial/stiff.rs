//! Bases that hardly give: their mode is so fast that a run would take hundreds of times the steps.
//!
//! What such a base changes is its quasi-static tilt, proportional to the compliance. Below the
//! least compliance that the search simulates, the change is therefore taken in proportion from
//! there.

use truecut_scenario::effect::{BaseEffect, Effect, EffectKind, Target, Typed};

use super::{Trial, reduced};
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
                    let effect = with_compliance(&candidate.target, value);
                    let step =
                        self.scenario.with_effects(&[effect]).ok().and_then(|s| {
                            reduced(&s, &self.measured, &self.robots).time_step_s().ok()
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

    /// The reduced prediction; where the base is too stiff to be simulated, in proportion from the
    /// least compliance.
    pub(super) fn extrapolated(
        &self,
        nominal: &[f64],
        effects: &[Effect],
        until_s: Option<f64>,
    ) -> Result<Columns, PredictError> {
        let stiff = effects.iter().enumerate().find_map(|(index, effect)| {
            let value = compliance(effect)?;
            let least = self.least(effect);
            (value < least).then_some((index, value / least, least))
        });
        let Some((index, share, least)) = stiff else {
            return self.forward(nominal, effects, self.reduced(), until_s);
        };
        let mut raised = effects.to_vec();
        raised[index] = with_compliance(&effects[index].target, least);
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

/// The compliance of a base, rad/(N m), if the effect is one.
fn compliance(effect: &Effect) -> Option<f64> {
    match effect.typed() {
        Some(Typed::Base(
            _,
            BaseEffect::Compliance {
                compliance_rad_per_n_m,
            },
        )) => Some(compliance_rad_per_n_m),
        Some(_) | None => None,
    }
}

/// A base that gives about the axis of `target`.
fn with_compliance(target: &Target, compliance_rad_per_n_m: f64) -> Effect {
    let law = BaseEffect::Compliance {
        compliance_rad_per_n_m,
    };
    Effect {
        kind: EffectKind::BaseCompliance,
        target: target.clone(),
        values: law.values(),
    }
}
