//! Noise as it is stated, for samples of the file, carried through the filter of drive forces.

use truecut_recording::fft::Complex64;
use truecut_recording::filter::left_of_noise;
use truecut_recording::measured::MeasuredChannel;
use truecut_sim::InverseModel;

use super::weights;
use crate::stats::quiet_density;

/// Relative error of the variance of what is carried: of the channels of 80 sets drawn at random
/// (seeds 9300000 on, all colours of noise) one in twenty is given less than .73 of its standard
/// deviation.
pub(super) const ERROR: f64 = 0.15;
/// Part of the segments in which friction's jumps add little.
const QUIET: f64 = 0.3;
/// Where the noise's density is looked at: from so many times the cutoff to a part of the rate,
/// beyond which interpolation between samples at irregular times lowers it.
const FROM_CUTOFF: f64 = 1.2;
const TO_RATE: f64 = 0.25;
/// Of a slow rate up to so many times the cutoff, and to what is less than half the rate.
const TO_CUTOFF: f64 = 3.0;
const LAST: f64 = 0.45;
/// Length of a segment in periods of the cutoff, at least.
const PERIODS: f64 = 1.5;
/// Frequencies at which the densities of the families are taken, and members of each family.
const FREQUENCIES: usize = 2048;
const MEMBERS: usize = 60;
/// Greatest coefficient of an autoregression, and exponent of a power of the frequency.
const MOST_MEMORY: f64 = 0.996;
const MOST_POWER: f64 = 1.6;

/// A low-pass filter of drive forces.
pub(super) struct Filter {
    /// Cycles per sample.
    pub cutoff: f64,
    /// Part of the standard deviation of white noise that it leaves.
    pub share: f64,
}

/// Standard deviation of noise, as it is stated for samples of the file, behind the filter. White
/// noise loses its part beyond the cutoff; of noise with a memory less lies there. How much does is
/// seen in two ways, of which the larger counts, since each takes what the arm does beyond the
/// cutoff for noise: by the size of what the filter takes, and by its colour just beyond.
pub(super) fn carried(
    noise: f64,
    filter: &Filter,
    raw: &MeasuredChannel,
    used: &MeasuredChannel,
) -> f64 {
    if filter.share >= 1.0 {
        return noise;
    }
    let taken: Vec<f64> = (raw.values.iter().zip(&used.values))
        .map(|(raw, used)| raw - used)
        .collect();
    let is_kept = taken.iter().zip(&used.valid).filter(|(_, valid)| **valid);
    let by_size = left_of_noise(noise, is_kept.map(|(taken, _)| *taken), raw.white_kept);
    let by_colour = share_of_colour(noise, filter, &taken, raw.white_kept, &used.valid);
    let by_colour = noise * by_colour.unwrap_or(0.0);
    (filter.share * noise).max(by_size).max(by_colour)
}

/// Part of the standard deviation that the filter leaves of noise of this size whose density beyond
/// the cutoff is nearest to what is there, by Whittle's likelihood: among autoregressions of first
/// order and powers of the frequency. `None` if nothing lies beyond the cutoff.
fn share_of_colour(
    noise: f64,
    filter: &Filter,
    taken: &[f64],
    white_kept: f64,
    valid: &[bool],
) -> Option<f64> {
    let length = ((PERIODS / filter.cutoff).ceil() as usize).next_power_of_two();
    let found = quiet_density(taken, valid, length, QUIET)?;
    let cycles = |bin: usize| bin as f64 / length as f64;
    let gain = |cycles: f64| InverseModel::filter_gain(filter.cutoff, cycles);
    let last = TO_RATE.max(TO_CUTOFF * filter.cutoff).min(LAST);
    let beyond: Vec<(f64, f64)> = (0..=length / 2)
        .filter(|&bin| (FROM_CUTOFF * filter.cutoff..=last).contains(&cycles(bin)))
        .map(|bin| {
            let is_taken = 1.0 - gain(cycles(bin));
            let is_there = is_taken.powi(2) * kept_at(cycles(bin), white_kept);
            (cycles(bin), found[bin] / is_there)
        })
        .filter(|(_, density)| *density > 0.0)
        .collect();
    let slowest = 1.0 / taken.len() as f64;
    let unlikely = |colour: &Colour| -> f64 {
        let terms = beyond.iter().map(|(cycles, density)| {
            let expected = noise.powi(2) * colour.density(*cycles);
            expected.ln() + density / expected
        });
        terms.sum()
    };
    let colours = colours(slowest);
    let nearest = (colours.iter().map(|colour| (unlikely(colour), colour)))
        .min_by(|a, b| a.0.total_cmp(&b.0))?
        .1;
    let left = every_frequency().map(|cycles| gain(cycles).powi(2) * nearest.density(cycles));
    (!beyond.is_empty()).then(|| (left.sum::<f64>() / FREQUENCIES as f64).sqrt())
}

/// Part of a density that interpolation leaves, of which it leaves the part `white_kept` over all
/// frequencies: as if it were needed for a part of the samples, which then lie anywhere between
/// those of the file.
pub(super) fn kept_at(cycles: f64, white_kept: f64) -> f64 {
    const PLACES: usize = 16;
    let mean = |of: &dyn Fn(f64) -> f64| {
        let places = (0..PLACES).map(|k| (k as f64 + 0.5) / PLACES as f64);
        places.map(of).sum::<f64>() / PLACES as f64
    };
    let whole = mean(&|place| weights(place).iter().map(|w| w * w).sum());
    let here = mean(&|place| left_between(place, cycles));
    1.0 - (1.0 - white_kept) / (1.0 - whole) * (1.0 - here)
}

/// Part of a density that a cubic leaves between samples, at this fraction of an interval.
pub(super) fn left_between(fraction: f64, cycles: f64) -> f64 {
    let terms = weights(fraction).into_iter().zip(0..4).map(|(weight, k)| {
        Complex64::from_polar(weight, std::f64::consts::TAU * cycles * f64::from(k))
    });
    terms.sum::<Complex64>().norm_sqr()
}

/// A density of unit variance.
struct Colour {
    kind: Kind,
    scale: f64,
}

enum Kind {
    /// Of first order, by its coefficient.
    Autoregression(f64),
    /// The exponent, and the frequency below which it is even.
    Power(f64, f64),
}

impl Colour {
    fn new(kind: Kind) -> Colour {
        let mut colour = Colour { kind, scale: 1.0 };
        let whole: f64 = every_frequency().map(|cycles| colour.density(cycles)).sum();
        colour.scale = FREQUENCIES as f64 / whole;
        colour
    }

    /// At a frequency in cycles per sample.
    fn density(&self, cycles: f64) -> f64 {
        let shape = match self.kind {
            Kind::Autoregression(memory) => {
                let turn = std::f64::consts::TAU * cycles;
                1.0 / (1.0 + memory * memory - 2.0 * memory * turn.cos())
            }
            Kind::Power(exponent, slowest) => cycles.max(slowest).powf(-exponent),
        };
        self.scale * shape
    }
}

fn colours(slowest: f64) -> Vec<Colour> {
    let part = |member: usize| member as f64 / (MEMBERS - 1) as f64;
    let memory = |member| 1.0 - (1.0 - MOST_MEMORY).powf(part(member));
    (0..MEMBERS)
        .map(|member| Kind::Autoregression(memory(member)))
        .chain((1..MEMBERS).map(|member| Kind::Power(MOST_POWER * part(member), slowest)))
        .map(Colour::new)
        .collect()
}

/// The middle of each of so many parts of the band.
fn every_frequency() -> impl Iterator<Item = f64> {
    (0..FREQUENCIES).map(|k| 0.5 * (k as f64 + 0.5) / FREQUENCIES as f64)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stats::{deviation, mean};
    use crate::testing::{Colour, channel, noise};

    fn cut_at(cutoff_hz: f64) -> Filter {
        Filter {
            cutoff: cutoff_hz / 200.0,
            share: InverseModel::white_share(cutoff_hz, 200.0),
        }
    }

    /// Noise with a memory on a motion whose friction jumps at each reversal, with some spikes:
    /// what is carried through the filter is what the filter leaves of the noise.
    #[test]
    fn verify_stated_noise_beside_jumps_and_spikes() {
        for seed in 0..20 {
            let count = 3000;
            let cutoff_hz = 4.0 + 0.2 * seed as f64;
            let filter = InverseModel::filter_of(cutoff_hz, 200.0);
            let drawn = noise(Colour::Ar1(0.9), count, seed);
            let level = 0.4 / deviation(&drawn);
            let noisy: Vec<f64> = drawn.iter().map(|n| level * n).collect();
            let jumps = |k: usize| 3.0 * (0.007 * k as f64 + seed as f64).sin().signum();
            let spikes = |k: usize| if k % 397 == 5 { 4.0 } else { 0.0 };
            let rows = noisy.iter().enumerate();
            let raw = channel(rows.map(|(k, n)| n + jumps(k) + spikes(k)).collect());
            let used = channel(filter.zero_phase(&raw.values));
            let found = carried(0.4, &cut_at(cutoff_hz), &raw, &used);
            let ratio = found / deviation(&filter.zero_phase(&noisy));
            assert!((0.85..1.1).contains(&ratio), "seed {seed}: {ratio}");
        }
    }

    /// Noise at stamps that come at another rate than the median's: between the samples there is
    /// less of it, and the filter leaves what it leaves of noise at the samples: within what a
    /// floor may be off, where it was 2.2 times too large.
    #[test]
    fn verify_stated_noise_between_samples() {
        for (seed, colour) in (0..20).zip([Colour::White, Colour::Ar1(0.9)].into_iter().cycle()) {
            let drawn = noise(colour, 4000, seed);
            let size = deviation(&drawn);
            // the fraction of an interval drifts through all
            let shift = |k: usize| 0.003 * k as f64 * (1.0 + 0.05 * seed as f64);
            let weights_at = |k: usize| weights(shift(k).fract());
            let at = |k: usize| {
                let first = k + shift(k) as usize;
                (0..4)
                    .map(|i| weights_at(k)[i] * drawn[first + i])
                    .sum::<f64>()
            };
            let count = 3900;
            let values: Vec<f64> = (0..count - 24).map(|k| at(k.min(count - 24))).collect();
            let squares: Vec<f64> = (0..values.len())
                .map(|k| weights_at(k).iter().map(|w| w * w).sum())
                .collect();
            let cutoff_hz = 4.0 + seed as f64;
            let filter = InverseModel::filter_of(cutoff_hz, 200.0);
            let raw = MeasuredChannel {
                white_kept: mean(&squares),
                ..channel(values)
            };
            let used = channel(filter.zero_phase(&raw.values));
            let found = carried(size, &cut_at(cutoff_hz), &raw, &used);
            let ratio = found / deviation(&used.values);
            assert!((0.8..1.3).contains(&ratio), "seed {seed}: {ratio}");
        }
    }
}
