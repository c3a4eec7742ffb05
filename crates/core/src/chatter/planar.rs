//! Mode coupling of two directions with equal mass: closed form of the undamped limit.

use nalgebra::Matrix2;

/// Undamped limit of a planar structure under an averaged process, m: the smallest a > 0 at which
/// the eigenvalues of K − a B coalesce (D = |s|), with B in N/m per m
/// ([`super::DirectionalMatrix::average_pa`], planar block). `None` if they never do.
pub fn coalescence_limit_m(
    stiffness_n_per_m: &Matrix2<f64>,
    process_pa: &Matrix2<f64>,
) -> Option<f64> {
    let (k, b) = (stiffness_n_per_m, process_pa);
    // D² - s² of K - aB is the quadratic c0 + c1 a + c2 a²: half difference squared + product of
    // the off-diagonals.
    let (dk, db) = (0.5 * (k.m11 - k.m22), 0.5 * (b.m11 - b.m22));
    let c0 = dk * dk + k.m12 * k.m21;
    let c1 = -2.0 * dk * db - k.m12 * b.m21 - k.m21 * b.m12;
    let c2 = db * db + b.m12 * b.m21;
    if c2 == 0.0 {
        return Some(-c0 / c1).filter(|a| a.is_finite() && *a > 0.0);
    }
    let discriminant = c1 * c1 - 4.0 * c0 * c2;
    if discriminant < 0.0 {
        return None;
    }
    let q = -0.5 * (c1 + c1.signum() * discriminant.sqrt());
    let roots = [q / c2, c0 / q];
    let positive = roots
        .into_iter()
        .filter(|a| a.is_finite() && *a > 1e-12 * (c0 / c2).abs().sqrt());
    positive.min_by(f64::total_cmp)
}

#[cfg(test)]
pub(crate) mod reference;

#[cfg(test)]
mod tests {
    use super::reference::{PlanarSplit, RankOneProcess, slot_limit_m};
    use super::*;
    use crate::chatter::DirectionalMatrix;
    use crate::cutting::milling::engagement::Engagement;
    use nalgebra::{Matrix3, Rotation2};

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
                let signs = (2.0 * process.depth_angle_rad).sin()
                    * (2.0 * process.reaction_angle_rad).sin();
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
            let b: Matrix3<f64> =
                DirectionalMatrix::planar(2, 767e6, 0.22, engagement).average_pa();
            let b = DirectionalMatrix::turned_pa(&b, feed_rad);
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
}
