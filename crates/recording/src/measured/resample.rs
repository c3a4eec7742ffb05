//! One uniform time base for all channels.

use super::place::Place;
use super::smoothed::{ANTI_ALIAS_ORDER, ANTI_ALIAS_SHARE};
use super::{ChannelMapping, DataError, MIN_SAMPLES, Mapping};
use crate::spline::spline_slopes;
use crate::unit::significant;

/// A channel counts as faster than the result from this ratio of rates on.
const FASTER: f64 = 1.2;
/// Samples that are further apart, in median intervals, have a gap between them; cubics cross none.
pub(super) const JITTER: f64 = 1.8;
/// Share of an interval within which two times are the same.
const SLACK: f64 = 1e-6;
/// Part of the median interval within which a sample repeats the one before it: the slope between
/// them is that of their rounding.
const TWIN: f64 = 1e-2;
/// Most samples of a result.
const MOST_SAMPLES: f64 = 2e7;
/// A result has no more than so many samples for one of its fastest channel: those between follow
/// from their neighbours.
const MOST_FOR_ONE: f64 = 10.0;

/// The valid samples of a channel.
#[derive(Debug, Default)]
pub(super) struct Series {
    pub time_s: Vec<f64>,
    pub values: Vec<f64>,
    /// Rows without a number.
    pub missing: usize,
    /// Rows at the end of the sensor's range.
    pub saturated: usize,
    /// The first of those rows, for messages.
    pub first_masked: Option<String>,
}

impl Series {
    pub fn note(&self, channel: &ChannelMapping) -> Option<String> {
        let first = self.first_masked.as_ref()?;
        Some(format!(
            "{}: masked rows: {} without a number, {} saturated; the first is {first}",
            channel.channel, self.missing, self.saturated
        ))
    }

    /// Whether it is sampled faster than the result, and so smoothed.
    pub fn is_smoothed(&self, base: &Base) -> bool {
        base.interval_s / self.interval_s() > FASTER
    }

    /// Median time between samples.
    pub fn interval_s(&self) -> f64 {
        median_interval_s(&self.time_s)
    }

    /// Mean square, over the base, of what interpolation leaves of white noise of the size one.
    pub fn white_kept(&self, base: &Base) -> f64 {
        if self.is_smoothed(base) {
            return 1.0;
        }
        let squares = self.places(base).map(|place| place.squares());
        squares.sum::<f64>() / base.samples as f64
    }

    /// Where on the series the times of the result lie.
    pub fn places(&self, base: &Base) -> impl Iterator<Item = Place> + '_ {
        self.on(base.start_s, base.interval_s, base.samples, 0.0)
    }

    /// Where on the series uniform times lie; cubics cross gaps of `smooth_gap_s`.
    pub fn on(
        &self,
        start_s: f64,
        interval_s: f64,
        samples: usize,
        smooth_gap_s: f64,
    ) -> impl Iterator<Item = Place> + '_ {
        let most_apart_s = self.most_apart_s(smooth_gap_s);
        let nearness_s = [SLACK * interval_s, most_apart_s];
        let mut from = 0;
        (0..samples).map(move |k| self.at(start_s + k as f64 * interval_s, nearness_s, &mut from))
    }

    /// How far apart samples may lie for a cubic to go from one to the next.
    fn most_apart_s(&self, smooth_gap_s: f64) -> f64 {
        smooth_gap_s.max(JITTER * self.interval_s())
    }

    /// Without samples that repeat the one before.
    fn without_twins(&self) -> Series {
        let least_s = TWIN * self.interval_s();
        let mut kept = Series::default();
        for (time_s, value) in self.time_s.iter().zip(&self.values) {
            if kept
                .time_s
                .last()
                .is_none_or(|last| time_s - last > least_s)
            {
                kept.time_s.push(*time_s);
                kept.values.push(*value);
            }
        }
        kept
    }

    /// Slopes of splines through the samples, from one gap that cubics do not cross to the next.
    fn slopes(&self, most_apart_s: f64) -> Vec<f64> {
        let mut slopes = Vec::with_capacity(self.values.len());
        for times in (self.time_s).chunk_by(|a, b| b - a <= most_apart_s) {
            let from = slopes.len();
            let values = &self.values[from..from + times.len()];
            slopes.extend(spline_slopes(times, values));
        }
        slopes
    }

    /// Where `t` is between the samples around it: on the cubic through the two on either side,
    /// where these are no further apart than stamps jitter, else on the line. A time within
    /// `slack_s` of a sample is that sample's: times are rounded. `from` remembers the place
    /// between calls with rising times.
    fn at(&self, t: f64, [slack_s, most_apart_s]: [f64; 2], from: &mut usize) -> Place {
        let last = self.time_s.len() - 1;
        while *from + 1 < last && self.time_s[*from + 1] <= t + slack_s {
            *from += 1;
        }
        let (row, next) = (*from, *from + 1);
        let (t0, t1) = (self.time_s[row], self.time_s[next]);
        if t <= t0 + slack_s {
            let apart_s = t0 - t;
            return Place::Sample { row, apart_s };
        }
        if t >= t1 - slack_s {
            let apart_s = t - t1;
            return Place::Sample { row: next, apart_s };
        }
        let apart_s = t1 - t0;
        let part = (t - t0) / apart_s;
        self.cubic(row, t, most_apart_s)
            .unwrap_or(Place::Line { row, part, apart_s })
    }

    /// The cubic through the samples from the one before `row` on, at `t`; `None` where two of them
    /// lie further apart than `most_apart_s`, or one is missing.
    fn cubic(&self, row: usize, t: f64, most_apart_s: f64) -> Option<Place> {
        let first = row.checked_sub(1)?;
        let times = self.time_s.get(first..first + 4)?;
        let apart = times.windows(2).map(|pair| pair[1] - pair[0]);
        if apart.fold(0.0, f64::max) > most_apart_s {
            return None;
        }
        let weight = |i: usize| -> f64 {
            let others = (0..4).filter(|j| *j != i);
            others
                .map(|j| (t - times[j]) / (times[i] - times[j]))
                .product()
        };
        Some(Place::Cubic {
            first,
            weights: std::array::from_fn(weight),
            apart_s: times[2] - times[1],
            part: (t - times[1]) / (times[2] - times[1]),
        })
    }
}

pub(super) fn median_interval_s(time_s: &[f64]) -> f64 {
    let mut intervals: Vec<f64> = time_s.windows(2).map(|pair| pair[1] - pair[0]).collect();
    intervals.sort_by(f64::total_cmp);
    intervals[intervals.len() / 2]
}

/// The uniform times of the result.
#[derive(Debug)]
pub(super) struct Base {
    pub start_s: f64,
    pub interval_s: f64,
    pub samples: usize,
    file_interval_s: f64,
}

impl Base {
    pub fn new(
        source: &str,
        mapping: &Mapping,
        time_s: &[f64],
        series: &[Series],
    ) -> Result<Base, DataError> {
        let fail = |message: String| {
            Err(DataError::File {
                source_name: source.to_owned(),
                message,
            })
        };
        let file_interval_s = median_interval_s(time_s);
        let interval_s = mapping.resample_hz.map_or(file_interval_s, |hz| 1.0 / hz);
        let sampled = series.iter().filter(|one| one.time_s.len() > 1);
        let each = sampled.map(|one| median_interval_s(&one.time_s));
        let fastest_s = each.fold(file_interval_s, f64::min);
        if interval_s * MOST_FOR_ONE * (1.0 + 1e-9) < fastest_s {
            return fail(format!(
                "`data.resample_hz` is {}, but must be at most {}, ten times the rate of the fastest channel: samples \
                 between those of the file say nothing new",
                significant(1.0 / interval_s, 6),
                significant(MOST_FOR_ONE / fastest_s, 6)
            ));
        }
        // From the first time at which every channel has begun to the last at which none has ended.
        let start = series.iter().map(|one| one.time_s[0]);
        let start_s = start.fold(time_s[0], f64::max);
        let end = series.iter().filter_map(|one| one.time_s.last().copied());
        let end_s = end.fold(time_s[time_s.len() - 1], f64::min);
        // A last sample that rounding put just beyond the end still counts.
        let count = ((end_s - start_s) / interval_s + 1e-3).floor() + 1.0;
        if count > MOST_SAMPLES {
            return fail(format!(
                "the data would have {count:.3e} samples, but must have at most {MOST_SAMPLES:.0e}: it fits into memory"
            ));
        }
        if count < MIN_SAMPLES as f64 {
            return fail(format!(
                "the channels have {:.0} samples in common, but at least {MIN_SAMPLES} are needed",
                count.max(0.0)
            ));
        }
        Ok(Base {
            start_s,
            interval_s,
            samples: count as usize,
            file_interval_s,
        })
    }

    /// From a time on within data of this length and this interval.
    pub fn within(start_s: f64, interval_s: f64, duration_s: f64, file_interval_s: f64) -> Base {
        // A last sample that rounding put just beyond the end still counts.
        let count = ((duration_s - start_s) / interval_s + 1e-3).floor() + 1.0;
        Base {
            start_s,
            interval_s,
            samples: count.max(1.0) as usize,
            file_interval_s,
        }
    }

    /// Time of the file that is 0 here, s.
    pub fn start_s(&self) -> f64 {
        self.start_s
    }

    pub fn interval_s(&self) -> f64 {
        self.interval_s
    }

    /// Times from 0 on.
    pub fn times(&self) -> Vec<f64> {
        (0..self.samples)
            .map(|k| k as f64 * self.interval_s)
            .collect()
    }

    pub fn notes(&self, mapping: &Mapping) -> Vec<String> {
        let rate = |interval_s: f64| significant(1.0 / interval_s, 6);
        let mut notes = vec![format!(
            "{} samples at {} Hz (median rate of the file {} Hz), by cubics between samples; \
             gaps up to {} s are bridged; time 0 is {} s of the file",
            self.samples,
            rate(self.interval_s),
            rate(self.file_interval_s),
            significant(mapping.max_gap_s, 3),
            significant(self.start_s, 7),
        )];
        notes.extend(self.smoothed());
        notes
    }

    /// That channels are smoothed, if so.
    pub fn smoothed(&self) -> Option<String> {
        (self.interval_s > FASTER * self.file_interval_s).then(|| {
            format!(
                "channels sampled faster are smoothed first: Butterworth of order {ANTI_ALIAS_ORDER}, forward \
                 and backward, cutoff {} Hz",
                significant(ANTI_ALIAS_SHARE / self.interval_s, 4)
            )
        })
    }
}

/// Gaps in a channel, s.
#[derive(Debug, Clone, Copy)]
pub(super) struct Gaps {
    /// Longest that is bridged.
    pub bridged_s: f64,
    /// Longest that is bridged by a cubic: what drives a model kicks it at the ends of a line.
    pub smoothly_s: f64,
    /// Whether it drives a model. Then it is a spline between samples: cubics through four of them
    /// each meet at their ends with different slopes, and err more beside uneven samples; stiff
    /// springs feel both.
    pub drives: bool,
}

/// Rows that seem to be missing between rising times.
pub(super) fn missing_rows(time_s: &[f64]) -> usize {
    let interval_s = median_interval_s(time_s);
    let steps = time_s
        .windows(2)
        .map(|pair| (pair[1] - pair[0]) / interval_s);
    steps
        .filter(|step| *step > JITTER)
        .map(|step| step.round() as usize - 1)
        .sum()
}

/// Values and validity of a channel at the times of `base`.
pub(super) fn resample(series: &Series, base: &Base, gaps: Gaps) -> (Vec<f64>, Vec<bool>) {
    if !series.is_smoothed(base) {
        return on_grid(series, base.start_s, base.interval_s, base.samples, gaps);
    }
    let fine = series.smoothed(base, gaps);
    let every = fine.every;
    // A filtered sample is a measurement if everything within a period of the cutoff is one.
    let reach = (every as f64 / ANTI_ALIAS_SHARE).ceil() as usize;
    let mut good_until = vec![0_usize; fine.valid.len() + 1];
    for (k, valid) in fine.valid.iter().enumerate() {
        good_until[k + 1] = good_until[k] + usize::from(*valid);
    }
    let at = |k: usize| {
        let (from, to) = (
            k.saturating_sub(reach),
            (k + reach + 1).min(fine.valid.len()),
        );
        good_until[to] - good_until[from] == to - from
    };
    (0..base.samples)
        .map(|k| (fine.smooth[k * every], at(k * every)))
        .unzip()
}

pub(super) fn on_grid(
    series: &Series,
    start_s: f64,
    interval_s: f64,
    samples: usize,
    gaps: Gaps,
) -> (Vec<f64>, Vec<bool>) {
    let distinct = gaps.drives.then(|| series.without_twins());
    let series = distinct.as_ref().unwrap_or(series);
    let most_apart_s = series.most_apart_s(gaps.smoothly_s);
    let slopes = match gaps.drives {
        true => series.slopes(most_apart_s),
        false => Vec::new(),
    };
    (series.on(start_s, interval_s, samples, gaps.smoothly_s))
        .map(|place| {
            let is_bridged = place.apart_s() <= gaps.bridged_s;
            let value = match slopes.is_empty() {
                true => place.value(&series.values),
                false => place.splined(&series.values, &slopes, most_apart_s),
            };
            (value, is_bridged)
        })
        .unzip()
}
