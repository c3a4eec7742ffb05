//! Motions drawn at random.

use truecut_recording::measured::{Pass, Role};

use super::*;
use crate::testing::{Colour, channel, noise};

/// A swing of several harmonics, seen from `from` on, at this interval.
fn swing(seed: u64, from: f64, interval_s: f64, level: f64) -> Measured {
    let drawn = noise(Colour::White, 1500, seed);
    let at = |t: f64| {
        let phase = 0.4 * seed as f64;
        (t + phase).sin() + 0.5 * (2.3 * t + phase).cos() + 0.2 * (5.1 * t).sin()
    };
    let rows = drawn.iter().enumerate();
    let values: Vec<f64> = rows
        .map(|(k, n)| at(from + k as f64 * interval_s) + level * n)
        .collect();
    Measured {
        source: "drawn".into(),
        time_s: (0..1500).map(|k| k as f64 * interval_s).collect(),
        channels: vec![channel(values)],
        ..Measured::default()
    }
}

#[test]
fn verify_a_shift_is_found_to_a_part_of_an_interval() {
    for seed in 0..12 {
        let shift = -2.0 + 0.37 * seed as f64;
        for level in [0.0, 0.01] {
            let first = swing(seed, 0.0, 0.01, level);
            let second = swing(seed, -shift, 0.01, 0.9 * level);
            let (lag, unlike) = later(&first, &second).expect("it repeats");
            assert!((0.01 * lag - shift).abs() < 2e-3, "{lag} {shift}");
            assert!(unlike < AGAIN, "{unlike}");
        }
        let other = swing(seed + 1, 0.0, 0.01, 0.0);
        assert_eq!(later(&swing(seed, 0.0, 0.01, 0.0), &other), None);
    }
}

/// Another rate: each run keeps its samples, and none is read across two runs.
#[test]
fn runs_are_counted_anew_at_another_rate() {
    for seed in 0..8 {
        let mut two = swing(seed, 0.0, 0.01, 0.0);
        let middle = 700 + 13 * seed as usize;
        two.passes = vec![
            Pass {
                samples: 0..middle,
                start_s: 0.0,
            },
            Pass {
                samples: middle..1500,
                start_s: 0.01 * middle as f64,
            },
        ];
        let there = resampled(&two, 0.0163, 0.0);
        let [a, b] = &there.passes[..] else {
            panic!("two runs")
        };
        assert_eq!((a.samples.start, b.samples.end), (0, there.time_s.len()));
        assert_eq!(a.samples.end, b.samples.start);
        let begins_s = there.time_s[b.samples.start];
        assert!(
            (0.0..0.0163).contains(&(begins_s - b.start_s)),
            "{begins_s}"
        );
        let across: Vec<usize> = (0..there.time_s.len())
            .filter(|row| !there.channels[0].valid[*row])
            .collect();
        assert!((1..=3).contains(&across.len()) && across.contains(&(b.samples.start - 1)));
    }
}

/// A joint that is parked, read to a count: one count off is no other motion, a degree is.
#[test]
fn a_joint_that_stands_still_is_held_against_those_that_move() {
    let count = 1e-5;
    let parked = |seed: u64, at: f64| {
        let mut moved = swing(seed, 0.0, 0.01, 1e-4);
        let mut still = moved.channels[0].clone();
        still.spec.name = "joint2.angle".into();
        still.values = vec![at; 1500];
        still.values[40 + seed as usize] += count;
        moved.channels.push(still);
        moved
    };
    for seed in 0..6 {
        let first = parked(seed, 0.5);
        let again = parked(seed, 0.5 + count);
        assert!(later(&first, &again).is_some(), "{seed}");
        assert_eq!(later(&first, &parked(seed, 0.5175)), None, "{seed}");
    }
}

/// All that is measured in a unit stands still, a count off: no other motion, as where something
/// else of that unit moves; a place that is another one is.
#[test]
fn a_unit_of_which_nothing_moves_is_held_against_its_size() {
    let count = 1e-5;
    let parked = |seed: u64, unit: Unit, at: f64| {
        let mut moved = swing(seed, 0.0, 0.01, 1e-4);
        let mut still = moved.channels[0].clone();
        moved.channels[0].spec.unit = Unit::NewtonMetre;
        still.spec.name = "parked".into();
        still.spec.unit = unit;
        still.values = vec![at; 1500];
        still.values[40 + seed as usize] += count;
        moved.channels.push(still);
        moved
    };
    for seed in 0..6 {
        for (unit, at, other) in [
            (Unit::Radian, 0.5, 0.5175),
            (Unit::Radian, 0.0, 0.0175),
            (Unit::Metre, 0.2, 0.21),
            (Unit::Newton, 40.0, 41.0),
        ] {
            let first = parked(seed, unit, at);
            let again = parked(seed, unit, at + count);
            assert!(later(&first, &again).is_some(), "{seed} {unit}");
            assert_eq!(
                later(&first, &parked(seed, unit, other)),
                None,
                "{seed} {unit}"
            );
        }
    }
}

/// Runs that are recorded at another rate and from another moment on begin at the same rows as
/// those of the first, with the same values.
#[test]
fn verify_runs_at_another_rate_are_the_same_runs() {
    let signal = |t: f64| (3.0 * t).sin() + 0.3 * (11.0 * t).cos();
    let recorded = |from_s: f64, interval_s: f64, starts_s: &[f64]| {
        let count = (20.0 / interval_s) as usize;
        let own: Vec<f64> = starts_s.iter().map(|start| start - from_s).collect();
        let first = |start: f64| ((start / interval_s - 1e-6).ceil()) as usize;
        let passes = own.iter().enumerate().map(|(k, start)| Pass {
            samples: first(*start)..own.get(k + 1).map_or(count, |next| first(*next)),
            start_s: *start,
        });
        let passes: Vec<Pass> = passes.collect();
        let since = |row: usize| {
            let t = row as f64 * interval_s;
            let begun = own.iter().rev().find(|start| **start <= t + 1e-9);
            t - begun.unwrap_or(&own[0])
        };
        let mut output = channel((0..count).map(|row| signal(since(row))).collect());
        output.role = Role::Output;
        Measured {
            source: "drawn".into(),
            time_s: (0..count).map(|k| k as f64 * interval_s).collect(),
            channels: vec![output],
            passes,
            ..Measured::default()
        }
    };
    for seed in 0..10_u32 {
        let turn = f64::from(seed);
        let starts = [1.0 + 0.123 * turn, 6.0 + 0.031 * turn, 13.0];
        let first = recorded(0.0, 0.01, &starts);
        let interval_s = 0.0083 + 0.0006 * turn;
        let second = recorded(0.37 + 0.0017 * turn, interval_s, &starts);
        let common_s = common_interval_s(&first, &second);
        let first = resampled(&first, common_s, 0.0);
        let found = later(&first, &resampled(&second, common_s, 0.0));
        let (second, _, rows) = placed(&second, common_s, found.expect("the same runs"), 1);
        let counts = [first.time_s.len(), second.time_s.len()];
        let at = crate::between::join::Overlap::of(counts, rows);
        let begins = |one: &Measured, from: usize| -> Vec<i64> {
            let runs = one.passes.iter();
            runs.map(|run| run.samples.start as i64 - from as i64)
                .collect()
        };
        assert_eq!(
            begins(&first, at.first),
            begins(&second, at.second),
            "{seed}"
        );
        let (a, b) = (&first.channels[0], &second.channels[0]);
        let both = (0..at.count).map(|k| (at.first + k, at.second + k));
        let both: Vec<(usize, usize)> = both.filter(|(k, l)| a.valid[*k] && b.valid[*l]).collect();
        assert!(both.len() > 9 * at.count / 10, "{seed}");
        // What is smoothed spreads the jump at which a run begins.
        let near = |k: usize| (first.passes.iter()).any(|run| k.abs_diff(run.samples.start) < 25);
        for (k, l) in both
            .into_iter()
            .filter(|(k, _)| !near(*k) && *k > 25 && k + 25 < counts[0])
        {
            let apart = (a.values[k] - b.values[l]).abs();
            assert!(apart < 2e-3, "{seed} {k}: {apart}");
        }
    }
}

/// Outputs of a few counts come again when the motion does; all of them only in a copy.
#[test]
fn counts_that_agree_make_no_copy() {
    let count = 0.05;
    for seed in 0..6 {
        // The same motion with noise of its own, a fifth of a count.
        let outputs = |own: u64| {
            let mut moved = swing(seed, 0.0, 0.01, 0.0);
            let output = &mut moved.channels[0];
            output.role = Role::Output;
            let drawn = noise(Colour::White, 1500, 1000 * own + seed);
            for (x, drawn) in output.values.iter_mut().zip(drawn) {
                *x = ((*x + 0.2 * count * drawn) / count).round() * count;
            }
            moved
        };
        let first = outputs(1);
        super::super::check_samples(&first, &outputs(2)).expect("no copy");
        super::super::check_samples(&first, &first).expect_err("a copy");
        // A copy of which the beginning is cut off, and one value is another one.
        let mut part = first.clone();
        part.time_s.truncate(1490);
        let output = &mut part.channels[0];
        output.valid.truncate(1490);
        output.values.drain(..10);
        output.values[745] += count;
        super::super::check_samples(&first, &part).expect_err("a copy");
        let fine = |from| {
            let mut moved = swing(seed, from, 0.01, 0.01);
            moved.channels[0].role = Role::Output;
            moved
        };
        let mut part = fine(5.0);
        part.channels[0].values[700..720].copy_from_slice(&fine(0.0).channels[0].values[300..320]);
        super::super::check_samples(&fine(0.0), &part).expect_err("a part that is copied");
    }
}

#[test]
fn verify_samples_at_other_places_are_those_of_the_signal() {
    for seed in 0..8 {
        let first = 0.13 * seed as f64;
        let there = resampled(&swing(seed, 0.0, 0.01, 0.0), 0.0083, 0.01 * first);
        let truth = swing(seed, 0.01 * first, 0.0083, 0.0);
        let rows = there.channels[0]
            .values
            .iter()
            .zip(&truth.channels[0].values);
        let rows = rows
            .zip(&there.channels[0].valid)
            .filter(|(_, valid)| **valid);
        assert!(there.channels[0].valid.iter().all(|valid| *valid));
        assert!(rows.clone().count() > 1400);
        for ((found, wanted), _) in rows {
            assert!((found - wanted).abs() < 1e-5, "{found} {wanted}");
        }
    }
}
