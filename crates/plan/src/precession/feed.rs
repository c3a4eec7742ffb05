//! Feed and largest rate of the angle along the path, lowered where they must be.

use std::f64::consts::FRAC_PI_4;

use super::task::PrecessionLimits;

/// What one lowering leaves of the feed.
const STEP: f64 = 0.9;

/// A feed within this share of what was asked counts as not lowered.
const UNCHANGED: f64 = 1e-9;

/// A stretch of the path on which the feed is lower than asked.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FeedReduction {
    /// Where it begins and ends, from the path's start.
    pub from_m: f64,
    pub to_m: f64,
    /// Lowest feed on it.
    pub least_m_per_s: f64,
    /// What it costs.
    pub lost_s: f64,
}

/// Feed and largest rate of the angle for each interval.
pub(super) struct FeedPace {
    lengths_m: Vec<f64>,
    asked_m_per_s: f64,
    least_m_per_s: f64,
    acceleration_m_s2: f64,
    feeds_m_per_s: Vec<f64>,
    rates_rad_s: Vec<f64>,
    /// Whether an interval has been lowered since the last time it all settled.
    slowed: Vec<bool>,
}

impl FeedPace {
    pub fn new(
        lengths_m: Vec<f64>,
        asked_m_per_s: f64,
        least_m_per_s: f64,
        limits: &PrecessionLimits,
    ) -> Self {
        let count = lengths_m.len();
        Self {
            lengths_m,
            asked_m_per_s,
            least_m_per_s,
            acceleration_m_s2: limits.feed_acceleration_m_s2,
            rates_rad_s: vec![limits.rate_rad_s; count],
            feeds_m_per_s: vec![asked_m_per_s; count],
            slowed: vec![false; count],
        }
    }

    /// Time at each station.
    pub fn times_s(&self) -> Vec<f64> {
        let mut times = vec![0.0];
        let mut time = 0.0;
        for (length, feed) in self.lengths_m.iter().zip(&self.feeds_m_per_s) {
            time += length / feed;
            times.push(time);
        }
        times
    }

    /// The rate that all intervals from one knot to the next allow.
    pub fn least_rates_rad_s(&self, knots: &[usize]) -> Vec<f64> {
        let least = |w: &[usize]| {
            let rates = self.rates_rad_s[w[0]..w[1]].iter();
            rates.copied().fold(f64::INFINITY, f64::min)
        };
        knots.windows(2).map(least).collect()
    }

    /// Time before a station from which the angle can get an eighth of a turn on until there. What
    /// is missing on the way to a station is time; spent nearer to it, it costs lower feeds, spent
    /// further away, feed where the angle has nowhere to go yet.
    pub fn turned_before_s(&self, station: usize, times_s: &[f64]) -> f64 {
        let mut left_rad = FRAC_PI_4;
        for k in (0..station).rev() {
            left_rad -= self.rates_rad_s[k] * (times_s[k + 1] - times_s[k]);
            if left_rad <= 0.0 {
                return times_s[k];
            }
        }
        times_s[0]
    }

    /// Lowers the largest rate of the angle in all intervals that are met between two times.
    pub fn hold_rate(&mut self, rate_rad_s: f64, from_s: f64, to_s: f64, times_s: &[f64]) {
        let first = times_s[1..].partition_point(|end| *end < from_s);
        let count = self.lengths_m.len();
        for k in (first..count).take_while(|k| times_s[*k] <= to_s) {
            self.rates_rad_s[k] = self.rates_rad_s[k].min(rate_rad_s);
        }
    }

    /// Lowers the feed by a step in all intervals that are met between two times; each once until
    /// it settles.
    ///
    /// # Errors
    /// The least feed, if it would fall below.
    pub fn slow(&mut self, from_s: f64, to_s: f64, times_s: &[f64]) -> Result<(), f64> {
        let first = times_s[1..].partition_point(|end| *end < from_s);
        let count = self.lengths_m.len();
        for k in (first..count).take_while(|k| times_s[*k] <= to_s) {
            self.slow_to(k, STEP)?;
        }
        Ok(())
    }

    /// Lowers the feed of an interval to a share of itself, once until it settles.
    ///
    /// # Errors
    /// The least feed, if it would fall below.
    pub fn slow_to(&mut self, interval: usize, share: f64) -> Result<(), f64> {
        if self.slowed[interval] {
            return Ok(());
        }
        self.slowed[interval] = true;
        let feed = &mut self.feeds_m_per_s[interval];
        *feed *= share;
        if *feed < self.least_m_per_s {
            return Err(self.least_m_per_s);
        }
        Ok(())
    }

    /// Brakes in time for every lowered feed, and speeds up after it no faster.
    pub fn settle(&mut self) {
        self.slowed.fill(false);
        let count = self.lengths_m.len();
        let onwards = (1..count).map(|k| (k, k - 1));
        let back = (1..count).rev().map(|k| (k - 1, k));
        for (k, beside) in onwards.chain(back) {
            let apart_m = 0.5 * (self.lengths_m[k] + self.lengths_m[beside]);
            let slower = self.feeds_m_per_s[beside];
            let most = (slower * slower + 2.0 * self.acceleration_m_s2 * apart_m).sqrt();
            self.feeds_m_per_s[k] = self.feeds_m_per_s[k].min(most);
        }
    }

    /// Stretches on which the feed is lower than asked.
    pub fn reductions(&self, along_m: &[f64]) -> Vec<FeedReduction> {
        let mut found: Vec<FeedReduction> = Vec::new();
        let mut within = false;
        for (k, feed) in self.feeds_m_per_s.iter().enumerate() {
            let lower = *feed < self.asked_m_per_s * (1.0 - UNCHANGED);
            if lower && !within {
                found.push(FeedReduction {
                    from_m: along_m[k],
                    to_m: along_m[k],
                    least_m_per_s: *feed,
                    lost_s: 0.0,
                });
            }
            within = lower;
            if let (true, Some(stretch)) = (lower, found.last_mut()) {
                stretch.to_m = along_m[k + 1];
                stretch.least_m_per_s = stretch.least_m_per_s.min(*feed);
                stretch.lost_s += self.lengths_m[k] * (1.0 / feed - 1.0 / self.asked_m_per_s);
            }
        }
        found
    }
}
