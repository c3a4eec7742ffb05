//! Frequency response of a linearised arm, by the full matrices and as a sum over modes.

use std::f64::consts::TAU;

use nalgebra::{Complex, Matrix3, Vector3};
use truecut_arm::{LinearArm, Modes};

/// Displacement of the frame per force on it (m/N) at `frequency_hz`, 3×3 complex, world axes:
/// J_v (K − ω²M + iωD)⁻¹ J_vᵀ. Damping is taken in full, not mode by mode.
pub fn response(arm: &LinearArm, frequency_hz: f64) -> Matrix3<Complex<f64>> {
    let omega = TAU * frequency_hz;
    let dynamic = (arm.stiffness).zip_zip_map(&arm.mass, &arm.damping, |k, m, d| {
        Complex::new(k - omega * omega * m, omega * d)
    });
    let tip = arm.tip_jacobian.map(|v| Complex::new(v, 0.0));
    let flexibility = dynamic.lu().solve(&tip.transpose()).expect("regular");
    let response = tip * flexibility;
    Matrix3::from_iterator(response.iter().copied())
}

/// The same as the sum over modes, Σ u_j/(ω_j² − ω² + 2iζ_jω_jω) with u_j = (J_vφ_j)(J_vφ_j)ᵀ;
/// equal if damping is proportional.
pub fn sum_over_modes(arm: &LinearArm, modes: &Modes, frequency_hz: f64) -> Matrix3<Complex<f64>> {
    let omega = TAU * frequency_hz;
    let each = modes.frequency_hz.iter().zip(&modes.damping_ratio);
    let term = |(j, (f, zeta)): (usize, (&f64, &f64))| {
        let omega_j = TAU * f;
        let at_tip = &arm.tip_jacobian * modes.shapes.column(j);
        let at_tip = Vector3::new(at_tip[0], at_tip[1], at_tip[2]);
        let denominator = Complex::new(
            omega_j * omega_j - omega * omega,
            2.0 * zeta * omega_j * omega,
        );
        (at_tip * at_tip.transpose()).map(|u| Complex::new(u, 0.0) / denominator)
    };
    each.enumerate().map(term).sum()
}
