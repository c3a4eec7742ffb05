//! Closed forms of planar mode coupling that tests hold the models against.

use nalgebra::{Complex, Matrix2};

/// A 2×2 stiffness split into what decides about flutter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlanarSplit {
    /// k̄, mean of the diagonal, N/m.
    pub mean_n_per_m: f64,
    /// D ≥ 0, half the difference of the symmetric part's eigenvalues, N/m.
    pub deviatoric_n_per_m: f64,
    /// s, half the difference of the off-diagonal elements, N/m.
    pub skew_n_per_m: f64,
}

impl PlanarSplit {
    /// From the effective stiffness K + K_p, N/m.
    pub fn of(stiffness_n_per_m: &Matrix2<f64>) -> Self {
        let k = stiffness_n_per_m;
        let shear = 0.5 * (k.m12 + k.m21);
        Self {
            mean_n_per_m: 0.5 * (k.m11 + k.m22),
            deviatoric_n_per_m: (0.5 * (k.m11 - k.m22)).hypot(shear),
            skew_n_per_m: 0.5 * (k.m12 - k.m21),
        }
    }

    /// Eigenvalues of the stiffness, k̄ ± √(D² − s²), N/m.
    pub fn eigenvalues_n_per_m(&self) -> [Complex<f64>; 2] {
        let inside = self.deviatoric_n_per_m.powi(2) - self.skew_n_per_m.powi(2);
        let root = Complex::new(inside, 0.0).sqrt();
        let mean = Complex::new(self.mean_n_per_m, 0.0);
        [mean + root, mean - root]
    }

    /// Flutter: s² > D² + c² k̄/m, exact for equal masses and isotropic damping c
    /// (`docs/physics/stability.md`). With K − ω²m + iωc = 0 the eigenvalue λ = k̄ ± i√(s² − D²)
    /// lies on the stability border where Im λ = c √(k̄/m).
    pub fn flutters(&self, mass_kg: f64, damping_n_s_per_m: f64) -> bool {
        self.skew_n_per_m.powi(2)
            > self.deviatoric_n_per_m.powi(2)
                + damping_n_s_per_m.powi(2) * self.mean_n_per_m / mass_kg
    }

    /// Rightmost eigenvalue of m ẍ + c ẋ + K x = 0, 1/s, with imaginary part ≥ 0.
    pub fn rightmost_per_s(&self, mass_kg: f64, damping_n_s_per_m: f64) -> Complex<f64> {
        let half = 0.5 * damping_n_s_per_m / mass_kg;
        let roots = self.eigenvalues_n_per_m().into_iter().flat_map(|k| {
            let root = (Complex::new(half * half, 0.0) - k / mass_kg).sqrt();
            [root - half, -root - half]
        });
        let rightmost = roots.max_by(|a, b| a.re.total_cmp(&b.re));
        let found = rightmost.unwrap_or_default();
        Complex::new(found.re, found.im.abs())
    }
}

/// A process of one direction: depth is felt along `d̂`, the force reacts along `f̂`, K_p f̂ d̂ᵀ
/// (`pan2006`).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RankOneProcess {
    /// K_p, N/m.
    pub stiffness_n_per_m: f64,
    /// α, angle of the depth direction from axis 1, rad.
    pub depth_angle_rad: f64,
    /// γ, angle of the reaction from axis 1, rad.
    pub reaction_angle_rad: f64,
}

impl RankOneProcess {
    /// The matrix K_p f̂ d̂ᵀ to be added to the structure's stiffness, N/m.
    pub fn matrix_n_per_m(&self) -> Matrix2<f64> {
        let (sa, ca) = self.depth_angle_rad.sin_cos();
        let (sg, cg) = self.reaction_angle_rad.sin_cos();
        self.stiffness_n_per_m * Matrix2::new(cg * ca, cg * sa, sg * ca, sg * sa)
    }

    /// Undamped mode coupling of a structure with principal stiffnesses k1, k2:
    /// (k1 − k2 + K_p cos(α+γ))² + K_p² sin 2α sin 2γ < 0 (`docs/physics/stability.md`).
    ///
    /// The left side is the squared difference of the eigenvalues of K + K_p, 4(D² − s²).
    pub fn couples(&self, k1_n_per_m: f64, k2_n_per_m: f64) -> bool {
        let (a, g) = (self.depth_angle_rad, self.reaction_angle_rad);
        let kp = self.stiffness_n_per_m;
        let straight = k1_n_per_m - k2_n_per_m + kp * (a + g).cos();
        straight * straight + kp * kp * (2.0 * a).sin() * (2.0 * g).sin() < 0.0
    }
}

/// Undamped slot limit of a planar structure, m: a = 2 (k_max − k_min)/(N K_t), whatever the feed
/// direction (`docs/physics/stability.md`), since a slot's averaged matrix is isotropic but for its
/// skew part s = ¼ N a K_t.
pub fn slot_limit_m(
    k_min_n_per_m: f64,
    k_max_n_per_m: f64,
    teeth: usize,
    tangential_pa: f64,
) -> f64 {
    2.0 * (k_max_n_per_m - k_min_n_per_m) / (teeth as f64 * tangential_pa)
}
