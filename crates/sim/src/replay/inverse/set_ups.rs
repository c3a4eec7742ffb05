//! The same arm and data in other set-ups.

use nalgebra::Vector3;

use super::{InverseModel, nominal};
use crate::replay::motion::Motion;

impl InverseModel {
    /// The same arm and data under gravity along a unit vector, and `speed` times as fast. What a
    /// payload adds stays that of the scenario.
    pub fn set_up(&self, gravity_direction: Vector3<f64>, speed: f64) -> InverseModel {
        self.moving(self.motion.set_up(gravity_direction, speed))
    }

    /// The same arm where the coordinate of a joint has the other sign.
    ///
    /// # Panics
    /// If there is no such joint.
    pub fn reversed(&self, joint: usize) -> InverseModel {
        self.moving(self.motion.reversed(joint))
    }

    fn moving(&self, motion: Motion) -> InverseModel {
        InverseModel {
            nominal: nominal(&self.robot, &motion, &self.joints, &self.filter),
            motion,
            ..self.clone()
        }
    }

    /// Where gravity points in the scenario; `None` without.
    pub fn gravity_direction(&self) -> Option<Vector3<f64>> {
        self.motion.gravity_m_s2.try_normalize(0.0)
    }
}
