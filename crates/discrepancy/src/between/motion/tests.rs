//! Motions drawn at random.

use truecut_recording::measured::Role;

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
        let there = resampled(two, 0.0163, 0.0);
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
        let there = resampled(swing(seed, 0.0, 0.01, 0.0), 0.0083, first);
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
