//! Cartesian compliance and what is read off it: directional, clamped and planar stiffness, and
//! the coupling between axial and lateral motion.
//!
//! Two definitions of stiffness at a point are in use. *Free*: the tool may turn while it is
//! pushed, k = 1/(eᵀ C_tt e) with C_tt the translational block of the compliance. *Clamped*:
//! rotation is held, k = 1/(eᵀ (K_tt)⁻¹ e) with K = C⁻¹; it does not depend on the length of the
//! tool and overstates what a tool feels.

use nalgebra::{DMatrix, Isometry3, Matrix2, Matrix3, Matrix6, Unit, Vector2, Vector3};

use crate::error::{ArmError, ArmErrorKind};
use crate::model::{FrameId, Robot};
use crate::tangent::Load;

impl Robot {
    /// 6×6 compliance at a frame's origin, in world axes: displacement and rotation (m, rad) per
    /// force and moment (N, N m), C = J K⁻¹ Jᵀ with K the joint-space tangent under `load`
    /// ([`Robot::tangent_stiffness`]); `Load::none()` gives J K_θ⁻¹ Jᵀ.
    ///
    /// # Errors
    /// If a joint has no stiffness, the tangent is singular, or `q` has the wrong length.
    pub fn cartesian_compliance(
        &self,
        q: &[f64],
        frame: FrameId,
        load: &Load,
    ) -> Result<Matrix6<f64>, ArmError> {
        let tangent = self.tangent_stiffness(q, load)?;
        let jacobian = self.jacobian(q, frame);
        let jacobian = DMatrix::from_fn(6, self.dof(), |r, c| jacobian[(r, c)]);
        let flexibility = tangent
            .lu()
            .solve(&jacobian.transpose())
            .ok_or(ArmErrorKind::SingularCompliance)?;
        let compliance = &jacobian * flexibility;
        Ok(Matrix6::from_iterator(compliance.iter().copied()))
    }

    /// Translational compliance (m/N) of a frame's origin in the axes of the process frame,
    /// without gravity or preload.
    ///
    /// # Errors
    /// As [`Robot::cartesian_compliance`].
    pub fn process_compliance(&self, q: &[f64], frame: FrameId) -> Result<Matrix3<f64>, ArmError> {
        let compliance = self.cartesian_compliance(q, frame, &Load::none())?;
        Ok(in_axes(
            &translational(&compliance),
            &self.world_from_process(q),
        ))
    }
}

/// The translational 3×3 block C_tt (m/N) of a 6×6 compliance.
#[must_use]
pub fn translational(compliance: &Matrix6<f64>) -> Matrix3<f64> {
    compliance.fixed_view::<3, 3>(0, 0).into_owned()
}

/// The translational compliance with rotation clamped, (K_tt)⁻¹ with K = C⁻¹ (m/N).
///
/// # Errors
/// If the 6×6 compliance is singular (fewer than six joints, or a singular posture).
pub fn clamped(compliance: &Matrix6<f64>) -> Result<Matrix3<f64>, ArmError> {
    // (K_tt)⁻¹ is the Schur complement C_tt − C_tr C_rr⁻¹ C_rt.
    let tt = compliance.fixed_view::<3, 3>(0, 0);
    let tr = compliance.fixed_view::<3, 3>(0, 3);
    let rt = compliance.fixed_view::<3, 3>(3, 0);
    let rr = compliance.fixed_view::<3, 3>(3, 3).into_owned();
    let singular = || ArmError::from(ArmErrorKind::SingularCompliance);
    let svd = rr.singular_values();
    if svd.min() <= 1e-12 * svd.max() {
        return Err(singular());
    }
    Ok(tt - tr * rr.try_inverse().ok_or_else(singular)? * rt)
}

/// A world-axes 3×3 compliance expressed in the axes of `world_from_axes`.
#[must_use]
pub fn in_axes(compliance: &Matrix3<f64>, world_from_axes: &Isometry3<f64>) -> Matrix3<f64> {
    let rotation = world_from_axes.rotation.to_rotation_matrix();
    rotation.matrix().transpose() * compliance * rotation.matrix()
}

/// Stiffness (N/m) met by a force along `direction`: 1/(eᵀ C e).
///
/// Free or clamped according to the 3×3 compliance given ([`translational`], [`clamped`]).
#[must_use]
pub fn directional_stiffness(compliance: &Matrix3<f64>, direction: &Unit<Vector3<f64>>) -> f64 {
    1.0 / direction.dot(&(compliance * direction.into_inner()))
}

/// Extreme stiffnesses in a plane.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct PlanarStiffness {
    pub k_min_n_per_m: f64,
    pub k_max_n_per_m: f64,
    /// Angle of the k_max axis from the plane's first axis towards its second, in (−π/2, π/2].
    pub k_max_angle_rad: f64,
}

/// Principal stiffnesses in the plane spanned by the orthonormal axes `first` and `second`:
/// reciprocals of the eigenvalues of the 2×2 block of the compliance, all else free.
#[must_use]
pub fn planar_principal(
    compliance: &Matrix3<f64>,
    first: &Unit<Vector3<f64>>,
    second: &Unit<Vector3<f64>>,
) -> PlanarStiffness {
    let c11 = first.dot(&(compliance * first.into_inner()));
    let c22 = second.dot(&(compliance * second.into_inner()));
    let c12 = 0.5
        * (first.dot(&(compliance * second.into_inner()))
            + second.dot(&(compliance * first.into_inner())));
    let mean = 0.5 * (c11 + c22);
    let half_difference = 0.5 * (c11 - c22);
    let radius = half_difference.hypot(c12);
    // Mohr's circle: the most compliant axis lies at half the angle of (half_difference, c12).
    let soft_angle = 0.5 * c12.atan2(half_difference);
    let stiff_angle = if soft_angle > 0.0 {
        soft_angle - std::f64::consts::FRAC_PI_2
    } else {
        soft_angle + std::f64::consts::FRAC_PI_2
    };
    PlanarStiffness {
        k_min_n_per_m: 1.0 / (mean + radius),
        k_max_n_per_m: 1.0 / (mean - radius),
        k_max_angle_rad: stiff_angle,
    }
}

/// A compliance below this share of what the free tool has is what rounding leaves of none, and may
/// be negative: in a singular posture nothing gives way in some direction once rotation is held.
pub(crate) const RIGID_SHARE: f64 = 1e-10;

/// Lateral force per axial force on a tool that is held laterally, S = (C_YZ,YZ)⁻¹ C_YZ,X.
///
/// `process_compliance` is in process axes ([`Robot::process_compliance`]); S is in its Y, Z axes.
///
/// # Errors
/// If the arm is not compliant in both lateral directions, beyond what rounding leaves.
pub fn axial_lateral_coupling(process_compliance: &Matrix3<f64>) -> Result<Vector2<f64>, ArmError> {
    let lateral: Matrix2<f64> = process_compliance.fixed_view::<2, 2>(1, 1).into_owned();
    let least_m_per_n = RIGID_SHARE * process_compliance.trace();
    let gives_way = lateral.symmetric_eigenvalues().min() > least_m_per_n;
    if !gives_way {
        return Err(ArmErrorKind::SingularCompliance.into());
    }
    let coupling: Vector2<f64> = process_compliance.fixed_view::<2, 1>(1, 0).into_owned();
    let inverse = lateral
        .try_inverse()
        .ok_or(ArmErrorKind::SingularCompliance)?;
    Ok(inverse * coupling)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What rounding leaves of a direction in which nothing gives way is no compliance to divide
    /// by.
    #[test]
    fn a_tool_that_is_rigid_to_one_side_has_no_coupling() {
        let mut compliance = Matrix3::new(2e-6, 1e-7, 3e-7, 1e-7, 1e-6, 0.0, 3e-7, 0.0, 4e-6);
        let coupling = axial_lateral_coupling(&compliance).expect("compliant to all sides");
        assert!((coupling - Vector2::new(0.1, 0.075)).norm() < 1e-12);
        compliance[(1, 1)] = 2.2e-22;
        compliance[(0, 1)] = 1e-6;
        compliance[(1, 0)] = 1e-6;
        assert!(axial_lateral_coupling(&compliance).is_err());
    }
}
