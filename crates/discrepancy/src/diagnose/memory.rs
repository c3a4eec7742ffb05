//! Whether a change stands out of noise of any memory.
//!
//! An autoregression of low order knows nothing of noise whose power grows towards ever lower frequencies (1/f); a constant or a slow
//! drift then looks sure when it is not. Here the spectrum of what is left is taken as it is, octave by octave, and its slope is
//! continued to the frequencies that the record is too short for.

use realfft::RealFftPlanner;

use super::problem::Problem;
use crate::model::Columns;

/// The change must be so many times what noise of that spectrum would do to it.
pub(super) const LEAST_DISTANCE: f64 = 6.0;
/// Lowest frequency, in cycles per record, at which a spectrum can be read off.
const LOWEST: usize = 3;
/// The slope is read off between `LOWEST` and this.
const SLOPE_UP_TO: usize = 48;

/// What is slower than can be read off counts by so much less: how noise goes on below the record's lowest frequencies is a guess.
const SLOW_PART: f64 = 0.6;

/// Distance of two residuals, in standard deviations of noise with the spectrum of the second; development part, all channels.
pub(super) fn distance(problem: &Problem, first: &Columns, second: &Columns) -> f64 {
    let parts = first
        .iter()
        .zip(second)
        .map(|(a, b)| squares(problem, a, b));
    weighed(parts.fold([0.0; 2], |sum, part| [sum[0] + part[0], sum[1] + part[1]]))
}

/// The same for one channel.
pub(super) fn channel_distance(problem: &Problem, first: &[f64], second: &[f64]) -> f64 {
    weighed(squares(problem, first, second))
}

fn weighed([slow, fast]: [f64; 2]) -> f64 {
    fast.sqrt().max(SLOW_PART * (slow + fast).sqrt())
}

/// Squared distances below `LOWEST` and from it on.
fn squares(problem: &Problem, first: &[f64], second: &[f64]) -> [f64; 2] {
    let samples = || problem.split.blocks.iter().cloned().flatten();
    let change = periodogram(samples().map(|t| first[t] - second[t]).collect());
    let noise = smoothed(&periodogram(samples().map(|t| second[t]).collect()));
    let last = change.len() - 1;
    let mut parts = [0.0; 2];
    for (k, (c, n)) in change.iter().zip(&noise).enumerate() {
        // Frequencies but the first and the last stand for two.
        let count = if k == 0 || k == last { 1.0 } else { 2.0 };
        if *c > 0.0 {
            parts[usize::from(k >= LOWEST)] += count * c / n.max(f64::MIN_POSITIVE);
        }
    }
    parts
}

fn periodogram(mut x: Vec<f64>) -> Vec<f64> {
    let transform = RealFftPlanner::<f64>::new().plan_fft_forward(x.len());
    let mut spectrum = transform.make_output_vec();
    transform
        .process(&mut x, &mut spectrum)
        .expect("buffers are of the plan's own lengths");
    spectrum.iter().map(|z| z.norm_sqr()).collect()
}

/// Means over an octave about each frequency, continued below `LOWEST` along the slope found above it.
fn smoothed(power: &[f64]) -> Vec<f64> {
    let mut sums = vec![0.0];
    for p in power {
        sums.push(sums[sums.len() - 1] + p);
    }
    let octave = |k: usize| {
        let low = ((k as f64 / 1.42).ceil() as usize).max(1);
        let high = ((k as f64 * 1.42).floor() as usize).min(power.len() - 1);
        (sums[high + 1] - sums[low]) / (high + 1 - low) as f64
    };
    let mut smooth: Vec<f64> = (0..power.len()).map(|k| octave(k.max(LOWEST))).collect();
    let top = SLOPE_UP_TO.min(power.len() - 1);
    // Steps of about an octave, so that each counts the same.
    let points: Vec<(f64, f64)> = (0..)
        .map(|i| LOWEST << i)
        .take_while(|k| *k <= top)
        .map(|k| ((k as f64).ln(), octave(k).max(f64::MIN_POSITIVE).ln()))
        .collect();
    let n = points.len() as f64;
    let (x, y) = points
        .iter()
        .fold((0.0, 0.0), |(x, y), p| (x + p.0 / n, y + p.1 / n));
    let products = points.iter().fold((0.0, 0.0), |(xy, xx), p| {
        (xy + (p.0 - x) * (p.1 - y), xx + (p.0 - x).powi(2))
    });
    let slope = if products.1 > 0.0 {
        (products.0 / products.1).min(0.0)
    } else {
        0.0
    };
    for (k, value) in smooth.iter_mut().enumerate().take(LOWEST) {
        // What is slower than the record by up to a decade looks like a constant in it.
        let frequency = (k as f64).max(0.15);
        *value = value.max((y + slope * (frequency.ln() - x)).exp());
    }
    smooth
}
