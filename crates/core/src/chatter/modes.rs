//! Modes of a tool holder as the tool point feels them.

use nalgebra::{Complex, Matrix3, Vector3};

/// One mode: `q̈ + 2ζω q̇ + ω² q = uᵀF`, displacement of the tool point `u q`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TipMode {
    /// ω, undamped, rad/s.
    pub natural_frequency_rad_s: f64,
    /// ζ.
    pub damping_ratio: f64,
    /// u, mass-normalised shape at the tool point, kg^-½, in the axes in which forces are given.
    pub shape_per_sqrt_kg: Vector3<f64>,
}

impl TipMode {
    /// An oscillator of mass `mass_kg` that moves along `direction` (of length 1).
    pub fn of_mass(
        natural_frequency_rad_s: f64,
        damping_ratio: f64,
        mass_kg: f64,
        direction: &Vector3<f64>,
    ) -> Self {
        Self {
            natural_frequency_rad_s,
            damping_ratio,
            shape_per_sqrt_kg: direction / mass_kg.sqrt(),
        }
    }

    /// An oscillator of stiffness `stiffness_n_per_m` that moves along `direction` (of length 1).
    pub fn of_stiffness(
        natural_frequency_rad_s: f64,
        damping_ratio: f64,
        stiffness_n_per_m: f64,
        direction: &Vector3<f64>,
    ) -> Self {
        let mass_kg = stiffness_n_per_m / natural_frequency_rad_s.powi(2);
        Self::of_mass(natural_frequency_rad_s, damping_ratio, mass_kg, direction)
    }

    /// Response of the modal coordinate to a modal force, 1/(ω_j² − ω² + 2iζω_jω), s².
    pub(crate) fn receptance_s2(&self, omega_rad_s: f64) -> Complex<f64> {
        let own = self.natural_frequency_rad_s;
        let denominator = Complex::new(
            own * own - omega_rad_s * omega_rad_s,
            2.0 * self.damping_ratio * own * omega_rad_s,
        );
        denominator.inv()
    }
}

/// The same modes with shapes in other axes: u' = Rᵀu with R = `outer_from_axes` (columns are the
/// new axes in the old).
pub fn in_axes(modes: &[TipMode], outer_from_axes: &Matrix3<f64>) -> Vec<TipMode> {
    let turned = modes.iter().map(|mode| TipMode {
        shape_per_sqrt_kg: outer_from_axes.transpose() * mode.shape_per_sqrt_kg,
        ..*mode
    });
    turned.collect()
}
