//! Forward kinematics, the geometric Jacobian and the process frame.

use nalgebra::{Isometry3, Matrix3, Matrix6xX, Point3, Rotation3, UnitQuaternion, Vector3};

use crate::error::{ArmError, ArmErrorKind};
use crate::model::{FrameId, Joint, JointKind, Robot};
use crate::moving::motion;

impl Joint {
    /// Previous link from this joint's link, at coordinate `q` (rad or m).
    #[must_use]
    pub fn parent_from_link(&self, q: f64) -> Isometry3<f64> {
        self.parent_from_joint * motion(self.kind, &self.axis, q)
    }
}

impl Robot {
    /// Poses of all links that move, those of followers too ([`crate::Chain::moving`]), at posture
    /// `q` (rad or m, in chain order), world from link.
    ///
    /// # Panics
    /// If `q` does not have one value per joint; check outside input with [`Robot::check_posture`].
    #[must_use]
    pub fn world_from_links(&self, q: &[f64]) -> Vec<Isometry3<f64>> {
        assert_eq!(q.len(), self.dof(), "one coordinate per joint");
        let mut world_from_link = Isometry3::identity();
        let moving = self.chain.moving().map(|body| {
            world_from_link *= body.parent_from_link(q);
            world_from_link
        });
        moving.collect()
    }

    /// Pose of a frame at posture `q`, world from frame.
    ///
    /// # Panics
    /// If `q` does not have one value per joint.
    #[must_use]
    pub fn world_from_frame(&self, q: &[f64], frame: FrameId) -> Isometry3<f64> {
        assert_eq!(q.len(), self.dof(), "one coordinate per joint");
        let moving = self.chain.moving();
        moving.fold(Isometry3::identity(), |pose, body| {
            pose * body.parent_from_link(q)
        }) * self.last_link_from_frame(frame)
    }

    /// Geometric Jacobian of a frame's origin at posture `q`, 6×n, in world axes.
    ///
    /// Rows 0..3 give linear velocity (m/s), rows 3..6 angular velocity (rad/s) per unit joint
    /// velocity.
    ///
    /// # Panics
    /// If `q` does not have one value per joint.
    #[must_use]
    pub fn jacobian(&self, q: &[f64], frame: FrameId) -> Matrix6xX<f64> {
        let links = self.world_from_links(q);
        let last = links.last().copied().unwrap_or_else(Isometry3::identity);
        let point_m = last * Point3::from(self.last_link_from_frame(frame).translation.vector);
        self.chain
            .folded(self.jacobian_by_link(&links, links.len(), &point_m))
    }

    /// Jacobian of a world point fixed to the link `count - 1` of those that move, with a column
    /// for each of them; columns of those that do not move the point are zero.
    pub(crate) fn jacobian_by_link(
        &self,
        world_from_links: &[Isometry3<f64>],
        count: usize,
        point_m: &Point3<f64>,
    ) -> Matrix6xX<f64> {
        let mut jacobian = Matrix6xX::zeros(world_from_links.len());
        let joints = self.chain.moving().zip(world_from_links).take(count);
        for (i, (joint, pose)) in joints.enumerate() {
            // The axis is the same in the joint frame and in the link frame: the motion leaves it.
            let axis = pose * joint.axis.into_inner();
            let mut column = jacobian.column_mut(i);
            match joint.kind {
                JointKind::Revolute => {
                    let arm_m = point_m - Point3::from(pose.translation.vector);
                    column.fixed_rows_mut::<3>(0).copy_from(&axis.cross(&arm_m));
                    column.fixed_rows_mut::<3>(3).copy_from(&axis);
                }
                JointKind::Prismatic => column.fixed_rows_mut::<3>(0).copy_from(&axis),
            }
        }
        jacobian
    }

    /// The process frame of posture `q`, world from process: X is the tool's z axis (feed and
    /// spindle axis, pointing into the workpiece), Y = ẑ × X normalised (horizontal), Z = X × Y,
    /// origin at the tool. With X within 1e-6 of the vertical, Y is X × x̂ of the world instead.
    ///
    /// # Panics
    /// If `q` does not have one value per joint.
    #[must_use]
    pub fn world_from_process(&self, q: &[f64]) -> Isometry3<f64> {
        let tool = self.world_from_frame(q, FrameId::Tool);
        let x = (tool * Vector3::z()).normalize();
        let horizontal = Vector3::z().cross(&x);
        let y = if horizontal.norm() > 1e-6 {
            horizontal.normalize()
        } else {
            x.cross(&Vector3::x()).normalize()
        };
        let axes = Matrix3::from_columns(&[x, y, x.cross(&y)]);
        let rotation =
            UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(axes));
        Isometry3::from_parts(tool.translation, rotation)
    }

    /// Checks that `q` has one finite value per joint and keeps the position limits.
    ///
    /// # Errors
    /// Names the joint, the value and the limits.
    pub fn check_posture(&self, q: &[f64]) -> Result<(), ArmError> {
        self.check_length(q)?;
        for joint in self.chain.moving() {
            let value = joint.value(q);
            let name = || joint.joint.to_owned();
            if !value.is_finite() {
                return Err(ArmErrorKind::PostureNotFinite {
                    joint: name(),
                    value,
                }
                .into());
            }
            if let Some(limits) = joint.limits
                && !(limits.lower..=limits.upper).contains(&value)
            {
                return Err(ArmErrorKind::OutsideLimits {
                    joint: name(),
                    value,
                    lower: limits.lower,
                    upper: limits.upper,
                    unit: joint.kind.coordinate_unit(),
                }
                .into());
            }
        }
        Ok(())
    }

    pub(crate) fn check_length(&self, q: &[f64]) -> Result<(), ArmError> {
        if q.len() == self.dof() {
            return Ok(());
        }
        Err(ArmErrorKind::PostureLength {
            found: q.len(),
            expected: self.dof(),
        }
        .into())
    }
}
