//! A zero of a joint that is off: reported coordinates stay, the links stand beyond them.

use std::f64::consts::TAU;
use std::path::Path;

use truecut_arm::{FrameId, Robot};
use truecut_recording::{ChannelSpec, Measured, MeasuredChannel, Role, Unit};
use truecut_scenario::Scenario;
use truecut_scenario::effect::{Effect, EffectKind, Target};
use truecut_sim::InverseModel;
use truecut_sim::run::{Engine, Run};

const RATE_HZ: f64 = 250.0;
const SAMPLES: usize = 1001;

fn load(text: &str) -> Scenario {
    let at = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios/replay/of_a_test.toml");
    let text = format!(
        "name = \"test\"\n[robot]\nurdf = \"../../assets/robots/arm_2r/robot.urdf\"\n{text}"
    );
    Scenario::from_str(&at, &text, &[]).unwrap_or_else(|error| panic!("{error:?}"))
}

fn zero(joint: usize, offset_rad: f64) -> Effect {
    Effect {
        kind: EffectKind::JointZero,
        target: Target::Joint(joint),
        values: vec![offset_rad],
    }
}

/// Motion of two joints, each counted from `from_rad`.
fn inverse(from_rad: [f64; 2]) -> InverseModel {
    let channel = |joint: usize| {
        format!(
            "[[data.channel]]\ncolumn = \"q{joint}\"\nchannel = \"joint{joint}.angle\"\nunit = \"rad\"\nrole = \"input\"\n\
             [[data.channel]]\ncolumn = \"f{joint}\"\nchannel = \"joint{joint}.drive_torque\"\nunit = \"N m\"\n"
        )
    };
    let scenario = load(&format!(
        "[process.replay]\nmode = \"inverse\"\n[data]\ntime = \"t\"\n{}{}",
        channel(1),
        channel(2)
    ));
    let time_s: Vec<f64> = (0..SAMPLES).map(|k| k as f64 / RATE_HZ).collect();
    let angle = |joint: usize, t: f64| {
        let (hz, phase) = [(0.8, 0.3), (1.3, 1.1)][joint];
        0.2 + 0.5 * (TAU * hz * t + phase).sin() - from_rad[joint]
    };
    let one = |joint: usize, is_angle: bool| {
        let (name, unit, role) = match is_angle {
            true => ("angle", Unit::Radian, Role::Input),
            false => ("drive_torque", Unit::NewtonMetre, Role::Output),
        };
        MeasuredChannel {
            spec: ChannelSpec::new(format!("joint{}.{name}", joint + 1), unit, ""),
            role,
            values: time_s.iter().map(|t| angle(joint, *t)).collect(),
            valid: vec![true; SAMPLES],
            noise: None,
            white_kept: 1.0,
        }
    };
    let measured = Measured {
        source: "made".into(),
        channels: vec![one(0, true), one(1, true), one(0, false), one(1, false)],
        time_s,
        ..Measured::default()
    };
    InverseModel::new(&scenario, &measured).unwrap_or_else(|e| panic!("{e}"))
}

/// What the drives give is what they give in the motion of the links: reported angles that are
/// counted from elsewhere need the same torques as the true ones.
#[test]
fn verify_drive_torques_are_those_of_the_true_angles() {
    let (first, second) = (0.07, -0.11);
    let expected = inverse([0.0, 0.0]).predict(&[]).unwrap();
    let reported = inverse([first, second]);
    let found = reported
        .predict(&[zero(0, first), zero(1, second)])
        .unwrap();
    let nominal = reported.predict(&[]).unwrap();
    for ((expected, found), nominal) in expected.iter().zip(&found).zip(&nominal) {
        let apart = |a: &[f64], b: &[f64]| {
            let middle = (a.iter().zip(b)).skip(200).take(SAMPLES - 400);
            middle.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
        };
        let change = apart(expected, nominal);
        assert!(change > 1.0, "{change} N m");
        assert!(apart(expected, found) < 1e-9 * change);
    }
}

/// A payload and a base that does not stand level act where the links are.
#[test]
fn verify_a_zero_goes_with_a_payload_and_a_tilt() {
    let payload = Effect {
        kind: EffectKind::Payload,
        target: Target::Whole,
        values: vec![3.0, 0.02, 0.0, 0.1],
    };
    let tilt = Effect {
        kind: EffectKind::BaseTilt,
        target: Target::Axis(1),
        values: vec![0.1],
    };
    let both = [payload, tilt];
    let expected = inverse([0.0, 0.0]).predict(&both).unwrap();
    let [payload, tilt] = both;
    let found = inverse([0.0, 0.2])
        .predict(&[payload, tilt, zero(1, 0.2)])
        .unwrap();
    for (expected, found) in expected.iter().zip(&found) {
        let middle = expected.iter().zip(found).skip(200).take(SAMPLES - 400);
        let apart = middle.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(apart < 1e-8, "{apart} N m");
    }
}

/// At rest the tool is where the true angles put it, in both plants.
#[test]
fn verify_the_tool_stands_where_the_true_angles_put_it() {
    let mut scenario = load(
        "posture_deg = [-20, 50]\n[process.load]\nconstant_n = [0.0, 0.0, 0.0]\n[run]\nduration_s = 0.02\n",
    );
    let offset_rad = 0.03;
    scenario.effects = vec![zero(1, offset_rad)];
    let urdf = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets/robots/arm_2r/robot.urdf");
    let robot = Robot::load(&urdf, None, None).unwrap();
    for engine in [Engine::Rapier, Engine::REDUCED] {
        let run = Run {
            engine,
            ..Run::of(&scenario)
        };
        let recording = run.execute().unwrap_or_else(|e| panic!("{e}")).recording;
        let last = |name: &str| *recording.channel(name).unwrap().last().unwrap();
        let reported = [last("joint1.angle"), last("joint2.angle")];
        assert!(
            (reported[1] - 50_f64.to_radians()).abs() < 1e-3,
            "{reported:?}"
        );
        let truly = [reported[0], reported[1] + offset_rad];
        let tool = robot.world_from_frame(&truly, FrameId::Tool).translation;
        for (axis, expected) in ["x", "z"].into_iter().zip([tool.x, tool.z]) {
            let found = last(&format!("tool.position_{axis}"));
            assert!(
                (found - expected).abs() < 1e-9,
                "{axis}: {found} for {expected}"
            );
        }
    }
}
