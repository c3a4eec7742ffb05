//! Scenarios and columns for the tests of effects.

#![allow(dead_code, reason = "each test program uses its part")]

use std::path::Path;
use truecut_recording::{Outcome, Recording};
use truecut_scenario::Scenario;
use truecut_scenario::effect::Effect;
use truecut_sim::sweep::record;

pub fn scenario(text: &str) -> Scenario {
    let at = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios/arm/effects.toml");
    Scenario::from_str(&at, text, &[]).unwrap_or_else(|e| panic!("{e:?}"))
}

/// The scenario with effects, to its end.
pub fn run(scenario: &Scenario, effects: &[Effect]) -> Recording {
    let extended = scenario
        .with_effects(effects)
        .unwrap_or_else(|e| panic!("{e:?}"));
    let recording = record(&extended, &[]).unwrap_or_else(|e| panic!("{effects:?}: {e}"));
    assert_eq!(recording.outcome, Outcome::Completed, "{effects:?}");
    recording
}

pub fn column<'a>(recording: &'a Recording, name: &str) -> &'a [f64] {
    let index = recording.header.index_of(name).expect("channel");
    &recording.columns[index]
}

/// A robot under a given force.
pub fn load(robot: &str, settings: &str, run: &str, forces: &str) -> Scenario {
    scenario(&format!(
        "name = \"load\"\n[robot]\nurdf = \"../../assets/robots/{robot}/robot.urdf\"\n{settings}\n\
         [run]\n{run}\n[process.load]\n{forces}\n"
    ))
}

pub const ARM_POSTURE: &str = "posture_deg = [-48.38, 54.82, 6.86, 54.16, 107.43, -21.95]";

/// Backward chamfering on the planar rig, with a foot that slides; `edges` of them.
pub fn chamfer(edges: usize, duration_s: f64) -> Scenario {
    scenario(&format!(
        r#"
name = "chamfer"
[robot]
urdf = "../../assets/robots/rig_planar/robot.urdf"
gravity = false
[run]
duration_s = {duration_s}
[process.chamfer]
direction = "backward"
edges = {edges}
spindle_rpm = 300
feed_mm_per_rev = 0.05
depth_mm = 1.0
half_angle_deg = 45
hole_diameter_mm = 42
regeneration = "off"
[process.chamfer.cutting]
axial_mpa = 1960
in_plane_mpa = 2140
in_plane_angle_deg = 20
[process.chamfer.foot]
pressure_mpa = 0.02
bore_mm = 32
cylinders = 2
seal_stiction_n = 0
[process.chamfer.foot.friction]
law = "coulomb"
mu = 0.15
"#
    ))
}

/// A wheel over 80 mm of a plate, on the planar rig.
pub fn wheel() -> Scenario {
    scenario(
        r#"
name = "wheel"
[robot]
urdf = "../../assets/robots/rig_planar/robot.urdf"
gravity = false
[process.wheel]
radius_mm = 75
width_mm = 25
speed_rpm = 1200
spin = "climb"
stiffness_n_per_mm = 40
damping_n_s_per_mm = 0.05
normal_force_n = 30
mu = 0.4
runout_um = 20
feed_mm_per_s = 50
strip_length_mm = 80
strip_cells = 100
preston_per_pa = 4e-11
"#,
    )
}

/// Peaks of a swinging column, by a parabola through three samples.
pub fn peaks(x: &[f64]) -> Vec<f64> {
    (x.windows(3))
        .filter(|w| w[1] > w[0] && w[1] >= w[2])
        .map(|w| w[1] - (w[0] - w[2]).powi(2) / (8.0 * (w[0] - 2.0 * w[1] + w[2])))
        .collect()
}

/// Mean period from the rising zero crossings.
pub fn period(recording: &Recording, x: &[f64]) -> f64 {
    let t = &recording.time_s;
    let crossings: Vec<f64> = (1..x.len())
        .filter(|i| x[i - 1] < 0.0 && x[*i] >= 0.0)
        .map(|i| t[i - 1] - x[i - 1] * (t[i] - t[i - 1]) / (x[i] - x[i - 1]))
        .collect();
    (crossings[crossings.len() - 1] - crossings[0]) / (crossings.len() - 1) as f64
}
