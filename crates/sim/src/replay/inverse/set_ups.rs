//! The same arm and data in other set-ups.

use std::sync::Arc;

use nalgebra::Vector3;
use truecut_arm::JointKind;

use super::{InverseModel, nominal};
use crate::effect::{Effects, JointEffects, build_in};
use crate::error::SimError;
use crate::replay::motion::Motion;
use crate::replay::rigid::{Forces, forces};

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

    /// Whether each joint turns.
    pub fn rotary(&self) -> Vec<bool> {
        let joints = self.robot.chain.joints.iter();
        (joints.map(|joint| joint.kind == JointKind::Revolute)).collect()
    }

    /// The same arm where two joints have each other's coordinates.
    ///
    /// # Panics
    /// If there is no such joint.
    pub fn swapped(&self, one: usize, other: usize) -> InverseModel {
        self.moving(self.motion.swapped(one, other))
    }

    /// The same arm where the coordinates of some joints are a factor times as large.
    ///
    /// # Panics
    /// If there is no such joint.
    pub fn scaled(&self, joints: &[usize], factor: f64) -> InverseModel {
        self.moving(self.motion.scaled(joints, factor))
    }

    fn moving(&self, motion: Motion) -> InverseModel {
        InverseModel {
            nominal: nominal(&self.robot, &motion, &self.joints, &self.filter),
            motion,
            ..self.clone()
        }
    }

    /// Forces of the same arm, payload included, where gravity comes from another direction, links
    /// or rotors are not those of their files or stand beyond what their joints report, or the
    /// motion is faster than the data say; `None` where none of this is.
    pub(super) fn as_it_stands(
        &self,
        reported: &Forces,
        effects: &Effects,
        motion: &Motion,
    ) -> Result<Option<Forces>, SimError> {
        let is_other = effects.joints.iter().any(JointEffects::is_another_arm);
        if effects.tilts.is_empty() && effects.clock_rate.is_none() && !is_other {
            return Ok(None);
        }
        let mut robot = reported.robot.clone();
        build_in(Arc::make_mut(&mut robot), effects)?;
        let gravity_m_s2 = effects.gravity_on_base(self.motion.gravity_m_s2);
        Ok(Some(forces(
            &robot,
            motion,
            &gravity_m_s2,
            &self.joints,
            &self.filter,
        )))
    }

    /// Where gravity points in the scenario; `None` without.
    pub fn gravity_direction(&self) -> Option<Vector3<f64>> {
        self.motion.gravity_m_s2.try_normalize(0.0)
    }
}
