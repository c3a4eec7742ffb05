//! What a search may propose.

use std::f64::consts::TAU;
use std::path::Path;

use truecut_recording::{ChannelSpec, Measured, MeasuredChannel, Role, Unit};
use truecut_scenario::Scenario;
use truecut_scenario::effect::{Effect, EffectKind, Target};
use truecut_sim::InverseModel;

use super::Trial;
use crate::diagnose::{check_units, clock_or_unit, set_up_doubt};
use crate::model::Model;
use crate::testing;

const RATE_HZ: f64 = 1000.0;
const SAMPLES: i32 = 400;

/// A mass on a slide that is pushed by measured forces and has no transmission.
fn pushed() -> (Scenario, Measured) {
    let text = r#"
name = "pushed"
[robot]
urdf = "../../assets/robots/emps/robot.urdf"
gravity = false
drive = "force"
[process.replay]
mode = "forward"
[data]
time = "t"
[[data.channel]]
column = "f"
channel = "joint1.drive_force"
unit = "N"
role = "input"
[[data.channel]]
column = "q"
channel = "joint1.position"
unit = "m"
"#;
    let at = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios/replay/of_a_test.toml");
    let scenario = Scenario::from_str(&at, text, &[]).unwrap_or_else(|e| panic!("{e:?}"));
    let measured = swinging(vec![
        ("joint1.drive_force", Unit::Newton, Role::Input, 40.0),
        ("joint1.position", Unit::Metre, Role::Output, 0.003),
    ]);
    (scenario, measured)
}

/// Sines of these sizes.
fn swinging(channels: Vec<(&str, Unit, Role, f64)>) -> Measured {
    let channel = |(name, unit, role, size): (&str, Unit, Role, f64)| MeasuredChannel {
        spec: ChannelSpec::new(name, unit, ""),
        role,
        values: (0..SAMPLES)
            .map(|k| size * (12.0 * f64::from(k) / RATE_HZ).sin())
            .collect(),
        valid: vec![true; SAMPLES as usize],
        noise: None,
        white_kept: 1.0,
    };
    Measured {
        source: "made".into(),
        time_s: (0..SAMPLES).map(|k| f64::from(k) / RATE_HZ).collect(),
        channels: channels.into_iter().map(channel).collect(),
        ..Measured::default()
    }
}

/// A slide of some mass, at 20 Hz and 4 %, that gives way along the feed of a cut, and its data.
fn milled(mass_kg: f64) -> (Scenario, Measured) {
    // The robot's file has 39.93 g, 1.34 N/um and 5.09 N s/m.
    let scales = [
        ("robot.inertia_scale", mass_kg / 0.03993),
        ("robot.stiffness_scale", mass_kg * 15791.0 / 1.34004965e6),
        ("robot.damping_scale", mass_kg * 10.05 / 5.0890039),
    ];
    let scales = scales.map(|(key, value)| (key, value.to_string()));
    let mut changes: Vec<(&str, &str)> =
        scales.iter().map(|(key, value)| (*key, &**value)).collect();
    changes.extend([
        ("process.milling.axial_depth_mm", "0.4"),
        ("process.milling.spindle_rpm", "450"),
        ("run.duration_s", "0.4"),
    ]);
    let measured = swinging(vec![
        ("milling.force_x", Unit::Newton, Role::Output, 40.0),
        ("joint1.position", Unit::Metre, Role::Output, 1e-5),
    ]);
    (testing::milling(&changes), measured)
}

fn tool_mode(compliance_m_per_n: f64, frequency_hz: f64) -> Effect {
    Effect {
        kind: EffectKind::ToolMode,
        target: Target::Whole,
        values: vec![compliance_m_per_n, frequency_hz, 0.04],
    }
}

#[test]
fn tool_modes_grow_out_of_nothing_without_a_jump_and_are_no_heavier_than_the_arm() {
    for (mass_kg, hz) in [(30.0, 90.0), (140.0, 240.0)] {
        let (scenario, measured) = milled(mass_kg);
        let trial = Trial::new(&scenario, &measured).unwrap_or_else(|e| panic!("{e}"));
        let found = trial.mass_at_tool_kg.unwrap();
        assert!(
            (found / mass_kg - 1.0).abs() < 0.02,
            "{found} of {mass_kg} kg"
        );

        let weighing = |kg: f64| tool_mode(1.0 / (kg * (TAU * hz).powi(2)), hz);
        let deflection = |effect| trial.predict(&[], &[effect]).unwrap().swap_remove(1);
        let apart = |a: &[f64], b: &[f64]| {
            let pairs = a.iter().zip(b);
            pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
        };
        let nominal = trial.predict(&[], &[]).unwrap().swap_remove(1);
        let quarter = deflection(weighing(0.25 * found));
        let effect = apart(&quarter, &nominal);
        assert!(effect > 0.0);
        assert!(apart(&deflection(weighing(1e6 * found)), &nominal) < 1e-5 * effect);
        let beside = deflection(weighing(0.2501 * found));
        assert!(apart(&beside, &quarter) < 0.01 * effect);

        for (part, is_one) in [(0.1, true), (0.4, true), (0.6, false), (20.0, false)] {
            assert_eq!(trial.may_be(&[weighing(part * found)]), is_one, "{part}");
        }
        let fast = trial
            .predict(&[], &[tool_mode(1e-8, 0.41 * RATE_HZ)])
            .unwrap_err();
        assert!(fast.0.contains("faster than the 400.0 Hz"), "{fast}");
    }
}

#[test]
fn no_candidate_is_refused_by_the_simulator() {
    let (scenario, measured) = pushed();
    let trial = Trial::new(&scenario, &measured).unwrap_or_else(|e| panic!("{e}"));
    let candidates = trial.candidates();
    let has = |kind| candidates.iter().any(|one| one.kind == kind);
    assert!(has(EffectKind::JointCoulomb) && has(EffectKind::SensorGain));
    for candidate in &candidates {
        let mut effect = Effect::neutral(candidate.kind, candidate.target.clone());
        for (value, scale) in effect.values.iter_mut().zip(&candidate.scale) {
            *value += scale;
        }
        let name = effect.to_string();
        if let Err(error) = trial.predict(&[], &[effect]) {
            assert!(error.0.contains("not fast enough"), "{name}: {error}");
        }
    }
}

/// From a rotor no more is taken than the robot's file gives: what is beyond cannot be simulated,
/// and a search that does not know would end somewhere before it.
#[test]
fn no_more_than_its_rotor_is_taken_from_a_joint() {
    let (scenario, measured) = swung([0.0, 0.0, -1.0], 1.0, &[]);
    let trial = Trial::new(&scenario, &measured).unwrap_or_else(|e| panic!("{e}"));
    let candidates = trial.candidates();
    let rotors = candidates.iter();
    let rotors = rotors.filter(|one| one.kind == EffectKind::JointRotor);
    let least: Vec<f64> = rotors.map(|one| trial.parameters(one)[0].min).collect();
    // As robot.toml has them.
    assert_eq!(least, [-4.0, -1.5]);
    for (joint, least) in least.into_iter().enumerate() {
        let rotor = |inertia: f64| Effect {
            kind: EffectKind::JointRotor,
            target: Target::Joint(joint),
            values: vec![inertia],
        };
        assert!(trial.predict(&[], &[rotor(least)]).is_ok());
        assert!(trial.predict(&[], &[rotor(1.01 * least)]).is_err());
    }
    let others = candidates.iter();
    let others = others.filter(|one| one.kind != EffectKind::JointRotor);
    for other in others {
        assert_eq!(trial.parameters(other), other.kind.parameters());
    }
}

/// The arm of two joints that moves in a plane, in inverse dynamics: motions are differentiated up
/// to one frequency, drive forces compared up to another.
pub(crate) fn arm_of_two(differentiated_to_hz: f64, compared_to_hz: f64) -> Scenario {
    let channel = |joint: usize| {
        format!(
            "[[data.channel]]\ncolumn = \"q{joint}\"\nchannel = \"joint{joint}.angle\"\nunit = \"rad\"\nrole = \"input\"\n\
             [[data.channel]]\ncolumn = \"f{joint}\"\nchannel = \"joint{joint}.drive_torque\"\nunit = \"N m\"\n"
        )
    };
    let text = format!(
        "name = \"swung\"\n[robot]\nurdf = \"../../assets/robots/arm_2r/robot.urdf\"\n[process.replay]\nmode = \"inverse\"\n\
         differentiate_cutoff_hz = {differentiated_to_hz}\ncompare_cutoff_hz = {compared_to_hz}\n[data]\ntime = \"t\"\n{}{}",
        channel(1),
        channel(2)
    );
    let at = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios/replay/of_a_test.toml");
    Scenario::from_str(&at, &text, &[]).unwrap_or_else(|e| panic!("{e:?}"))
}

/// That arm, and what its drives would give in a set-up: under a gravity along `down`, moved
/// `speed` times as fast, with `effects`.
fn swung(down: [f64; 3], speed: f64, effects: &[Effect]) -> (Scenario, Measured) {
    let scenario = arm_of_two(100.0, 60.0);
    let mut measured = swinging(vec![
        ("joint1.angle", Unit::Radian, Role::Input, 0.5),
        ("joint2.angle", Unit::Radian, Role::Input, 0.8),
        ("joint1.drive_torque", Unit::NewtonMetre, Role::Output, 1.0),
        ("joint2.drive_torque", Unit::NewtonMetre, Role::Output, 1.0),
    ]);
    // Two joints that do not go together.
    for (k, value) in measured.channels[1].values.iter_mut().enumerate() {
        *value += 0.4 * (31.0 * k as f64 / RATE_HZ).cos();
    }
    let model = InverseModel::new(&scenario, &measured).unwrap_or_else(|e| panic!("{e}"));
    let made = model.set_up(down.into(), speed).predict(effects).unwrap();
    for (channel, values) in measured.channels[2..].iter_mut().zip(made) {
        channel.values = values;
    }
    (scenario, measured)
}

/// An arm that hangs, a clock that is not the data's and a sign that is reversed are told; friction
/// of the joints, and a payload, are no set-up.
#[test]
fn another_set_up_is_told_and_a_cause_is_none() {
    let floor = [0.0, 0.0, -1.0];
    let told = |(scenario, measured): &(Scenario, Measured)| {
        let trial = Trial::new(scenario, measured).unwrap_or_else(|e| panic!("{e}"));
        let after = trial.predict(&[], &[]).unwrap();
        set_up_doubt(&trial, &trial.observation, &after)
    };
    for (down, speed, words) in [
        ([0.0, 0.0, 1.0], 1.0, "upside down"),
        ([1.0, 0.0, 0.0], 1.0, "its x axis down"),
        (floor, 2.0, "2 times as fast as"),
        (floor, 0.25, "4 times slower than"),
    ] {
        let found = told(&swung(down, speed, &[])).unwrap_or_else(|| panic!("{words}: nothing"));
        assert!(found.contains(words), "{words}: {found}");
    }
    // A column times -1, and an axis that points the other way: both signs of it.
    for (joint, signs, words) in [
        (
            0,
            [-1.0, 1.0],
            "the sign of joint 1's coordinate looks reversed",
        ),
        (
            1,
            [-1.0, 1.0],
            "the sign of joint 2's coordinate looks reversed",
        ),
        (1, [-1.0, -1.0], "the axis of joint 2 looks reversed"),
    ] {
        let mut made = swung(floor, 1.0, &[]);
        for (channel, sign) in [joint, 2 + joint].into_iter().zip(signs) {
            let values = &mut made.1.channels[channel].values;
            values.iter_mut().for_each(|x| *x *= sign);
        }
        let found = told(&made).unwrap_or_else(|| panic!("{words}: nothing"));
        assert!(found.contains(words), "{words}: {found}");
    }
    // Angles in rad that are said to be degrees, and two joints that are taken for each other.
    let mut made = swung(floor, 1.0, &[]);
    for channel in &mut made.1.channels[..2] {
        channel.values.iter_mut().for_each(|x| *x = x.to_radians());
    }
    let found = told(&made).expect("units");
    assert!(found.contains("are in rad and taken for deg"), "{found}");
    let mut made = swung(floor, 1.0, &[]);
    let (one, other) = made.1.channels.split_at_mut(1);
    std::mem::swap(&mut one[0].values, &mut other[0].values);
    let found = told(&made).expect("a swap");
    let words = "the coordinates of joint 1 and joint 2 are swapped";
    assert!(found.contains(words), "{found}");
    assert_eq!(told(&swung(floor, 1.0, &[])), None);
    let payload = Effect {
        kind: EffectKind::Payload,
        target: Target::Whole,
        values: vec![4.0, 0.0, 0.0, 0.1],
    };
    assert_eq!(told(&swung(floor, 1.0, &[payload])), None);
}

/// Of a unit and a set-up that both explain the data what leaves less is told first, and what
/// leaves far more not at all.
#[test]
fn a_reversed_torque_is_told_as_such() {
    let (scenario, mut measured) = swung([0.0, 0.0, -1.0], 1.0, &[]);
    for value in &mut measured.channels[3].values {
        *value = -*value;
    }
    let trial = Trial::new(&scenario, &measured).unwrap_or_else(|e| panic!("{e}"));
    let before = trial.predict(&[], &[]).unwrap();
    let data = &trial.observation;
    let error = check_units(&trial, data, &before).unwrap_err();
    let told = clock_or_unit(&trial, data, &before, error).to_string();
    assert!(
        told.starts_with("channel \"joint2.drive_torque\"") && told.contains("sign is reversed"),
        "{told}"
    );
    assert!(!told.contains("Else"), "{told}");
}
