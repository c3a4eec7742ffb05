//! Six revolute joints in a row: the last steps of the closed form, without the heap.

use nalgebra::{Isometry3, Matrix6, Translation3, Unit, UnitQuaternion, Vector3, Vector6};

use crate::model::{JointKind, Robot};

/// What is left of a pose (m and rad together) that no step betters.
const ROUNDING: f64 = 1e-13;
/// Most of a step, rad: the closed form is nearer to the pose than that, and near a singularity a
/// step is worthless.
const LONGEST_STEP_RAD: f64 = 1e-3;

/// Joint frames at zero in the link before, and the axes in them.
#[derive(Debug, Clone)]
pub(crate) struct SixAxes([(Isometry3<f64>, Unit<Vector3<f64>>); 6]);

impl SixAxes {
    /// `None` for any other arm.
    pub fn of(robot: &Robot) -> Option<Self> {
        let joints = &robot.chain.joints;
        let is_plain = joints.iter().all(|j| j.kind == JointKind::Revolute)
            && robot.chain.followers.is_empty();
        let axes = joints.iter().map(|j| (j.parent_from_joint, j.axis));
        let axes: Vec<_> = axes.filter(|_| is_plain).collect();
        axes.try_into().ok().map(Self)
    }

    /// Newton steps on a posture that is right to the closed form's own tolerance: the posture, and
    /// what is left of the pose.
    pub fn polished(
        &self,
        mut best: [f64; 6],
        last_from_frame: &Isometry3<f64>,
        target: &Isometry3<f64>,
    ) -> ([f64; 6], f64) {
        let mut links = self.links(&best);
        let mut error = pose_error(&(links[5] * last_from_frame), target);
        for _ in 0..3 {
            if error.norm() <= ROUNDING {
                break;
            }
            let point_m = (links[5] * last_from_frame).translation.vector;
            let Some(step) = self.jacobian(&links, &point_m).lu().solve(&error) else {
                break;
            };
            let trial: [f64; 6] = std::array::from_fn(|i| best[i] + step[i]);
            let there = self.links(&trial);
            let left = pose_error(&(there[5] * last_from_frame), target);
            if step.amax() > LONGEST_STEP_RAD || left.norm() >= error.norm() {
                break;
            }
            (best, links, error) = (trial, there, left);
        }
        (best, error.norm())
    }

    /// World from each link.
    fn links(&self, q: &[f64; 6]) -> [Isometry3<f64>; 6] {
        let mut pose = Isometry3::identity();
        std::array::from_fn(|i| {
            let (parent_from_joint, axis) = &self.0[i];
            let turn = UnitQuaternion::from_axis_angle(axis, q[i]);
            pose *= parent_from_joint * Isometry3::from_parts(Translation3::identity(), turn);
            pose
        })
    }

    /// Of a world point on the last link.
    fn jacobian(&self, links: &[Isometry3<f64>; 6], point_m: &Vector3<f64>) -> Matrix6<f64> {
        let mut jacobian = Matrix6::zeros();
        for (i, (pose, (_, axis))) in links.iter().zip(&self.0).enumerate() {
            let axis = pose * axis.into_inner();
            let arm_m = point_m - pose.translation.vector;
            let mut column = jacobian.column_mut(i);
            column.fixed_rows_mut::<3>(0).copy_from(&axis.cross(&arm_m));
            column.fixed_rows_mut::<3>(3).copy_from(&axis);
        }
        jacobian
    }
}

/// Translation and rotation vector from a pose to the target, world axes.
pub(crate) fn pose_error(pose: &Isometry3<f64>, target: &Isometry3<f64>) -> Vector6<f64> {
    let linear = target.translation.vector - pose.translation.vector;
    let angular = (target.rotation * pose.rotation.inverse()).scaled_axis();
    Vector6::from_iterator(linear.iter().chain(angular.iter()).copied())
}
