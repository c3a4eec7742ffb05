//! False-alarm rates of the tests on pure noise of each colour, many seeds.

use super::*;
use crate::stats::welch;
use crate::testing::{Colour, noise};
use truecut_recording::ChannelSpec;

const SAMPLES: usize = 4096;
const ALL: [bool; SAMPLES] = [true; SAMPLES];
const RECORDS: u64 = 500;

/// At nominal 5 % and 1 %: the nominal rate, and three standard errors of a rate found in so many
/// records.
const MOST: [f64; 2] = [0.079, 0.0233];

fn signal(name: &str, kind: Kind, values: Vec<f64>) -> Explanatory {
    let spec = ChannelSpec::new(name, Unit::One, "");
    Explanatory { spec, kind, values }
}

fn wave(period: f64) -> Vec<f64> {
    let turn = std::f64::consts::TAU / period;
    (0..SAMPLES).map(|row| (turn * row as f64).sin()).collect()
}

fn signals() -> Vec<Explanatory> {
    let rows = |step: f64| (0..SAMPLES).map(|row| step * row as f64).collect();
    vec![
        signal("time", Kind::Time, rows(1.0)),
        signal("slow position", Kind::Position, wave(1500.0)),
        signal("fast position", Kind::Position, wave(90.0)),
        signal("velocity", Kind::Velocity, wave(400.0)),
        signal("phase", Kind::SpindlePhase, rows(0.31)),
        signal(
            "load, AR(1)",
            Kind::Load,
            noise(Colour::Ar1(0.9), SAMPLES, 99_999),
        ),
        signal(
            "load, 1/f",
            Kind::Load,
            noise(Colour::Pink, SAMPLES, 99_999),
        ),
    ]
}

/// Every test on one record of noise: name and p-value.
fn p_values(values: &[f64], signals: &[Explanatory]) -> Vec<(String, f64)> {
    let background = Background::of(values, &ALL).unwrap();
    let spec = ChannelSpec::new("x", Unit::One, "");
    let nothing = [0.0; SAMPLES];
    let pair = Pair {
        spec: &spec,
        measured: values,
        valid: &ALL,
        simulated: &nothing,
        noise: None,
    };
    let mut found = vec![(
        "bias".to_owned(),
        level(&pair, values, Some(&background)).bias.p_value,
    )];
    for signal in signals {
        let name = &signal.spec.name;
        let test = dependence(values, &ALL, signal).unwrap();
        found.push((format!("mean over {name}"), test.p_value));
        if !matches!(signal.kind, Kind::Time | Kind::SpindlePhase) {
            let test = input_correlation(values, &ALL, name, &signal.values, 1.0);
            found.push((format!("correlation with {name}"), test.unwrap().p_value));
        }
    }
    let periodogram = welch(values, &ALL, SAMPLES / 4).unwrap();
    let lines = lines::line_p_values(&periodogram, &Background::fit(&periodogram).unwrap());
    found.push(("lines".to_owned(), lines.into_iter().fold(1.0, f64::min)));
    let colour = whiteness(values, &ALL, &background).unwrap();
    found.push(("whiteness, whitened".to_owned(), colour.p_whitened));
    found.push(("whiteness, raw".to_owned(), colour.p_raw));
    let simulated: Vec<f64> = wave(300.0).iter().map(|s| 20.0 * s).collect();
    let measured: Vec<f64> = values.iter().zip(&simulated).map(|(n, s)| n + s).collect();
    let pair = Pair {
        measured: &measured,
        simulated: &simulated,
        ..pair
    };
    let setting = Setting {
        interval_s: 1.0,
        explanatory: signals,
        spindle_hz: None,
    };
    let aligned = align(&pair, &setting).unwrap();
    found.push(("delay".to_owned(), aligned.delay_s.p_value));
    found.push(("gain".to_owned(), aligned.gain.p_value));
    found
}

fn check(colour: Colour, left_out: &str) {
    let signals = signals();
    let records: Vec<Vec<(String, f64)>> = (0..RECORDS)
        .map(|seed| p_values(&noise(colour, SAMPLES, seed), &signals))
        .collect();
    let mut wrong = Vec::new();
    for test in 0..records[0].len() {
        let name = &records[0][test].0;
        let rate = |level: f64| {
            let alarms = records
                .iter()
                .filter(|record| record[test].1 < level)
                .count();
            alarms as f64 / RECORDS as f64
        };
        let rates = [rate(0.05), rate(0.01)];
        println!(
            "{colour:?}, {name}: {:.1} % and {:.1} %",
            100.0 * rates[0],
            100.0 * rates[1]
        );
        if name != left_out && (rates[0] > MOST[0] || rates[1] > MOST[1]) {
            wrong.push(format!("{name}: {rates:?}"));
        }
    }
    assert!(wrong.is_empty(), "{colour:?}: {wrong:#?}");
}

#[test]
fn verify_false_alarm_rates_in_white_noise() {
    check(Colour::White, "");
}

/// The raw residual is coloured here: its whiteness test rejects rightly.
#[test]
fn verify_false_alarm_rates_in_first_order_noise() {
    check(Colour::Ar1(0.9), "whiteness, raw");
}

#[test]
fn verify_false_alarm_rates_in_pink_noise() {
    check(Colour::Pink, "whiteness, raw");
}
