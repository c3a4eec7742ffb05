//! The friction tables of `docs/physics/vibration.md`, run through the whole simulator on the
//! planar rig: rapier, the contact solver and the foot, with the numbers of an independent
//! integration.
//!
//! What breaks if this is wrong: a friction that creeps or is split by axes gives the paper's
//! amplitudes (62 % too small near the threshold) or none; see
//! `crates/core/tests/planar_oscillator.rs` for the same tables on two bare oscillators.

#[path = "../../crates/core/tests/vibration_tables/mod.rs"]
mod vibration_tables;

use crate::support::{amplitude, channel, lateral_peak, run_text};

/// Force of the table, N, and the foot pressure at which μN has a given ratio to it.
const ROTATING_N: f64 = 109.68;
const MU: f64 = 0.15;
const PISTONS_M2: f64 = 2.0 * std::f64::consts::PI * 0.032 * 0.032 / 4.0;

fn steady(rho: f64, rpm: f64) -> (f64, f64) {
    let period = 60.0 / rpm;
    let duration = 60.0 * period;
    let pressure_mpa = rho * ROTATING_N / MU / PISTONS_M2 * 1e-6;
    let recording = run_text(&format!(
        r#"
name = "steady rotation against friction"
[robot]
urdf = "../../assets/robots/rig_planar/robot.urdf"
gravity = false
[run]
duration_s = {duration}
[process.load.rotating]
amplitude_n = {ROTATING_N}
frequency_hz = {}
[process.load.foot]
pressure_mpa = {pressure_mpa}
axial_share = 0.0
seal_stiction_n = 0
[process.load.foot.friction]
law = "coulomb"
mu = {MU}
"#,
        rpm / 60.0
    ));
    let from = duration - 2.0 * period;
    (
        amplitude(&recording, "tool.displacement_y", from, duration) * 1e6,
        amplitude(&recording, "tool.displacement_z", from, duration) * 1e6,
    )
}

/// At 300 rpm, k2 ≠ k3. The step of 0.25 ms adds (ω dt)²/24 = 3e-6.
#[test]
fn verify_steady_amplitude_table() {
    vibration_tables::check_300_rpm(|rho| steady(rho, 300.0));
}

#[test]
fn verify_steady_amplitude_near_resonance() {
    vibration_tables::check_400_rpm(|rho| steady(rho, 400.0));
}

/// Largest radius in each quarter of the ramp, µm.
fn ramp(rpm: f64, foot: bool) -> [f64; 4] {
    let duration = 20.0 * 60.0 / rpm;
    let foot = if foot {
        format!(
            r#"
[process.chamfer.foot]
pressure_mpa = 0.3
axial_share = 0.0
seal_stiction_n = 0
[process.chamfer.foot.friction]
law = "coulomb"
mu = {MU}
"#
        )
    } else {
        String::new()
    };
    // The table's ramp runs until 1 mm has been cut *behind* the edge, which then stands at 1.05
    // mm.
    let recording = run_text(&format!(
        r#"
name = "ramp"
[robot]
urdf = "../../assets/robots/rig_planar/robot.urdf"
gravity = false
[process.chamfer]
direction = "forward"
spindle_rpm = {rpm}
feed_mm_per_rev = 0.05
depth_mm = 1.05
half_angle_deg = 45
hole_diameter_mm = 42
dwell_revolutions = 0
regeneration = "off"
[process.chamfer.cutting]
axial_mpa = 1960
in_plane_mpa = 2140
{foot}"#
    ));
    assert!((recording.time_s.last().unwrap() - duration).abs() < 1e-3);
    assert!(channel(&recording, "cutting.depth").last().unwrap() > &0.99e-3);
    std::array::from_fn(|i| {
        let quarter = duration / 4.0;
        let from = quarter * i as f64;
        lateral_peak(&recording, from, from + quarter) * 1e6
    })
}

/// The ramp table: printed to 1 µm, hence half a micrometre beside the one percent.
#[test]
fn verify_ramp_table() {
    for (rpm, foot, expected) in [
        (300.0, false, [53.0, 104.0, 154.0, 205.0]),
        (300.0, true, [0.0, 0.0, 34.0, 142.0]),
        (400.0, false, [189.0, 481.0, 737.0, 964.0]),
        (400.0, true, [0.0, 0.0, 28.0, 288.0]),
    ] {
        let got = ramp(rpm, foot);
        println!("{rpm} rpm, foot {foot}: {got:.1?} against {expected:?}");
        for (got, expected) in got.iter().zip(expected) {
            let tolerance = 0.01 * expected + 0.5;
            assert!(
                (got - expected).abs() <= tolerance,
                "{rpm} {foot}: {got} against {expected}"
            );
        }
    }
}

/// Den Hartog's amplification at r = 5/7, through dry friction in a joint of the one-joint rig.
#[test]
fn verify_den_hartog_with_dry_joint_friction() {
    let folder = tempfile::tempdir().expect("temporary folder");
    let rig = crate::support::repository().join("assets/robots/rig_1dof");
    std::fs::copy(rig.join("robot.urdf"), folder.path().join("robot.urdf")).expect("copy");
    let config = std::fs::read_to_string(rig.join("robot.toml")).expect("asset");
    let (k, m, force) = (1.0e6, 100.0, 200.0);
    let natural_hz = f64::sqrt(k / m) / std::f64::consts::TAU;
    let drive_hz = natural_hz * 5.0 / 7.0;
    for (rho, expected) in [(0.25, 1.984), (0.5, 1.800), (0.7, 1.533)] {
        let friction = format!("dry_friction_n = {}", rho * force);
        let with_friction = config.replace("dry_friction_n = 0.0", &friction);
        assert_ne!(with_friction, config);
        std::fs::write(folder.path().join("robot.toml"), with_friction).expect("write");
        let duration = 400.0 / drive_hz;
        let recording = run_text(&format!(
            r#"
name = "Den Hartog"
[robot]
urdf = {:?}
gravity = false
damping_scale = 0.0
[run]
duration_s = {duration}
[process.load.sweep]
amplitude_n = [{force}, 0.0, 0.0]
from_hz = {drive_hz}
to_hz = {}
"#,
            folder.path().join("robot.urdf"),
            drive_hz * (1.0 + 1e-12)
        ));
        let from = duration - 3.0 / drive_hz;
        let x = amplitude(&recording, "tool.displacement_x", from, duration) * k / force;
        println!("Den Hartog rho {rho}: {x:.4} ({expected})");
        assert!(
            (x / expected - 1.0).abs() <= 0.005,
            "{rho}: {x} against {expected}"
        );
    }
}
