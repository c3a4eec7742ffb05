//! Channels that are sampled faster than the result: smoothed, so that nothing folds back.

use super::resample::{Base, Gaps, Series, on_grid};
use crate::filter::{Butterworth, left_of_noise};

/// Order of the filter that keeps out what would fold back; it acts twice.
pub(super) const ANTI_ALIAS_ORDER: usize = 4;
/// Its cutoff as a share of the new rate.
pub(super) const ANTI_ALIAS_SHARE: f64 = 0.4;

/// A series at a multiple of the rate of a result.
pub(super) struct Smoothed {
    pub every: usize,
    interval_s: f64,
    raw: Vec<f64>,
    pub smooth: Vec<f64>,
    pub valid: Vec<bool>,
}

impl Series {
    /// Standard deviation that resampling leaves of noise of the samples: of white noise its part
    /// below the cutoff, of noise with a memory more, as much as smoothing does not take.
    pub fn noise_left(&self, noise: f64, base: &Base, gaps: Gaps) -> f64 {
        if !self.is_smoothed(base) {
            return noise;
        }
        let fine = self.smoothed(base, gaps);
        let count = fine.raw.len();
        let places = self.on(base.start_s, fine.interval_s, count, 0.0);
        let kept = places.map(|place| place.squares()).sum::<f64>() / count as f64;
        let rows = (0..count).filter(|k| fine.valid[*k]);
        let taken = rows.map(|k| fine.raw[k] - fine.smooth[k]);
        left_of_noise(noise, taken, kept).max(self.white_share(base) * noise)
    }

    /// The series at a rate that is a multiple of the result's, and smoothed.
    pub fn smoothed(&self, base: &Base, gaps: Gaps) -> Smoothed {
        let every = (base.interval_s / self.interval_s()).ceil() as usize;
        let interval_s = base.interval_s / every as f64;
        let count = (base.samples - 1) * every + 1;
        let (raw, valid) = on_grid(self, base.start_s, interval_s, count, gaps);
        let [cutoff_hz, rate_hz] = [ANTI_ALIAS_SHARE / base.interval_s, 1.0 / interval_s];
        let filter = Butterworth::low_pass(ANTI_ALIAS_ORDER, cutoff_hz, rate_hz);
        Smoothed {
            smooth: filter.zero_phase(&raw),
            every,
            interval_s,
            raw,
            valid,
        }
    }

    /// Part of the standard deviation of white noise that resampling leaves.
    fn white_share(&self, base: &Base) -> f64 {
        let interval_s = self.interval_s();
        match self.is_smoothed(base) {
            false => 1.0,
            true => Butterworth::white_share(
                ANTI_ALIAS_ORDER,
                ANTI_ALIAS_SHARE / base.interval_s,
                1.0 / interval_s,
            ),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::resample::resample;
    use super::*;

    /// White noise of unit variance: sums of twelve even numbers (SplitMix64, `steele2014`).
    fn white(seed: u64, count: usize) -> Vec<f64> {
        let mut state = seed;
        let mut draw = || {
            state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
            let mut z = state;
            z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
            z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
            ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
        };
        (0..count)
            .map(|_| (0..12).map(|_| draw()).sum::<f64>() - 6.0)
            .collect()
    }

    fn deviation(x: &[f64]) -> f64 {
        let mean = x.iter().sum::<f64>() / x.len() as f64;
        (x.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / x.len() as f64).sqrt()
    }

    /// White noise, and white noise beside as much with a memory of a tenth of a second or more, at
    /// rates that fit into one another or do not: what is told to be left is what is left.
    #[test]
    fn verify_noise_left_by_thinning() {
        for seed in 0..24_u64 {
            let (count, slow) = (6000, seed % 2 == 1);
            let memory = 0.96 + 0.001 * seed as f64;
            let [drawn, pushed] = [white(seed, count), white(seed + 100, count)];
            let mut state = 0.0;
            let values: Vec<f64> = (drawn.iter().zip(&pushed))
                .map(|(white, pushed)| {
                    state = memory * state + (1.0 - memory * memory).sqrt() * pushed;
                    if slow { white + state } else { *white }
                })
                .collect();
            let series = Series {
                time_s: (0..count).map(|k| k as f64 / 250.0).collect(),
                values: values.clone(),
                ..Series::default()
            };
            let base = Base::within(0.0, (3.0 + 0.2 * seed as f64) / 250.0, 23.9, 1.0 / 250.0);
            let gaps = Gaps {
                bridged_s: 0.05,
                smoothly_s: 0.0,
                drives: false,
            };
            let (thinned, _) = resample(&series, &base, gaps);
            let told = series.noise_left(deviation(&values), &base, gaps);
            let ratio = told / deviation(&thinned);
            assert!((0.8..1.3).contains(&ratio), "seed {seed}: {ratio}");
            let by_white = series.white_share(&base) * deviation(&values) / deviation(&thinned);
            assert!(!slow || by_white < 0.8, "seed {seed}: {by_white}");
        }
    }
}
