//! Whole recordings.

use super::*;
use truecut_recording::{Header, Measured, MeasuredChannel, Recording, Role};

fn recording(unit: Unit, rows: usize) -> Recording {
    Recording {
        header: Header {
            channels: vec![
                ChannelSpec::new("joint1.angle", unit, ""),
                ChannelSpec::new("joint1.velocity", Unit::RadianPerSecond, ""),
                ChannelSpec::new("joint2.angle", Unit::Radian, ""),
            ],
            ..Header::default()
        },
        time_s: times()[..rows].to_vec(),
        columns: vec![
            of_time(|t| (TAU * 0.9 * t).sin())[..rows].to_vec(),
            of_time(|t| TAU * 0.9 * (TAU * 0.9 * t).cos())[..rows].to_vec(),
            vec![0.3; rows],
        ],
        ..Recording::default()
    }
}

/// A measured angle: the run's with noise.
fn angle() -> Vec<f64> {
    let noise = noise(Colour::White, SAMPLES, 1);
    sum(&[&of_time(|t| (TAU * 0.9 * t).sin()), &noise])
}

fn measured(channels: &[(&str, Role)]) -> Measured {
    let channel = |(name, role): &(&str, Role)| MeasuredChannel {
        spec: ChannelSpec::new(*name, Unit::Radian, ""),
        role: *role,
        values: angle(),
        valid: vec![true; SAMPLES],
        noise: None,
        white_kept: 1.0,
    };
    Measured {
        source: "file.csv".into(),
        time_s: times(),
        channels: channels.iter().map(channel).collect(),
        notes: Vec::new(),
        ..Measured::default()
    }
}

#[test]
fn recordings_are_held_against_what_moves() {
    let one = measured(&[("joint1.angle", Role::Output)]);
    let found = compare_recordings(&recording(Unit::Radian, SAMPLES), &one, None).unwrap();
    let signals: Vec<&str> = found
        .explanatory
        .iter()
        .map(|one| one.spec.name.as_str())
        .collect();
    // The second joint is at rest and explains nothing.
    assert_eq!(signals, ["joint1.angle", "joint1.velocity", "time"]);
    assert_eq!(found.channels.len(), 1);
    let json = serde_json::to_value(&found).unwrap();
    assert!(json["channels"][0]["level"]["nrmse"].is_f64(), "{json:#}");
}

#[test]
fn verify_a_measured_coordinate_brings_its_velocity_along() {
    let driven = measured(&[
        ("joint1.angle", Role::Output),
        ("joint3.angle", Role::Input),
    ]);
    let found = compare_recordings(&recording(Unit::Radian, SAMPLES), &driven, None).unwrap();
    let derived = found
        .explanatory
        .iter()
        .find(|one| one.spec.name == "joint3.velocity")
        .unwrap();
    let expected = (angle()[1004] - angle()[996]) / (8.0 * INTERVAL_S);
    assert!((derived.values[1000] - expected).abs() < 1e-9);
}

#[test]
fn recordings_that_do_not_fit_are_refused() {
    let one = measured(&[("joint1.angle", Role::Output)]);
    let against =
        |unit, rows, data: &Measured| compare_recordings(&recording(unit, rows), data, None);
    let short = against(Unit::Radian, 1000, &one);
    assert!(
        matches!(short, Err(CompareError::NoCommonTime { .. })),
        "{short:?}"
    );
    let part = against(Unit::Radian, 3000, &one).unwrap();
    assert!(part.notes[0].contains("left out"), "{:?}", part.notes);
    let other = against(Unit::Metre, SAMPLES, &one);
    assert!(
        matches!(other, Err(CompareError::Dimension { .. })),
        "{other:?}"
    );
    let misspelt = measured(&[("joint1.angel", Role::Output)]);
    let unknown = against(Unit::Radian, SAMPLES, &misspelt).unwrap_err();
    assert!(unknown.to_string().contains("joint1.angle"), "{unknown}");
    let inputs = measured(&[("joint1.angle", Role::Input)]);
    assert_eq!(
        against(Unit::Radian, SAMPLES, &inputs),
        Err(CompareError::NoOutput)
    );
}

#[test]
fn every_pass_is_held_against_the_run_from_its_start() {
    use truecut_recording::Pass;
    let half = SAMPLES / 2;
    let run = recording(Unit::Radian, half - 100);
    let once = run.columns[0].clone();
    let mut data = measured(&[("joint1.angle", Role::Output)]);
    let noise = noise(Colour::White, SAMPLES, 3);
    let at = |row: usize| once[(row % half).min(once.len() - 1)];
    data.channels[0].values = (0..SAMPLES).map(|row| at(row) + noise[row]).collect();
    let start = |row: usize| Pass {
        samples: row..row + half,
        start_s: data.time_s[row],
    };
    data.passes = vec![start(0), start(half)];
    let level = |data: &Measured| compare_recordings(&run, data, None).unwrap();
    let found = level(&data);
    let rms = found.channels[0].level.rms_error;
    let floor = (noise.iter().map(|n| n * n).sum::<f64>() / SAMPLES as f64).sqrt();
    assert!((rms / floor - 1.0).abs() < 0.05, "{rms} against {floor}");
    assert!(
        found
            .notes
            .iter()
            .any(|note| note.contains("outside the passes"))
    );
    // Without passes the second half is after the run's end.
    data.passes.clear();
    assert!(compare_recordings(&run, &data, None).is_err());
}
