//! Motion beyond the limits that a robot's file gives.

use super::InverseModel;
use crate::replay::inputs::{JointQuantity, joint_channel};

impl InverseModel {
    /// A sentence for each joint that has moved beyond the limits in its file.
    pub fn beyond_limits(&self) -> Vec<String> {
        let joints = self.robot.chain.joints.iter().zip(&self.motion.position);
        let beyond = joints.enumerate().filter_map(|(index, (joint, places))| {
            let limits = joint.limits?;
            let by = |q: &f64| (q - limits.upper).max(limits.lower - q);
            let farthest = places.iter().max_by(|a, b| by(a).total_cmp(&by(b)))?;
            let name = joint_channel(&self.robot, index, JointQuantity::Coordinate);
            let unit = joint.kind.coordinate_unit();
            (by(farthest) > 0.0).then(|| {
                format!(
                    "{name} reaches {farthest:.4} {unit}, beyond the limits of joint `{}` in its file, {:.4} and {:.4} \
                     {unit}: taken as measured",
                    joint.name, limits.lower, limits.upper
                )
            })
        });
        beyond.collect()
    }
}
