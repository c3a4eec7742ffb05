//! Scenarios and runs of the polishing tests.

use super::shared::{SOFT_WHEEL, below, run_with, scenario};
use truecut_core::wheel::pneumatic::PneumaticWheel;
use truecut_recording::Recording;

/// By the path alone.
const BY_POSITION: &str = "law = \"position\"\nindentation_mm = 0.6\n";

/// Three lines in the middle of a face, 9 mm and more from its edges: no edge comes into the patch.
fn inside(control: &str) -> String {
    format!(
        r#"
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
[process.polish.face]
origin_mm = [1000, -15, 400]
length_mm = 40
width_mm = 26
cell_mm = 0.5
[process.polish.precession]
turn_rpm = 15
rule = "none"
[process.polish.control]
{control}
[process.polish.path]
line_spacing_mm = 4
feed_mm_per_s = 20{SOFT_WHEEL}"#
    )
}

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
    let scenario = scenario(&inside(BY_POSITION));
    run_with(&scenario, &below("process.polish", overrides))
}

/// The same under another control.
pub fn run_under(control: &str) -> Recording {
    run_with(&scenario(&inside(control)), &[])
}

/// The same by the path, with further tables.
pub fn run_with_tables(tables: &str, overrides: &[(&str, &str)]) -> Recording {
    let scenario = scenario(&format!("{}{tables}", inside(BY_POSITION)));
    run_with(&scenario, &below("process.polish", overrides))
}

/// The text of it with tables and another step.
pub fn with_step(tables: &str, step_ms: &str) -> String {
    let text = format!("{}{tables}", inside(BY_POSITION));
    text.replace("[run]\n", &format!("[run]\ntime_step_ms = {step_ms}\n"))
}
