//! Inputs that come again after a period, and values between samples.

use truecut_recording::measured::MeasuredChannel;

use super::{LEAST_SAMPLES, without_memory};
use crate::stats::{deviation, mean};

/// Samples that a search for a period compares at most.
const COMPARED: usize = 2000;
/// Intervals that a period has at least.
const SHORTEST: usize = 100;
/// Inputs come again if they differ by less than this part of their deviation.
const AGAIN: f64 = 2e-3;

/// By more than this, nothing near does.
const UNLIKE: f64 = 0.3;

/// An input that moves.
struct Moving<'a> {
    input: &'a MeasuredChannel,
    deviation: f64,
    /// Part of its deviation that is noise.
    noise: f64,
}

impl Moving<'_> {
    fn of(input: &MeasuredChannel) -> Option<Moving<'_>> {
        let deviation = deviation(&input.values);
        (deviation > 0.0).then(|| Moving {
            input,
            deviation,
            noise: without_memory(&input.values, &input.valid) / deviation,
        })
    }

    /// How unlike it is to itself so many intervals later, beyond its noise, as a part of its
    /// deviation.
    fn unlike(&self, lag: f64, stride: usize) -> f64 {
        let count = self.input.values.len();
        let squares: Vec<f64> = (0..count)
            .step_by(stride)
            .filter_map(|row| Some(cubic(self.input, row as f64 + lag)? - self.input.values[row]))
            .map(|x| (x / self.deviation).powi(2))
            .collect();
        if squares.len() * stride < LEAST_SAMPLES.max(count / 10) {
            return f64::INFINITY;
        }
        let own = 2.0 * self.noise.powi(2);
        // The mean of squares is known to a part of itself.
        (mean(&squares) - (1.0 + 6.0 / (squares.len() as f64).sqrt()) * own)
            .max(0.0)
            .sqrt()
    }
}

/// Intervals after which all inputs that move come again, if they do.
pub(super) fn period(inputs: &[&MeasuredChannel]) -> Option<f64> {
    let moving: Vec<Moving> = inputs
        .iter()
        .filter_map(|input| Moving::of(input))
        .collect();
    let count = moving.first()?.input.values.len();
    let stride = (count / COMPARED).max(1);
    let unlike = |lag: f64| -> f64 {
        let mut most = 0.0_f64;
        for one in moving.iter() {
            most = most.max(one.unlike(lag, stride));
            if most > UNLIKE {
                break;
            }
        }
        most
    };
    let lags: Vec<usize> = (SHORTEST..count * 9 / 10).step_by(stride.min(4)).collect();
    let coarse: Vec<f64> = lags.iter().map(|lag| unlike(*lag as f64)).collect();
    let lowest = |k: usize| coarse[k] <= coarse[k - 1] && coarse[k] < coarse[k + 1];
    let minima = (1..lags.len().saturating_sub(1)).filter(|&k| lowest(k) && coarse[k] < UNLIKE);
    minima.map(|k| lags[k] as f64).find_map(|middle| {
        let (mut low, mut high) = (middle - 4.0, middle + 4.0);
        while high - low > 1e-3 {
            let (a, b) = (low + (high - low) / 3.0, high - (high - low) / 3.0);
            if unlike(a) < unlike(b) {
                high = b;
            } else {
                low = a;
            }
        }
        let lag = 0.5 * (low + high);
        (unlike(lag) < AGAIN).then_some(lag)
    })
}

/// Value between samples, on the cubic through the four around it; `None` where one is missing.
pub(crate) fn cubic(channel: &MeasuredChannel, place: f64) -> Option<f64> {
    let nearest = place.round();
    if (place - nearest).abs() < 1e-6 {
        let row = nearest as usize;
        return (row < channel.values.len() && channel.valid[row]).then(|| channel.values[row]);
    }
    let row = place.floor() as usize;
    let first = row.checked_sub(1)?;
    let values = channel.values.get(first..row + 3)?;
    let valid = channel.valid[first..row + 3].iter().all(|valid| *valid);
    let weights = weights(place - row as f64);
    valid.then(|| weights.iter().zip(values).map(|(w, x)| w * x).sum())
}

/// Weights of four samples, for the place `t` between the second and the third.
pub(crate) fn weights(t: f64) -> [f64; 4] {
    [
        -t * (t - 1.0) * (t - 2.0) / 6.0,
        (t + 1.0) * (t - 1.0) * (t - 2.0) / 2.0,
        -(t + 1.0) * t * (t - 2.0) / 2.0,
        (t + 1.0) * t * (t - 1.0) / 6.0,
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{Colour, channel, noise};

    #[test]
    fn verify_periods_are_found_to_a_part_of_an_interval() {
        for seed in 0..20 {
            let truth = 170.0 + 13.37 * seed as f64;
            let wave = |k: f64| {
                let turn = std::f64::consts::TAU * k / truth;
                turn.sin() + 0.4 * (3.0 * turn + seed as f64).sin()
            };
            let clean = channel((0..1200).map(|k| wave(k as f64)).collect());
            let found = period(&[&clean]).unwrap();
            assert!((found / truth - 1.0).abs() < 1e-3, "{found} {truth}");
            let drawn = noise(Colour::White, 1200, seed);
            let noisy = clean.values.iter().zip(drawn).map(|(x, n)| x + 0.02 * n);
            let found = period(&[&channel(noisy.collect())]).unwrap();
            assert!((found / truth - 1.0).abs() < 3e-3, "{found} {truth}");
            let never = (0..1200).map(|k| wave(k as f64 + 1e-5 * (k * k) as f64));
            assert_eq!(period(&[&channel(never.collect())]), None);
        }
    }
}
