//! Noise is within its own floor, and what is no noise is beyond it.

use super::*;
use crate::testing::{Colour, noise};
use crate::trial::noise::held_step;

const COLOURS: [Colour; 4] = [
    Colour::White,
    Colour::Ar1(0.5),
    Colour::Ar1(0.9),
    Colour::Pink,
];

/// A floor of noise whose size the data state.
fn stated(size: f64, values: &[f64]) -> Floor {
    let output = Output {
        values: values.to_vec(),
        valid: vec![true; values.len()],
        noise: Some(size),
        sample: None,
        noise_without_memory: 0.0,
        held_step: 0.0,
        noise_of_inputs: 0.0,
        noise_error: 0.0,
    };
    Floor::of(&output, 0.0).expect("stated")
}

/// Noise of 600 samples beside so many seen elsewhere.
fn drawn(colour: Colour, seed: u64, stretches: usize, length: usize) -> (Floor, Vec<f64>) {
    let all = noise(colour, 600 + stretches * length, seed);
    let (own, other) = all.split_at(600);
    let sample = other.chunks(length).map(<[f64]>::to_vec).collect();
    let output = Output {
        values: own.to_vec(),
        valid: vec![true; own.len()],
        noise: None,
        sample: NoiseSample::of(NoiseSource::Standstill, sample, 40),
        noise_without_memory: 0.0,
        held_step: 0.0,
        noise_of_inputs: 0.0,
        noise_error: 0.0,
    };
    (
        Floor::of(&output, deviation(&output.values)).unwrap(),
        own.to_vec(),
    )
}

/// Readings in steps that noise seldom crosses repeat with the motion, and what rounding makes of a
/// slow course is neither noise like the sample nor of its size.
#[test]
fn verify_rounding_that_comes_again_is_within_the_floor() {
    for seed in 0..60 {
        // From a hundredth of a step to three of them.
        let size = 10_f64.powf(-2.0 + 2.5 * seed as f64 / 60.0);
        let drawn = noise(Colour::White, 1800, seed);
        let course = |t: usize| 7.0 * (0.011 * t as f64 + seed as f64).sin();
        let read = |t: usize| (course(t % 600) + size * drawn[t]).round();
        let periods = [0, 600].map(|from| -> Vec<f64> {
            let rows = from..from + 600;
            rows.map(|t| (read(t + 600) - read(t)) / 2_f64.sqrt())
                .collect()
        });
        let output = Output {
            values: (0..600).map(read).collect(),
            valid: vec![true; 600],
            noise: None,
            sample: NoiseSample::of(NoiseSource::Repetition, periods.to_vec(), 40),
            noise_without_memory: 0.0,
            held_step: 1.0,
            noise_of_inputs: 0.0,
            noise_error: 0.0,
        };
        let floor = Floor::of(&output, 0.0).unwrap();
        let residual: Vec<f64> = (0..600).map(|t| read(t) - course(t)).collect();
        let rows: Vec<usize> = (10..600).collect();
        let beyond = floor.beyond(&residual, &rows);
        assert!(beyond.is_none(), "{size}: {beyond:?}");
        let truth = deviation(&residual);
        let ratio = floor.rms / truth;
        assert!((0.7..1.6).contains(&ratio), "{size}: {ratio}");
    }
}

#[test]
fn verify_noise_is_within_its_own_floor() {
    let rows: Vec<usize> = (10..600).collect();
    for (k, colour) in COLOURS.into_iter().enumerate() {
        for (stretches, length) in [(5, 40), (1, 400), (30, 8)] {
            let beyond = (0..200).filter(|seed| {
                let (floor, own) = drawn(colour, 1000 * k as u64 + seed, stretches, length);
                floor.beyond(&own, &rows).is_some()
            });
            let count = beyond.count();
            assert!(
                count <= 2,
                "{colour:?} {stretches} x {length}: {count} of 200"
            );
        }
    }
}

/// Floors and noise of all colours, fifty seeds each from `first` on.
fn each_drawn(first: u64, mut check: impl FnMut(u64, &Floor, &[f64], &str)) {
    for colour in COLOURS {
        for seed in 0..50 {
            let (floor, own) = drawn(colour, first + seed, 5, 40);
            check(seed, &floor, &own, &format!("{colour:?} {seed}"));
        }
    }
}

#[test]
fn verify_a_pattern_is_beyond_the_floor() {
    let rows: Vec<usize> = (10..600).collect();
    each_drawn(50_000, |seed, floor, own, which| {
        let size = 4.0 * deviation(own);
        let place = |t: usize| (0.07 * t as f64).sin() + (0.03 * t as f64).cos();
        let rippled: Vec<f64> = (own.iter().enumerate())
            .map(|(t, n)| n + size * (9.0 * place(t) + seed as f64).sin())
            .collect();
        assert!(floor.beyond(&rippled, &rows).is_some(), "{which}");
    });
}

#[test]
fn a_sensor_at_rest_has_the_noise_of_its_steps() {
    let step = 0.01;
    let rounded = |x: f64| (x / step).round() * step;
    let values: Vec<f64> = (0..600)
        .map(|t| rounded((0.05 * t as f64).sin() * 0.1))
        .collect();
    let valid = vec![true; 600];
    let output = Output {
        held_step: held_step(&values, &valid, 1.0),
        values,
        valid,
        noise: None,
        sample: NoiseSample::of(NoiseSource::Standstill, vec![vec![0.0; 100]], 40),
        noise_without_memory: 0.0,
        noise_of_inputs: 0.0,
        noise_error: 0.0,
    };
    let floor = Floor::of(&output, deviation(&output.values)).unwrap();
    assert!((floor.rms / (step / 12_f64.sqrt()) - 1.0).abs() < 1e-6);
}

/// Noise of a stated size is within it whatever its memory, and seven times its size is not: what
/// follows itself through the record has one degree of freedom, not less.
#[test]
fn verify_a_constant_is_beyond_stated_noise_of_any_memory() {
    let rows: Vec<usize> = (0..230).collect();
    for (k, memory) in [0.0_f64, 0.5, 0.9, 0.99, 0.999].into_iter().enumerate() {
        let size = 1.0 / (1.0 - memory * memory).sqrt();
        let (mut within, mut beyond) = (0, 0);
        for seed in 0..200 {
            let own = noise(Colour::Ar1(memory), 230, 90_000 + 1000 * k as u64 + seed);
            let floor = stated(size, &own);
            within += usize::from(floor.beyond(&own, &rows).is_none());
            let moved: Vec<f64> = own.iter().map(|x| x + 7.0 * size).collect();
            beyond += usize::from(floor.loss(&moved, &rows) > 16.0);
        }
        assert!(within >= 198, "{memory}: {within} of 200");
        assert!(beyond >= 180, "{memory}: {beyond} of 200");
    }
}

#[test]
fn verify_a_constant_is_beyond_the_floor_and_told_in_size() {
    let rows: Vec<usize> = (10..600).collect();
    each_drawn(70_000, |_, floor, own, which| {
        let away = 12.0 * deviation(own).max(floor.rms);
        let moved: Vec<f64> = own.iter().map(|n| n + away).collect();
        let beyond = floor.beyond(&moved, &rows).expect("a constant");
        let share = beyond.variance / away.powi(2);
        assert!((0.6..1.5).contains(&share), "{which}: {share}");
        assert!(
            floor.loss(&moved, &rows) > floor.loss(own, &rows) + 16.0,
            "{which}"
        );
    });
}
