use super::*;
use crate::chatter::DirectionalMatrix;
use crate::chatter::limit::{LimitSearch, first_limit};
use crate::chatter::planar::tests::PlanarSplit;
use crate::chatter::spectral_elements::SpectralElements;
use crate::cutting::milling::engagement::Engagement;
use crate::cutting::milling::flank::Flank;
use nalgebra::Vector3;
use std::f64::consts::FRAC_PI_2;

fn scattered(count: usize, seed: usize) -> Vec<TipMode> {
    let x = |i: usize| (((seed * 31 + i) * 7 + 3) as f64 * 0.618_034).fract();
    (0..count)
        .map(|i| TipMode {
            natural_frequency_rad_s: TAU * (5.0 + 40.0 * x(4 * i)),
            damping_ratio: 0.01 + 0.03 * x(4 * i + 50),
            shape_per_sqrt_kg: Vector3::new(
                x(4 * i + 1) - 0.5,
                x(4 * i + 2) - 0.5,
                x(4 * i + 3) - 0.5,
            ) * 0.1,
        })
        .collect()
}

/// Below the limit all eigenvalues of the damped system lie to the left, above it one lies to the
/// right, and at the limit it stands on the axis at the frequency given.
#[test]
fn verify_limit_is_where_an_eigenvalue_crosses() {
    let mut found = 0;
    for seed in 0..400 {
        let modes = scattered(1 + seed % 6, seed);
        let down = Engagement::down(0.2 + 0.013 * (seed % 60) as f64, 1.0).expect("partial");
        let mut process = DirectionalMatrix::planar(4, 2e9, 0.3, down);
        process.coefficients.axial_pa = 0.2e9;
        let b = process.average_pa();
        let right = |depth| rightmost_per_s(&modes, &b, depth).expect("modes").re;
        let deepest = 20e-3;
        let Some(limit) = mode_coupling_limit(&modes, &b).filter(|l| l.depth_m < deepest) else {
            for i in 1..=40 {
                let depth = deepest * f64::from(i) / 40.0;
                assert!(right(depth) <= 1e-6, "seed {seed}: {depth}");
            }
            continue;
        };
        found += 1;
        let at = rightmost_per_s(&modes, &b, limit.depth_m).expect("modes");
        let scale = TAU * limit.frequency_hz.max(1.0);
        assert!(at.re.abs() < 1e-6 * scale, "seed {seed}: {at}");
        assert!((at.im / TAU - limit.frequency_hz).abs() < 1e-4 * scale);
        for i in 1..20 {
            assert!(
                right(limit.depth_m * f64::from(i) / 20.0) < 0.0,
                "seed {seed}"
            );
        }
        assert!(right(limit.depth_m * 1.01) > 0.0);
    }
    assert!(found > 130, "{found}");
}

/// Two directions of equal mass and damping: the n-mode limit is the closed criterion's.
#[test]
fn verify_planar_criterion_is_the_case_of_two_modes() {
    let (mass, damping) = (500.0_f64, 871.8);
    let modes: Vec<TipMode> = [(0.9e6, Vector3::x()), (1.0e6, Vector3::y())]
        .iter()
        .map(|(k, axis)| {
            let omega = (k / mass).sqrt();
            TipMode::of_mass(omega, damping / (2.0 * mass * omega), mass, axis)
        })
        .collect();
    let b = DirectionalMatrix::planar(2, 767e6, 0.22, Engagement::SLOT).average_pa();
    let limit = mode_coupling_limit(&modes, &b).expect("skew").depth_m;
    let flutters = |depth: f64| {
        let block = b.fixed_view::<2, 2>(0, 0).into_owned();
        let k = Matrix2::new(0.9e6, 0.0, 0.0, 1.0e6) - block * depth;
        PlanarSplit::of(&k).flutters(mass, damping)
    };
    assert!(!flutters(limit * (1.0 - 1e-6)) && flutters(limit * (1.0 + 1e-6)));
}

/// `docs/physics/stability.md`, benchmark 2: lowest zero-order limit over all speeds, 1.087 mm at
/// 633 Hz.
#[test]
fn verify_benchmark_2_lowest_limit() {
    let modes = [
        TipMode::of_stiffness(TAU * 603.0, 0.039, 5.59e6, &Vector3::x()),
        TipMode::of_stiffness(TAU * 666.0, 0.035, 5.715e6, &Vector3::y()),
    ];
    let quarter = Engagement {
        entry_rad: 0.0,
        exit_rad: FRAC_PI_2,
    };
    let b = DirectionalMatrix::planar(3, 6e8, 0.07, quarter).average_pa();
    let lowest = (0..4000)
        .filter_map(|i| {
            let rpm = 4000.0 + 2.0 * f64::from(i);
            zero_order_limit(&modes, &b, 20.0 / rpm)
        })
        .min_by(|a, b| a.depth_m.total_cmp(&b.depth_m))
        .expect("limits");
    assert!((lowest.depth_m / 1.087e-3 - 1.0).abs() < 2e-3, "{lowest:?}");
    assert!((lowest.frequency_hz - 633.0).abs() < 1.0, "{lowest:?}");
}

/// One mode across the feed only: Tlusty's limit −1/(2 B Re G) at its least, where the phase is
/// free.
#[test]
fn verify_one_direction_at_its_lowest_is_the_real_part_rule() {
    let mode = TipMode::of_stiffness(TAU * 100.0, 0.03, 1e7, &Vector3::y());
    let b = DirectionalMatrix::planar(2, 8e8, 0.3, Engagement::SLOT).average_pa();
    let lowest = (0..3000)
        .filter_map(|i| zero_order_limit(&[mode], &b, 1.0 / (5.0 + 0.02 * f64::from(i))))
        .map(|c| c.depth_m)
        .fold(f64::INFINITY, f64::min);
    // Re G is lowest at −1/(4kζ(1+ζ)).
    let expected = 1e7 * 4.0 * 0.03 * 1.03 / (2.0 * b.m22.abs());
    assert!(
        (lowest / expected - 1.0).abs() < 2e-3,
        "{lowest} {expected}"
    );
}

/// Regeneration of slow vibration, x(t) − x(t − T) ≈ T ẋ.
fn damper_of(average_pa: &Matrix3<f64>, period_s: f64) -> AveragedCut {
    AveragedCut {
        on_position_pa: Matrix3::zeros(),
        on_rate_pa_s: average_pa * period_s,
    }
}

/// A slot's regeneration as a damper: C_p = ¼ N a K_t T [[K_r, 1], [−1, K_r]].
#[test]
fn verify_slow_regeneration_is_damping() {
    let (teeth, k_t, k_r, depth, period) = (4, 2e9, 0.3, 0.3e-3, 6.25e-3);
    let b = DirectionalMatrix::planar(teeth, k_t, k_r, Engagement::SLOT).average_pa();
    let damper = -depth * period * b.fixed_view::<2, 2>(0, 0).into_owned();
    let size = 0.25 * teeth as f64 * depth * k_t * period;
    let expected = Matrix2::new(k_r, 1.0, -1.0, k_r) * size;
    assert!((damper - expected).amax() < 1e-12 * size);
    // One direction along the feed: half the damper's diagonal over the mass is added to the decay
    // rate.
    let mass = 2000.0;
    let mode = TipMode::of_mass(TAU * 7.0, 0.02, mass, &Vector3::x());
    let found = rightmost_per_s(&[mode], damper_of(&b, period), depth).expect("a mode");
    let decay = 0.02 * TAU * 7.0 + 0.5 * size * k_r / mass;
    assert!((found.re / -decay - 1.0).abs() < 1e-9, "{found}");
}

/// For slow vibration the damper's eigenvalue is that of semi-discretisation: x(t) − x(t−T) departs
/// from T ẋ by ωT/2, as a stiffness that leaves the growth rate alone to first order.
#[test]
fn verify_slow_regeneration_against_semi_discretisation() {
    let modes = [
        TipMode::of_mass(TAU * 7.0, 0.02, 2000.0, &Vector3::x()),
        TipMode::of_mass(TAU * 9.0, 0.02, 1500.0, &Vector3::y()),
    ];
    let process = DirectionalMatrix::planar(4, 2e9, 0.3, Engagement::SLOT);
    let period = 1e-3;
    let elements = SpectralElements::new(&modes, &process);
    for depth in [0.1e-3, 0.3e-3] {
        let growth = elements.at(period).multiplier(depth).growth_per_s(period);
        let damper = damper_of(&process.average_pa(), period);
        let slow = rightmost_per_s(&modes, damper, depth).expect("modes");
        assert!((growth / slow.re - 1.0).abs() < 0.02, "{growth} {slow}");
    }
}

/// Flanks worn by 0.1 mm in a material that resists with 1.5e14 N/m³, on a cutter of 16 mm.
fn worn(process: DirectionalMatrix) -> DirectionalMatrix {
    DirectionalMatrix {
        flank: Flank::worn(1.5e14, 0.1e-3, 0.3),
        radius_m: 8e-3,
        ..process
    }
}

/// In a slot four teeth are together a damper of ¼ K_sp V_B² b/v in every direction: two are in the
/// cut, and half of their radial motion is along it. 295 kg at 6.7 Hz: 1.8 % at 300 rpm, 0.9 and
/// 0.2 % at 600 and 2400 rpm.
#[test]
fn verify_damping_of_worn_flanks_in_a_slot() {
    let (omega, mass, depth) = (TAU * 6.7, 295.0, 0.3e-3);
    let mode = TipMode::of_mass(omega, 0.0, mass, &Vector3::x());
    let process = DirectionalMatrix::planar(4, 0.0, 0.0, Engagement::SLOT);
    let mut process = worn(process);
    process.flank.mu = 0.0;
    for (rpm, printed) in [(300.0, 0.018), (600.0, 0.009), (2400.0, 0.00225)] {
        let speed = TAU * rpm / 60.0 * 8e-3;
        let damper = 0.25 * 1.5e14 * 0.1e-3_f64.powi(2) * depth / speed;
        let ratio = damper / (2.0 * mass * omega);
        assert!((ratio / printed - 1.0).abs() < 0.01, "{ratio}");
        let average = process.averaged(15.0 / rpm);
        let found = rightmost_per_s(&[mode], average, depth).expect("a mode");
        assert!((found.re / -(ratio * omega) - 1.0).abs() < 1e-9, "{found}");
    }
}

/// Four teeth in a slot have a constant directional matrix: zero order is exact, and
/// spectral elements must find the same first limit for any modes.
#[test]
fn verify_zero_order_against_spectral_elements_where_it_is_exact() {
    let sharp = DirectionalMatrix::planar(4, 2e9, 0.3, Engagement::SLOT);
    for seed in 0..60 {
        let modes = scattered(1 + seed % 6, seed);
        let process = if seed % 5 == 0 { worn(sharp) } else { sharp };
        for period in [0.004, 0.011, 0.03] {
            let average = process.averaged(period);
            // Worn flanks can damp so much that no depth is unstable.
            let zero = zero_order_limit(&modes, average, period);
            let Some(zero) = zero else {
                assert!(!process.flank.is_sharp(), "seed {seed}, {period} s");
                continue;
            };
            let elements = SpectralElements::new(&modes, &process);
            let search = LimitSearch::to_depth(2.0 * zero.depth_m);
            let limit = first_limit(&elements, period, &search)
                .expect("a limit")
                .depth_m;
            assert!(
                (limit / zero.depth_m - 1.0).abs() < 2e-4,
                "seed {seed}, {period} s: {limit} {zero:?}"
            );
        }
    }
}
