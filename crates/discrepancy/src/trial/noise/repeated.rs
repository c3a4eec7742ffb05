//! Noise of an output as it differs from one pass, or one period of the inputs, to the next.

use std::ops::Range;

use truecut_recording::fft::forward;
use truecut_recording::measured::MeasuredChannel;

use super::carried::{kept_at, left_between};
use super::slow::{Lengths, seen};
use super::{LEAST_SAMPLES, Recording, cubic, weights};
use crate::diagnose::{NoiseSample, NoiseSource};
use crate::stats::mean;

/// What a filter leaves is taken as a difference of squares where that is so many of its standard
/// errors.
const CERTAIN: f64 = 7.0;

impl Recording<'_> {
    /// Rows of each pass but the last, or of each period of the inputs, and how much later the next
    /// is at the same place.
    fn repeats(&self) -> Vec<(Range<usize>, f64)> {
        let passes = self.raw.passes();
        let count = self.used.time_s.len();
        if passes.len() > 1 && self.raw.inputs().next().is_none() {
            let interval_s = self.raw.interval_s();
            let pairs = passes.windows(2).map(|pair| {
                let lag = (pair[1].start_s - pair[0].start_s) / interval_s;
                let end = pair[0].samples.end.min(pair[1].samples.end);
                let known = before(lag, pair[1].samples.end);
                (pair[0].samples.start..end.min(known), lag)
            });
            return pairs.collect();
        }
        let (Some(period), 1) = (self.period, passes.len()) else {
            return Vec::new();
        };
        let last = before(period, count);
        let starts = (0..).map(|k| (f64::from(k) * period).round() as usize);
        let starts: Vec<usize> = starts.take_while(|start| *start < last).collect();
        let ends = starts.iter().skip(1).copied().chain([last]);
        let ranges = starts.iter().zip(ends).map(|(start, end)| *start..end);
        ranges.map(|range| (range, period)).collect()
    }

    /// Samples of the data, and those at which the inputs come again.
    pub(super) fn again(&self) -> Vec<[usize; 2]> {
        let pairs = self.repeats().into_iter().flat_map(|(rows, lag)| {
            let rows = rows.filter(|row| row % self.every == 0);
            rows.map(move |row| [row as f64, row as f64 + lag])
        });
        let sample = |row: f64| (row / self.every as f64).round() as usize;
        let count = self.used.time_s.len().div_ceil(self.every);
        pairs
            .map(|pair| pair.map(sample))
            .filter(|[_, later]| *later < count)
            .collect()
    }

    /// Differences between one pass and the next, or one period of the inputs and the next, of the
    /// size of the noise of one.
    pub(super) fn repeated(&self, used: &MeasuredChannel) -> Option<NoiseSample> {
        let repeats = self.repeats();
        let lags: Vec<f64> = repeats.iter().map(|(_, lag)| *lag).collect();
        let filtered = self.cutoff_hz().is_some();
        let stretches = (repeats.into_iter())
            .map(|(rows, lag)| {
                let rows = rows.filter(|row| row % self.every == 0);
                differences(used, lag, rows, filtered)
            })
            .collect();
        let sample = NoiseSample::of(NoiseSource::Repetition, stretches, LEAST_SAMPLES)?;
        let every = self.every as f64;
        let lengths = Lengths {
            lag: mean(&lags) / every,
            record: used.values.len() as f64 / every,
            shortest: (self.cutoff_hz()).map_or(2.0, |hz| self.raw.rate_hz() / hz / every),
        };
        let seen = seen(&sample.stretches, &lengths);
        Some(NoiseSample { seen, ..sample })
    }

    /// What the filter leaves of an output's noise of this size, by what it takes of the
    /// differences between periods, or, where that is nearly all, by the part that it leaves of
    /// them: what the arm does beyond the cutoff comes again and is none of it. What is too slow to
    /// be seen in differences passes the filter whole.
    pub(super) fn left_of(
        &self,
        noise: f64,
        raw: &MeasuredChannel,
        sample: &NoiseSample,
    ) -> Option<f64> {
        let repeats = self.repeats();
        let fraction = repeats.first().map_or(0.0, |(_, lag)| lag.fract());
        let stretches = (repeats.into_iter())
            .map(|(rows, lag)| differences(raw, lag, rows, true))
            .collect();
        let before = NoiseSample::of(NoiseSource::Repetition, stretches, LEAST_SAMPLES)?;
        let (left, _) = size(sample, |_| 1.0);
        // Interpolation takes its part of what is fast: of what comes a period later, between its
        // samples, and of both where stamps are irregular.
        let regular = raw.white_kept >= 1.0;
        let (whole, free) = size(&before, |cycles| {
            let of_later = left_between(fraction, cycles);
            let of_both = if regular {
                1.0
            } else {
                kept_at(cycles, raw.white_kept)
            };
            0.5 * (1.0 + of_later) * of_both
        });
        let taken = whole - left;
        let rest = noise.powi(2) - taken;
        if taken > 0.0 && rest > CERTAIN * taken * (2.0 / free).sqrt() {
            return Some(rest.sqrt());
        }
        let slow = left * (sample.seen.powi(-2) - 1.0);
        let part = ((left + slow) / (whole + slow)).sqrt();
        (part > 0.0 && part <= 1.0).then_some(part * noise)
    }
}

/// Mean square of a sample about the means of its stretches, each frequency by its part, and its
/// degrees of freedom.
fn size(sample: &NoiseSample, part: impl Fn(f64) -> f64) -> (f64, f64) {
    let free: usize = sample.stretches.iter().map(|one| one.len() - 1).sum();
    let squares = sample.stretches.iter().map(|one| {
        let length = one.len();
        let bins = forward(one.clone(), length).into_iter().enumerate();
        let powers = bins.map(|(k, bin)| {
            let both_sides = if k == 0 || 2 * k == length { 1.0 } else { 2.0 };
            both_sides * bin.norm_sqr() / part(k as f64 / length as f64)
        });
        powers.sum::<f64>() / length as f64
    });
    (squares.sum::<f64>() / free as f64, free as f64)
}

/// A channel's samples that many rows later less those at the rows, of the size of the noise of
/// one.
fn differences(
    channel: &MeasuredChannel,
    lag: f64,
    rows: impl Iterator<Item = usize>,
    filtered: bool,
) -> Vec<f64> {
    // Between samples the mean of several has less noise than each, unless a filter made them
    // alike.
    let later = match filtered {
        true => 1.0,
        false => weights(lag - lag.floor()).map(|w| w * w).iter().sum(),
    };
    let size = (1.0_f64 + later).sqrt();
    rows.filter(|row| channel.valid[*row])
        .filter_map(|row| {
            let later = cubic(channel, row as f64 + lag)?;
            Some((later - channel.values[row]) / size)
        })
        .collect()
}

/// The first row whose later one is not before the last but one of `count`.
fn before(lag: f64, count: usize) -> usize {
    (count as f64 - 1.0 - lag).max(0.0).ceil() as usize
}
