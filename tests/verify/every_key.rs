//! Every numeric key of a scenario changes what its run gives. A key that did not would be a
//! promise that the simulator does not keep.

use crate::support::{recording, repository};
use truecut_recording::Recording;
use truecut_scenario::Scenario;
use truecut_sim::run::Engine;

const CHAMFER: &str = r#"
name = "every key"
[robot]
urdf = "../../assets/robots/irb6600_175_255/robot.urdf"
posture_deg = [-48.38, 54.82, 6.86, 54.16, 107.43, -21.95]
inertia_scale = 1.0
stiffness_scale = 1.0
damping_scale = 1.0
hold_against_sag = true
[run]
time_step_ms = 0.1
[process.chamfer]
direction = "backward"
spindle_rpm = 900
feed_mm_per_rev = 0.05
depth_mm = 0.4
half_angle_deg = 45
hole_diameter_mm = 42
edges = 1
start_angle_deg = 0.0
dwell_revolutions = 1.0
[process.chamfer.cutting]
axial_mpa = 1960
in_plane_mpa = 2140
in_plane_angle_deg = 20
edge_axial_n_per_mm = 5.0
edge_radial_n_per_mm = 5.0
edge_tangential_n_per_mm = 5.0
[process.chamfer.foot]
pressure_mpa = 0.1
bore_mm = 32
cylinders = 2
gas_length_mm = 50
polytropic_exponent = 1.4
seal_stiction_n = 30
rod_stiffness_n_per_um = 50
[process.chamfer.foot.friction]
law = "stribeck"
mu = 0.15
mu_static = 0.18
stribeck_speed_mm_per_s = 1.0
[[tool.mode]]
frequency_hz = 900
damping_ratio = 0.03
stiffness_n_per_um = 8
direction = [1, 0.5, 0.2]
[[workpiece.mode]]
frequency_hz = 700
damping_ratio = 0.02
stiffness_n_per_um = 20
direction = [0.2, 1, 0.3]
"#;

const WHEEL: &str = r#"
name = "every key"
[robot]
urdf = "../../assets/robots/irb6600_175_255/robot.urdf"
posture_deg = [-48.38, 54.82, 6.86, 54.16, 107.43, -21.95]
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
strip_length_mm = 20
strip_cells = 40
preston_per_pa = 4e-11
[[tool.mode]]
frequency_hz = 900
damping_ratio = 0.03
stiffness_n_per_um = 8
direction = [1, 0.5, 0.2]
[[workpiece.mode]]
frequency_hz = 700
damping_ratio = 0.02
stiffness_n_per_um = 20
direction = [0.2, 1, 0.3]
"#;

const MILLING: &str = r#"
name = "every key"
[robot]
urdf = "../../assets/robots/irb6600_175_255/robot.urdf"
config = "../../assets/robots/irb6600_175_255/milling.toml"
[process.milling]
spindle_rpm = 2400
feed_mm_per_s = 16
axial_depth_mm = 0.3
engagement = "between"
entry_deg = 20
exit_deg = 170
regeneration = true
start_angle_deg = 0.0
lead_in_mm = 0.2
ramp_mm = 0.5
[process.milling.cutter]
diameter_mm = 4
teeth = 4
helix_deg = 30
runout_um = 5
runout_angle_deg = 20
wear_land_mm = 0.08
[process.milling.cutting]
tangential_mpa = 2000
radial_mpa = 600
axial_mpa = 200
edge_tangential_n_per_mm = 5.0
edge_radial_n_per_mm = 5.0
edge_axial_n_per_mm = 1.0
indentation_n_per_mm3 = 40000
flank_friction = 0.3
[[process.milling.cutter.mode]]
frequency_hz = 900
damping_ratio = 0.03
stiffness_n_per_um = 8
direction = [1, 0.5, 0.2]
[[process.milling.cutter.mode.over_speed]]
spindle_rpm = 3000
frequency_hz = 820
damping_ratio = 0.04
stiffness_n_per_um = 6
[[process.milling.workpiece.mode]]
frequency_hz = 700
damping_ratio = 0.02
stiffness_n_per_um = 20
direction = [0.2, 1, 0.3]
[process.milling.path]
start_mm = [1050, -1450, 870]
direction = [1, 0.5, 0]
length_mm = 4
zero_direction = [1, 0.3, 0]
redundancy_deg = 120
"#;

const MILLING_FROM_THE_POSTURE: &str = r#"
name = "every key"
[robot]
urdf = "../../assets/robots/irb6600_175_255/robot.urdf"
posture_deg = [10, 20, -15, 0, 85, 0]
damping_ratio = [0.02, 0.03, 0.025, 0.02, 0.04, 0.05]
[process.milling]
spindle_rpm = 2400
feed_mm_per_tooth = 0.1
axial_depth_mm = 0.3
engagement = "down"
radial_depth_mm = 3
[process.milling.cutter]
diameter_mm = 4
teeth = 2
[process.milling.cutting]
tangential_mpa = 600
radial_mpa = 200
indentation_n_per_mm3 = 40000
wear_land_mm = 0.05
[process.milling.path]
direction = [0.3, 1, 0]
length_mm = 1
"#;

const LOAD: &str = r#"
name = "every key"
[robot]
urdf = "../../assets/robots/irb6600_175_255/robot.urdf"
posture_deg = [-48.38, 54.82, 6.86, 54.16, 107.43, -21.95]
[run]
duration_s = 0.2
[process.load]
constant_n = [100.0, 50.0, 20.0]
release_n = [10.0, 20.0, 30.0]
[process.load.sweep]
amplitude_n = [10.0, 20.0, 30.0]
from_hz = 5.0
to_hz = 50.0
[process.load.rotating]
amplitude_n = 100.0
frequency_hz = 20.0
start_angle_deg = 0.0
[process.load.foot]
pressure_mpa = 0.02
axial_share = 0.3
seal_stiction_n = 0
[process.load.foot.friction]
law = "equivalent_viscous"
mu = 0.15
amplitude_floor_um = 1.0
[[tool.mode]]
frequency_hz = 900
damping_ratio = 0.03
stiffness_n_per_um = 8
direction = [1, 0.5, 0.2]
[[workpiece.mode]]
frequency_hz = 700
damping_ratio = 0.02
stiffness_n_per_um = 20
direction = [0.2, 1, 0.3]
"#;

/// `turn_rpm` and `start_deg` are written so that they are not changed: edges hold the angle all
/// along this short way. They are changed in the text after this.
const POLISH: &str = r#"
name = "every key"
[robot]
urdf = "../../assets/robots/hp20/robot.urdf"
[run]
time_step_ms = 0.1
duration_s = 0.8
[process.polish]
spin_rpm = 1000
tilt_deg = 20
mu = 0.3
eccentricity_um = 50
eccentricity_angle_deg = 10
preston_per_pa = 4e-12
[process.polish.wheel]
radius_mm = 20
pressure_mpa = 0.1
shell_thickness_mm = 5
youngs_modulus_mpa = 4
poisson = 0.45
damping_pa_s_per_m = 10000
[process.polish.face]
origin_mm = [1000, -15, 400]
x_axis = [1, 0.2, 0]
length_mm = 20
width_mm = 14
cell_mm = 0.5
[process.polish.path]
line_spacing_mm = 3.95
inset_mm = 1
corner_radius_mm = 1.4
feed_mm_per_s = 60
[process.polish.precession]
turn_rpm=15
start_deg=190
rule = "cosine"
epsilon = 0.1
largest_rate_deg_per_s = 200
largest_acceleration_deg_per_s2 = 4000
[process.polish.control]
law = "compliant"
force_n = 4
mass_kg = 0.5
stiffness_n_per_mm = 0.2
damping_n_s_per_mm = 0.05
stroke_mm = 0.01
[process.polish.roughness]
start_um = 0.8
end_um = 0.1
dose_j_per_mm2 = 0.5
"#;

const POLISH_HELD: &str = r#"
name = "every key"
[robot]
urdf = "../../assets/robots/hp20/robot.urdf"
[run]
time_step_ms = 0.1
duration_s = 0.7
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
length_mm = 20
width_mm = 14
[process.polish.path]
line_spacing_mm = 4.6
corner_radius_mm = 1.5
feed_mm_per_s = 60
[process.polish.precession]
turn_rpm = 15
start_deg = 20
rule = "none"
[process.polish.texture]
rms_um = 10
length_mm = 3
seed = 4
[process.polish.grains]
radius_um = 40
protrusion_um = 30
protrusion_spread_um = 8
number_per_mm2 = 8
strength_n = 0.04
shed_share = 0.5
edge_radius_um = 5
ploughing_um = 20
specific_energy_j_per_mm3 = 10
seed = 2
[process.polish.control]
law = "constant_force"
force_n = 4
damping_n_s_per_mm = 0.2
fastest_mm_per_s = 4
[process.polish.roughness]
start_um = 0.8
end_um = 0.1
dose_j_per_mm2 = 0.5
"#;

/// A belt run with further keys of its table, and a control table.
fn belt(keys: &str, control: &str) -> String {
    format!(
        r#"
name = "every key"
[robot]
urdf = "../../assets/robots/hp20/robot.urdf"
[run]
time_step_ms = 0.2
duration_s = 1.6
[process.belt]
job = "../finishing/hub_spoke.toml"
belt_m_per_s = 20
tension_n = 60
rubber_mm = 15
mu = 0.3
preston_per_pa = 4e-12
cell_mm = 2
{keys}
{control}
[process.belt.roughness]
start_um = 3.2
end_um = 0.4
dose_j_per_mm2 = 0.5
"#
    )
}

const BELT_KEYS: &str = "copies = 1
poisson = 0.48
damping_pa_s_per_m = 2000";

const BELT_HELD: &str = r#"[process.belt.control]
law = "constant_force"
force_n = 40
damping_n_s_per_mm = 4
fastest_mm_per_s = 8
stroke_mm = 1.5"#;

const BELT_COMPLIANT: &str = r#"[process.belt.control]
law = "compliant"
force_n = 40
mass_kg = 2
stiffness_n_per_mm = 2
damping_n_s_per_mm = 0.3
stroke_mm = 1.5"#;

const BRUSH: &str = r#"
name = "every key"
[robot]
urdf = "../../assets/robots/hp20/robot.urdf"
[run]
time_step_ms = 0.5
[process.brush]
taught = "../finishing/block_edge.csv"
feed_mm_per_s = 40
joint_speed = 0.01
radius_mm = 60
width_mm = 20
speed_rpm = 1500
bristles = 8000
bristle_diameter_mm = 0.5
free_length_mm = 25
youngs_modulus_mpa = 3000
mu = 0.3
preston_per_pa = 1.5e-10
station_mm = 1.2
[process.brush.workpiece]
mesh = "../../assets/surfaces/mould_block.obj"
xyz_mm = [1000, -30, 400]
rpy_deg = [0.01, 0, 0]
[[process.brush.edge]]
points_mm = [[0, 0, 20], [100, 0, 20]]
burr_height_mm = 0.15
burr_thickness_mm = 0.05
"#;

fn run(text: &str, overrides: &[(String, String)]) -> Recording {
    let at = repository().join("scenarios/arm/every_key.toml");
    let scenario = Scenario::from_str(&at, text, &[]).unwrap_or_else(|e| panic!("{e:?}"));
    recording(Engine::Rapier, &scenario, overrides)
}

/// What a run gives: all channels, scalars and profiles.
fn differs(a: &Recording, b: &Recording) -> bool {
    let bits = |x: &f64| x.to_bits();
    a.columns != b.columns
        || a.profiles != b.profiles
        || (a.scalars.iter().map(|s| bits(&s.value))).ne(b.scalars.iter().map(|s| bits(&s.value)))
}

/// Keys and their numbers, with the table they stand in; arrays are changed in their first element.
fn numeric_keys(text: &str) -> Vec<(String, String)> {
    let mut table = String::new();
    let mut keys = Vec::new();
    for line in text.lines() {
        if let Some(name) = line.strip_prefix("[[") {
            // A list within a list is that of its first entry.
            let name = name.trim_end_matches(']').replace(".mode.", ".mode.0.");
            table = format!("{name}.0");
        } else if let Some(name) = line.strip_prefix('[') {
            table = name.trim_end_matches(']').to_string();
        } else if let Some((key, value)) = line.split_once(" = ") {
            let changed = changed(key, value);
            if let Some(changed) = changed {
                keys.push((format!("{table}.{key}"), changed));
            }
        }
    }
    keys
}

fn changed(key: &str, value: &str) -> Option<String> {
    if value == "true" {
        return Some("false".into());
    }
    if let Some(inside) = value.strip_prefix('[') {
        let (first, rest) = inside.split_once(',')?;
        return Some(format!("[{}, {rest}", first.parse::<f64>().ok()? * 1.03));
    }
    let counts = [
        "edges",
        "cylinders",
        "strip_cells",
        "teeth",
        "copies",
        "bristles",
        "seed",
    ];
    if counts.contains(&key) {
        return Some((value.parse::<i64>().ok()? + 1).to_string());
    }
    let number: f64 = value.parse().ok()?;
    Some(match number {
        0.0 => "7.0".into(),
        _ => format!("{:?}", number * 1.03),
    })
}

fn check(text: &str, least: usize) {
    let nominal = run(text, &[]);
    let keys = numeric_keys(text);
    assert!(keys.len() >= least, "{} keys found", keys.len());
    for (key, value) in keys {
        let other = run(text, &[(key.clone(), value.clone())]);
        assert!(
            differs(&nominal, &other),
            "`{key}` = {value} changes nothing"
        );
    }
}

#[test]
fn every_key_of_chamfering_counts() {
    check(CHAMFER, 28);
}

#[test]
fn every_key_of_the_wheel_counts() {
    check(WHEEL, 12);
}

#[test]
fn every_key_of_milling_counts() {
    check(MILLING, 36);
    check(MILLING_FROM_THE_POSTURE, 12);
}

#[test]
fn every_key_of_polishing_counts() {
    check(POLISH, 34);
    check(POLISH_HELD, 37);
}

#[test]
fn every_key_of_belt_finishing_counts() {
    check(&belt(BELT_KEYS, ""), 14);
    check(&belt("", BELT_HELD), 15);
    check(&belt("", BELT_COMPLIANT), 16);
}

#[test]
fn every_key_of_brushing_counts() {
    check(BRUSH, 17);
}

#[test]
fn every_key_of_given_loads_counts() {
    check(LOAD, 13);
}
