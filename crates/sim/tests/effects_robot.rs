//! Effects on the build of the robot, against closed forms.

use crate::support::{ARM_POSTURE, column, load, peaks, period, run};
use nalgebra::{Rotation3, Vector3};
use std::f64::consts::TAU;
use std::path::Path;
use truecut_arm::Robot;
use truecut_recording::Recording;
use truecut_scenario::effect::{Effect, EffectKind, Target};

/// Of the carriage along z, kg.
const CARRIAGE_KG: f64 = 557.2998;

/// A payload that the controller does not know lets a vertical slide sag by `m g / k`.
#[test]
fn verify_payload_sag() {
    let scenario = load(
        "rig_planar",
        "",
        "duration_s = 0.01",
        "constant_n = [0.0, 0.0, 0.0]",
    );
    let payload = Effect {
        values: vec![25.0, 0.0, 0.0, 0.0],
        ..Effect::neutral(EffectKind::Payload, Target::Whole)
    };
    let nominal = run(&scenario, &[]);
    let with = run(&scenario, &[payload]);
    let z = |r: &Recording| column(r, "tool.position_z")[0];
    let sag = z(&nominal) - z(&with);
    assert!((sag / (25.0 * 9.81 / 1.394e6) - 1.0).abs() < 1e-9, "{sag}");
}

/// A link that is heavier than the controller knows moves as a heavier link does, to the bit where
/// nothing sags. Under gravity it sags by what it is too heavy over the stiffness, since the
/// command holds the arm that is known.
#[test]
fn verify_link_mass_is_that_of_a_heavier_link() {
    let (factor, last) = (1.15, 2);
    let heavier = Effect {
        values: vec![factor],
        ..Effect::neutral(EffectKind::LinkMass, Target::Joint(last))
    };
    let pushed = |keys: &str| {
        let push = "release_n = [100.0, 30.0, 20.0]";
        load("rig_planar", keys, "duration_s = 0.05", push)
    };
    let floating = run(&pushed("gravity = false"), std::slice::from_ref(&heavier));
    let link = "gravity = false\n[[robot.link]]\nname = \"carriage_z\"\nmass_factor = 1.15";
    let known = run(&pushed(link), &[]);
    for name in ["tool.position_x", "tool.position_y", "tool.position_z"] {
        assert_eq!(column(&floating, name), column(&known, name), "{name}");
    }
    let still = load(
        "rig_planar",
        "",
        "duration_s = 0.01",
        "constant_n = [0.0, 0.0, 0.0]",
    );
    let (nominal, with) = (run(&still, &[]), run(&still, &[heavier]));
    let z = |r: &Recording| column(r, "tool.position_z")[0];
    let sag = z(&nominal) - z(&with);
    let expected = (factor - 1.0) * CARRIAGE_KG * 9.81 / 1.394e6;
    assert!((sag / expected - 1.0).abs() < 1e-9, "{sag} {expected}");
}

/// A link with its centre elsewhere, and a rotor beyond the file's, are those that a scenario's
/// tables give, to the bit where nothing sags.
#[test]
fn verify_link_center_and_joint_rotor_are_those_of_an_arm_that_has_them() {
    let pushed = |keys: &str| {
        let settings = format!("{ARM_POSTURE}\ngravity = false\ndrive = \"servo\"\n{keys}");
        let push = "release_n = [100.0, 300.0, -200.0]";
        load("irb6600_175_255", &settings, "duration_s = 0.05", push)
    };
    let urdf = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../../assets/robots/irb6600_175_255/robot.urdf");
    let nominal = Robot::load(&urdf, None, None).expect("asset");
    let (link, joint) = (&nominal.chain.links[2].name, &nominal.chain.joints[2]);
    let cases = [
        (
            EffectKind::LinkCenter,
            vec![0.03125, -0.0625, 0.125],
            format!(
                "[[robot.link]]\nname = \"{link}\"\ncenter_x_mm = 31.25\ncenter_y_mm = -62.5\n\
                 center_z_mm = 125.0"
            ),
        ),
        (
            EffectKind::JointRotor,
            vec![0.5 * joint.transmission.rotor_inertia],
            format!(
                "[[robot.joint]]\nname = \"{}\"\nrotor_inertia_factor = 1.5",
                joint.name
            ),
        ),
    ];
    let plain = run(&pushed(""), &[]);
    for (kind, values, keys) in cases {
        let effect = Effect {
            values,
            ..Effect::neutral(kind, Target::Joint(2))
        };
        let (with, known) = (run(&pushed(""), &[effect]), run(&pushed(&keys), &[]));
        for name in ["tool.position_x", "tool.position_y", "tool.position_z"] {
            assert_eq!(column(&with, name), column(&known, name), "{kind:?} {name}");
            assert_ne!(column(&with, name), column(&plain, name), "{kind:?} {name}");
        }
    }
}

/// The next joint stands elsewhere on a link: the tool moves by that, turned as the link is.
#[test]
fn verify_link_length_moves_the_tool_as_the_link_is_turned() {
    let settings = format!("{ARM_POSTURE}\ngravity = false");
    let still = "constant_n = [0.0, 0.0, 0.0]";
    let scenario = load("irb6600_175_255", &settings, "duration_s = 0.01", still);
    let off = Vector3::new(0.01, -0.02, 0.043);
    let effect = Effect {
        values: off.as_slice().to_vec(),
        ..Effect::neutral(EffectKind::LinkLength, Target::Joint(1))
    };
    let place = |recording: &Recording| {
        let names = ["tool.position_x", "tool.position_y", "tool.position_z"];
        Vector3::from(names.map(|name| column(recording, name)[0]))
    };
    let moved = place(&run(&scenario, &[effect])) - place(&run(&scenario, &[]));
    let [first, second] = [-48.38_f64, 54.82].map(f64::to_radians);
    let link = Rotation3::from_axis_angle(&Vector3::z_axis(), first)
        * Rotation3::from_axis_angle(&Vector3::y_axis(), second);
    assert!((moved - link * off).norm() < 1e-9, "{moved}");
}

fn tilt(compliance: f64) -> Effect {
    Effect {
        values: vec![compliance],
        ..Effect::neutral(EffectKind::BaseCompliance, Target::Axis(1))
    }
}

/// A carriage of mass m at x tilts its base by `C m g X cosθ`, and slides down the slope by
/// `m g sinθ / k`.
#[test]
fn verify_base_tilts_under_the_arm() {
    let compliance = 2e-5;
    let scenario = load(
        "rig_1dof",
        "posture_mm = [100]",
        "duration_s = 0.01",
        "constant_n = [0.0, 0.0, 0.0]",
    );
    let with = run(&scenario, &[tilt(compliance)]);
    let (theta, x) = (
        column(&with, "base.tilt_y")[0],
        column(&with, "joint1.position")[0],
    );
    let weight = 100.0 * 9.81;
    assert!(theta > 1e-3);
    assert!(
        (theta / (compliance * weight * x * theta.cos()) - 1.0).abs() < 1e-9,
        "{theta}"
    );
    assert!(
        ((x - 0.1) / (weight * theta.sin() / 1e6) - 1.0).abs() < 1e-6,
        "{x}"
    );
    let still = column(&with, "base.tilt_rate_y")
        .iter()
        .fold(0.0, |a: f64, v| a.max(v.abs()));
    assert!(still < 1e-9, "it starts at rest: {still}");
}

/// How far a carriage slides, and how fast it moves at most, on a base that stands turned by these
/// angles about these axes.
fn slid_on(turns: &[(f64, usize)]) -> (f64, f64) {
    let scenario = load(
        "rig_1dof",
        "posture_mm = [100]",
        "duration_s = 0.01",
        "constant_n = [0.0, 0.0, 0.0]",
    );
    let effects = turns.iter().map(|(angle, axis)| Effect {
        values: vec![*angle],
        ..Effect::neutral(EffectKind::BaseTilt, Target::Axis(*axis))
    });
    let with = run(&scenario, &effects.collect::<Vec<_>>());
    let rates = column(&with, "joint1.velocity").iter();
    let fastest = rates.fold(0.0, |a: f64, v| a.max(v.abs()));
    (column(&with, "joint1.position")[0] - 0.1, fastest)
}

/// On a base that stands turned by α about y a carriage rests down the slope, to +x, by
/// `m g sinα / k`; about x it does not slide.
#[test]
fn verify_carriage_slides_down_a_tilted_base() {
    for (angle, axis) in [(0.03, 1), (-0.4, 1), (0.3, 0)] {
        let slope = if axis == 1 { f64::sin(angle) } else { 0.0 };
        let (slid, fastest) = slid_on(&[(angle, axis)]);
        assert!((slid - 100.0 * 9.81 * slope / 1e6).abs() < 1e-12, "{slid}");
        assert!(fastest < 1e-9, "it starts at rest: {fastest}");
    }
}

/// Turned about x and y at once a base stands turned about the axis between them by the length of
/// both angles, in whatever order they are written: `g sin|a| a_y/|a|` along x.
#[test]
fn verify_two_tilts_are_one_turn() {
    let (x, y) = (0.35, -0.2);
    let length = f64::hypot(x, y);
    let (slid, _) = slid_on(&[(x, 0), (y, 1)]);
    let expected = 100.0 * 9.81 * length.sin() * y / length / 1e6;
    assert!((slid - expected).abs() < 1e-12, "{slid} for {expected}");
    assert_eq!(slid.to_bits(), slid_on(&[(y, 1), (x, 0)]).0.to_bits());
}

/// A rigid carriage on a tilting base is a torsional oscillator: `ω² = 1 / (C (I + m x²))`.
#[test]
fn verify_base_swings_at_its_frequency() {
    let compliance = 1e-5;
    let scenario = load(
        "rig_1dof",
        "posture_mm = [100]\ngravity = false\nstiffness_scale = 100",
        "duration_s = 0.5",
        "frame = \"world\"\nrelease_n = [0.0, 0.0, 20.0]",
    );
    let with = run(&scenario, &[tilt(compliance)]);
    let theta = column(&with, "base.tilt_y");
    let expected = TAU * (compliance * (1.0 + 100.0 * 0.01f64)).sqrt();
    assert!(
        (period(&with, theta) / expected - 1.0).abs() < 2e-3,
        "{}",
        period(&with, theta)
    );
    let found = peaks(theta);
    assert!(
        (found[found.len() - 1] / found[0] - 1.0).abs() < 0.02,
        "no damping of its own"
    );
}
