//! Springs that are too stiff to be simulated: bases that hardly give, whose mode is so fast that a
//! run would take hundreds of times the steps, and tool modes that at their frequency would move
//! most of the arm's mass.
//!
//! What such a spring changes is proportional to its compliance. Below the least compliance that
//! the search simulates, the change is therefore taken in proportion from there, so that an effect
//! comes out of nothing without a jump. For a base it is the quasi-static tilt. A tool mode of mass
//! m and angular frequency ω adds 1/m - 1/M = Cω² - 1/M to the square of the arm's shape at its
//! tip, M being the arm's mass there.

use std::f64::consts::TAU;

use truecut_scenario::effect::{BaseEffect, Effect, EffectKind, MillingEffect, Target, Typed};

use super::{Trial, reduced};
use crate::model::{Columns, PredictError};

/// Halvings and doublings that are tried.
const TRIES: i32 = 40;
/// Bisections of the mass that the arm has at its tool, which is then known to a percent.
const BISECTIONS: i32 = 12;
/// A mode of the tool is simulated up to this part of the arm's mass at its tool.
const MOST_MASS: f64 = 0.25;
/// A fit that ends at more than this part of it has found no tool.
const MOST_MASS_FOUND: f64 = 0.5;
/// Damping ratio of the modes that the arm's mass is found with; it has no part in it.
const ANY_DAMPING: f64 = 0.03;

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
                    self.step_with(with_compliance(&candidate.target, value))
                        .is_some_and(|step| step >= self.shortest_step_s)
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

    /// The arm's mass at its tool, as modes across the tool's axis meet it where the cut begins,
    /// kg; none if a tool mode is no candidate, or the arm does not move across.
    pub(super) fn mass_at_tool_kg(&self) -> Option<f64> {
        let of_mode = |c: &&crate::model::Candidate| c.kind == EffectKind::ToolMode;
        self.candidates.iter().find(of_mode)?;
        let mut heavy = 10.0 * self.facts.moving_mass_kg;
        let mut hz = 0.5 * self.fastest_mode_hz;
        let light = |hz: f64| {
            let softest = EffectKind::ToolMode.parameters()[0].max;
            (1e-4 * heavy).max(1.0 / (softest * (TAU * hz).powi(2)))
        };
        let fits = |mass_kg: f64, hz: f64| {
            let compliance = 1.0 / (mass_kg * (TAU * hz).powi(2));
            self.step_with(with_mode(compliance, hz)).is_some()
        };
        // What else a run is refused for, too many periods between two teeth, is met by slower
        // ones.
        let mut slower = 0;
        while !fits(light(hz), hz) {
            hz *= 0.5;
            slower += 1;
            if slower > BISECTIONS {
                return None;
            }
        }
        let mut light = light(hz);
        if fits(heavy, hz) {
            return None;
        }
        for _ in 0..BISECTIONS {
            let middle = (light * heavy).sqrt();
            if fits(middle, hz) {
                light = middle;
            } else {
                heavy = middle;
            }
        }
        Some(light)
    }

    /// The step that a run with the effect takes; `None` if it is refused.
    fn step_with(&self, effect: Effect) -> Option<f64> {
        let scenario = self.scenario.with_effects(&[effect]).ok()?;
        let run = reduced(&scenario, &self.measured, &self.robots);
        run.time_step_s().ok()
    }

    /// The reduced prediction; where a spring is too stiff to be simulated, in proportion from the
    /// least compliance.
    pub(super) fn extrapolated(
        &self,
        nominal: &[f64],
        effects: &[Effect],
        until_s: Option<f64>,
    ) -> Result<Columns, PredictError> {
        let stiff = effects.iter().enumerate().find_map(|(index, effect)| {
            let value = compliance(effect)?;
            let least = self.least(effect)?;
            (value < least).then_some((index, value / least, least))
        });
        let Some((index, share, least)) = stiff else {
            return self.forward(nominal, effects, self.reduced(), until_s);
        };
        let mut raised = effects.to_vec();
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

    /// Whether all effects are such as a machine may have: none is found where predictions are only
    /// extrapolated.
    pub(super) fn may_be(&self, effects: &[Effect]) -> bool {
        effects.iter().all(|effect| match effect.typed() {
            Some(Typed::Milling(MillingEffect::ToolMode { .. })) => {
                let pairs = compliance(effect).zip(self.least(effect));
                pairs.is_none_or(|(value, least)| value > least * MOST_MASS / MOST_MASS_FOUND)
            }
            _ => true,
        })
    }

    /// Refuses a tool mode faster than the samples show.
    pub(super) fn check_modes(&self, effects: &[Effect]) -> Result<(), PredictError> {
        for effect in effects {
            let Some(Typed::Milling(MillingEffect::ToolMode { frequency_hz, .. })) = effect.typed()
            else {
                continue;
            };
            if frequency_hz > self.fastest_mode_hz {
                return Err(PredictError(format!(
                    "a mode at {frequency_hz:.1} Hz is faster than the {:.1} Hz that the samples show",
                    self.fastest_mode_hz
                )));
            }
        }
        Ok(())
    }

    /// The least compliance that the search simulates.
    fn least(&self, effect: &Effect) -> Option<f64> {
        match effect.typed()? {
            Typed::Base(_, BaseEffect::Compliance { .. }) => {
                let known = self.stiff.iter().find(|(t, _)| *t == effect.target);
                known.map(|(_, least)| *least)
            }
            Typed::Milling(MillingEffect::ToolMode { frequency_hz, .. }) => {
                let mass_kg = MOST_MASS * self.mass_at_tool_kg?;
                Some(1.0 / (mass_kg * (TAU * frequency_hz).powi(2)))
            }
            _ => None,
        }
    }
}

/// The compliance of a base, rad/(N m), or of a tool, m/N, if the effect is one of these.
fn compliance(effect: &Effect) -> Option<f64> {
    match effect.typed() {
        Some(Typed::Base(
            _,
            BaseEffect::Compliance {
                compliance_rad_per_n_m,
            },
        )) => Some(compliance_rad_per_n_m),
        Some(Typed::Milling(MillingEffect::ToolMode {
            compliance_m_per_n, ..
        })) => Some(compliance_m_per_n),
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

/// A tool that gives.
fn with_mode(compliance_m_per_n: f64, frequency_hz: f64) -> Effect {
    let law = MillingEffect::ToolMode {
        compliance_m_per_n,
        frequency_hz,
        damping_ratio: ANY_DAMPING,
    };
    Effect {
        kind: EffectKind::ToolMode,
        target: Target::Whole,
        values: law.values(),
    }
}
