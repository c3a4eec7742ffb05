//! Noise of the outputs as it shows where no model is needed: repeated motion, standstill, and
//! differences in time.

mod carried;
mod inputs;
mod period;
mod repeated;
mod slow;
mod steps;

use std::ops::Range;

use truecut_recording::ChannelSpec;
use truecut_recording::measured::{Measured, MeasuredChannel};
use truecut_scenario::{ProcessSpec, ReplayMode, Scenario};
use truecut_sim::InverseModel;

use self::carried::{Filter, carried};
pub(crate) use self::inputs::of_inputs;
use self::period::period;
pub(crate) use self::period::{cubic, weights};
pub(crate) use self::steps::held_step;
use crate::diagnose::{NoiseSample, NoiseSource, Observation};
use crate::stats::{deviation, mean};

/// Fewest samples of noise that say how large it is.
const LEAST_SAMPLES: usize = 40;
/// Fewest samples and shortest time of a stretch at rest.
const REST_SAMPLES: usize = 8;
const REST_S: f64 = 0.25;
/// Part of its range by which an input may creep within [`REST_S`] while it counts as at rest.
const CREEP: f64 = 1e-4;
/// Stretches at rest whose variance is so many times the median still ring.
const RINGING: f64 = 4.0;
/// Orders of differences in time: motion is smooth, so that high ones are noise alone.
const DIFFERENCES: usize = 6;

/// What is known of an output's noise.
#[derive(Default)]
struct Known {
    /// Standard deviation as stated, carried through the filter.
    pub stated: Option<f64>,
    /// Of its square, relative.
    pub stated_error: f64,
    pub sample: Option<NoiseSample>,
    /// Standard deviation if the noise has no memory.
    pub without_memory: f64,
    /// Step between readings that hold still from one sample to the next; 0 where they do not.
    pub held_step: f64,
}

/// The recording whose outputs `used` are, at the same rate: filtered in mode "inverse", and
/// thinned afterwards.
pub(super) struct Recording<'a> {
    scenario: &'a Scenario,
    raw: &'a Measured,
    used: &'a Measured,
    every: usize,
    at_rest: Vec<bool>,
    /// Intervals after which all inputs come again.
    period: Option<f64>,
}

impl<'a> Recording<'a> {
    pub fn new(
        scenario: &'a Scenario,
        raw: &'a Measured,
        used: &'a Measured,
        every: usize,
    ) -> Recording<'a> {
        let inputs: Vec<&MeasuredChannel> = raw.inputs().collect();
        Recording {
            scenario,
            raw,
            used,
            every,
            at_rest: at_rest(&inputs, raw.rate_hz()),
            period: period(&inputs),
        }
    }

    /// Adds to each output, of these channels, what is known of its noise.
    pub fn add(&self, observation: &mut Observation, channels: &[ChannelSpec]) {
        for (output, spec) in observation.outputs.iter_mut().zip(channels) {
            let known = self.known(&spec.name);
            output.noise = known.stated;
            output.noise_error = known.stated_error;
            output.sample = known.sample;
            output.noise_without_memory = known.without_memory;
            output.held_step = known.held_step;
        }
        observation.again = self.again();
    }

    /// Of the channel of this name.
    fn known(&self, name: &str) -> Known {
        let find = |measured: &'a Measured| measured.outputs().find(|one| one.spec.name == name);
        let (Some(raw), Some(used)) = (find(self.raw), find(self.used)) else {
            return Known::default();
        };
        let share = self.share();
        let filter = self.cutoff_hz().map(|hz| Filter {
            cutoff: hz / self.raw.rate_hz(),
            share,
        });
        let is_carried = filter.as_ref().is_some_and(|filter| filter.share < 1.0);
        let repeated = self.repeated(used);
        let carried = |noise: f64| match &filter {
            Some(filter) if is_carried => (repeated.as_ref())
                .and_then(|sample| self.left_of(noise, raw, sample))
                .unwrap_or_else(|| carried(noise, filter, raw, used)),
            _ => noise,
        };
        Known {
            stated: raw.noise.map(carried),
            stated_error: if is_carried { carried::ERROR } else { 0.0 },
            sample: repeated.or_else(|| self.resting(used)),
            without_memory: share * without_memory(&raw.values, &raw.valid),
            held_step: held_step(&raw.values, &raw.valid, share),
        }
    }

    /// Part of the standard deviation of white noise that is left by the filter of drive forces.
    fn share(&self) -> f64 {
        let rate_hz = self.raw.rate_hz();
        self.cutoff_hz()
            .map_or(1.0, |hz| InverseModel::white_share(hz, rate_hz))
    }

    fn cutoff_hz(&self) -> Option<f64> {
        let ProcessSpec::Replay(replay) = &self.scenario.process else {
            return None;
        };
        match replay.mode {
            ReplayMode::Inverse {
                compare_cutoff_hz, ..
            } => Some(compare_cutoff_hz),
            _ => None,
        }
    }

    /// Windows of the time during which all inputs stand still.
    fn resting(&self, used: &MeasuredChannel) -> Option<NoiseSample> {
        let rate_hz = self.raw.rate_hz();
        // What was before and after reaches as far as the filter does.
        let reach = self
            .cutoff_hz()
            .map_or(0, |hz| (rate_hz / hz).ceil() as usize);
        let length =
            ((REST_S * rate_hz).ceil() as usize).max(REST_SAMPLES * self.every) / self.every;
        let mut windows: Vec<Vec<f64>> = Vec::new();
        for stretch in runs(&self.at_rest) {
            let (start, end) = (stretch.start + reach, stretch.end.saturating_sub(reach));
            let rows: Vec<usize> = (start..end)
                .filter(|row| row % self.every == 0 && used.valid[*row])
                .collect();
            let windowed = rows.chunks_exact(length);
            windows.extend(windowed.map(|rows| rows.iter().map(|row| used.values[*row]).collect()));
        }
        let mut deviations: Vec<f64> = windows.iter().map(|x| deviation(x)).collect();
        deviations.sort_by(f64::total_cmp);
        let median = *deviations.get(deviations.len() / 2)?;
        windows.retain(|x| deviation(x).powi(2) <= RINGING * median.powi(2));
        NoiseSample::of(NoiseSource::Standstill, windows, LEAST_SAMPLES)
    }
}

/// Standard deviation of white noise on something smooth: the least of those by differences of
/// several orders (`hall1990`), each of which takes what is left of the signal for noise.
pub(crate) fn without_memory(values: &[f64], valid: &[bool]) -> f64 {
    let mut differences = values.to_vec();
    let mut factor = 1.0;
    let mut least = f64::INFINITY;
    for order in 1..=DIFFERENCES {
        differences = differences
            .windows(2)
            .map(|pair| pair[1] - pair[0])
            .collect();
        // The sum of squared binomial coefficients is that in the middle of twice the order.
        factor *= (4 * order - 2) as f64 / order as f64;
        let kept = differences.iter().enumerate();
        let kept: Vec<f64> = kept
            .filter(|(k, _)| valid[*k..=k + order].iter().all(|valid| *valid))
            .map(|(_, x)| x * x / factor)
            .collect();
        if kept.len() >= LEAST_SAMPLES {
            least = least.min(mean(&kept).sqrt());
        }
    }
    if least.is_finite() { least } else { 0.0 }
}

/// Stretches of samples that are marked.
pub(super) fn runs(marked: &[bool]) -> Vec<Range<usize>> {
    let mut found = Vec::new();
    let mut start = None;
    for (k, marked) in marked.iter().chain(std::iter::once(&false)).enumerate() {
        match (marked, start) {
            (true, None) => start = Some(k),
            (false, Some(first)) => {
                found.push(first..k);
                start = None;
            }
            _ => {}
        }
    }
    found
}

/// Where every input stands still, by its mean over two halves of a window; nowhere without inputs.
fn at_rest(inputs: &[&MeasuredChannel], rate_hz: f64) -> Vec<bool> {
    let Some(count) = inputs.first().map(|input| input.values.len()) else {
        return Vec::new();
    };
    let half = ((0.5 * REST_S * rate_hz).ceil() as usize).max(REST_SAMPLES / 2);
    let mut still = vec![true; count.saturating_sub(2 * half)];
    for input in inputs {
        let range = range_of(&input.values);
        let noise = without_memory(&input.values, &input.valid);
        let most = CREEP * range + 6.0 * noise / (half as f64).sqrt();
        let mut sums = vec![0.0];
        let first = input.values[0];
        sums.extend(input.values.iter().scan(0.0, |sum, x| {
            *sum += x - first;
            Some(*sum)
        }));
        for (k, still) in still.iter_mut().enumerate() {
            let [a, b] = [k, k + half].map(|from| (sums[from + half] - sums[from]) / half as f64);
            let valid = input.valid[k..k + 2 * half].iter().all(|valid| *valid);
            *still &= valid && (b - a).abs() <= most;
        }
    }
    let mut rest = vec![false; count];
    // Turning points pass for rest in a single window: it must go on for as long again.
    for run in runs(&still).iter().filter(|run| run.len() > half) {
        rest[run.start + half / 2..run.end + 2 * half - half / 2].fill(true);
    }
    rest
}

fn range_of(values: &[f64]) -> f64 {
    let low = values.iter().copied().fold(f64::INFINITY, f64::min);
    values.iter().copied().fold(f64::NEG_INFINITY, f64::max) - low
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{Colour, channel, noise};

    #[test]
    fn verify_differences_find_white_noise_on_a_smooth_signal() {
        for seed in 0..20 {
            let white = noise(Colour::White, 2000, seed);
            let rows = white.iter().enumerate();
            let values: Vec<f64> = rows
                .map(|(k, n)| 500.0 * (0.03 * k as f64).sin() + 0.4 * n)
                .collect();
            let found = without_memory(&values, &vec![true; 2000]) / 0.4;
            assert!((0.9..1.1).contains(&found), "{found}");
        }
    }

    #[test]
    fn verify_rest_is_where_the_inputs_rest() {
        for (seed, level) in [(1, 0.0), (2, 1e-3), (3, 1e-2)] {
            let drawn = noise(Colour::White, 1500, seed);
            let moved = |k: usize| match k {
                0..500 => 0.0,
                500..1000 => 1.0 - (0.02 * (k - 500) as f64).cos(),
                _ => 1.0 - 10_f64.cos(),
            };
            let values = drawn.iter().enumerate().map(|(k, n)| moved(k) + level * n);
            let rest = at_rest(&[&channel(values.collect())], 100.0);
            let moving = rest[510..990].iter().filter(|still| **still).count();
            let still = (rest[..500].iter().chain(&rest[1000..])).filter(|still| **still);
            assert!(moving == 0 && still.count() > 900, "level {level}");
        }
    }
}
