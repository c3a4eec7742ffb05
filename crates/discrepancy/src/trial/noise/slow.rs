//! What differences between periods do not see of slow noise.
//!
//! Noise whose density falls with the frequency, as 1/f does, is alike from one period to the next:
//! their difference holds less than both, and about the mean of a stretch still less. How much is
//! missing follows from the density's exponent, which the differences show, and from the length of
//! the record.

use std::f64::consts::{PI, TAU};

use truecut_recording::fft::forward;

use crate::stats::centred;

/// Exponents of the density that are tried.
const MOST: f64 = 2.0;
const STEPS: usize = 41;
/// Frequencies of the sums, evenly in the logarithm.
const FREQUENCIES: usize = 400;
/// Shortest stretch that says something of the exponent.
const SHORTEST: usize = 16;
/// At least this part of the deviation is seen: what is not is a guess.
const LEAST_SEEN: f64 = 0.5;

/// In samples of the stretches.
pub(super) struct Lengths {
    /// Between a sample and the one taken from it.
    pub lag: f64,
    /// Of the record.
    pub record: f64,
    /// Of the shortest cycle that a filter leaves.
    pub shortest: f64,
}

/// Part of the standard deviation of the noise of a whole record that differences of this lag,
/// each about its own mean, have.
pub(super) fn seen(stretches: &[Vec<f64>], lengths: &Lengths) -> f64 {
    let top = (1.0 / lengths.shortest).min(0.5);
    let long: Vec<&Vec<f64>> = (stretches.iter())
        .filter(|one| one.len() >= SHORTEST)
        .collect();
    let count: usize = long.iter().map(|one| one.len()).sum();
    if count == 0 || lengths.record * top <= 2.0 {
        return 1.0;
    }
    let exponent = exponent(&long, top);
    let mean_length = count as f64 / long.len() as f64;
    let lowest = 1.0 / lengths.record;
    // A sum over logarithms: the density times the frequency.
    let cycles = |k: usize| lowest * (top / lowest).powf((k as f64 + 0.5) / FREQUENCIES as f64);
    let (mut part, mut whole) = (0.0, 0.0);
    for cycles in (0..FREQUENCIES).map(cycles) {
        let density = cycles.powf(1.0 - exponent);
        let about_mean = 1.0 - sinc(PI * cycles * mean_length).powi(2);
        part += density * about_mean * (1.0 - (TAU * cycles * lengths.lag).cos());
        whole += density;
    }
    (part / whole).sqrt().clamp(LEAST_SEEN, 1.0)
}

/// The exponent with which the density falls, by Whittle's likelihood.
fn exponent(stretches: &[&Vec<f64>], top: f64) -> f64 {
    let mut powers: Vec<(f64, f64)> = Vec::new();
    for stretch in stretches {
        let length = stretch.len();
        let bins = forward(centred(stretch), length);
        let inside = (1..bins.len()).map(|k| (k as f64 / length as f64, bins[k].norm_sqr()));
        powers.extend(inside.filter(|(cycles, _)| *cycles <= top));
    }
    let unlikely = |exponent: f64| -> f64 {
        let scaled = powers.iter().map(|(f, power)| power * f.powf(exponent));
        let level = scaled.sum::<f64>() / powers.len() as f64;
        let slopes: f64 = powers.iter().map(|(f, _)| -exponent * f.ln()).sum();
        powers.len() as f64 * level.max(f64::MIN_POSITIVE).ln() + slopes
    };
    (0..STEPS)
        .map(|k| MOST * k as f64 / (STEPS - 1) as f64)
        .min_by(|a, b| unlikely(*a).total_cmp(&unlikely(*b)))
        .unwrap_or(0.0)
}

fn sinc(x: f64) -> f64 {
    if x == 0.0 { 1.0 } else { x.sin() / x }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stats::deviation;
    use crate::testing::{Colour, noise};

    /// Of white and of 1/f noise, over two periods and a half: differences divided by the part that
    /// is seen are as large as the noise of the record, in the mean of many (1/f: 6 % less).
    #[test]
    fn verify_what_differences_miss_of_slow_noise() {
        for colour in [Colour::White, Colour::Pink] {
            let (record, lag) = (1200, 480);
            let ratios = (0..60).map(|seed| {
                let drawn = noise(colour, record, seed);
                let differences = |range: std::ops::Range<usize>| -> Vec<f64> {
                    let all = range.map(|k| (drawn[k + lag] - drawn[k]) / 2_f64.sqrt());
                    centred(&all.collect::<Vec<_>>())
                };
                let stretches = vec![differences(0..lag), differences(lag..record - lag)];
                let lengths = Lengths {
                    lag: lag as f64,
                    record: record as f64,
                    shortest: 2.0,
                };
                let part = seen(&stretches, &lengths);
                deviation(&stretches.concat()) / part / deviation(&drawn)
            });
            let ratios: Vec<f64> = ratios.collect();
            let mean = ratios.iter().sum::<f64>() / ratios.len() as f64;
            let within = ratios.iter().filter(|x| (0.8..1.3).contains(*x)).count();
            assert!((mean - 1.0).abs() < 0.08 && within >= 51, "{mean} {within}");
        }
    }
}
