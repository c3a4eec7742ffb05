//! Significance of a change in noise of any memory.
//!
//! An autoregression of low order knows nothing of noise whose power grows towards ever lower
//! frequencies (1/f); a constant or a slow drift then looks sure when it is not. Here the spectrum
//! of what is left is taken as it is, octave by octave, and its low end is continued to the
//! frequencies that the record is too short for.

use std::ops::Range;

use truecut_recording::fft;

use super::problem::Problem;
use crate::model::Columns;

/// Least ratio of the change to its standard deviation in noise of that spectrum.
const LEAST_DISTANCE: f64 = 3.5;
/// Least mean ratio over both noise models: this one, and an autoregression.
pub(super) const LEAST_MEAN_DISTANCE: f64 = 5.1;
/// The same where the autoregression leaves a doubt, in units of the scale of [`stands_far_out`]
/// (tuned: 120 drawn sets without a cause, of arms that are led and of arms that are pushed, came
/// to 5.4 at most and mostly to less than 4, two causes that had been missed to 6.1 and 6.5).
const FAR_MEAN_DISTANCE: f64 = 6.0;
/// A generalisation must stand out so far from what it generalises, which is itself beyond doubt.
pub(super) const LEAST_GENERALISATION: f64 = 1.8;
/// Lowest frequency, in cycles per record, at which a spectrum can be read off.
const LOWEST: usize = 3;
/// The low end of a spectrum, in cycles per record.
const FITTED_UP_TO: usize = 96;

/// What is slower than can be read off counts by so much less: how noise goes on below the record's
/// lowest frequencies is a guess.
const SLOW_PART: f64 = 0.8;
/// And where the change is whatever fits best, out of many that are slow, by so much.
const SLOW_PART_OF_ANY: f64 = 0.5;
/// Shapes of a spectrum's low end that are less likely than the likeliest by no more than this
/// logarithm are possible, too.
const POSSIBLE: f64 = 2.0;

/// Distance of two residuals, in standard deviations of noise with the spectrum of the second;
/// development part, all channels.
pub(super) fn distance(problem: &Problem, first: &Columns, second: &Columns) -> f64 {
    let rows = &problem.split.development.per_channel;
    let parts = (first.iter().zip(second).zip(rows))
        .map(|((a, b), rows)| squares(problem, rows, a, b, Freedom::default()));
    let parts = parts.fold([0.0; 2], |sum, part| [sum[0] + part[0], sum[1] + part[1]]);
    weighed(parts, SLOW_PART)
}

/// Whether a change is beyond chance in noise of any memory, besides gaining `gain` in minus twice
/// the log-likelihood under an autoregression. It must be so by `scale` times as much as the best
/// of single changes of one size.
pub(super) fn stands_out(problem: &Problem, gain: f64, scale: f64, pair: [&Columns; 2]) -> bool {
    let (distance, mean) = two_views(problem, gain, pair);
    distance > scale * LEAST_DISTANCE && mean > scale * LEAST_MEAN_DISTANCE
}

/// Whether it is so far beyond chance there that an autoregression need not rule chance out by
/// itself.
pub(super) fn stands_far_out(
    problem: &Problem,
    gain: f64,
    scale: f64,
    pair: [&Columns; 2],
) -> bool {
    two_views(problem, gain, pair).1 > scale * FAR_MEAN_DISTANCE
}

/// Distance of a pair of residuals in noise of any memory, and its mean with that under an
/// autoregression.
fn two_views(problem: &Problem, gain: f64, [first, second]: [&Columns; 2]) -> (f64, f64) {
    let distance = distance(problem, first, second);
    (distance, 0.5 * (gain.max(0.0).sqrt() + distance))
}

/// Number of fitted parameters of a change.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Freedom {
    /// They take the noise away, too, where they are slow: there the spectrum is continued from
    /// where they cannot reach.
    pub parameters: usize,
    /// Those by which it was laid on the frequencies where most was to be explained: an octave in
    /// which it acts has lost as many of its degrees of freedom.
    pub tuned: usize,
}

/// Distance in one channel, where the change may be anything that fits.
pub(super) fn channel_distance(
    problem: &Problem,
    rows: &[usize],
    first: &[f64],
    second: &[f64],
    freedom: Freedom,
) -> f64 {
    let squares = squares(problem, rows, first, second, freedom);
    weighed(squares, SLOW_PART_OF_ANY)
}

fn weighed([slow, fast]: [f64; 2], slow_part: f64) -> f64 {
    fast.sqrt().max(slow_part * (slow + fast).sqrt())
}

/// Squared distances below `LOWEST` and from it on.
fn squares(
    problem: &Problem,
    rows: &[usize],
    first: &[f64],
    second: &[f64],
    freedom: Freedom,
) -> [f64; 2] {
    let samples = || problem.split.blocks.iter().cloned().flatten();
    let change = between(rows, samples(), |t| first[t] - second[t]);
    let change = periodogram(change);
    let left = periodogram(samples().map(|t| second[t]).collect());
    let noise = smoothed(&left, LOWEST.max(freedom.parameters));
    let last = change.len() - 1;
    // Frequencies but the first and the last stand for two.
    let count = |k: usize| if k == 0 || k == last { 1.0 } else { 2.0 };
    let ratios = change.iter().zip(&noise).enumerate();
    let ratios: Vec<f64> = ratios
        .map(|(k, (c, n))| count(k) * c / n.max(f64::MIN_POSITIVE))
        .collect();
    let kept = kept_by_octave(&ratios, freedom.tuned);
    let mut parts = [0.0; 2];
    for (k, (ratio, kept)) in ratios.iter().zip(&kept).enumerate() {
        parts[usize::from(k >= LOWEST)] += ratio * kept;
    }
    parts
}

/// Share of an octave's degrees of freedom that a change laid by so many numbers leaves to the
/// noise, by the frequency in its middle. They act where the change is, by its squares over the
/// noise.
fn kept_by_octave(ratios: &[f64], tuned: usize) -> Vec<f64> {
    let sums = running_sums(ratios);
    let whole = sums[ratios.len()].max(f64::MIN_POSITIVE);
    let kept = |k: usize| {
        let octave = octave(k.max(LOWEST), ratios.len());
        let freedom = 2.0 * octave.len() as f64;
        let share = (sums[octave.end] - sums[octave.start]) / whole;
        ((freedom - tuned as f64 * share) / freedom).max(1.0 / freedom)
    };
    (0..ratios.len()).map(kept).collect()
}

/// A change at the rows, and on straight lines between them: elsewhere nothing was fitted, and it
/// may be anything.
fn between(
    rows: &[usize],
    samples: impl Iterator<Item = usize>,
    change: impl Fn(usize) -> f64,
) -> Vec<f64> {
    let last = rows.len() - 1;
    let mut next = 0;
    let line = samples.map(|t| {
        while next < last && rows[next] < t {
            next += 1;
        }
        let (a, b) = (rows[next.saturating_sub(1)], rows[next]);
        if t >= b || t <= a || a == b {
            return change(if t <= a && next > 0 { a } else { b });
        }
        let part = (t - a) as f64 / (b - a) as f64;
        (1.0 - part) * change(a) + part * change(b)
    });
    line.collect()
}

fn periodogram(x: Vec<f64>) -> Vec<f64> {
    let length = x.len();
    let bins = fft::forward(x, length);
    bins.iter().map(|z| z.norm_sqr()).collect()
}

/// Frequencies of the octave about one, of so many.
fn octave(k: usize, count: usize) -> Range<usize> {
    let low = ((k as f64 / 1.42).ceil() as usize).max(1);
    low..((k as f64 * 1.42).floor() as usize).min(count - 1) + 1
}

fn running_sums(x: &[f64]) -> Vec<f64> {
    let mut sums = vec![0.0];
    for x in x {
        sums.push(sums[sums.len() - 1] + x);
    }
    sums
}

/// Means over an octave about each frequency, continued below `lowest` as the low end of the
/// spectrum goes.
fn smoothed(power: &[f64], lowest: usize) -> Vec<f64> {
    let sums = running_sums(power);
    let mean = |octave: Range<usize>| (sums[octave.end] - sums[octave.start]) / octave.len() as f64;
    let mut smooth: Vec<f64> = (0..power.len())
        .map(|k| mean(octave(k.max(LOWEST), power.len())))
        .collect();
    for (k, value) in smooth.iter_mut().enumerate().take(lowest) {
        // What is slower than the record by up to a decade looks like a constant in it.
        let frequency = (k as f64).max(0.15);
        *value = value.max(continued(power, lowest, frequency));
    }
    smooth
}

/// The low end of a spectrum, continued to any frequency: a power law, as of 1/f noise, or flat up
/// to a corner, as of an autoregression of first order. Of those that are possible by Whittle's
/// likelihood the one with most power there.
fn continued(power: &[f64], lowest: usize, frequency: f64) -> f64 {
    let range = lowest - 1
        ..FITTED_UP_TO
            .min(power.len() / 2)
            .max(2 * lowest)
            .min(power.len());
    let n = range.len() as f64;
    let mut shapes = Vec::new();
    let mut try_shape = |shape: &dyn Fn(f64) -> f64| {
        let ratios: f64 = range.clone().map(|k| power[k] / shape(k as f64)).sum();
        let level = ratios / n;
        let logs: f64 = range.clone().map(|k| shape(k as f64).ln()).sum();
        let criterion = n * level.max(f64::MIN_POSITIVE).ln() + logs;
        shapes.push((criterion, level * shape(frequency)));
    };
    for step in 0..=10 {
        let exponent = 0.25 * f64::from(step);
        try_shape(&|k| k.powf(-exponent));
    }
    for step in 0..=12 {
        let corner = 2.0 * 1.5_f64.powi(step);
        try_shape(&|k| 1.0 / (1.0 + (k / corner).powi(2)));
    }
    let best = shapes.iter().map(|s| s.0).fold(f64::INFINITY, f64::min);
    let possible = shapes.iter().filter(|s| s.0 <= best + POSSIBLE);
    possible.map(|s| s.1).fold(0.0, f64::max)
}
