//! Growth of motions that are known.

use super::*;
use std::f64::consts::TAU;

const STEP_S: f64 = 1e-4;

fn motion(rate_per_s: f64, period_s: f64, size_m: f64, count: usize) -> Vec<Vector3<f64>> {
    (0..count)
        .map(|i| {
            let t = i as f64 * STEP_S;
            let free = size_m * (rate_per_s * t).exp();
            let fast = size_m * (-30.0 * t).exp() * (TAU * 41.0 * t).cos();
            let forced =
                2e-5 * (TAU * t / period_s).sin() + 1e-5 * (2.0 * TAU * t / period_s).cos();
            Vector3::new(
                3e-4 + 1e-4 * t + 1e-6 * t * t + forced + free * (TAU * 9.3 * t).sin() + fast,
                0.5 * free * (TAU * 9.3 * t + 1.0).sin(),
                0.0,
            )
        })
        .collect()
}

/// A slow mode that grows or decays beside forced vibration ten times as large, a drift and a
/// fast mode that dies away, tooth periods of whole and of broken numbers of samples.
#[test]
fn verify_rate_of_an_exponential() {
    for period_s in [6.25e-3, 7.123e-3] {
        for rate_per_s in [-2.0, -0.4, 0.5, 2.0] {
            let motion = motion(rate_per_s, period_s, 1e-6, 20_000);
            let options = GrowthOptions {
                period_s,
                linear_m: 1e-4,
            };
            let found = growth(&motion, STEP_S, &options).expect("long enough");
            let rate = found.rate_per_s.expect("linear");
            assert!(
                (rate - rate_per_s).abs() < 0.02,
                "{rate} instead of {rate_per_s}"
            );
        }
    }
}

/// A stable tool that is knocked again and again has the rate at which it dies away, not that
/// of the knocks, however large and wherever they fall; a growing one that is knocked grows.
#[test]
fn knocks_are_no_growth() {
    let options = GrowthOptions {
        period_s: 6.25e-3,
        linear_m: 1e-4,
    };
    let knocks = [1.31, 3.87, 4.13, 5.49];
    for (rate_per_s, shift_s) in [(-3.0, 0.0), (-3.0, 0.11), (-1.5, 0.05), (0.5, 0.0)] {
        // Each knock is louder than all before it in a motion that dies away.
        let sizes_m = knocks.map(|at: f64| 1e-9 * (1.2 * at).exp());
        let motion: Vec<Vector3<f64>> = (0..80_000)
            .map(|i| {
                let t = i as f64 * STEP_S;
                let mut x = 3e-4 + 1e-5 * t + 2e-5 * (TAU * t / options.period_s).sin();
                let mut ring = |since: f64, size: f64| {
                    if since > 0.0 {
                        x += size * (rate_per_s * since).exp() * (TAU * 9.3 * since).sin();
                    }
                };
                ring(t, 1e-7);
                for (at, size) in knocks.iter().zip(sizes_m) {
                    ring(t - at - shift_s, size);
                }
                Vector3::new(x, 0.0, 0.0)
            })
            .collect();
        let found = growth(&motion, STEP_S, &options).expect("long enough");
        let rate = found.rate_per_s.expect("linear");
        assert!(
            (rate - rate_per_s).abs() < 0.3 * rate_per_s.abs(),
            "{rate} instead of {rate_per_s}, {shift_s}"
        );
    }
}

/// A motion that dies away before it grows out of the linear range has the rate of its growth,
/// whatever came before.
#[test]
fn growth_counts_from_the_quietest_window_on() {
    let options = GrowthOptions {
        period_s: 6.25e-3,
        linear_m: 5e-6,
    };
    let mut motion = motion(5.0, 6.25e-3, 1e-8, 12_000);
    for (i, x) in motion.iter_mut().enumerate() {
        let t = i as f64 * STEP_S;
        x.y += 1e-6 * (-8.0 * t).exp() * (TAU * 9.3 * t).sin();
        x.z += 2e-5 / (1.0 + (-80.0 * (t - 1.0)).exp()) * (TAU * 9.3 * t).sin();
    }
    let found = growth(&motion, STEP_S, &options).expect("long enough");
    assert!(found.last_level_m > options.linear_m);
    assert!(found.rate_per_s.is_none_or(|rate| rate > 0.0), "{found:?}");
}

/// A steady cut, whose motion from tooth to tooth is picometres that come and go; beside a mode
/// that dies away into them, which has its rate.
#[test]
fn noise_of_computing_neither_grows_nor_dies_away() {
    let options = GrowthOptions {
        period_s: 6.25e-3,
        linear_m: 2.5e-6,
    };
    let motion = |size_m: f64| -> Vec<Vector3<f64>> {
        let at = |i: usize| {
            let t = i as f64 * STEP_S;
            let forced = 2e-6 * (TAU * t / options.period_s).sin();
            let swell = 1.0 + (0.8 * t).sin() + 0.5 * t;
            let noise = 1e-12 * swell * (TAU * 83.0 * t + 3.0 * (7.0 * t).sin()).sin();
            let mode = size_m * (-6.0 * t).exp() * (TAU * 60.0 * t).sin();
            Vector3::new(forced + noise + mode, 0.0, 0.0)
        };
        (0..60_000).map(at).collect()
    };
    let still = growth(&motion(0.0), STEP_S, &options).expect("long enough");
    assert_eq!(still.rate_per_s, None, "{still:?}");
    assert!(still.last_level_m > 1e-13 && still.last_level_m < NOISE * options.linear_m);
    let decaying = growth(&motion(1e-6), STEP_S, &options).expect("long enough");
    let rate = decaying.rate_per_s.expect("a mode");
    assert!((rate + 6.0).abs() < 0.3, "{rate}");
}

/// What has saturated does not count. A motion that is beyond the linear range from the
/// beginning has the rate at which it grows, and how large it was says so.
#[test]
fn growth_ends_where_the_motion_is_no_longer_linear() {
    let options = GrowthOptions {
        period_s: 6.25e-3,
        linear_m: 1e-5,
    };
    let mut motion = motion(3.0, 6.25e-3, 1e-6, 20_000);
    motion.iter_mut().for_each(|x| x.y = x.y.clamp(-3e-5, 3e-5));
    let found = growth(&motion, STEP_S, &options).expect("long enough");
    assert!((found.rate_per_s.expect("linear") - 3.0).abs() < 0.1);
    assert!(found.last_level_m > options.linear_m);
    assert!(found.largest_m <= options.linear_m);
    let narrow = GrowthOptions {
        linear_m: 1e-9,
        ..options
    };
    let grown = growth(&motion[..6_000], STEP_S, &narrow).expect("long enough");
    assert!(
        (grown.rate_per_s.expect("a rate") - 3.0).abs() < 0.1,
        "{grown:?}"
    );
    assert!(grown.largest_m > narrow.linear_m);
    let still = vec![Vector3::repeat(1e-3); 6_000];
    let none = growth(&still, STEP_S, &options).expect("long enough");
    assert_eq!(none.rate_per_s, None);
    assert_eq!(growth(&motion[..100], STEP_S, &options), None);
}
