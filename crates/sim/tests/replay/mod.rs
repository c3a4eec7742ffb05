//! Replays against closed forms: measured inputs in, motion out, and back.

mod inverse;
mod refusals;
mod sensors;
mod servo;

use std::f64::consts::TAU;
use std::path::Path;

use truecut_recording::{
    ChannelSpec, Measured, MeasuredChannel, Outcome, Recording, Role, Unit, UnknownName,
};
use truecut_scenario::Scenario;
use truecut_sim::InverseModel;
use truecut_sim::run::Run;

const MASS_KG: f64 = 95.1;

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
