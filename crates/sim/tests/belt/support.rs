//! Scenarios and runs of the belt tests.

use super::shared::{below, belt, run_with};
use truecut_core::wheel::belt::BeltWheel;
use truecut_recording::Recording;

/// The wheel of these scenarios.
pub const WHEEL: BeltWheel = BeltWheel {
    radius_m: 20e-3,
    width_m: 10e-3,
    contact_modulus_pa: 8e6,
    poisson: 0.48,
    rubber_m: 8e-3,
    tension_n: 40.0,
    damping_pa_s_per_m: 0.0,
};

/// A finished run in rapier; keys are those of `process.belt`.
pub fn run(overrides: &[(&str, &str)]) -> Recording {
    run_with(&belt(&[]), &below("process.belt", overrides))
}
