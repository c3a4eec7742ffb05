//! Whether two recordings repeat one motion, and by how much one of them is shifted in time.

use truecut_recording::Unit;
use truecut_recording::measured::{Measured, MeasuredChannel};

use crate::stats::{deviation, mean};
use crate::trial::noise::{cubic, held_step, weights, without_memory};

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
/// From this ratio of intervals on a recording is slower than the other, which is smoothed.
const SLOWER: f64 = 1.2;

/// An input in both recordings.
struct Input<'a> {
    first: &'a MeasuredChannel,
    second: &'a MeasuredChannel,
    /// What differences are held against: its own deviation, the larger of both, unless it stands
    /// still.
    deviation: f64,
    /// Variances of the noise of each, over the square of the deviation.
    noises: [f64; 2],
    /// Step of readings that hold still, where it is fine: so much apart is rounding.
    count: f64,
}

/// An input that moves by less than this part of what another one of its unit does stands still:
/// what it is apart is held against that; where none of them moves, against 1 rad or 1 m, by which
/// a place changes the machine's levers, or against how large they are.
const STANDS_STILL: f64 = 0.05;
/// What deviates by less than so many times its noise without memory does not move.
const NO_MOTION: f64 = 1.5;

impl<'a> Input<'a> {
    /// `of_unit` is what inputs in the same unit do.
    fn of([first, second]: [&'a MeasuredChannel; 2], of_unit: f64) -> Input<'a> {
        let both = [first, second];
        let deviation = larger_deviation(both).max(STANDS_STILL * of_unit);
        let noises = both.map(|one| without_memory(&one.values, &one.valid).powi(2));
        Input {
            first,
            second,
            deviation,
            noises: noises.map(|noise| noise / deviation.powi(2).max(f64::MIN_POSITIVE)),
            count: match count(both) {
                rounding if rounding < STANDS_STILL * deviation => rounding,
                _ => 0.0,
            },
        }
    }

    /// How unlike both are, beyond their noise, if the second comes `lag` intervals later.
    fn unlike(&self, lag: f64, stride: usize) -> f64 {
        let [apart, chance] = self.apart(lag, stride, self.count);
        (apart - chance).max(0.0).sqrt()
    }

    /// Mean square of what is apart if the second comes `lag` intervals later, without what noise
    /// gives in the mean, and by how much more it may give by chance; both over the square of the
    /// deviation. What is apart by no more than `count` is not. The first is infinite where too few
    /// rows meet.
    fn apart(&self, lag: f64, stride: usize, count: f64) -> [f64; 2] {
        let rows = (0..self.first.values.len()).step_by(stride);
        let pairs = rows.filter_map(|row| {
            let place = row as f64 + lag;
            let later = (place >= 0.0)
                .then(|| cubic(self.second, place))
                .flatten()?;
            let apart = (later - self.first.values[row]).abs();
            self.first.valid[row].then(|| (apart - count).max(0.0))
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

/// Step of readings most of which are that of the sample before, the larger of both.
fn count(both: [&MeasuredChannel; 2]) -> f64 {
    let [a, b] = both.map(|one| held_step(&one.values, &one.valid, 1.0));
    a.max(b)
}

/// What the inputs in one unit do: the largest deviation of one that moves, or what their places
/// are held against where none does.
fn of_unit(pairs: &[[&MeasuredChannel; 2]], unit: Unit) -> f64 {
    let alike = || pairs.iter().filter(|[one, _]| one.spec.unit == unit);
    let moves = |one: &MeasuredChannel, count: f64| {
        let noise = without_memory(&one.values, &one.valid);
        deviation(&one.values) > (NO_MOTION * noise).max(count)
    };
    let moving = alike().filter(|both| both.iter().any(|one| moves(one, count(**both))));
    let largest = moving.fold(0.0_f64, |most, both| most.max(larger_deviation(*both)));
    if largest > 0.0 {
        return largest;
    }
    match unit {
        Unit::Radian | Unit::Metre => 1.0,
        _ => (alike().flatten()).fold(0.0, |most, one| most.max(mean(&one.values).abs())),
    }
}

/// Intervals by which the second recording comes later, and how unlike the inputs are there; `None`
/// where it does not repeat the first. Both have the same interval.
pub(super) fn later(first: &Measured, second: &Measured) -> Option<(f64, f64)> {
    let pairs: Vec<[&MeasuredChannel; 2]> = (first.inputs())
        .map(|one| Some([one, second.channel(&one.spec.name).ok()?]))
        .collect::<Option<_>>()?;
    let inputs: Vec<Input> = (pairs.iter())
        .map(|both| Input::of(*both, of_unit(&pairs, both[0].spec.unit)))
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
    // Chance and rounding are no part of where both are most alike: they would make the least a
    // wide one.
    let apart = |lag: f64| -> f64 {
        let each = inputs.iter().map(|input| input.apart(lag, stride, 0.0)[0]);
        each.fold(f64::NEG_INFINITY, f64::max)
    };
    let mut ends = minima.iter().take(PLACES).map(|&k| {
        let lag = least(&apart, lags[k] - step, lags[k] + step);
        (lag, unlike(lag))
    });
    ends.find(|end| end.1 < AGAIN)
}

/// Recordings of which each sample has its place: nothing drives them, or they begin several times,
/// each time after as long as in the other.
fn as_they_are(first: &Measured, second: &Measured, inputs: &[Input]) -> Option<(f64, f64)> {
    let [a, b] = [first, second].map(|one| one.passes());
    let later_s = b[0].start_s - a[0].start_s;
    let slack_s = NO_SHIFT * first.interval_s();
    let same = a.len() == b.len()
        && (a.iter().zip(&b)).all(|(a, b)| (b.start_s - a.start_s - later_s).abs() < slack_s);
    let lag = match later_s.abs() < slack_s {
        true => 0.0,
        false => later_s / first.interval_s(),
    };
    let most = inputs.iter().map(|input| input.unlike(lag, 1));
    let most = most.fold(0.0, f64::max);
    (same && most < AGAIN).then_some((lag, most))
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

/// Samples of a recording `interval_s` apart, from its time `start_s` on; itself where they are its
/// own.
pub(super) fn resampled(measured: &Measured, interval_s: f64, start_s: f64) -> Measured {
    let ratio = interval_s / measured.interval_s();
    let last = measured.time_s.len() - 1;
    if (ratio - 1.0).abs() * (last as f64) < NO_SHIFT && start_s < NO_SHIFT * interval_s {
        return measured.clone();
    }
    measured.taken_anew(interval_s, start_s)
}

/// The second recording at places that are whole intervals from those that are kept of the first,
/// one of `every`, and by how many of these it comes later: by `lag` intervals, at which inputs are
/// apart by the part `unlike`.
pub(super) fn placed(
    second: &Measured,
    interval_s: f64,
    (lag, unlike): (f64, f64),
    every: usize,
) -> (Measured, Motion, i64) {
    let whole = (lag + NO_SHIFT).floor();
    let skipped = (whole as i64).rem_euclid(every as i64);
    let begins = (lag - whole).max(0.0) + skipped as f64;
    let motion = Motion::Repeated {
        later_s: lag * interval_s,
        unlike,
    };
    let second = resampled(second, interval_s, begins * interval_s);
    (second, motion, (whole as i64 - skipped) / every as i64)
}

/// What both recordings have in common is known at the rate of the slower; rates that are nearly
/// the same count as that of the first.
pub(super) fn common_interval_s(first: &Measured, second: &Measured) -> f64 {
    let [first_s, second_s] = [first, second].map(Measured::interval_s);
    match second_s > SLOWER * first_s {
        true => second_s,
        false => first_s,
    }
}

#[cfg(test)]
mod tests;
