//! Frames of the arm, and its linearisation where it travels.

use super::{RENEWAL_RAD, ReducedPlant};
use crate::plant::combined;
use nalgebra::{Isometry3, Quaternion, UnitQuaternion, Vector3};
use truecut_arm::{FrameId, JointKind};

/// Part of that by which the new linearisation lies ahead; short of one, so that a vibrating joint
/// does not call for the next one at once.
const LEAD: f64 = 0.8;

impl ReducedPlant {
    /// Poses to first order about the linearisation's, or exactly where the arm travels.
    pub(super) fn update_frames(&mut self) {
        if self.travels {
            let q = &self.joints.position;
            let joints = self.arm.robot.chain.joints.iter().zip(q);
            let last = joints.fold(Isometry3::identity(), |pose, (joint, &q)| {
                pose * joint.parent_from_link(q)
            });
            self.tool.world_from_frame = last * self.last_from_tool;
            self.foot.world_from_frame = last * self.last_from_foot;
            let jacobian = &mut self.tool.jacobian;
            (self.arm.dynamics).jacobian_into(q, FrameId::Tool, jacobian);
            // Both are fixed to the last link: they turn alike, and move apart by the turning.
            let arm_m = self.foot.world_from_frame.translation.vector
                - self.tool.world_from_frame.translation.vector;
            self.foot.jacobian.copy_from(jacobian);
            for mut column in self.foot.jacobian.column_iter_mut() {
                let turn: Vector3<f64> = column.fixed_rows::<3>(3).into_owned();
                let mut linear = column.fixed_rows_mut::<3>(0);
                linear += turn.cross(&arm_m);
            }
            return;
        }
        let linear = &self.linear;
        for (state, at) in [
            (&mut self.tool, &linear.tool),
            (&mut self.foot, &linear.foot),
        ] {
            let [shift, turn] =
                [0, 3].map(|row| combined(&at.jacobian, row, self.shift.as_slice()));
            let pose = &mut state.world_from_frame;
            pose.translation.vector = at.world_from_frame.translation.vector + shift;
            let half = Quaternion::from_parts(1.0, turn * 0.5);
            pose.rotation = UnitQuaternion::new_normalize(half) * at.world_from_frame.rotation;
        }
    }

    /// Linearises a travelling arm anew where it has turned too far from its linearisation: about a
    /// posture ahead, so that what mass and recurrence err by before it makes up for what they err
    /// by behind it.
    pub(super) fn renew(&mut self) {
        let (mut turned, mut fastest) = (0.0f64, 0.0f64);
        for (i, joint) in self.arm.robot.chain.joints.iter().enumerate() {
            if joint.kind == JointKind::Revolute {
                turned = turned.max((self.joints.position[i] - self.linear.posture[i]).abs());
                fastest = fastest.max(self.joints.velocity[i].abs());
            }
        }
        if turned <= RENEWAL_RAD {
            return;
        }
        let ahead_s = LEAD * RENEWAL_RAD / fastest.max(f64::MIN_POSITIVE);
        let joints = self.joints.position.iter().zip(&self.joints.velocity);
        let posture: Vec<f64> = joints.map(|(q, v)| q + v * ahead_s).collect();
        // Only a state that has already left the numbers has no linearisation; the guard will say
        // so.
        if let Some(linear) = self.arm.about(&posture) {
            self.linear = linear;
        }
    }
}
