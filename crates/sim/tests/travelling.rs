//! The reduced plant of an arm that travels, beside rapier at a fiftieth of its step: what it errs
//! by, and that it errs by less in shorter steps.

use std::f64::consts::TAU;
use std::path::Path;
use truecut_recording::{ChannelSpec, Measured, MeasuredChannel, Outcome, Role, Unit};
use truecut_scenario::Scenario;
use truecut_scenario::effect::{Effect, EffectKind, Target};
use truecut_sim::run::{Claims, Engine, Rows, Run};

const RATE_HZ: f64 = 250.0;
const SAMPLES: usize = 501;
const TORQUE: [&str; 2] = ["joint1.transmission_torque", "joint2.transmission_torque"];

fn scenario() -> Scenario {
    let channels = [1, 2].map(|joint| {
        format!(
            "[[data.channel]]\ncolumn = \"c{joint}\"\nchannel = \"joint{joint}.command\"\nunit = \"rad\"\nrole = \"input\"\n"
        )
    });
    let text = format!(
        "name = \"travelling\"\n[robot]\nurdf = \"../../assets/robots/arm_2r/robot.urdf\"\nposture_deg = [-40.0, 60.0]\n\
         gravity = false\n[process.replay]\nmode = \"forward\"\n[data]\ntime = \"t\"\n{}",
        channels.concat()
    );
    let at = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios/replay/of_a_test.toml");
    Scenario::from_str(&at, &text, &[]).unwrap_or_else(|error| panic!("{error:?}"))
}

/// Both joints swing through some 20°, from rest.
fn measured() -> Measured {
    let swing = |start_deg: f64, by_deg: f64, hz: f64| -> Vec<f64> {
        let times = (0..SAMPLES).map(|k| k as f64 / RATE_HZ);
        times
            .map(|t| (start_deg + by_deg * (1.0 - (TAU * hz * t).cos())).to_radians())
            .collect()
    };
    let inputs = [swing(-40.0, 9.0, 1.0), swing(60.0, -11.0, 1.5)];
    let channels = inputs.into_iter().enumerate().map(|(i, values)| {
        let name = format!("joint{}.command", i + 1);
        MeasuredChannel {
            spec: ChannelSpec::new(&name, Unit::Radian, ""),
            role: Role::Input,
            valid: vec![true; values.len()],
            values,
            noise: None,
            white_kept: 1.0,
        }
    });
    Measured {
        source: "made".into(),
        time_s: (0..SAMPLES).map(|k| k as f64 / RATE_HZ).collect(),
        channels: channels.collect(),
        ..Measured::default()
    }
}

fn run(scenario: &Scenario, engine: Engine, step_ms: Option<f64>) -> Rows {
    let step = step_ms.map(|ms| ("run.time_step_ms".to_owned(), format!("{ms:?}")));
    let overrides: Vec<_> = step.into_iter().collect();
    let run = Run {
        overrides,
        measured: Some(&measured()),
        engine,
        ..Run::of(scenario)
    };
    let rows = run.rows(&TORQUE, None).unwrap();
    assert_eq!(rows.outcome, Outcome::Completed);
    rows
}

/// A run that keeps rows alone moves the tool only where a row is due: its rows are those of the
/// recording to the last bit.
#[test]
fn frames_that_no_one_looks_at_change_no_row() {
    let (scenario, measured) = (scenario(), measured());
    let run = || Run {
        overrides: vec![("run.record_interval_ms".to_owned(), "4".to_owned())],
        measured: Some(&measured),
        engine: Engine::REDUCED,
        claims: Claims::Ignore,
        ..Run::of(&scenario)
    };
    let recording = run().execute().unwrap_or_else(|e| panic!("{e}")).recording;
    let rows = run().rows(&[], None).unwrap();
    assert_eq!(rows.time_s.len(), SAMPLES);
    assert!(
        rows.channels
            .iter()
            .any(|spec| spec.name == "tool.position_x")
    );
    for (spec, column) in rows.channels.iter().zip(&rows.columns) {
        let index = recording.header.index_of(&spec.name).expect("a channel");
        assert_eq!(column, &recording.columns[index], "{}", spec.name);
    }
}

/// Root mean square of what the torques are apart, of all by which rapier's swing.
fn apart(ours: &Rows, theirs: &Rows) -> f64 {
    let rms = |x: &dyn Fn(usize, usize) -> f64| {
        let squares = (0..2).flat_map(|c| (0..ours.time_s.len()).map(move |i| (c, i)));
        let sum: f64 = squares.map(|(c, i)| x(c, i).powi(2)).sum();
        (sum / ours.time_s.len() as f64).sqrt()
    };
    for (a, b) in ours.time_s.iter().zip(&theirs.time_s) {
        assert!((a - b).abs() < 1e-9);
    }
    let difference = rms(&|c, i| ours.columns[c][i] - theirs.columns[c][i]);
    difference / rms(&|c, i| theirs.columns[c][i])
}

/// Parts of the torque by which the reduced plant errs at steps of 0.8 and 0.4 ms, and at its own
/// default step.
fn errors(effects: &[Effect]) -> [f64; 3] {
    let scenario = scenario().with_effects(effects).unwrap();
    let theirs = run(&scenario, Engine::Rapier, Some(0.02));
    let errors = [Some(0.8), Some(0.4), None].map(|step| {
        let ours = run(&scenario, Engine::REDUCED, step);
        apart(&ours, &theirs)
    });
    println!("{errors:?}");
    errors
}

#[test]
fn regress_a_travelling_arm_is_met_to_a_ten_thousandth() {
    let [coarse, fine, own] = errors(&[]);
    assert!(own < 2e-4 && coarse < 2e-4 && fine < 0.4 * coarse);
}

/// The flanks meet within a step; second order in the step all the same.
#[test]
fn regress_play_of_a_travelling_arm_is_met_to_second_order() {
    let play = Effect {
        kind: EffectKind::JointBacklash,
        target: Target::Joint(1),
        values: vec![1.2e-3],
    };
    let [coarse, fine, own] = errors(std::slice::from_ref(&play));
    assert!(coarse < 2e-3 && fine < 0.4 * coarse);
    // Steps are a whole part of the 4 ms from record to record. Without play there are five, of 0.8
    // ms, the longest; play asks for forty in a period of the faster mode, which takes seven.
    let steps = |effects: &[Effect]| {
        let scenario = scenario().with_effects(effects).unwrap();
        let run = Run {
            measured: Some(&measured()),
            engine: Engine::REDUCED,
            ..Run::of(&scenario)
        };
        let step_s = run.time_step_s().unwrap();
        1.0 / (RATE_HZ * step_s)
    };
    let [without, with] = [steps(&[]), steps(&[play])];
    assert!((without - 5.0).abs() < 1e-6 && (with - 7.0).abs() < 1e-6);
    assert!(own < 1e-3);
}

/// A base so stiff that its mode has some five steps in a period: the recurrence is exact for it.
#[test]
fn regress_a_stiff_base_needs_no_shorter_step() {
    let base = Effect {
        kind: EffectKind::BaseCompliance,
        target: Target::Axis(1),
        values: vec![1e-7],
    };
    let [coarse, fine, own] = errors(&[base]);
    assert!(own < 2e-4 && coarse < 2e-4 && fine < 0.4 * coarse);
}
