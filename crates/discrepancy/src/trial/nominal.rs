//! Nominal parameters put into a scenario without reading it anew: an inverse model predicts in
//! less time than a text is read.

use truecut_scenario::RobotSpec;
use truecut_scenario::effect::{Effect, ParameterInfo};

use super::Trial;
use crate::model::PredictError;

/// Keys of effects begin with it.
const EFFECT: &str = "effect.";

impl Trial {
    /// The nominal parameters that are the robot's: drive forces without effects depend on these
    /// alone.
    pub(super) fn of_robot(&self, nominal: &[f64]) -> Vec<f64> {
        let all = self.nominal.iter().zip(nominal);
        all.filter(|(one, _)| !one.key.starts_with(EFFECT))
            .map(|(_, value)| *value)
            .collect()
    }

    /// The robot with other nominal parameters.
    pub(super) fn varied_robot(&self, nominal: &[f64]) -> Result<RobotSpec, PredictError> {
        let mut robot = self.scenario.robot.clone();
        let mut keys = self.nominal.iter().zip(nominal);
        let is_set = |key: &str, value: f64, robot: &mut RobotSpec| robot.set_inertial(key, value);
        if keys
            .all(|(one, value)| one.key.starts_with(EFFECT) || is_set(&one.key, *value, &mut robot))
        {
            return Ok(robot);
        }
        Ok(self.varied(nominal, &[])?.robot)
    }

    /// The scenario's own effects as far as nominal parameters change them, and `effects`, which
    /// replace those of the same kind and target.
    pub(super) fn with_own(&self, nominal: &[f64], effects: &[Effect]) -> Vec<Effect> {
        let mut own: Vec<(usize, Effect)> = Vec::new();
        for (one, value) in self.nominal.iter().zip(nominal) {
            let Some((index, parameter)) = self.parameter(&one.key) else {
                continue;
            };
            let at = own.iter().position(|(known, _)| *known == index);
            let at = at.unwrap_or_else(|| {
                own.push((index, self.scenario.effects[index].clone()));
                own.len() - 1
            });
            own[at].1.values[parameter] = *value;
        }
        let replaced = |one: &Effect| {
            let twin = |other: &Effect| other.kind == one.kind && other.target == one.target;
            effects.iter().any(twin)
        };
        let kept = own.into_iter().map(|(_, one)| one);
        let mut all: Vec<Effect> = kept.filter(|one| !replaced(one)).collect();
        all.extend_from_slice(effects);
        all
    }

    /// Which effect of the scenario, and which of its values, a key means.
    fn parameter(&self, key: &str) -> Option<(usize, usize)> {
        let (index, own) = key.strip_prefix(EFFECT)?.split_once('.')?;
        let index: usize = index.parse().ok()?;
        let known = self.scenario.effects.get(index)?.kind.parameters();
        let is_meant = |info: &ParameterInfo| info.key == own || info.rotary_key == own;
        Some((index, known.iter().position(is_meant)?))
    }
}
