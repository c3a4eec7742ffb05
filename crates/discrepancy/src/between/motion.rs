//! Whether two recordings repeat one motion, and by how much one of them is shifted in time.

use truecut_recording::measured::{Measured, MeasuredChannel, Pass};

use crate::stats::{deviation, mean};
use crate::trial::noise::{cubic, weights, without_memory};

/// How the motions of two recordings compare.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Motion {
    /// The second repeats the first: what the model gets wrong of both goes with the difference.
    Repeated {
        /// By so much it comes later in its file, s.
        later_s: f64,
        /// Inputs differ by so much at most, beyond their noise, as a part of their deviation.
        unlike: f64,
    },
    /// They differ, so that what is common has to be modelled.
    Different,
}

/// Inputs that differ by less than this part of their deviation repeat: of what the model gets
/// wrong of both, the difference then keeps no more than this part.
const AGAIN: f64 = 0.02;
/// By more than this, nothing near does.
const UNLIKE: f64 = 0.5;
/// Rows that are compared at most.
const COMPARED: usize = 1500;
/// Places at which the second recording may lie so that the first is like it; the nearest first.
const PLACES: usize = 20;
/// A shift of less than this part of an interval is none.
const NO_SHIFT: f64 = 1e-3;

/// An input in both recordings.
struct Input<'a> {
    first: &'a MeasuredChannel,
    second: &'a MeasuredChannel,
    /// The larger of both.
    deviation: f64,
    /// Variances of the noise of each, over the square of the deviation.
    noises: [f64; 2],
}

/// An input that moves by less than this part of what another one of its unit does stands still:
/// what it is apart is held against that.
const STANDS_STILL: f64 = 0.05;

impl<'a> Input<'a> {
    /// `largest` is the largest deviation of an input in the same unit.
    fn of(first: &'a MeasuredChannel, second: &'a MeasuredChannel, largest: f64) -> Input<'a> {
        let both = [first, second];
        let deviation = larger_deviation(both).max(STANDS_STILL * largest);
        let noises = both.map(|one| without_memory(&one.values, &one.valid).powi(2));
        Input {
            first,
            second,
            deviation,
            noises: noises.map(|noise| noise / deviation.powi(2).max(f64::MIN_POSITIVE)),
        }
    }

    /// How unlike both are, beyond their noise, if the second comes `lag` intervals later.
    fn unlike(&self, lag: f64, stride: usize) -> f64 {
        let [apart, chance] = self.apart(lag, stride);
        (apart - chance).max(0.0).sqrt()
    }

    /// Mean square of what is apart if the second comes `lag` intervals later, without what noise
    /// gives in the mean, and by how much more it may give by chance; both over the square of the
    /// deviation. The first is infinite where too few rows meet.
    fn apart(&self, lag: f64, stride: usize) -> [f64; 2] {
        let rows = (0..self.first.values.len()).step_by(stride);
        let pairs = rows.filter_map(|row| {
            let place = row as f64 + lag;
            let later = (place >= 0.0)
                .then(|| cubic(self.second, place))
                .flatten()?;
            self.first.valid[row].then(|| later - self.first.values[row])
        });
        let apart: Vec<f64> = pairs.collect();
        let shorter = self.first.values.len().min(self.second.values.len());
        if 2 * apart.len() * stride < shorter {
            return [f64::INFINITY, 0.0];
        }
        if self.deviation <= 0.0 {
            return match apart.iter().all(|x| *x == 0.0) {
                true => [0.0, 0.0],
                false => [f64::INFINITY, 0.0],
            };
        }
        let squares: Vec<f64> = apart.iter().map(|x| (x / self.deviation).powi(2)).collect();
        // Between samples the interpolation takes a part of the second's noise away.
        let kept: f64 = weights(lag - lag.floor()).map(|w| w * w).iter().sum();
        let noise = self.noises[0] + kept * self.noises[1];
        // The mean of squares is known to a part of itself.
        let chance = 6.0 / (squares.len() as f64).sqrt() * noise;
        [mean(&squares) - noise, chance]
    }
}

fn larger_deviation(both: [&MeasuredChannel; 2]) -> f64 {
    let [a, b] = both.map(|one| deviation(&one.values));
    a.max(b)
}

/// Intervals by which the second recording comes later, and how unlike the inputs are there; `None`
/// where it does not repeat the first. Both have the same interval.
pub(super) fn later(first: &Measured, second: &Measured) -> Option<(f64, f64)> {
    let pairs: Vec<[&MeasuredChannel; 2]> = (first.inputs())
        .map(|one| Some([one, second.channel(&one.spec.name).ok()?]))
        .collect::<Option<_>>()?;
    let largest = |unit| {
        let alike = pairs.iter().filter(|[one, _]| one.spec.unit == unit);
        alike.fold(0.0_f64, |most, pair| most.max(larger_deviation(*pair)))
    };
    let inputs: Vec<Input> = (pairs.iter())
        .map(|[one, other]| Input::of(one, other, largest(one.spec.unit)))
        .collect();
    if inputs.is_empty() || !first.passes.is_empty() || !second.passes.is_empty() {
        return as_they_are(first, second, &inputs);
    }
    let [n, m] = [first.time_s.len(), second.time_s.len()];
    let stride = (n / COMPARED).max(1);
    let unlike = |lag: f64| -> f64 {
        let mut most = 0.0_f64;
        for input in &inputs {
            most = most.max(input.unlike(lag, stride));
            if most > UNLIKE {
                break;
            }
        }
        most
    };
    if unlike(0.0) < AGAIN / 10.0 {
        return Some((0.0, unlike(0.0)));
    }
    let step = stride.min(4) as f64;
    let reach = |count: usize| (count as f64 / 2.0 / step) as i64;
    let lags: Vec<f64> = (-reach(n)..=reach(m)).map(|k| k as f64 * step).collect();
    let coarse: Vec<f64> = lags.iter().map(|lag| unlike(*lag)).collect();
    let at = |k: usize| coarse.get(k).copied().unwrap_or(f64::INFINITY);
    let mut minima: Vec<usize> = (0..lags.len())
        .filter(|&k| at(k) < UNLIKE && (k == 0 || at(k) <= at(k - 1)) && at(k) <= at(k + 1))
        .collect();
    minima.sort_by(|a, b| lags[*a].abs().total_cmp(&lags[*b].abs()));
    // Chance is no part of where both are most alike: it would make the least a wide one.
    let apart = |lag: f64| -> f64 {
        let each = inputs.iter().map(|input| input.apart(lag, stride)[0]);
        each.fold(f64::NEG_INFINITY, f64::max)
    };
    let mut ends = minima.iter().take(PLACES).map(|&k| {
        let lag = least(&apart, lags[k] - step, lags[k] + step);
        (lag, unlike(lag))
    });
    ends.find(|end| end.1 < AGAIN)
}

/// Recordings of which each sample has its place: nothing drives them, or they begin several times.
fn as_they_are(first: &Measured, second: &Measured, inputs: &[Input]) -> Option<(f64, f64)> {
    let [a, b] = [first, second].map(|one| one.passes());
    let interval_s = first.interval_s();
    let near = |a: f64, b: f64| (a - b).abs() < 1e-6 * interval_s;
    let same = a.len() == b.len()
        && (a.iter().zip(&b)).all(|(a, b)| {
            a.samples.start == b.samples.start
                && near(
                    first.time_s[a.samples.start] - a.start_s,
                    second.time_s[b.samples.start] - b.start_s,
                )
        });
    let most = inputs.iter().map(|input| input.unlike(0.0, 1));
    let most = most.fold(0.0, f64::max);
    (same && most < AGAIN).then_some((0.0, most))
}

/// Where the function is least, between these ends.
fn least(of: &impl Fn(f64) -> f64, mut low: f64, mut high: f64) -> f64 {
    while high - low > 1e-3 {
        let (a, b) = (low + (high - low) / 3.0, high - (high - low) / 3.0);
        if of(a) < of(b) {
            high = b;
        } else {
            low = a;
        }
    }
    0.5 * (low + high)
}

/// Samples of a recording from the place `first` on, in intervals of `interval_s`; itself where
/// they are its own.
pub(super) fn resampled(measured: Measured, interval_s: f64, first: f64) -> Measured {
    let ratio = interval_s / measured.interval_s();
    let last = measured.time_s.len() - 1;
    if (ratio - 1.0).abs() * (last as f64) < NO_SHIFT && first < NO_SHIFT {
        return measured;
    }
    let count = ((last as f64 - first) / ratio).floor() as usize + 1;
    let places: Vec<f64> = (0..count).map(|k| first + k as f64 * ratio).collect();
    let squares: Vec<f64> = (places.iter())
        .map(|place| weights(place - place.floor()).map(|w| w * w).iter().sum())
        .collect();
    let at_an_end = |place: f64| place < 1.0 || place > last as f64 - 1.0;
    let channels = (measured.channels.iter()).map(|channel| {
        let value = |place: &f64| match at_an_end(*place) {
            true => at_end(channel, *place),
            false => cubic(channel, *place),
        };
        let found: Vec<Option<f64>> = places.iter().map(value).collect();
        let near = |k: usize| channel.values[(places[k].round() as usize).min(last)];
        MeasuredChannel {
            values: (found.iter().enumerate())
                .map(|(k, value)| value.unwrap_or_else(|| near(k)))
                .collect(),
            valid: found.iter().map(Option::is_some).collect(),
            white_kept: channel.white_kept * mean(&squares),
            ..channel.clone()
        }
    });
    let channels = channels.collect();
    let passes = passes_at(&measured, interval_s, first, count);
    let mut there = Measured {
        channels,
        time_s: (0..count).map(|k| k as f64 * interval_s).collect(),
        passes,
        ..measured.clone()
    };
    for channel in &mut there.channels {
        for (place, valid) in places.iter().zip(&mut channel.valid) {
            *valid &= !meets_two(&measured.passes, *place);
        }
    }
    there
}

/// Runs of the process, their samples counted anew.
fn passes_at(measured: &Measured, interval_s: f64, first: f64, count: usize) -> Vec<Pass> {
    let old_s = measured.interval_s();
    let anew = |sample: usize| {
        let row = ((sample as f64 - first) * old_s / interval_s - NO_SHIFT).ceil();
        (row.max(0.0) as usize).min(count)
    };
    let begins_s = first * old_s;
    let passes = measured.passes.iter().map(|pass| Pass {
        samples: anew(pass.samples.start)..anew(pass.samples.end),
        start_s: (pass.start_s - begins_s).max(0.0),
    });
    passes.filter(|pass| !pass.samples.is_empty()).collect()
}

/// Whether the samples around a place belong to two runs.
fn meets_two(passes: &[Pass], place: f64) -> bool {
    let around = (place.floor() - 1.0).max(0.0) as usize..=place.floor() as usize + 2;
    let mut begins = passes.iter().skip(1).map(|pass| pass.samples.start);
    begins.any(|start| around.contains(&start) && *around.start() < start)
}

/// Value in the first or last interval, on the cubic through the four samples nearest to it.
fn at_end(channel: &MeasuredChannel, place: f64) -> Option<f64> {
    let first = match place < 1.0 {
        true => 0,
        false => channel.values.len().checked_sub(4)?,
    };
    let values = channel.values.get(first..first + 4)?;
    let valid = channel.valid[first..first + 4].iter().all(|valid| *valid);
    let weights = weights(place - (first + 1) as f64);
    valid.then(|| weights.iter().zip(values).map(|(w, x)| w * x).sum())
}

#[cfg(test)]
mod tests;
