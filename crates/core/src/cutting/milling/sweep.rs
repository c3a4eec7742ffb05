//! Integrals over the angle of a tooth that all closed forms of milling share.

use nalgebra::{Matrix3, Vector3};

use crate::cutting::chamfer::CuttingCoefficients;

/// Integrals of 1, sin, cos, sin², sin·cos over an interval of φ.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Sweep {
    pub one: f64,
    pub sin: f64,
    pub cos: f64,
    pub sin_sin: f64,
    pub sin_cos: f64,
}

impl Sweep {
    pub fn between(from_rad: f64, to_rad: f64) -> Self {
        let (s0, c0) = from_rad.sin_cos();
        let (s1, c1) = to_rad.sin_cos();
        let one = to_rad - from_rad;
        Self {
            one,
            sin: c0 - c1,
            cos: s1 - s0,
            sin_sin: 0.5 * (one - (s1 * c1 - s0 * c0)),
            sin_cos: 0.5 * (s1 * s1 - s0 * s0),
        }
    }

    /// The integrands themselves, per rad.
    pub fn at(angle_rad: f64) -> Self {
        let (s, c) = angle_rad.sin_cos();
        Self {
            one: 1.0,
            sin: s,
            cos: c,
            sin_sin: s * s,
            sin_cos: s * c,
        }
    }

    pub fn times(&self, factor: f64) -> Self {
        Self {
            one: self.one * factor,
            sin: self.sin * factor,
            cos: self.cos * factor,
            sin_sin: self.sin_sin * factor,
            sin_cos: self.sin_cos * factor,
        }
    }

    /// The sum over teeth that stand `behind_rad` behind an angle.
    pub fn at_teeth(angle_rad: f64, behind_rad: &[f64]) -> Self {
        let mut sum = Self::default();
        for behind in behind_rad {
            sum += Self::at(angle_rad - behind);
        }
        sum
    }

    fn cos_cos(&self) -> f64 {
        self.one - self.sin_sin
    }

    /// ∫ d(K) [sin φ, cos φ, 0]ᵀ… as a matrix: force on the tool per edge length (Pa rad) for a
    /// chip h = (sin φ, cos φ, 0)·Δ, by columns of Δ.
    pub fn chip_force_pa(&self, k: &CuttingCoefficients) -> Matrix3<f64> {
        let (t, r, a) = (k.tangential_pa, k.radial_pa, k.axial_pa);
        let (ss, sc, cc) = (self.sin_sin, self.sin_cos, self.cos_cos());
        Matrix3::new(
            -t * sc - r * ss,
            -t * cc - r * sc,
            0.0,
            t * ss - r * sc,
            t * sc - r * cc,
            0.0,
            a * self.sin,
            a * self.cos,
            0.0,
        )
    }

    /// ∫ of the edge forces on the tool per edge length, N/m rad.
    pub fn edge_force_n_per_m(&self, k: &CuttingCoefficients) -> Vector3<f64> {
        let (t, r) = (k.edge_tangential_n_per_m, k.edge_radial_n_per_m);
        Vector3::new(
            -t * self.cos - r * self.sin,
            t * self.sin - r * self.cos,
            k.edge_axial_n_per_m * self.one,
        )
    }
}

impl std::ops::AddAssign for Sweep {
    fn add_assign(&mut self, other: Self) {
        self.one += other.one;
        self.sin += other.sin;
        self.cos += other.cos;
        self.sin_sin += other.sin_sin;
        self.sin_cos += other.sin_cos;
    }
}

/// Force on the tool from forces (tangential, radial, axial) of a tooth at φ, in the milling frame,
/// N.
pub(crate) fn on_tool_n(
    angle_rad: f64,
    tangential_n: f64,
    radial_n: f64,
    axial_n: f64,
) -> Vector3<f64> {
    let (s, c) = angle_rad.sin_cos();
    Vector3::new(
        -tangential_n * c - radial_n * s,
        tangential_n * s - radial_n * c,
        axial_n,
    )
}
