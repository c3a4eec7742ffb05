//! Scenarios and runs of the belt tests.

use crate::shared::{below, run_with};
use std::path::Path;
use truecut_core::wheel::belt::BeltWheel;
use truecut_recording::Recording;
use truecut_scenario::Scenario;

/// A belt over the plane face of `plane.toml`.
pub const PLANE: &str = r#"
name = "plane"
[robot]
urdf = "../../../../assets/robots/hp20/robot.urdf"
[run]
time_step_ms = 0.2
[process.belt]
job = "plane.toml"
belt_m_per_s = 15
tension_n = 40
rubber_mm = 8
poisson = 0.48
mu = 0.3
preston_per_pa = 4e-12
cell_mm = 0.5
[process.belt.roughness]
start_um = 3.2
end_um = 0.4
dose_j_per_mm2 = 0.5
"#;

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

/// The scenario with overrides of whole keys.
pub fn scenario(overrides: &[(String, String)]) -> Scenario {
    let at = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/belt/scenario.toml");
    Scenario::from_str(&at, PLANE, overrides).unwrap_or_else(|e| panic!("{e}"))
}

/// A finished run in rapier; keys are those of `process.belt`.
pub fn run(overrides: &[(&str, &str)]) -> Recording {
    run_with(&scenario(&[]), &below("process.belt", overrides))
}
