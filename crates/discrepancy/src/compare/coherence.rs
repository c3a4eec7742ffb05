//! Coherence of measured and simulated channel, by frequency band.

use serde::Serialize;

use super::series::Pair;
use crate::stats::ratio;
use crate::stats::spectrum::cross_welch;

/// Coherence in one band.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Band {
    /// Lower end, Hz.
    pub from_hz: f64,
    /// Upper end, Hz.
    pub to_hz: f64,
    /// Fraction of the measured power in the band that is a linear function of the simulated
    /// channel: the magnitude-squared coherence, weighted by measured power.
    pub coherence: f64,
    /// Mean of that fraction for unrelated channels.
    pub chance: f64,
    /// Fraction of the measured power, without trend, that lies in the band.
    pub power_share: f64,
}

/// Bands of equal width in ln(frequency).
const BANDS: usize = 6;

/// Welch's estimate over eighths of the record. Empty if the record is too short or has too many
/// gaps.
pub fn coherence(pair: &Pair<'_>, interval_s: f64) -> Vec<Band> {
    let length = pair.measured.len() / 16 * 2;
    let spectra = cross_welch(pair.simulated, pair.measured, pair.valid, length);
    let Some((simulated, measured, cross)) = spectra else {
        return Vec::new();
    };
    let last = length / 2;
    let edge = |i: usize| (last as f64).powf(i as f64 / BANDS as f64).round() as usize;
    let total: f64 = measured.density[1..].iter().sum();
    let hertz = |bin: usize| bin as f64 / (length as f64 * interval_s);
    (0..BANDS)
        .map(|i| (edge(i), edge(i + 1) + usize::from(i + 1 == BANDS)))
        .filter(|(first, end)| first < end)
        .map(|(first, end)| {
            let power: f64 = measured.density[first..end].iter().sum();
            let common =
                (first..end).map(|bin| ratio(cross[bin].norm_sqr(), simulated.density[bin]));
            let common: f64 = common.sum();
            Band {
                from_hz: hertz(first),
                to_hz: hertz(end.min(last)),
                coherence: ratio(common, power),
                chance: 2.0 / measured.degrees,
                power_share: ratio(power, total),
            }
        })
        .collect()
}
