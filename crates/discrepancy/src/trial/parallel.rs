//! Parallel decimation: of filtered drive forces, measured and predicted alike, as many samples as
//! the filter leaves worth of information. (`gautier1997`.)
//!
//! Between the filter's cutoff and half the rate of the data nothing is left but rounding. A search
//! that whitens noise would weigh that as much as the motion.

use truecut_recording::measured::Measured;
use truecut_recording::short_number;
use truecut_scenario::{ProcessSpec, ReplayMode, Scenario};

use crate::diagnose::MIN_SAMPLES;

/// Samples kept per period of the cutoff. At 2 the cutoff is half the rate of what is kept: the
/// spectrum is filled to its end.
const PER_PERIOD: f64 = 2.0;

/// Most that are kept of a record that would otherwise be too short. Neighbours are alike then; the
/// autoregression takes care of that, up to where rounding begins.
const MOST_PER_PERIOD: f64 = 4.0;

/// Relative error of a rate that is read off times in decimals.
const ROUNDING: f64 = 1e-6;

/// What was kept of filtered drive forces for the search.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Thinning {
    /// Samples of the data for one that is kept.
    pub every: usize,
    /// The filter's cutoff, Hz.
    pub cutoff_hz: f64,
    /// Samples kept per period of the cutoff.
    pub per_period: f64,
    /// Whether more are kept than the filter leaves worth of information, since the record is
    /// short.
    pub is_short: bool,
}

impl Thinning {
    /// Of filtered drive forces; none elsewhere. The widest that leaves enough samples of each.
    pub(super) fn of(scenario: &Scenario, filtered: &Measured) -> Option<Thinning> {
        let cutoff_hz = cutoff_hz(scenario)?;
        let rate_hz = filtered.rate_hz();
        let enough = |every: &usize| {
            let kept = |valid: &[bool]| valid.iter().step_by(*every).filter(|one| **one).count();
            (filtered.outputs()).all(|one| kept(&one.valid) >= MIN_SAMPLES)
        };
        let whole = widest(rate_hz, PER_PERIOD * cutoff_hz);
        let closest = widest(rate_hz, MOST_PER_PERIOD * cutoff_hz);
        let every = (closest..=whole).rev().find(enough).unwrap_or(closest);
        Some(Thinning {
            every,
            cutoff_hz,
            per_period: rate_hz / every as f64 / cutoff_hz,
            is_short: every < whole,
        })
    }

    /// The cutoff that would leave enough samples where this one left only so many valid ones.
    pub fn enough_hz(&self, valid: usize) -> f64 {
        let lacks = MIN_SAMPLES as f64 / valid.max(1) as f64;
        lacks * self.cutoff_hz * self.per_period / MOST_PER_PERIOD
    }

    /// What was done to that many samples, as a note of the report.
    pub(super) fn told(&self, samples: usize) -> Option<String> {
        let short = match self.is_short {
            true => format!(", more than {PER_PERIOD} since the record is short"),
            false => String::new(),
        };
        (self.every > 1).then(|| {
            format!(
                "drive forces are filtered at {} Hz; of {samples} samples one in {} serves, {} in all: {} a period of \
                 that{short}",
                short_number(self.cutoff_hz),
                self.every,
                samples.div_ceil(self.every),
                short_number(self.per_period),
            )
        })
    }
}

/// Data as they are compared with a run: drive forces that were filtered as thin as a search takes
/// them, with a note, all else as it is. Beyond the cutoff a filtered series falls further than the
/// background of its spectrum is followed, and its edge would be told as lines.
pub fn for_comparison(scenario: &Scenario, measured: Measured) -> Measured {
    let Some(thinning) = Thinning::of(scenario, &measured).filter(|one| one.every > 1) else {
        return measured;
    };
    let mut used = thinned(&measured, thinning.every);
    used.notes.extend(thinning.told(measured.time_s.len()));
    used
}

/// The filter's cutoff, where drive forces are filtered.
fn cutoff_hz(scenario: &Scenario) -> Option<f64> {
    let ProcessSpec::Replay(replay) = &scenario.process else {
        return None;
    };
    match replay.mode {
        ReplayMode::Inverse {
            compare_cutoff_hz, ..
        } => Some(compare_cutoff_hz),
        _ => None,
    }
}

/// Samples of the data for one that is kept, if at least so many a second are to be.
fn widest(rate_hz: f64, kept_hz: f64) -> usize {
    ((rate_hz / kept_hz * (1.0 + ROUNDING)) as usize).max(1)
}

/// Samples of the data for one that holds as much as the filter leaves.
pub(crate) fn spacing(scenario: &Scenario, rate_hz: f64) -> usize {
    cutoff_hz(scenario).map_or(1, |cutoff_hz| widest(rate_hz, PER_PERIOD * cutoff_hz))
}

/// Every so many-th sample of all channels.
pub(super) fn thinned(measured: &Measured, every: usize) -> Measured {
    let mut thinned = measured.clone();
    thinned.time_s = picked(&measured.time_s, every);
    for (channel, whole) in thinned.channels.iter_mut().zip(&measured.channels) {
        channel.values = picked(&whole.values, every);
        channel.valid = picked(&whole.valid, every);
    }
    thinned
}

/// Every so many-th value.
pub(crate) fn picked<T: Copy>(values: &[T], every: usize) -> Vec<T> {
    values.iter().step_by(every).copied().collect()
}
