//! Replays against closed forms: measured inputs in, motion out, and back.

use std::f64::consts::TAU;
use std::path::Path;
use truecut_recording::{
    ChannelSpec, Measured, MeasuredChannel, Outcome, Recording, Role, Unit, UnknownName,
};
use truecut_scenario::Scenario;
use truecut_scenario::effect::{Effect, EffectKind, Target};
use truecut_sim::InverseModel;
use truecut_sim::run::Run;

const MASS_KG: f64 = 95.1;
const GAIN_N_S_PER_M: f64 = 9385.0;
const POSITION_GAIN_PER_S: f64 = 160.0;

fn scenario(drive: &str, mode: &str, extra: &str) -> Scenario {
    let text = format!(
        r#"
name = "test"
[robot]
urdf = "../../assets/robots/emps/robot.urdf"
gravity = false
drive = "{drive}"
[process.replay]
mode = "{mode}"
[data]
time = "t"
[[data.channel]]
column = "a"
channel = "joint1.command"
unit = "m"
role = "input"
{extra}"#
    );
    let at = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios/replay/of_a_test.toml");
    Scenario::from_str(&at, &text, &[]).unwrap_or_else(|error| panic!("{error:?}"))
}

fn data(rate_hz: f64, samples: usize, channels: Vec<(&str, Unit, Role, Vec<f64>)>) -> Measured {
    Measured {
        source: "made".into(),
        time_s: (0..samples).map(|k| k as f64 / rate_hz).collect(),
        channels: channels
            .into_iter()
            .map(|(name, unit, role, values)| MeasuredChannel {
                spec: ChannelSpec::new(name, unit, ""),
                role,
                valid: vec![true; values.len()],
                values,
                noise: None,
                white_kept: 1.0,
            })
            .collect(),
        notes: Vec::new(),
        ..Measured::default()
    }
}

fn wave(rate_hz: f64, samples: usize, law: impl Fn(f64) -> f64) -> Vec<f64> {
    (0..samples).map(|k| law(k as f64 / rate_hz)).collect()
}

/// A command of the joint at 1 kHz.
fn commanded(samples: usize, law: impl Fn(f64) -> f64) -> Measured {
    let values = wave(1000.0, samples, law);
    let channel = ("joint1.command", Unit::Metre, Role::Input, values);
    data(1000.0, samples, vec![channel])
}

fn run(scenario: &Scenario, measured: &Measured) -> Recording {
    let run = Run {
        measured: Some(measured),
        ..Run::of(scenario)
    };
    let recording = run.execute().unwrap_or_else(|e| panic!("{e}")).recording;
    assert_eq!(recording.outcome, Outcome::Completed);
    recording
}

/// Rise of the command: smooth, so that the start is at rest.
fn command(t: f64) -> f64 {
    0.02 * (1.0 - (TAU * 1.5 * t).cos())
}

/// Motion of the mass under the servo: both feed-forward shares, exact from the transfer function
/// in the steady state. `m q'' + k_v q' + k_v k_p q = k_v (k_p c + f c')`.
fn steady_state(t: f64, feed_forward: f64) -> f64 {
    let w = TAU * 1.5;
    let k = GAIN_N_S_PER_M * POSITION_GAIN_PER_S;
    let (re, im) = (k - MASS_KG * w * w, GAIN_N_S_PER_M * w);
    let (nre, nim) = (k, feed_forward * GAIN_N_S_PER_M * w);
    let norm = re * re + im * im;
    let (gre, gim) = ((nre * re + nim * im) / norm, (nim * re - nre * im) / norm);
    0.02 - 0.02 * (gre * (w * t).cos() - gim * (w * t).sin())
}

#[test]
fn verify_rigid_servo_follows_its_transfer_function_to_second_order() {
    let measured = commanded(2001, command);
    let error = |step_ms: f64| {
        let scenario = scenario("servo", "forward", "");
        let step = [("run.time_step_ms".to_owned(), step_ms.to_string())];
        let recording = run(&scenario.with_overrides(&step).unwrap(), &measured);
        let times = wave(1000.0, 500, |t| 1.0 + t);
        let got = sample_at(&recording, "joint1.position", &times).unwrap();
        let errors = times
            .iter()
            .zip(&got)
            .map(|(t, q)| (q - steady_state(*t, 0.0)).abs());
        errors.fold(0.0, f64::max)
    };
    let (coarse, fine) = (error(2.0), error(1.0));
    assert!(coarse < 2e-5 && fine < 5e-6, "{coarse} {fine}");
    assert!(
        (3.5..4.5).contains(&(coarse / fine)),
        "order: {coarse} / {fine}"
    );
}

/// What the servo exerts is what the motion needs, also in the recording.
#[test]
fn verify_recorded_drive_force_moves_the_mass() {
    let measured = commanded(1501, command);
    let recording = run(&scenario("servo", "forward", ""), &measured);
    let force = recording.channel("joint1.drive_force").unwrap();
    let velocity = recording.channel("joint1.velocity").unwrap();
    let dt = recording.time_s[1] - recording.time_s[0];
    for k in 1..velocity.len() - 1 {
        let needed = MASS_KG * (velocity[k + 1] - velocity[k - 1]) / (2.0 * dt);
        assert!(
            (force[k] - needed).abs() < 0.3,
            "{k}: {} beside {needed}",
            force[k]
        );
    }
}

/// Beyond its limit the servo is a constant force: the mass starts with limit / mass.
#[test]
fn verify_saturated_servo_accelerates_uniformly() {
    let step = |t: f64| if t < 0.002 { 0.0 } else { 0.02 };
    let measured = commanded(301, step);
    let recording = run(&scenario("servo", "forward", ""), &measured);
    let velocity = recording.channel("joint1.velocity").unwrap();
    let force = recording.channel("joint1.drive_force").unwrap();
    let at = |t: f64| {
        recording
            .time_s
            .iter()
            .position(|x| *x >= t - 1e-9)
            .unwrap()
    };
    let (a, b) = (at(0.010), at(0.050));
    assert!(force[a..b].iter().all(|f| *f == 351.5));
    let slope = (velocity[b] - velocity[a]) / (recording.time_s[b] - recording.time_s[a]);
    assert!((slope * MASS_KG / 351.5 - 1.0).abs() < 1e-3, "{slope}");
}

/// A force drive gives the mass the measured force: F sin wt moves it by F/(m w) (t - sin(wt)/w).
#[test]
fn verify_measured_drive_force_moves_a_free_mass() {
    let (force, w) = (30.0, TAU * 2.0);
    let measured = data(
        2000.0,
        2001,
        vec![(
            "joint1.drive_force",
            Unit::Newton,
            Role::Input,
            wave(2000.0, 2001, |t| force * (w * t).sin()),
        )],
    );
    let recording = run(&scenario("force", "forward", ""), &measured);
    let position = recording.channel("joint1.position").unwrap();
    for (t, q) in recording.time_s.iter().zip(position) {
        let exact = force / (MASS_KG * w) * (t - (w * t).sin() / w);
        assert!((q - exact).abs() < 2e-6, "{t}: {q} beside {exact}");
    }
}

/// Forward and inverse are the same mechanics: the recorded motion asks for the recorded force.
#[test]
fn inverse_dynamics_give_back_the_force_of_a_forward_run() {
    let on_joint = |kind: EffectKind, values: &[f64]| Effect {
        kind,
        target: Target::Joint(0),
        values: values.to_vec(),
    };
    gives_back(&[], 0.1);
    // The instant of a reversal is known to a sample: dry friction F that turns there leaves an
    // impulse of up to F ms, which the filter of 30 Hz spreads.
    let pressed = on_joint(EffectKind::JointLoadFriction, &[0.1]);
    gives_back(std::slice::from_ref(&pressed), 1.0);
    gives_back(
        &[
            pressed,
            on_joint(EffectKind::JointCoulomb, &[20.0]),
            on_joint(EffectKind::JointViscous, &[200.0]),
            on_joint(EffectKind::JointOffset, &[5.0]),
        ],
        4.0,
    );
}

/// To `most_n` in the middle of the run.
fn gives_back(effects: &[Effect], most_n: f64) {
    let measured = commanded(2001, command);
    let mut forward = scenario("servo", "forward", "");
    forward.effects = effects.to_vec();
    let recording = run(&forward, &measured);
    let at = |name: &str| sample_at(&recording, name, &measured.time_s).unwrap();
    let moved = data(
        1000.0,
        2001,
        vec![
            (
                "joint1.position",
                Unit::Metre,
                Role::Input,
                at("joint1.position"),
            ),
            (
                "joint1.drive_force",
                Unit::Newton,
                Role::Output,
                at("joint1.drive_force"),
            ),
        ],
    );
    let cutoffs = [
        (
            "process.replay.differentiate_cutoff_hz".to_owned(),
            "60".to_owned(),
        ),
        (
            "process.replay.compare_cutoff_hz".to_owned(),
            "30".to_owned(),
        ),
    ];
    let inverse = scenario("position", "inverse", "")
        .with_overrides(&cutoffs)
        .unwrap();
    let model = InverseModel::new(&inverse, &moved).unwrap_or_else(|e| panic!("{e}"));
    let predicted = model.predict(effects).unwrap();
    let measured = &model.measured().channels[0].values;
    for k in 200..1800 {
        let error = (predicted[0][k] - measured[k]).abs();
        assert!(error < most_n, "{k}: {error} N of {}", measured[k]);
    }
}

/// Every effect on a joint changes the drive force by its own law.
#[test]
fn verify_effects_change_the_drive_force_by_their_law() {
    let n = 1201;
    let motion = |t: f64| 0.1 + 0.05 * (TAU * 0.8 * t).sin();
    let measured = data(
        400.0,
        n,
        vec![
            (
                "joint1.position",
                Unit::Metre,
                Role::Input,
                wave(400.0, n, motion),
            ),
            (
                "joint1.drive_force",
                Unit::Newton,
                Role::Output,
                wave(400.0, n, motion),
            ),
        ],
    );
    let model = InverseModel::new(&scenario("position", "inverse", ""), &measured).unwrap();
    let nominal = model.predict(&[]).unwrap();
    // In the middle of the stroke, both ways.
    let (forth, back) = (500, 750);
    let speed = 0.05 * TAU * 0.8;
    let cases: [(EffectKind, &[f64], f64, f64); 6] = [
        (
            EffectKind::JointViscous,
            &[200.0],
            200.0 * speed,
            -200.0 * speed,
        ),
        (EffectKind::JointCoulomb, &[20.0], 20.0, -20.0),
        (
            EffectKind::JointAsymmetricViscous,
            &[200.0, 100.0],
            200.0 * speed,
            -100.0 * speed,
        ),
        (
            EffectKind::JointAsymmetricCoulomb,
            &[20.0, 10.0],
            20.0,
            -10.0,
        ),
        (EffectKind::JointOffset, &[3.0], -3.0, -3.0),
        (EffectKind::JointStribeck, &[5.0, 1e9], 5.0, -5.0),
    ];
    for (kind, values, up, down) in cases {
        let effect = Effect {
            kind,
            target: Target::Joint(0),
            values: values.to_vec(),
        };
        let with = model.predict(&[effect]).unwrap();
        let change = |k: usize| with[0][k] - nominal[0][k];
        let scale = up.abs();
        assert!(
            (change(forth) - up).abs() < 0.03 * scale,
            "{kind:?} {}",
            change(forth)
        );
        assert!(
            (change(back) - down).abs() < 0.03 * scale,
            "{kind:?} {}",
            change(back)
        );
    }
    let payload = Effect {
        kind: EffectKind::Payload,
        target: Target::Whole,
        values: vec![MASS_KG, 0.0, 0.1, 0.0],
    };
    let doubled = model.predict(&[payload]).unwrap();
    for (one, two) in nominal[0].iter().zip(&doubled[0]) {
        assert!(
            (two - 2.0 * one).abs() < 1e-9,
            "twice the mass takes twice the force"
        );
    }
}

/// A motion f times as fast takes f² times the force of a mass, and f times that of a damper.
#[test]
fn verify_forces_under_a_clock_that_runs_fast() {
    let model = swinging_mass();
    let one = |kind, target, value: f64| Effect {
        kind,
        target,
        values: vec![value],
    };
    let viscous = one(EffectKind::JointViscous, Target::Joint(0), 200.0);
    let factor = 1.02;
    let rate = one(EffectKind::ClockRate, Target::Whole, factor);
    let [plain, damped] =
        [vec![], vec![viscous.clone()]].map(|all| model.predict(&all).unwrap().remove(0));
    let found = model.predict(&[rate, viscous]).unwrap().remove(0);
    for ((plain, damped), found) in plain.iter().zip(&damped).zip(&found) {
        let expected = factor * factor * plain + factor * (damped - plain);
        assert!((found - expected).abs() < 1e-9, "{found} {expected}");
    }
}

/// A mass that swings at 0.8 Hz, 801 samples at 400 Hz.
fn swinging_mass() -> InverseModel {
    let motion = |t: f64| 0.1 + 0.05 * (TAU * 0.8 * t).sin();
    let channel = |name, role| (name, Unit::Metre, role, wave(400.0, 801, motion));
    let mut force = channel("joint1.drive_force", Role::Output);
    force.1 = Unit::Newton;
    let measured = data(
        400.0,
        801,
        vec![channel("joint1.position", Role::Input), force],
    );
    InverseModel::new(&scenario("position", "inverse", ""), &measured).unwrap()
}

/// States without an order are read by a sensor that is late like any others, be they more or fewer
/// than the samples of the data.
#[test]
fn verify_a_late_sensor_reads_unrelated_states() {
    let model = swinging_mass();
    // by one interval of the data
    let late = Effect {
        kind: EffectKind::SensorDelay,
        target: Target::Channel("joint1.drive_force".into()),
        values: vec![1.0 / 400.0],
    };
    for states in [150, 2000] {
        let model = model.in_any_state(states);
        let [prompt, late] =
            [vec![], vec![late.clone()]].map(|effects| model.predict(&effects).unwrap().remove(0));
        assert_eq!([prompt.len(), late.len()], [states, states]);
        for (before, after) in prompt.iter().zip(&late[1..]) {
            assert!((before - after).abs() < 1e-6 * before.abs().max(1.0));
        }
    }
}

/// A sensor's gain, offset and the rest act in one order, whatever the order of the entries.
#[test]
fn verify_a_sensor_is_the_same_in_any_order_of_its_effects() {
    let model = swinging_mass();
    let sensor = |kind, value| Effect {
        kind,
        target: Target::Channel("joint1.drive_force".into()),
        values: vec![value],
    };
    let gain = sensor(EffectKind::SensorGain, 1.25);
    let offset = sensor(EffectKind::SensorOffset, 8.0);
    let nominal = model.predict(&[]).unwrap();
    for effects in [[gain.clone(), offset.clone()], [offset, gain]] {
        let predicted = model.predict(&effects).unwrap();
        for (got, force) in predicted[0].iter().zip(&nominal[0]) {
            assert!((got - (1.25 * force + 8.0)).abs() < 1e-9, "{got} {force}");
        }
    }
}

fn refusal(scenario: &Scenario, measured: &Measured) -> String {
    let run = Run {
        measured: Some(measured),
        ..Run::of(scenario)
    };
    run.rows(&[], None)
        .expect_err("must be refused")
        .to_string()
}

#[test]
fn inputs_that_do_not_fit_are_refused_with_their_place() {
    let forward = scenario("servo", "forward", "");
    let made = |name: &str, unit, values: Vec<f64>| {
        data(1000.0, 300, vec![(name, unit, Role::Input, values)])
    };
    let text = refusal(
        &forward,
        &made("joint1.command", Unit::Radian, vec![0.0; 300]),
    );
    assert!(
        text.starts_with("`data.channel.0.channel`") && text.contains("must be one of m"),
        "{text}"
    );
    let text = refusal(
        &forward,
        &made("joint1.comand", Unit::Metre, vec![0.0; 300]),
    );
    assert!(text.contains("did you mean \"joint1.command\"?"), "{text}");
    let text = refusal(
        &forward,
        &made("joint1.command", Unit::Metre, vec![2.0; 300]),
    );
    assert!(text.contains("is the column's unit right?"), "{text}");
    let mut gap = made("joint1.command", Unit::Metre, vec![0.0; 300]);
    gap.channels[0].valid[100..140].fill(false);
    let text = refusal(&forward, &gap);
    assert!(
        text.contains("no measurement from 0.100 s to 0.139 s (40 samples)"),
        "{text}"
    );
    let without = Run::of(&forward).rows(&[], None);
    let text = without.expect_err("no data").to_string();
    assert!(text.contains("a replay needs its measured data"), "{text}");
    let longer = [("run.duration_s".to_owned(), "5".to_owned())];
    let longer = forward.with_overrides(&longer).unwrap();
    let text = refusal(
        &longer,
        &made("joint1.command", Unit::Metre, vec![0.0; 300]),
    );
    assert!(
        text.contains("is 5 s, but the data takes 0.2990 s"),
        "{text}"
    );
    let text = refusal(&scenario("servo", "inverse", ""), &gap);
    assert!(text.contains("has no plant to run"), "{text}");
}

#[test]
fn the_robots_of_the_replays_load() {
    let assets = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets/robots");
    for name in ["emps", "ur10e"] {
        truecut_arm::Robot::load(&assets.join(name).join("robot.urdf"), None, None)
            .unwrap_or_else(|error| panic!("{error}"));
    }
}

/// A channel of a recording at other times, by cubic interpolation between its rows; NaN outside
/// the recording, as after a run that diverged.
fn sample_at(
    recording: &Recording,
    channel: &str,
    time_s: &[f64],
) -> Result<Vec<f64>, UnknownName> {
    let values = recording.channel(channel)?;
    let rows = &recording.time_s;
    let mut from = 0;
    let at = |&t: &f64| {
        let last = rows.len().saturating_sub(1);
        let slack = 1e-9 * t.abs().max(1e-3);
        if rows.is_empty() || t < rows[0] - slack || t > rows[last] + slack {
            return f64::NAN;
        }
        while from + 1 < last && rows[from + 1] <= t {
            from += 1;
        }
        let start = from.saturating_sub(1).min(rows.len().saturating_sub(4));
        let end = (start + 4).min(rows.len());
        lagrange(&rows[start..end], &values[start..end], t)
    };
    Ok(time_s.iter().map(at).collect())
}

/// The polynomial through the points.
fn lagrange(x: &[f64], y: &[f64], at: f64) -> f64 {
    (0..x.len())
        .map(|i| {
            let others = (0..x.len()).filter(|j| *j != i);
            y[i] * others.map(|j| (at - x[j]) / (x[i] - x[j])).product::<f64>()
        })
        .sum()
}
