//! Closed forms of planar mode coupling that tests hold the models against.

use super::*;
use crate::chatter::DirectionalMatrix;
use crate::cutting::milling::engagement::Engagement;
use nalgebra::{Complex, Matrix2};
use nalgebra::{Matrix3, Rotation2, Rotation3, Vector3};

/// A matrix B of a cut whose feed stands at an angle (rad) from the x axis.
fn turned_pa(matrix_pa: &Matrix3<f64>, feed_rad: f64) -> Matrix3<f64> {
    let turn = Rotation3::from_axis_angle(&Vector3::z_axis(), feed_rad).into_inner();
    turn * matrix_pa * turn.transpose()
}

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

/// The worked case of `docs/physics/stability.md`, Mode coupling: N = 2, a = 0.3 mm, K_t = 767
/// MPa, K_r = 0.22.
fn worked_case() -> Matrix2<f64> {
    let b = DirectionalMatrix::planar(2, 767e6, 0.22, Engagement::SLOT).average_pa();
    let k = Matrix2::new(0.9e6, 0.0, 0.0, 1.0e6);
    k - 0.3e-3 * b.fixed_view::<2, 2>(0, 0).into_owned()
}

/// Rightmost eigenvalue +1.471451 ± 44.219371i, 1e-5 relative.
#[test]
fn verify_flutter_eigenvalue() {
    let split = PlanarSplit::of(&worked_case());
    let found = split.rightmost_per_s(500.0, 871.8);
    assert!((found.re / 1.471451 - 1.0).abs() < 1e-5, "{found}");
    assert!((found.im / 44.219371 - 1.0).abs() < 1e-5, "{found}");
    assert!(split.flutters(500.0, 871.8));
    // Against the eigenvalues of the state matrix.
    let k = worked_case() / 500.0;
    let c = 871.8 / 500.0;
    let state = nalgebra::Matrix4::new(
        0.0, 0.0, 1.0, 0.0, //
        0.0, 0.0, 0.0, 1.0, //
        -k.m11, -k.m12, -c, 0.0, //
        -k.m21, -k.m22, 0.0, -c,
    );
    let eigenvalues = state.complex_eigenvalues();
    let right = eigenvalues
        .iter()
        .map(|e| e.re)
        .fold(f64::NEG_INFINITY, f64::max);
    assert!((right / found.re - 1.0).abs() < 1e-9);
}

/// The criterion changes side exactly where the rightmost eigenvalue does.
#[test]
fn verify_criterion_is_the_sign_of_the_rightmost_eigenvalue() {
    let mut both = [0, 0];
    for i in 0..400 {
        let x = |n: i32| ((i * n) as f64 * 0.618_034).fract() - 0.5;
        let k = Matrix2::new(1e6, 3e5 * x(1), 3e5 * x(3), 1e6 + 3e5 * x(7));
        let split = PlanarSplit::of(&k);
        let (mass, damping) = (500.0, 1500.0 * (x(5) + 0.5));
        let right = split.rightmost_per_s(mass, damping).re;
        assert_eq!(split.flutters(mass, damping), right > 0.0, "{k} {damping}");
        both[usize::from(right > 0.0)] += 1;
    }
    assert!(both[0] > 50 && both[1] > 50, "{both:?}");
}

/// `docs/physics/stability.md`, Mode coupling: k1 = 1e6, k2 = 1.1e6, K_p = 2e5 N/m.
#[test]
fn verify_both_rank_one_cases() {
    let at = |reaction_deg: f64| {
        let process = RankOneProcess {
            stiffness_n_per_m: 2e5,
            depth_angle_rad: 60f64.to_radians(),
            reaction_angle_rad: reaction_deg.to_radians(),
        };
        let k = Matrix2::new(1e6, 0.0, 0.0, 1.1e6) + process.matrix_n_per_m();
        let eigenvalues = PlanarSplit::of(&k).eigenvalues_n_per_m();
        (process.couples(1e6, 1.1e6), eigenvalues)
    };
    let (unstable, [first, second]) = at(-20.0);
    assert!(unstable);
    assert!((first.re / 1.0674e6 - 1.0).abs() < 1e-4 && second.re == first.re);
    assert!(
        (first.im.abs() / 6.97e4 - 1.0).abs() < 1e-3 && second.im == -first.im,
        "{first}"
    );
    let (unstable, [first, second]) = at(20.0);
    assert!(!unstable);
    assert!((first.re / 1.2080e6 - 1.0).abs() < 1e-4 && first.im == 0.0);
    assert!((second.re / 1.0452e6 - 1.0).abs() < 1e-4 && second.im == 0.0);
}

/// |k1 − k2| > 2 K_p is always enough, and sin 2α sin 2γ < 0 is needed.
#[test]
fn verify_rank_one_criterion_equals_the_eigenvalues() {
    for i in 0..2000 {
        let x = |n: i32| ((i * n) as f64 * 0.618_034).fract();
        let process = RankOneProcess {
            stiffness_n_per_m: 2e5 * x(1),
            depth_angle_rad: 6.3 * x(3),
            reaction_angle_rad: 6.3 * x(7),
        };
        let (k1, k2) = (1e6, 0.7e6 + 6e5 * x(11));
        let k = Matrix2::new(k1, 0.0, 0.0, k2) + process.matrix_n_per_m();
        let complex = PlanarSplit::of(&k).eigenvalues_n_per_m()[0].im != 0.0;
        assert_eq!(process.couples(k1, k2), complex);
        if complex {
            assert!((k1 - k2).abs() <= 2.0 * process.stiffness_n_per_m);
            let signs =
                (2.0 * process.depth_angle_rad).sin() * (2.0 * process.reaction_angle_rad).sin();
            assert!(signs < 0.0);
        }
    }
}

/// The slot's limit does not depend on the feed direction, to 1e-6; half a slot's does, and is
/// higher.
#[test]
fn verify_slot_limit_is_independent_of_the_feed_direction() {
    let stiffness = {
        let r = Rotation2::new(0.37);
        r.matrix() * Matrix2::new(0.6e6, 0.0, 0.0, 1.5e6) * r.matrix().transpose()
    };
    let limit = |engagement, feed_rad: f64| {
        let b: Matrix3<f64> = DirectionalMatrix::planar(2, 767e6, 0.22, engagement).average_pa();
        let b = turned_pa(&b, feed_rad);
        coalescence_limit_m(&stiffness, &b.fixed_view::<2, 2>(0, 0).into_owned())
    };
    let closed = slot_limit_m(0.6e6, 1.5e6, 2, 767e6);
    let half = Engagement::down(0.5, 1.0).expect("half");
    let (mut low, mut high) = (f64::INFINITY, 0.0_f64);
    for i in 0..72 {
        let feed = i as f64 * 0.0873;
        let slot = limit(Engagement::SLOT, feed).expect("skew");
        assert!((slot / closed - 1.0).abs() < 1e-6, "{slot} {closed}");
        if let Some(depth) = limit(half, feed) {
            low = low.min(depth);
            high = high.max(depth);
        }
    }
    assert!(low > closed && high > 1.05 * low, "{low} {high}");
}
