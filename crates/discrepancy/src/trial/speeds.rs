//! Friction that falls with speed, and where it cannot be told from other friction.
//!
//! Stribeck's excess is one only if the joint also moves beyond its fall. Over a range of speeds in
//! which it is still falling, it is dry friction with a bend, and a search would take it for any
//! curvature that friction has.

use truecut_scenario::effect::{Effect, JointEffect, Typed};

use super::Trial;
use crate::model::PredictError;

impl Trial {
    /// Refuses a fall that the motion does not reach the end of.
    pub(super) fn check_speeds(&self, effects: &[Effect]) -> Result<(), PredictError> {
        for effect in effects {
            let Some(Typed::Joint(joint, JointEffect::Stribeck { excess: _, speed })) =
                effect.typed()
            else {
                continue;
            };
            let fastest = self.fall_speeds.get(joint).copied();
            if speed > fastest.unwrap_or(f64::INFINITY) {
                let text = format!(
                    "friction of joint {} falls over {speed} per second, and the joint is not fast enough to tell",
                    joint + 1
                );
                return Err(PredictError(text));
            }
        }
        Ok(())
    }
}
