//! Comparisons of recordings of an arm of two joints, in inverse dynamics, whose drive forces are
//! those of a set-up, with effects, a law that no effect has, and noise.

use std::sync::Mutex;

use truecut_recording::ChannelSpec;
use truecut_recording::Unit;
use truecut_recording::measured::Role;
use truecut_scenario::effect::{Effect, EffectKind, Target};
use truecut_sim::InverseModel;

use super::change::{Change, Of};
use super::*;
use crate::diagnose::{Options, Progress};
use crate::testing::{Colour, noise};
use crate::trial::tests::arm_of_two;

const RATE_HZ: f64 = 100.0;
const SAMPLES: usize = 1200;
const FLOOR: [f64; 3] = [0.0, 0.0, -1.0];

/// How a recording is made.
struct Made<'a> {
    name: &'a str,
    seed: u64,
    /// Of the motion.
    phase: f64,
    /// By how much the motion is faster than the times of the recording say.
    speed: f64,
    effects: &'a [Effect],
    /// Beyond that, on the first drive, by the first joint's angle.
    law: fn(f64) -> f64,
    /// When a brake drags on the first joint, s.
    drags_s: [f64; 2],
}

const PLAIN: Made = Made {
    name: "first.csv",
    seed: 1,
    phase: 0.0,
    speed: 1.0,
    effects: &[],
    law: |_| 0.0,
    drags_s: [0.0; 2],
};

/// The arm, its drive forces compared up to a frequency.
fn scenario(compared_to_hz: f64) -> Scenario {
    arm_of_two(20.0, compared_to_hz)
}

fn recorded(made: &Made) -> Measured {
    let time_s: Vec<f64> = (0..SAMPLES).map(|k| k as f64 / RATE_HZ).collect();
    let angle = |size: f64, slow: f64, fast: f64| -> Vec<f64> {
        let at = |t: &f64| {
            size * (slow * t + made.phase).sin() + 0.4 * size * (fast * t + 2.0 * made.phase).cos()
        };
        time_s.iter().map(at).collect()
    };
    let channel = |name: &str, unit, role, values: Vec<f64>| MeasuredChannel {
        spec: ChannelSpec::new(name, unit, "made"),
        role,
        valid: vec![true; SAMPLES],
        values,
        noise: None,
        white_kept: 1.0,
    };
    let still = || vec![0.0; SAMPLES];
    let mut measured = Measured {
        source: made.name.into(),
        channels: vec![
            channel(
                "joint1.angle",
                Unit::Radian,
                Role::Input,
                angle(0.6, 1.9, 4.7),
            ),
            channel(
                "joint2.angle",
                Unit::Radian,
                Role::Input,
                angle(0.9, 2.7, 5.3),
            ),
            channel(
                "joint1.drive_torque",
                Unit::NewtonMetre,
                Role::Output,
                still(),
            ),
            channel(
                "joint2.drive_torque",
                Unit::NewtonMetre,
                Role::Output,
                still(),
            ),
        ],
        time_s,
        ..Measured::default()
    };
    // Nearly as they are before the filter of the comparison.
    let model = InverseModel::new(&scenario(45.0), &measured).unwrap_or_else(|e| panic!("{e}"));
    let forces = model.set_up(FLOOR.into(), made.speed).predict(made.effects);
    for (j, mut values) in forces.unwrap().into_iter().enumerate() {
        let size = crate::stats::deviation(&values);
        if j == 0 {
            let angles = &measured.channels[0].values;
            (values.iter_mut().zip(angles)).for_each(|(x, q)| *x += size * (made.law)(*q));
            let [from, until] = made.drags_s.map(|time_s| (time_s * RATE_HZ) as usize);
            let ways = angles.windows(2).map(|pair| (pair[1] - pair[0]).signum());
            for (x, way) in values.iter_mut().zip(ways).take(until).skip(from) {
                *x += 0.15 * size * way;
            }
        }
        let drawn = noise(Colour::White, SAMPLES, 10 * made.seed + j as u64);
        (values.iter_mut().zip(drawn)).for_each(|(x, n)| *x += 0.01 * size * n);
        measured.channels[2 + j].values = values;
    }
    measured
}

fn pair_of(scenario: &Scenario, first: &Made, second: &Made) -> Between {
    let [first, second] = [first, second].map(recorded);
    Between::new(scenario, &first, &second).unwrap_or_else(|e| panic!("{e}"))
}

fn friction(friction: f64) -> Effect {
    Effect {
        kind: EffectKind::JointCoulomb,
        target: Target::Joint(0),
        values: vec![friction],
    }
}

fn asked(pair: &Between) -> Answer {
    changes(pair, &Options::default(), &|_| {}).unwrap_or_else(|e| panic!("{e}"))
}

/// Another set-up of either recording is told by its name, as an answer or as what is wrong with
/// the data, and nothing is named then.
#[test]
fn the_set_up_of_either_recording_is_told() {
    for (fast, phase) in [
        ([false, true], 0.0),
        ([true, false], 0.0),
        ([false, true], 1.3),
    ] {
        let speed = fast.map(|fast| if fast { 2.0 } else { 1.0 });
        let names = [PLAIN.name, "second.csv"];
        let pair = pair_of(
            &scenario(10.0),
            &Made {
                speed: speed[0],
                ..PLAIN
            },
            &Made {
                name: names[1],
                seed: 2,
                phase,
                speed: speed[1],
                ..PLAIN
            },
        );
        let told = match changes(&pair, &Options::default(), &|_| {}) {
            Err(error) => error.to_string(),
            Ok(answer) => {
                let found = answer.changes;
                assert!(found.changes.is_empty(), "{found:?}");
                assert_eq!(found.verdict, Verdict::UnknownChange, "{found:?}");
                format!("{} {}", found.reason, found.doubts.join(" "))
            }
        };
        for (name, fast) in names.iter().zip(fast) {
            let words = format!("{name}: Look at the set-up first");
            assert_eq!(told.contains(&words), fast, "{name} {phase}: {told}");
        }
        assert!(told.contains("2 times as fast as"), "{told}");
    }
}

/// All searches share what they may do, and the progress is that of all.
#[test]
fn searches_share_their_simulations() {
    let law = |q: f64| 0.3 * (5.0 * q).sin();
    let pair = pair_of(
        &scenario(10.0),
        &Made {
            effects: &[friction(2.0)],
            law,
            ..PLAIN
        },
        &Made {
            name: "second.csv",
            seed: 2,
            phase: 1.0,
            effects: &[friction(3.0)],
            law,
            ..PLAIN
        },
    );
    for most in [80, 400] {
        let options = Options {
            max_predictions: most,
            ..Options::default()
        };
        let seen = Mutex::new(Vec::new());
        let progress = |now: Progress| {
            assert_eq!(now.max_predictions, most);
            seen.lock().unwrap().push(now.predictions);
        };
        let found = changes(&pair, &options, &progress).unwrap_or_else(|e| panic!("{e}"));
        let seen = seen.into_inner().unwrap();
        assert!(seen.is_sorted(), "{seen:?}");
        assert!(
            seen.last()
                .is_some_and(|last| *last <= found.changes.work.predictions)
        );
    }
}

/// What both share has the size that fits both: that with which both scenarios are written.
#[test]
fn what_is_shared_is_fitted_to_both() {
    let truth = 2.0;
    for (seed, phase) in [(1, 0.0), (3, 0.0), (5, 1.3), (7, 0.6)] {
        let pair = pair_of(
            &scenario(10.0),
            &Made {
                seed,
                effects: &[friction(truth)],
                ..PLAIN
            },
            &Made {
                name: "second.csv",
                seed: seed + 1,
                phase,
                effects: &[friction(truth)],
                ..PLAIN
            },
        );
        assert_eq!(pair.repeats(), phase == 0.0);
        let answer = asked(&pair);
        let [cause] = &answer.changes.shared[..] else {
            panic!("{:?}", answer.changes)
        };
        let told = &cause.parameters["friction_n_m"];
        assert_eq!(answer.before, [friction(told.value)], "{seed}");
        assert_eq!(answer.after, answer.before, "{seed}");
        let error = (told.high.unwrap() - told.low.unwrap()) / (2.0 * 1.96);
        // The data went through a filter of their own, which dry friction shows by a per cent.
        assert!((told.value / truth - 1.0).abs() < 0.02, "{seed}: {told:?}");
        // One recording alone says the same, and knows it less well.
        let quiet = |_: Progress| {};
        let alone = crate::diagnose::diagnose(
            &pair.first,
            &pair.first.observation,
            &Options::default(),
            &quiet,
        );
        let alone = alone.unwrap().diagnosis;
        let one = &alone.causes[0].parameters["friction_n_m"];
        let error_alone = (one.high.unwrap() - one.low.unwrap()) / (2.0 * 1.96);
        let apart = (told.value - one.value).abs();
        assert!(apart < 3.5 * error_alone, "{seed}: {told:?} {one:?}");
        assert!(error < 0.9 * error_alone, "{seed}: {error} {error_alone}");
    }
}

/// After another motion a law without a name is no change, and no part of what is shown.
#[test]
fn what_is_shown_is_the_model_that_is_told() {
    let law = |q: f64| 0.4 * (6.0 * q).sin();
    for (seed, grown) in [(1, 0.0), (4, 3.0)] {
        let pair = pair_of(
            &scenario(10.0),
            &Made { seed, ..PLAIN },
            &Made {
                name: "second.csv",
                seed: seed + 1,
                phase: 1.1,
                effects: &[friction(grown)],
                law,
                ..PLAIN
            },
        );
        let answer = asked(&pair);
        let told = format!("{:?}", answer.changes.reason);
        assert!(answer.changes.curve.is_none(), "{told}");
        assert!(
            !answer.after.iter().any(|one| one.kind.is_curve()),
            "{told}"
        );
        let sides = [(&pair.first, &answer.before), (&pair.second, &answer.after)];
        let [a, b] = sides.map(|(trial, effects)| trial.predict(&[], effects).unwrap());
        for (c, column) in answer.changed.iter().enumerate() {
            let wanted = [a[c].as_slice(), &b[c]].concat();
            let size = crate::stats::deviation(&wanted);
            let apart = column.iter().zip(&wanted).map(|(x, y)| (x - y).abs());
            assert!(apart.fold(0.0, f64::max) < 1e-6 * size, "{told}");
        }
        // Its errors are those that are told.
        let after = &answer.changes.channels["joint1.drive_torque"];
        let output = &pair.observation.outputs[0];
        let last = output.values.len() * 9 / 10..output.values.len();
        let left: Vec<f64> = last
            .map(|row| output.values[row] - answer.changed[0][row])
            .collect();
        let left = (left.iter().map(|x| x * x).sum::<f64>() / left.len() as f64).sqrt();
        assert!(
            (0.6..1.6).contains(&(after.after / left)),
            "{told} {after:?} {left}"
        );
    }
}

/// What the scenario holds itself is looked for as what it lacks is: delays late, frictions
/// together.
#[test]
fn effects_that_the_scenario_holds_are_looked_for_in_the_same_way() {
    let delay = Effect {
        kind: EffectKind::SensorDelay,
        target: Target::Channel("joint1.drive_torque".into()),
        values: vec![0.004],
    };
    let held = [delay.clone(), friction(2.0)];
    let scenario = scenario(10.0).with_effects(&held).unwrap();
    let pair = pair_of(
        &scenario,
        &PLAIN,
        &Made {
            name: "second.csv",
            seed: 2,
            ..PLAIN
        },
    );
    let model = Change::new(&pair, Of::Difference, &[], Vec::new());
    let candidates = model.candidates();
    let is_in = |list: &[usize], effect: &Effect| {
        let is_own = |one: &&usize| {
            candidates[**one].kind == effect.kind && candidates[**one].target == effect.target
        };
        list.iter().filter(is_own).count()
    };
    assert_eq!(is_in(&model.late(), &delay), 1);
    assert_eq!(is_in(&model.additive(), &friction(0.0)), 1);
}

/// A brake that drags for a while in one of two recordings of a motion is told with the recording
/// and the time, before whatever is named beside it.
#[test]
fn what_happens_within_a_recording_is_told_as_that() {
    let drags_s = [3.0, 5.5];
    for (recording, seed) in [(Recording::First, 11), (Recording::Second, 21)] {
        let drags_in = |own: Recording| match own == recording {
            true => drags_s,
            false => [0.0; 2],
        };
        let pair = pair_of(
            &scenario(10.0),
            &Made {
                seed,
                drags_s: drags_in(Recording::First),
                ..PLAIN
            },
            &Made {
                name: "second.csv",
                seed: seed + 1,
                drags_s: drags_in(Recording::Second),
                ..PLAIN
            },
        );
        let found = asked(&pair).changes;
        let told = format!("{:?} {} {:?}", found.verdict, found.reason, found.events);
        assert_ne!(found.verdict, Verdict::NothingChanged, "{told}");
        let near = |moment: Option<f64>, truth: f64| {
            moment.is_some_and(|moment| (moment - truth).abs() < 0.3)
        };
        let is_it = |one: &Event| {
            one.recording == recording
                && one.change.channel == "joint1.drive_torque"
                && near(one.change.from_s, drags_s[0])
                && near(one.change.until_s, drags_s[1])
        };
        assert!(found.events.iter().any(is_it), "{told}");
        let place = match recording {
            Recording::First => "Within the first recording",
            _ => "Within the second recording",
        };
        assert!(found.reason.starts_with(place), "{told}");
    }
}
