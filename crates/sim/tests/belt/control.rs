//! A carrier holds the force that the path alone leaves to rubber and arm.

use super::shared::{self, belt, column, run_with, scalar};
use truecut_recording::Recording;
use truecut_scenario::effect::{Effect, EffectKind, Target};

/// A run along the first line; keys are those of the scenario.
fn run(overrides: &[(&str, &str)]) -> Recording {
    let begun = [("run.duration_s".to_owned(), "1.2".to_owned())];
    let overrides = overrides.iter();
    let overrides: Vec<(String, String)> = overrides
        .map(|(key, value)| ((*key).to_owned(), (*value).to_owned()))
        .collect();
    run_with(&belt(&begun), &overrides)
}

const HELD: [(&str, &str); 5] = [
    ("process.belt.control.law", "\"constant_force\""),
    ("process.belt.control.force_n", "12"),
    ("process.belt.control.damping_n_s_per_mm", "0.2"),
    ("process.belt.control.fastest_mm_per_s", "50"),
    ("process.belt.control.stroke_mm", "1"),
];

/// Forces along the middle of the line, when the arm has come to rest from setting down.
fn on_line(recording: &Recording) -> Vec<f64> {
    let normal = column(recording, "belt.normal_force");
    let u = column(recording, "belt.position_u");
    let pairs = normal.iter().zip(u);
    pairs
        .filter(|(force, u)| **force > 0.0 && (0.45..0.6).contains(*u))
        .map(|(force, _)| *force)
        .collect()
}

/// Half as stiff an arm takes a good part of the force that the path gives, and nothing of the one
/// that is held; what the carrier makes up for is what the arm gives way.
#[test]
fn verify_a_held_force_does_not_depend_on_the_arm() {
    let soft = ("robot.stiffness_scale", "0.5");
    let mean = |forces: &[f64]| forces.iter().sum::<f64>() / forces.len() as f64;
    let [stiff, weak] = [run(&[]), run(&[soft])].map(|recording| mean(&on_line(&recording)));
    assert!(weak < 0.85 * stiff, "{weak} {stiff}");
    for arm in [None, Some(soft)] {
        let overrides: Vec<(&str, &str)> = HELD.iter().copied().chain(arm).collect();
        let recording = run(&overrides);
        let forces = on_line(&recording);
        assert!(forces.len() > 100);
        assert!(
            (mean(&forces) / 12.0 - 1.0).abs() < 2e-3,
            "{}",
            mean(&forces)
        );
        for force in &forces {
            assert!((force / 12.0 - 1.0).abs() < 0.02, "{force}");
        }
        assert!(scalar(&recording, "belt.force_spread") < 4.0);
    }
}

/// A control that holds another force than it is told holds that; one whose guide rubs leaves no
/// more than its stiction as an error.
#[test]
fn verify_offset_and_stiction_act_on_the_held_force() {
    let begun = [("run.duration_s", "1.2")].into_iter().chain(HELD);
    let begun: Vec<(String, String)> = begun
        .map(|(key, value)| (key.to_owned(), value.to_owned()))
        .collect();
    let with = |kind, size| {
        let effect = Effect {
            kind,
            target: Target::Whole,
            values: vec![size],
        };
        on_line(&shared::run(&belt(&begun), &[effect]))
    };
    let higher = with(EffectKind::WheelForceOffset, 3.0);
    let mean = higher.iter().sum::<f64>() / higher.len() as f64;
    assert!((mean / 15.0 - 1.0).abs() < 2e-3, "{mean}");
    let rubbing = with(EffectKind::WheelForceStiction, 2.0);
    assert!(rubbing.iter().all(|force| (force - 12.0).abs() < 2.1));
    assert!(rubbing.iter().any(|force| (force - 12.0).abs() > 0.5));
}

/// Lifted before the line the carrier stands at the end of its stroke, on the line within it.
#[test]
fn the_carrier_stands_out_before_the_line() {
    let recording = run(&HELD);
    let carrier = column(&recording, "belt.carrier_offset");
    let normal = column(&recording, "belt.normal_force");
    let first = normal
        .iter()
        .position(|force| *force > 0.0)
        .expect("contact");
    assert_eq!(carrier[first - 1], 1e-3);
    let last = carrier.len() - 1;
    assert!(normal[last] > 0.0 && carrier[last].abs() < 1e-3);
}
