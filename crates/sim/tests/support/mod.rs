//! Scenarios and columns for the tests of effects.

#![allow(dead_code, reason = "each test program uses its part")]

use std::path::Path;
use truecut_recording::{Outcome, Recording};
use truecut_scenario::Scenario;
use truecut_scenario::effect::Effect;
use truecut_sim::run::{Claims, Run};

pub fn scenario(text: &str) -> Scenario {
    let at = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios/arm/effects.toml");
    Scenario::from_str(&at, text, &[]).unwrap_or_else(|e| panic!("{e:?}"))
}

/// The scenario with effects, to its end.
pub fn run(scenario: &Scenario, effects: &[Effect]) -> Recording {
    let extended = scenario
        .with_effects(effects)
        .unwrap_or_else(|e| panic!("{e:?}"));
    run_with(&extended, &[])
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

/// Overrides of keys in one table.
pub fn below(table: &str, overrides: &[(&str, &str)]) -> Vec<(String, String)> {
    (overrides.iter())
        .map(|(key, value)| (format!("{table}.{key}"), (*value).to_owned()))
        .collect()
}

/// A finished run of a scenario with overrides.
pub fn run_with(scenario: &Scenario, overrides: &[(String, String)]) -> Recording {
    finished(Run {
        overrides: overrides.to_vec(),
        ..Run::of(scenario)
    })
}

/// A finished run, whatever its scenario claims.
pub fn finished(run: Run<'_>) -> Recording {
    let run = Run {
        claims: Claims::Ignore,
        ..run
    };
    let recording = run.execute().unwrap_or_else(|e| panic!("{e}")).recording;
    assert_eq!(recording.outcome, Outcome::Completed);
    recording
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
eccentricity_um = 20
feed_mm_per_s = 50
strip_length_mm = 80
strip_cells = 100
preston_per_pa = 4e-11
"#,
    )
}

/// The wheel of polishing scenarios, its raster's margins, and how the face smooths; the path's
/// other keys go before it.
pub const SOFT_WHEEL: &str = r#"
inset_mm = 9
corner_radius_mm = 2
[process.polish.wheel]
radius_mm = 20
pressure_mpa = 0.1
shell_thickness_mm = 5
youngs_modulus_mpa = 4
[process.polish.roughness]
start_um = 0.8
end_um = 0.1
dose_j_per_mm2 = 0.5
"#;

/// Force control of polishing scenarios.
pub const SPRUNG: &str = r#"
law = "compliant"
force_n = 4
mass_kg = 0.5
stiffness_n_per_mm = 0.2
damping_n_s_per_mm = 0.05
stroke_mm = 2
"#;

/// A soft wheel, its axis leaning steadily and its force held by a sprung carrier, on the planar
/// rig; it begins to follow a line.
pub fn polish() -> Scenario {
    scenario(&format!(
        r#"
name = "polish"
[robot]
urdf = "../../assets/robots/rig_planar/robot.urdf"
gravity = false
posture_mm = [0, 10, 20]
[run]
duration_s = 0.4
[process.polish]
spin_rpm = 900
tilt_deg = 20
mu = 0.3
eccentricity_um = 50
eccentricity_angle_deg = 30
preston_per_pa = 4e-12
[process.polish.face]
origin_mm = [371.3, 19.0, 21.8]
x_axis = [-0.3420201433256687, 0.0, -0.9396926207859084]
normal = [-0.9396926207859084, 0.0, 0.3420201433256687]
length_mm = 78
width_mm = 30
cell_mm = 1
[process.polish.precession]
turn_rpm = 0
rule = "none"
[process.polish.control]{SPRUNG}
[process.polish.path]
line_spacing_mm = 12
feed_mm_per_s = 15{SOFT_WHEEL}"#
    ))
}

/// A belt over the plane face of a path job, in rapier; with overrides of whole keys.
pub fn belt(overrides: &[(String, String)]) -> Scenario {
    let at = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/belt/scenario.toml");
    let text = r#"
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
    Scenario::from_str(&at, text, overrides).unwrap_or_else(|e| panic!("{e}"))
}

/// A brush on the mould block, led along a file of taught postures, in rapier; with overrides of
/// whole keys.
pub fn brush(taught: &str, overrides: &[(String, String)]) -> Scenario {
    let at = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/brush/scenario.toml");
    let text = format!(
        r#"
name = "block"
[robot]
urdf = "../../../../assets/robots/rig_planar/robot.urdf"
stiffness_scale = 100
damping_scale = 200
[run]
time_step_ms = 0.5
[process.brush]
taught = "{taught}"
feed_mm_per_s = 20
radius_mm = 30
width_mm = 10
speed_rpm = 2000
bristles = 3000
bristle_diameter_mm = 0.4
free_length_mm = 12
youngs_modulus_mpa = 3000
mu = 0.3
preston_per_pa = 1e-10
station_mm = 0.25
[process.brush.workpiece]
mesh = "../../../../assets/surfaces/mould_block.obj"
xyz_mm = [400, -30, -50]
rpy_deg = [0, -90, 0]
[[process.brush.edge]]
points_mm = [[0, 0, 20], [0, 60, 20]]
burr_height_mm = 0.03
burr_thickness_mm = 0.04
"#
    );
    Scenario::from_str(&at, &text, overrides).unwrap_or_else(|e| panic!("{e}"))
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
