//! Depth limits in the time domain against stability theory.

use super::support::{RIG, grows, scenario};
use nalgebra::Vector3;
use std::f64::consts::TAU;
use truecut_core::chatter::limit::{LimitSearch, first_limit};
use truecut_core::chatter::spectral_elements::SpectralElements;
use truecut_core::chatter::{DirectionalMatrix, TipMode};
use truecut_core::cutting::milling::engagement::Engagement;
use truecut_scenario::Scenario;

/// Tooth periods on the wedge, and after it.
const RAMP: f64 = 60.0;
const SETTLED: f64 = 120.0;

pub fn benchmark(immersion: f64, rpm: f64, depth_m: f64) -> Scenario {
    let feed_mm = 0.02;
    scenario(
        RIG,
        &[
            ("process.milling.spindle_rpm", format!("{rpm:?}")),
            (
                "process.milling.radial_depth_mm",
                format!("{:?}", 20.0 * immersion),
            ),
            (
                "process.milling.axial_depth_mm",
                format!("{:?}", depth_m * 1e3),
            ),
            ("process.milling.feed_mm_per_tooth", format!("{feed_mm:?}")),
            ("process.milling.ramp_mm", format!("{:?}", RAMP * feed_mm)),
            (
                "process.milling.path.length_mm",
                format!("{:?}", (RAMP + SETTLED) * feed_mm),
            ),
        ],
    )
}

/// Benchmark 1 in rapier: an end mill of two teeth on one spring, five speeds, flips among them.
/// Bisection on the growth rate of the recording to 1 %.
#[test]
fn verify_limits_of_the_benchmark_in_rapier() {
    let omega = TAU * 922.0;
    let mode = TipMode::of_mass(omega, 0.011, 0.03993, &Vector3::x());
    for (immersion, rpm) in [
        (0.5, 5e3),
        (0.5, 10e3),
        (1.0, 12e3),
        (0.5, 16e3),
        (1.0, 20e3),
    ] {
        let down = Engagement::down(immersion, 1.0).expect("partial");
        let process = DirectionalMatrix::planar(2, 6e8, 1.0 / 3.0, down);
        let sdm = SpectralElements::new(&[mode], &process);
        let search = LimitSearch::to_depth(5e-3);
        let theory_m = first_limit(&sdm, 30.0 / rpm, &search)
            .expect("a limit")
            .depth_m;
        let (mut low, mut high) = (0.7 * theory_m, 1.3 * theory_m);
        assert!(!grows(&benchmark(immersion, rpm, low)), "{rpm}: {low}");
        assert!(grows(&benchmark(immersion, rpm, high)), "{rpm}: {high}");
        while high - low > 0.01 * theory_m {
            let middle = 0.5 * (low + high);
            if grows(&benchmark(immersion, rpm, middle)) {
                high = middle;
            } else {
                low = middle;
            }
        }
        let found_m = 0.5 * (low + high);
        println!(
            "a/D {immersion}, {rpm} rpm: {:.4} mm, {:+.4}",
            found_m * 1e3,
            found_m / theory_m - 1.0
        );
        assert!(
            (found_m / theory_m - 1.0).abs() <= 0.05,
            "a/D {immersion}, {rpm} rpm: {found_m} m instead of {theory_m} m"
        );
    }
}
