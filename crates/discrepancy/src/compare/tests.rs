//! Known differences are found in noise of every colour.

use super::*;
use crate::testing::{Colour, noise};
use std::f64::consts::TAU;
use truecut_recording::ChannelSpec;

mod bias;
mod delays;
mod exchanged;
mod whole;

const SAMPLES: usize = 4000;
const INTERVAL_S: f64 = 2.5e-3;
const COLOURS: [Colour; 3] = [Colour::White, Colour::Ar1(0.9), Colour::Pink];

fn times() -> Vec<f64> {
    (0..SAMPLES).map(|row| row as f64 * INTERVAL_S).collect()
}

fn of_time(law: impl Fn(f64) -> f64) -> Vec<f64> {
    times().into_iter().map(law).collect()
}

fn sum(parts: &[&[f64]]) -> Vec<f64> {
    (0..SAMPLES)
        .map(|row| parts.iter().map(|part| part[row]).sum())
        .collect()
}

/// Compares with gaps: a tenth of the record is invalid.
fn compared(
    measured: &[f64],
    simulated: &[f64],
    explanatory: &[Explanatory],
) -> Result<ChannelComparison, CompareError> {
    let spec = ChannelSpec::new("joint1.angle", Unit::Radian, "");
    let valid: Vec<bool> = (0..SAMPLES)
        .map(|row| row % 1000 < 450 || row % 1000 >= 550)
        .collect();
    let pair = Pair {
        spec: &spec,
        measured,
        valid: &valid,
        simulated,
        noise: None,
    };
    compare_channel(
        &pair,
        &Setting {
            interval_s: INTERVAL_S,
            explanatory,
            spindle_hz: Some(5.0),
        },
    )
}

fn signal(name: &str, kind: Kind, values: Vec<f64>) -> Explanatory {
    Explanatory {
        spec: ChannelSpec::new(name, Unit::One, ""),
        kind,
        values,
    }
}

/// A tenth of a sample and a gain of 2 % off, and 3.7 samples late: both within four standard
/// errors, and these are small.
#[test]
fn verify_delay_and_gain_are_found_below_a_sample() {
    for colour in COLOURS {
        for delay_s in [0.1 * INTERVAL_S, 3.7 * INTERVAL_S, -2.25 * INTERVAL_S] {
            let law = |t: f64| 30.0 * (TAU * 0.7 * t).sin() + 15.0 * (TAU * 2.3 * t).sin();
            let late = of_time(|t| 1.02 * law(t - delay_s) + 0.4);
            let measured = sum(&[&late, &noise(colour, SAMPLES, 7)]);
            let found = compared(&measured, &of_time(law), &[])
                .unwrap()
                .alignment
                .unwrap();
            let delay = found.delay_s;
            assert!(
                (delay.value - delay_s).abs() < 4.0 * delay.standard_error,
                "{found:?}"
            );
            assert!(delay.standard_error < 0.6 * INTERVAL_S, "{found:?}");
            assert!(
                (found.gain.value - 1.02).abs() < 4.0 * found.gain.standard_error,
                "{found:?}"
            );
        }
    }
}

/// A missing line at order 1, an extra one at order 3, and one at no order of rotation.
#[test]
fn verify_lines_are_found_with_place_amplitude_and_lock() {
    let motion = of_time(|t| 30.0 * (TAU * 0.4 * t).sin());
    for colour in COLOURS {
        let missing = of_time(|t| 2.0 * (TAU * 5.0 * t + 1.0).sin() + 1.5 * (TAU * 62.3 * t).cos());
        let extra = of_time(|t| 2.5 * (TAU * 15.0 * t).sin());
        let measured = sum(&[&motion, &missing, &noise(colour, SAMPLES, 11)]);
        let found = compared(&measured, &sum(&[&motion, &extra]), &[])
            .unwrap()
            .lines;
        let expected = [
            (5.0, 2.0, LineKind::Missing, Some(1)),
            (15.0, 2.5, LineKind::Extra, Some(3)),
            (62.3, 1.5, LineKind::Missing, None),
        ];
        assert_eq!(found.len(), 3, "{colour:?}: {found:#?}");
        for (frequency_hz, amplitude, kind, order) in expected {
            let near = |line: &&SpectralLine| (line.frequency_hz - frequency_hz).abs() < 0.05;
            let line = found.iter().find(near).unwrap();
            assert_eq!(
                (line.kind, line.per_revolution),
                (kind, order),
                "{colour:?}"
            );
            assert!(
                (line.residual / amplitude - 1.0).abs() < 0.25,
                "{colour:?}: {line:?}"
            );
        }
    }
}

/// A residual that follows the sign of velocity, amid positions, loads, time and phase that it does
/// not follow: found first, with the true difference of its means.
#[test]
fn verify_a_force_that_changes_with_the_sign_of_velocity_is_found() {
    let velocity = of_time(|t| (TAU * 0.9 * t).sin() + 0.5 * (TAU * 0.37 * t).cos());
    let friction: Vec<f64> = velocity.iter().map(|v| 1.5 * v.signum()).collect();
    let explanatory = [
        signal(
            "position",
            Kind::Position,
            of_time(|t| (TAU * 0.9 * t).cos()),
        ),
        signal("velocity", Kind::Velocity, velocity.clone()),
        signal("load", Kind::Load, noise(Colour::Ar1(0.99), SAMPLES, 3)),
        signal("spindle", Kind::SpindlePhase, of_time(|t| TAU * 5.0 * t)),
        signal("time", Kind::Time, times()),
    ];
    let simulated = of_time(|t| 20.0 * (TAU * 0.9 * t).cos());
    for colour in COLOURS {
        let measured = sum(&[&simulated, &friction, &noise(colour, SAMPLES, 5)]);
        let found = compared(&measured, &simulated, &explanatory)
            .unwrap()
            .dependence;
        assert_eq!(found[0].kind, Kind::Velocity, "{colour:?}: {found:#?}");
        assert!(found[0].p_value < 1e-3, "{colour:?}: {}", found[0].p_value);
        let [backward, forward] = [0, 1].map(|bin| found[0].bins[bin]);
        let error = backward.standard_error + forward.standard_error;
        assert!(
            (forward.mean - backward.mean - 3.0).abs() < 4.0 * error,
            "{:?}",
            found[0].bins
        );
        let others = &found[1..];
        let silent = ["load", "spindle", "time"].map(|name| {
            others
                .iter()
                .find(|one| one.signal == name)
                .unwrap()
                .p_value
                > LEVEL
        });
        assert_eq!(silent, [true; 3], "{colour:?}: {found:#?}");
    }
}

/// Drift, and a force that follows the load.
#[test]
fn verify_drift_and_dependence_on_load_are_found() {
    let load = noise(Colour::Ar1(0.99), SAMPLES, 3);
    let explanatory = [
        signal("load", Kind::Load, load.clone()),
        signal("time", Kind::Time, times()),
    ];
    let simulated = of_time(|t| 20.0 * (TAU * 0.9 * t).cos());
    let by_load: Vec<f64> = load.iter().map(|load| 0.3 * load).collect();
    let measured = sum(&[&simulated, &by_load, &noise(Colour::White, SAMPLES, 5)]);
    let found = compared(&measured, &simulated, &explanatory).unwrap();
    assert_eq!(
        found.dependence[0].kind,
        Kind::Load,
        "{:#?}",
        found.dependence
    );
    assert!(
        found.dependence[0].p_value < LEVEL,
        "{:#?}",
        found.dependence
    );
    assert!(
        found.inputs[0].signal == "load" && found.inputs[0].p_value < LEVEL,
        "{:?}",
        found.inputs
    );
    assert_eq!(found.inputs[0].delay_s, 0.0);
    let drift = of_time(|t| 3.0 * (TAU * t / 20.0).sin());
    let measured = sum(&[&simulated, &drift, &noise(Colour::White, SAMPLES, 5)]);
    let found = compared(&measured, &simulated, &explanatory).unwrap();
    assert_eq!(found.dependence[0].kind, Kind::Time);
    assert!(
        found.dependence[0].p_value < 0.05,
        "{:#?}",
        found.dependence
    );
}

/// Measured half noise in one band, all of the simulation in another.
#[test]
fn verify_coherence_by_band() {
    let simulated = noise(Colour::White, SAMPLES, 21);
    let measured = sum(&[&simulated, &noise(Colour::White, SAMPLES, 22)]);
    let bands = compared(&measured, &simulated, &[]).unwrap().coherence;
    let upper = bands.last().unwrap();
    assert!((upper.coherence - 0.5).abs() < 0.06, "{bands:#?}");
    assert!((bands.iter().map(|band| band.power_share).sum::<f64>() - 1.0).abs() < 0.01);
    assert!((upper.to_hz - 200.0).abs() < 1e-9);
}

/// A constant offset, in units of what is known of the noise; sizes by hand.
#[test]
fn verify_sizes_of_a_known_residual() {
    let simulated = of_time(|t| 3.0 * (TAU * 0.9 * t).sin());
    let measured: Vec<f64> = simulated.iter().map(|s| s + 0.5).collect();
    let spec = ChannelSpec::new("x", Unit::One, "");
    let valid = [true; SAMPLES];
    let pair = Pair {
        spec: &spec,
        measured: &measured,
        valid: &valid,
        simulated: &simulated,
        noise: Some(0.25),
    };
    let setting = Setting {
        interval_s: INTERVAL_S,
        explanatory: &[],
        spindle_hz: None,
    };
    let level = compare_channel(&pair, &setting).unwrap().level;
    assert!((level.rms_error - 0.5).abs() < 1e-12 && (level.bias.value - 0.5).abs() < 1e-12);
    assert!((level.nrmse - 0.5 / 6.0).abs() < 1e-6);
    assert!((level.relative_rms_error - 0.5 / (4.5_f64 + 0.25).sqrt()).abs() < 1e-3);
    assert!((level.error_over_noise.unwrap() - 2.0).abs() < 1e-12);
    assert!(level.bias.p_value < 1e-6, "{level:?}");
    // Identical channels do not differ.
    let pair = Pair {
        measured: &simulated,
        ..pair
    };
    let same = compare_channel(&pair, &setting).unwrap();
    assert_eq!((same.level.rms_error, same.level.bias.p_value), (0.0, 1.0));
    assert!(
        same.lines.is_empty() && same.whiteness.is_none(),
        "{same:?}"
    );
}

#[test]
fn a_wrong_unit_is_named_and_a_poor_model_is_not() {
    let simulated = of_time(|t| (TAU * 0.9 * t).sin() + 0.3 * (TAU * 2.9 * t).cos());
    let noise = noise(Colour::White, SAMPLES, 2);
    let scaled = |factor: f64| -> Vec<f64> {
        simulated
            .iter()
            .zip(&noise)
            .map(|(s, n)| factor * (s + 0.1 * n) + 4.0)
            .collect()
    };
    for (written, expected) in [
        (1000.0, 1e-3),
        (0.01, 100.0),
        (360.0 / TAU, TAU / 360.0),
        (60.0 / TAU, TAU / 60.0),
        (1.0 / 9.806_65, 9.806_65),
        (1.0 / TAU, TAU),
        (-1.0, -1.0),
    ] {
        match compared(&scaled(written), &simulated, &[]) {
            Err(CompareError::Unit { suspicion, .. }) => {
                assert!(
                    (suspicion.factor / expected - 1.0).abs() < 1e-12,
                    "{written}: {suspicion:?}"
                );
            }
            other => panic!("{written}: {other:?}"),
        }
    }
    for poor in [0.5, 1.0, 2.0, 2.5] {
        assert!(compared(&scaled(poor), &simulated, &[]).is_ok(), "{poor}");
    }
    // A gain of 3.4 is not newtons taken for pounds of force, which would be 4.45.
    let rows = simulated.iter().zip(&noise);
    let gained: Vec<f64> = rows.map(|(s, n)| 3.4 * (s + 0.02 * n)).collect();
    assert!(compared(&gained, &simulated, &[]).is_ok());
    // Unrelated channels: no factor helps.
    assert!(compared(&noise, &simulated, &[]).is_ok());
}

#[test]
fn what_cannot_be_compared_is_refused() {
    let simulated = of_time(|t| (TAU * 0.9 * t).sin());
    let error = |measured: &[f64], simulated: &[f64]| {
        compared(measured, simulated, &[]).unwrap_err().to_string()
    };
    assert_eq!(
        error(&[0.25; SAMPLES], &simulated),
        "channel \"joint1.angle\" never changes: it is 0.2500 rad throughout; check the column"
    );
    let mut broken = simulated.clone();
    broken[7] = f64::NAN;
    assert_eq!(
        error(&simulated, &broken),
        "channel \"joint1.angle\": a simulated value is not finite"
    );
    let spec = ChannelSpec::new("x", Unit::One, "");
    let pair = Pair {
        spec: &spec,
        measured: &simulated,
        valid: &[false; SAMPLES],
        simulated: &simulated,
        noise: None,
    };
    let setting = Setting {
        interval_s: 1.0,
        explanatory: &[],
        spindle_hz: None,
    };
    assert!(matches!(
        compare_channel(&pair, &setting),
        Err(CompareError::TooFew { counted: 0, .. })
    ));
}
