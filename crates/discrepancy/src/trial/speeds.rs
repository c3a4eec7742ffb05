//! Friction that falls with speed, and where it cannot be told from other friction.
//!
//! Stribeck's excess is one only if the joint also moves beyond its fall. Over a range of speeds in which it is still falling, it is dry
//! friction with a bend, and a search would take it for any curvature that friction has.

use truecut_scenario::effect::{Effect, EffectKind, Target};

use super::Trial;
use crate::model::PredictError;

/// Place of the speed among the effect's values.
const SPEED: usize = 1;

impl Trial {
    /// Refuses a fall that the motion does not reach the end of.
    pub(super) fn check_speeds(&self, effects: &[Effect]) -> Result<(), PredictError> {
        for effect in effects {
            let Target::Joint(joint) = effect.target else {
                continue;
            };
            let most = self
                .fall_speeds
                .get(joint)
                .copied()
                .unwrap_or(f64::INFINITY);
            if effect.kind == EffectKind::JointStribeck && effect.values[SPEED] > most {
                let text = format!(
                    "friction of joint {} falls over {} per second, and the joint is not fast enough to tell",
                    joint + 1,
                    effect.values[SPEED]
                );
                return Err(PredictError(text));
            }
        }
        Ok(())
    }
}
