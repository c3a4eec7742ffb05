//! From motion to drive forces, and what effects add to them.

use truecut_scenario::effect::{Effect, EffectKind, Target};

use super::*;

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

/// A rotor as heavy as the mass, on a motion without gravity, takes as much force again.
#[test]
fn verify_a_rotor_beyond_the_file_takes_its_force() {
    let model = swinging_mass();
    let rotor = |mass_kg: f64| Effect {
        kind: EffectKind::JointRotor,
        target: Target::Joint(0),
        values: vec![mass_kg],
    };
    let nominal = model.predict(&[]).unwrap().remove(0);
    let with = model.predict(&[rotor(MASS_KG)]).unwrap().remove(0);
    for (one, two) in nominal.iter().zip(&with) {
        assert!((two - 2.0 * one).abs() < 1e-9, "{two} {one}");
    }
    let error = model.predict(&[rotor(-1.0)]).unwrap_err().to_string();
    assert!(error.contains("must not be negative"), "{error}");
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
