use super::*;
use crate::chatter::averaged::zero_order_limit;
use crate::chatter::limit::{LimitSearch, first_limit};
use crate::cutting::chamfer::CuttingCoefficients;
use crate::cutting::milling::cutter::Cutter;
use crate::cutting::milling::engagement::Engagement;
use nalgebra::Vector3;
use std::f64::consts::{FRAC_PI_2, PI};

/// How a solution behaves from one tooth period to the next.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Bifurcation {
    /// A complex pair: vibration at a frequency of its own.
    Hopf,
    /// A negative real multiplier: every other tooth alike, period doubling.
    Flip,
    /// A positive real multiplier.
    Fold,
}

/// Kind of instability that a multiplier brings when it leaves the unit circle.
fn bifurcation(multiplier: &Multiplier) -> Bifurcation {
    if multiplier.value.im.abs() > 1e-6 * multiplier.magnitude() {
        Bifurcation::Hopf
    } else if multiplier.value.re < 0.0 {
        Bifurcation::Flip
    } else {
        Bifurcation::Fold
    }
}

fn seconds_per_tooth(rpm: f64, teeth: usize) -> f64 {
    60.0 / (rpm * teeth as f64)
}

/// Benchmark 1 (Insperger): one direction of 0.03993 kg, 922 Hz, ζ = 0.011, two teeth, K_t = 6e8,
/// K_n = 2e8 Pa.
fn benchmark_1(immersion: f64) -> SpectralElements {
    let mode = TipMode::of_mass(TAU * 922.0, 0.011, 0.03993, &Vector3::x());
    let down = Engagement::down(immersion, 1.0).expect("partial");
    let process = DirectionalMatrix::planar(2, 6e8, 1.0 / 3.0, down);
    SpectralElements::new(&[mode], &process)
}

/// `docs/physics/stability.md`, benchmark 1: |μ| at a/D = 1, 5000 rpm, k → ∞.
#[test]
fn verify_benchmark_1_multipliers() {
    let period = seconds_per_tooth(5000.0, 2);
    for (depth_mm, expected) in [(0.2, 0.8197), (0.5, 1.0740), (1.0, 1.4065)] {
        let found = benchmark_1(1.0).at(period).multiplier(depth_mm * 1e-3);
        let found = found.magnitude();
        assert!((found - expected).abs() < 1.5e-4, "{depth_mm} mm: {found}");
    }
}

/// `docs/physics/stability.md`, benchmark 1: first limits in mm at k = 100, ±2 %, and which of them
/// are flips.
#[test]
fn verify_benchmark_1_first_limits() {
    use Bifurcation::{Flip, Hopf};
    let speeds = [5e3, 8e3, 10e3, 12e3, 16e3, 18e3, 20e3, 25e3];
    let table: [(f64, [(f64, Bifurcation); 8]); 3] = [
        (
            0.05,
            [
                (2.21, Hopf),
                (2.16, Hopf),
                (4.09, Flip),
                (1.68, Hopf),
                (5.50, Flip),
                (1.30, Flip),
                (2.29, Hopf),
                (2.91, Hopf),
            ],
        ),
        (
            0.5,
            [
                (0.852, Hopf),
                (0.800, Hopf),
                (2.11, Flip),
                (0.614, Hopf),
                (2.07, Flip),
                (1.62, Hopf),
                (0.720, Hopf),
                (1.04, Hopf),
            ],
        ),
        (
            1.0,
            [
                (0.414, Hopf),
                (0.680, Hopf),
                (0.323, Hopf),
                (2.14, Flip),
                (0.319, Hopf),
                (0.690, Hopf),
                (1.42, Flip),
                (3.94, Hopf),
            ],
        ),
    ];
    for (immersion, row) in table {
        let elements = benchmark_1(immersion);
        for (rpm, (expected_mm, kind)) in speeds.into_iter().zip(row) {
            let period = seconds_per_tooth(rpm, 2);
            let limit =
                first_limit(&elements, period, &LimitSearch::to_depth(7e-3)).expect("a limit");
            let found_mm = limit.depth_m * 1e3;
            assert!(
                (found_mm / expected_mm - 1.0).abs() < 0.02,
                "a/D {immersion}, {rpm} rpm: {found_mm} mm instead of {expected_mm} mm"
            );
            assert_eq!(
                bifurcation(&limit.multiplier),
                kind,
                "a/D {immersion}, {rpm} rpm"
            );
        }
    }
}

/// `docs/physics/stability.md`, benchmark 1: limits in mm extrapolated from 120 and 240 steps of
/// first-order semi-discretisation.
#[test]
fn verify_benchmark_1_converged_limits() {
    let table = [
        (7e3, 0.3, true, 1.0718),
        (4e3, 0.3, true, 0.6840),
        (5e3, 0.3, true, 0.3652),
        (9e3, 0.5, true, 1.6020),
        (3e3, 0.3, true, 0.5882),
        (6e3, 0.5, false, 1.1389),
    ];
    let mode = TipMode::of_mass(TAU * 922.0, 0.011, 0.03993, &Vector3::x());
    for (rpm, immersion, up, expected_mm) in table {
        let way = if up { Engagement::up } else { Engagement::down };
        let engagement = way(immersion, 1.0).expect("partial");
        let process = DirectionalMatrix::planar(2, 6e8, 1.0 / 3.0, engagement);
        let elements = SpectralElements::new(&[mode], &process);
        let period = seconds_per_tooth(rpm, 2);
        let limit = first_limit(&elements, period, &LimitSearch::to_depth(3e-3)).expect("a limit");
        let found_mm = limit.depth_m * 1e3;
        assert!(
            (found_mm / expected_mm - 1.0).abs() < 1e-3,
            "{rpm} rpm: {found_mm} mm"
        );
    }
}

/// Benchmark 2 (Altintas and Budak class): two directions, three teeth.
fn benchmark_2(engagement: Engagement) -> (Vec<TipMode>, DirectionalMatrix) {
    let modes = vec![
        TipMode::of_stiffness(TAU * 603.0, 0.039, 5.59e6, &Vector3::x()),
        TipMode::of_stiffness(TAU * 666.0, 0.035, 5.715e6, &Vector3::y()),
    ];
    (modes, DirectionalMatrix::planar(3, 6e8, 0.07, engagement))
}

/// `docs/physics/stability.md`, benchmark 2: zero-order and semi-discretisation limits in mm at
/// four speeds, ±2 %.
#[test]
fn verify_benchmark_2_zero_order_and_semi_discretisation() {
    let quarter = Engagement {
        entry_rad: 0.0,
        exit_rad: FRAC_PI_2,
    };
    let half = [
        (5e3, 1.087, 1.10),
        (8e3, 1.095, 1.10),
        (10e3, 1.340, 1.366),
        (12e3, 4.03, 4.29),
    ];
    let slot = [
        (5e3, 0.780, 0.789),
        (8e3, 0.777, 0.783),
        (10e3, 0.956, 0.968),
        (12e3, 2.69, 2.77),
    ];
    for (engagement, rows) in [(quarter, half), (Engagement::SLOT, slot)] {
        let (modes, process) = benchmark_2(engagement);
        let elements = SpectralElements::new(&modes, &process);
        for (rpm, zero_mm, sdm_mm) in rows {
            let period = seconds_per_tooth(rpm, 3);
            let zero = zero_order_limit(&modes, &process.average_pa(), period).expect("a limit");
            assert!(
                (zero.depth_m * 1e3 / zero_mm - 1.0).abs() < 0.02,
                "{rpm} rpm: zero order {} mm instead of {zero_mm} mm",
                zero.depth_m * 1e3
            );
            let limit =
                first_limit(&elements, period, &LimitSearch::to_depth(6e-3)).expect("a limit");
            assert!(
                (limit.depth_m * 1e3 / sdm_mm - 1.0).abs() < 0.02,
                "{rpm} rpm: {} mm instead of {sdm_mm} mm",
                limit.depth_m * 1e3
            );
        }
    }
}

/// The dominant multiplier found by iteration, against all eigenvalues of the map's matrix.
#[test]
fn verify_krylov_against_dense_monodromy() {
    let down = Engagement::down(0.4, 1.0).expect("partial");
    let process = DirectionalMatrix::planar(4, 9e8, 0.3, down);
    let modes: Vec<TipMode> = (0..6)
        .map(|i| TipMode {
            natural_frequency_rad_s: TAU * (6.0 + 9.0 * i as f64),
            damping_ratio: 0.02,
            shape_per_sqrt_kg: Vector3::new(
                0.04 * (1.0 + i as f64).sin(),
                0.05 * (2.0 * i as f64).cos(),
                0.03,
            ),
        })
        .collect();
    let elements = SpectralElements::new(&modes, &process);
    for i in 0..24 {
        let (period, depth) = (
            0.003 + 0.0025 * f64::from(i),
            0.37e-3 * f64::from(1 + i * 7 % 24),
        );
        let at = elements.at(period);
        let map = at.period_map(depth);
        let length = map.length();
        let images: Vec<DVector<f64>> = (0..length)
            .map(|i| {
                let (mut unit, mut image) = (vec![0.0; length], vec![0.0; length]);
                unit[i] = 1.0;
                map.apply(&unit, &mut image);
                DVector::from_vec(image)
            })
            .collect();
        let eigenvalues = DMatrix::from_columns(&images).complex_eigenvalues();
        let expected = eigenvalues.iter().map(|e| e.norm()).fold(0.0, f64::max);
        let found = at.multiplier(depth).magnitude();
        assert!((found / expected - 1.0).abs() < 1e-7, "{found} {expected}");
    }
}

/// Without depth, multipliers are those of the free modes: e^{−ζωT}.
#[test]
fn verify_zero_depth_is_free_decay() {
    let elements = benchmark_1(1.0);
    let period = seconds_per_tooth(9000.0, 2);
    let expected = (-0.011 * TAU * 922.0 * period).exp();
    let found = elements.at(period).multiplier(0.0);
    assert!((found.magnitude() / expected - 1.0).abs() < 1e-9);
    assert!(found.is_stable() && found.growth_per_s(period) < 0.0);
    let own = found.base_frequency_rad_s(period);
    let damped = TAU * 922.0 * (1.0 - 0.011_f64.powi(2)).sqrt();
    let folded = (damped * period).rem_euclid(2.0 * PI);
    let folded = folded.min(2.0 * PI - folded);
    assert!((own * period - folded).abs() < 1e-6);
    let all = found.frequencies_rad_s(period, 2.0 * damped);
    assert!(all.iter().any(|f| (f / damped - 1.0).abs() < 1e-6));
    assert!(all.windows(2).all(|w| w[0] < w[1]));
}

/// The floor alone (no depth): a slot with four teeth pushes with a constant force per
/// displacement, and the multiplier is that of the state matrix.
#[test]
fn verify_floor_feedback_is_that_of_the_state_matrix() {
    let shapes = [
        Vector3::new(0.02, 0.05, 0.04),
        Vector3::new(-0.04, 0.03, 0.06),
    ];
    let modes: Vec<TipMode> = (shapes.iter().zip([60.0, 75.0]))
        .map(|(shape, omega)| TipMode {
            natural_frequency_rad_s: omega,
            damping_ratio: 0.02,
            shape_per_sqrt_kg: *shape,
        })
        .collect();
    let process = DirectionalMatrix::planar(4, 2e9, 0.3, Engagement::SLOT);
    let cut = NominalCut {
        cutter: Cutter::straight(8e-3, 4),
        coefficients: process.coefficients,
        engagement: Engagement::SLOT,
        axial_depth_m: 0.3e-3,
        feed_per_tooth_m: 1e-3,
    };
    let feedback = cut.floor_feedback_n_per_m();
    let mut state = DMatrix::zeros(4, 4);
    for i in 0..2 {
        state[(i, 2 + i)] = 1.0;
        let own = modes[i].natural_frequency_rad_s;
        state[(2 + i, i)] = -own * own;
        state[(2 + i, 2 + i)] = -2.0 * modes[i].damping_ratio * own;
        for j in 0..2 {
            state[(2 + i, j)] += shapes[i].dot(&(feedback * shapes[j]));
        }
    }
    let growth = state.complex_eigenvalues();
    let growth = growth
        .iter()
        .map(|z| z.re)
        .fold(f64::NEG_INFINITY, f64::max);
    let period_s = 0.025;
    let plain = SpectralElements::new(&modes, &process);
    let without = plain.at(period_s).multiplier(0.0).growth_per_s(period_s);
    let found = plain
        .with_floor(&cut)
        .at(period_s)
        .multiplier(0.0)
        .growth_per_s(period_s);
    assert!((found - growth).abs() < 1e-6, "{found} {growth}");
    assert!((without - growth).abs() > 0.05, "{without}");
}

/// `docs/physics/stability.md`, Edge forces: two modes of 10 N/µm in aluminium 6061, 0.05 mm a
/// tooth; limits in mm without and with edge forces, by semi-discretisation, extrapolated.
#[test]
fn verify_limits_with_edge_forces() {
    let mode = |hz: f64, along: Vector3<f64>| TipMode::of_stiffness(TAU * hz, 0.03, 1e7, &along);
    let modes = [mode(1000.0, Vector3::x()), mode(1040.0, Vector3::y())];
    let up = Engagement::up(0.3, 1.0).expect("partial");
    let down = Engagement::down(0.3, 1.0).expect("partial");
    for (teeth, engagement, rpm, without_mm, with_mm) in [
        (2, Engagement::SLOT, 4738.0, 2.8559, 2.4164),
        (2, Engagement::SLOT, 12_523.0, 3.0715, 2.0760),
        (3, Engagement::SLOT, 8000.0, 1.8891, 1.7013),
        (2, up, 9000.0, 10.2485, 4.4606),
        (4, down, 7000.0, 21.8914, 6.3114),
    ] {
        let without = DirectionalMatrix {
            coefficients: CuttingCoefficients {
                axial_pa: 0.0,
                tangential_pa: 243.8e6,
                radial_pa: 113.5e6,
                edge_axial_n_per_m: 0.0,
                edge_tangential_n_per_m: 7.53e3,
                edge_radial_n_per_m: 7.83e3,
            },
            ..DirectionalMatrix::planar(teeth, 0.0, 0.0, engagement)
        };
        let with = DirectionalMatrix {
            feed_per_tooth_m: 0.05e-3,
            ..without
        };
        for (process, expected_mm) in [(without, without_mm), (with, with_mm)] {
            let search = LimitSearch::to_depth(1.5e-3 * expected_mm);
            let elements = SpectralElements::new(&modes, &process);
            let found = first_limit(&elements, 60.0 / (teeth as f64 * rpm), &search);
            let found_mm = found.expect("a limit").depth_m * 1e3;
            let error = found_mm / expected_mm - 1.0;
            assert!(
                error.abs() < 1e-3,
                "{teeth} {rpm}: {found_mm} {expected_mm}"
            );
        }
    }
}
