//! Scenarios and runs of the polishing tests.

use std::path::Path;

use truecut_core::wheel::pneumatic::PneumaticWheel;
use truecut_recording::{Outcome, Recording};
use truecut_scenario::Scenario;
use truecut_sim::sweep::record;

/// Three lines in the middle of a face, 9 mm and more from its edges: no edge comes into the patch.
pub const INSIDE: &str = r#"
name = "inside"
[robot]
urdf = "../../assets/robots/hp20/robot.urdf"
posture_deg = [0, 20, -20, 0, -50, 0]
[run]
record_interval_ms = 1
[process.polish]
spin_rpm = 1000
tilt_deg = 20
mu = 0.3
preston_per_pa = 4e-12
[process.polish.wheel]
radius_mm = 20
pressure_mpa = 0.1
shell_thickness_mm = 5
youngs_modulus_mpa = 4
[process.polish.face]
origin_mm = [1000, -15, 400]
length_mm = 40
width_mm = 26
cell_mm = 0.5
[process.polish.path]
line_spacing_mm = 4
inset_mm = 9
corner_radius_mm = 2
feed_mm_per_s = 20
[process.polish.precession]
turn_rpm = 15
rule = "none"
[process.polish.control]
law = "position"
penetration_mm = 0.6
[process.polish.roughness]
start_um = 0.8
end_um = 0.1
dose_j_per_mm2 = 0.5
"#;

/// The wheel of these scenarios.
pub const WHEEL: PneumaticWheel = PneumaticWheel {
    radius_m: 20e-3,
    pressure_pa: 0.1e6,
    shell_thickness_m: 5e-3,
    youngs_modulus_pa: 4e6,
    poisson: 0.49,
    damping_pa_s_per_m: 0.0,
};

/// A finished run in rapier; keys are those of `process.polish`.
pub fn run(overrides: &[(&str, &str)]) -> Recording {
    run_text(INSIDE, overrides)
}

/// The same of another text.
pub fn run_text(text: &str, overrides: &[(&str, &str)]) -> Recording {
    let at = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios/arm/polish.toml");
    let scenario = Scenario::from_str(&at, text, &[]).unwrap_or_else(|e| panic!("{e}"));
    let owned: Vec<(String, String)> = (overrides.iter())
        .map(|(key, value)| (format!("process.polish.{key}"), (*value).to_owned()))
        .collect();
    let recording = record(&scenario, &owned).unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(recording.outcome, Outcome::Completed);
    recording
}

pub fn column<'a>(recording: &'a Recording, name: &str) -> &'a [f64] {
    let index = recording.header.index_of(name).expect("channel");
    &recording.columns[index]
}

pub fn scalar(recording: &Recording, name: &str) -> f64 {
    recording.scalar(name).expect("scalar").value
}

pub fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}
