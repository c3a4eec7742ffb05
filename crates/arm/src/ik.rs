//! Numeric inverse kinematics near a seed.

use nalgebra::{DMatrix, Isometry3, Vector3, Vector6};

use crate::error::{ArmError, ArmErrorKind};
use crate::model::{FrameId, Robot};

/// When to stop looking for a posture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct IkOptions {
    pub max_iterations: usize,
    pub position_tolerance_m: f64,
    pub angle_tolerance_rad: f64,
}

impl Default for IkOptions {
    fn default() -> Self {
        Self {
            max_iterations: 200,
            position_tolerance_m: 1e-10,
            angle_tolerance_rad: 1e-10,
        }
    }
}

/// A step that takes less than this share off the squared error is the last.
const LEAST_GAIN: f64 = 1e-9;
/// Nor is a way down looked for by shorter steps than this damping gives.
const MOST_DAMPING: f64 = 1e10;

impl Robot {
    /// A posture near `seed` that puts `frame` at `world_from_target`, by damped least squares
    /// (Levenberg–Marquardt: the damping falls with success and rises with failure).
    ///
    /// # Errors
    /// If the pose is not reached, or the posture found breaks a position limit (revolute joints
    /// are first turned by whole turns into their limits where that helps).
    pub fn inverse_kinematics(
        &self,
        world_from_target: &Isometry3<f64>,
        frame: FrameId,
        seed: &[f64],
        options: &IkOptions,
    ) -> Result<Vec<f64>, ArmError> {
        self.check_length(seed)?;
        let mut q = seed.to_vec();
        let mut error = self.pose_error(&q, frame, world_from_target);
        let mut damping = 1e-3;
        let mut iterations = 0;
        // A pose out of reach has a nearest one, from which no step leads on.
        let mut is_nearest = false;
        while iterations < options.max_iterations && !is_nearest {
            if within(&error, options) {
                break;
            }
            iterations += 1;
            let jacobian = self.jacobian(&q, frame);
            let jacobian = DMatrix::from_fn(6, self.dof(), |r, c| jacobian[(r, c)]);
            let normal = jacobian.tr_mul(&jacobian);
            let gradient = jacobian.tr_mul(&error);
            let damped = &normal + DMatrix::identity(self.dof(), self.dof()) * damping;
            let Some(step) = damped.cholesky().map(|c| c.solve(&gradient)) else {
                damping *= 10.0;
                continue;
            };
            let trial: Vec<f64> = q.iter().zip(step.iter()).map(|(q, s)| q + s).collect();
            let trial_error = self.pose_error(&trial, frame, world_from_target);
            let (before, after) = (error.norm_squared(), trial_error.norm_squared());
            if after < before {
                is_nearest = after > (1.0 - LEAST_GAIN) * before;
                q = trial;
                error = trial_error;
                damping = (damping * 0.1).max(1e-15);
            } else {
                is_nearest = damping > MOST_DAMPING;
                damping *= 10.0;
            }
        }
        if !within(&error, options) {
            let (position_m, angle_rad) = lengths(&error);
            return Err(ArmErrorKind::Unreachable {
                iterations,
                position_m,
                angle_rad,
                position_limit_m: options.position_tolerance_m,
                angle_limit_rad: options.angle_tolerance_rad,
            }
            .into());
        }
        self.unwind(&mut q);
        self.check_posture(&q)?;
        Ok(q)
    }

    /// Translation and rotation vector from the frame to the target, world axes.
    pub(crate) fn pose_error(
        &self,
        q: &[f64],
        frame: FrameId,
        target: &Isometry3<f64>,
    ) -> Vector6<f64> {
        crate::six_axes::pose_error(&self.world_from_frame(q, frame), target)
    }

    /// Brings revolute joints into their limits by whole turns where possible.
    fn unwind(&self, q: &mut [f64]) {
        use std::f64::consts::TAU;
        for (joint, value) in self.chain.joints.iter().zip(q) {
            let Some(limits) = joint.limits else { continue };
            if joint.kind == crate::model::JointKind::Prismatic {
                continue;
            }
            if *value > limits.upper {
                *value -= ((*value - limits.upper) / TAU).ceil() * TAU;
            } else if *value < limits.lower {
                *value += ((limits.lower - *value) / TAU).ceil() * TAU;
            }
        }
    }
}

fn lengths(error: &Vector6<f64>) -> (f64, f64) {
    let linear: Vector3<f64> = error.fixed_rows::<3>(0).into();
    let angular: Vector3<f64> = error.fixed_rows::<3>(3).into();
    (linear.norm(), angular.norm())
}

pub(crate) fn within(error: &Vector6<f64>, options: &IkOptions) -> bool {
    let (position_m, angle_rad) = lengths(error);
    position_m <= options.position_tolerance_m && angle_rad <= options.angle_tolerance_rad
}
