//! The linearised arm mills like the one in rapier.

use super::arm::slot;
use super::support::{run, run_reduced, scalar};
use truecut_scenario::Scenario;

/// Largest difference of the two plants in a scalar, as a part of its size in rapier.
fn apart(scenario: &Scenario, names: &[&str]) -> f64 {
    let (rapier, reduced) = (run(scenario), run_reduced(scenario));
    let of = |name: &&str| {
        let (a, b) = (scalar(&rapier, name), scalar(&reduced, name));
        println!("{name}: rapier {a:.6e}, linearised {b:.6e}");
        (b / a - 1.0).abs()
    };
    names.iter().map(of).fold(0.0, f64::max)
}

/// Forces, surface and deflection of a cut on its own surface; growth of one on the nominal
/// surface, whose rate is a small difference of large ones: 0.1 % of frequency is 0.06 /s.
#[test]
fn regress_linearised_arm_mills_like_rapier() {
    let own = slot(120.0, 0.3e-3, true, 2.5);
    let names = [
        "milling.mean_force_x",
        "milling.mean_force_y",
        "milling.exit_wall_error",
        "milling.floor_error",
    ];
    assert!(apart(&own, &names) < 2e-3);
    let nominal = slot(120.0, 0.2e-3, false, 2.0);
    let names = ["milling.growth_rate", "milling.chatter_frequency"];
    assert!(apart(&nominal, &names) < 0.03);
}
