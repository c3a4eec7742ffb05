//! Places that no tool gets to.

use nalgebra::Vector3;

use super::FEWEST_JOINTS;
use crate::model::{JointKind, Robot};

/// No arm's foot is narrower than this part of its reach to either side: a small one of 0.5 m has
/// 65 mm there, one of 2.5 m some 400 mm.
const NARROWEST: f64 = 0.05;
/// Its first joint is no further up than this part of its reach: else the origin is not its foot,
/// but the floor below an arm that hangs, or stands on a pedestal.
const HIGHEST: f64 = 0.5;

impl Robot {
    /// How far a tool point in the world is off the origin of the arm, m, where that is within the
    /// arm's own foot; `None` elsewhere, and where nothing says that a foot stands at the origin.
    #[must_use]
    pub fn within_foot_m(&self, tool_m: &Vector3<f64>) -> Option<f64> {
        let first = self.chain.joints.first()?;
        let reach_m = self.chain.reach_m();
        let origin_m = first.parent_from_joint.translation.vector;
        let axis = first.parent_from_joint.rotation * first.axis.into_inner();
        let beside_m = (origin_m - axis * axis.dot(&origin_m)).norm();
        let stands = first.kind == JointKind::Revolute
            && self.chain.joints.len() >= FEWEST_JOINTS
            && beside_m < NARROWEST * reach_m
            && origin_m.norm() < HIGHEST * reach_m;
        let off_m = tool_m.norm();
        (stands && off_m < NARROWEST * reach_m).then_some(off_m)
    }
}
