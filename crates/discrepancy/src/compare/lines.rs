//! Spectral lines that are missing in the simulation, or only there.

use nalgebra::{Matrix3, Vector3};
use serde::Serialize;

use super::series::Pair;
use crate::stats::distributions::{f_tail, family_wise};
use crate::stats::spectrum::hann;
use crate::stats::{Background, Periodogram, contiguous_blocks, welch};

/// A line of the residual.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SpectralLine {
    /// Frequency, Hz.
    pub frequency_hz: f64,
    /// Which of the two channels has it.
    pub kind: LineKind,
    /// Amplitude in the residual, SI.
    pub residual: f64,
    /// Amplitude in the measured channel, SI.
    pub measured: f64,
    /// Amplitude in the simulated channel, SI.
    pub simulated: f64,
    /// Probability of such a line at any frequency in noise with this background.
    pub p_value: f64,
    /// Order of rotation of the spindle, if it is an integer.
    pub per_revolution: Option<u32>,
}

/// What is wrong with a line.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum LineKind {
    /// Measured, but not simulated.
    Missing,
    /// Simulated, but not measured.
    Extra,
    /// In both, with another amplitude or phase.
    Differs,
}

/// Spectra of a channel, for figures: two-sided densities per cycle and sample.
#[derive(Clone, Debug, PartialEq)]
pub struct Spectra {
    /// Of each bin, Hz.
    pub frequency_hz: Vec<f64>,
    /// Of the residual.
    pub residual: Vec<f64>,
    /// Of the residual's background.
    pub background: Vec<f64>,
    /// Of the measured channel.
    pub measured: Vec<f64>,
    /// Of the simulated channel.
    pub simulated: Vec<f64>,
}

/// Bins from here on are unaffected by the removal of the trend.
const FIRST_BIN: usize = 3;
/// Highest order of rotation that is searched.
const HIGHEST_MULTIPLE: f64 = 24.0;
/// Maximum number of reported lines.
const MOST: usize = 12;

/// Lines of the residual above its coloured background with a family-wise p below `level`: an F
/// test of each bin of Welch's spectrum over quarters of the record. The highest is located and
/// measured over the whole record and subtracted, with its leakage through window and gaps; then
/// the next is searched. Strongest first.
pub fn lines(
    pair: &Pair<'_>,
    residual: &[f64],
    interval_s: f64,
    spindle_hz: Option<f64>,
    level: f64,
) -> (Vec<SpectralLine>, Option<Spectra>) {
    let mut rest = residual.to_vec();
    let mut lines = Vec::new();
    let mut taken: Vec<usize> = Vec::new();
    let mut background = None;
    while lines.len() < MOST {
        let Some(periodogram) = quarter_spectrum(&rest, pair.valid) else {
            break;
        };
        let Some(fitted) = Background::fit(&periodogram) else {
            break;
        };
        let p_values = line_p_values(&periodogram, &fitted);
        background = Some(fitted);
        let Some(bin) = highest_peak(&periodogram.density, &p_values, level, &taken) else {
            break;
        };
        let wide = 1.0 / periodogram.length as f64;
        let frequency = refine(&rest, pair.valid, bin as f64 * wide, wide);
        taken.push(bin);
        lines.push(describe(
            pair,
            residual,
            frequency,
            interval_s,
            p_values[bin],
            spindle_hz,
        ));
        take_out(&mut rest, pair.valid, frequency);
    }
    lines.sort_by(|a, b| b.residual.total_cmp(&a.residual));
    let spectra = background.and_then(|one| spectra(pair, residual, &one, interval_s));
    (lines, spectra)
}

fn spectra(
    pair: &Pair<'_>,
    residual: &[f64],
    background: &Background,
    interval_s: f64,
) -> Option<Spectra> {
    let periodogram = quarter_spectrum(residual, pair.valid)?;
    let wide = 1.0 / periodogram.length as f64;
    let other = |values: &[f64]| {
        let found = welch(values, pair.valid, periodogram.length);
        found.map_or_else(Vec::new, |one| one.density[1..].to_vec())
    };
    let bins = 1..periodogram.density.len();
    Some(Spectra {
        frequency_hz: bins
            .clone()
            .map(|bin| bin as f64 * wide / interval_s)
            .collect(),
        background: bins
            .map(|bin| background.density(bin as f64 * wide))
            .collect(),
        residual: periodogram.density[1..].to_vec(),
        measured: other(pair.measured),
        simulated: other(pair.simulated),
    })
}

/// Over quarters of the record, or the longest segments where gaps leave no complete quarter.
fn quarter_spectrum(values: &[f64], valid: &[bool]) -> Option<Periodogram> {
    let longest = contiguous_blocks(valid, 64)
        .iter()
        .map(ExactSizeIterator::len)
        .max()?;
    let quarter = values.len() / 8 * 2;
    welch(values, valid, quarter).or_else(|| welch(values, valid, longest.min(quarter) / 2 * 2))
}

/// Family-wise p of each bin; 1 where no line is searched.
pub(super) fn line_p_values(periodogram: &Periodogram, background: &Background) -> Vec<f64> {
    let last = periodogram.density.len() - 1;
    let tested = last.saturating_sub(FIRST_BIN) as f64;
    let p_of = |bin: usize| {
        if bin < FIRST_BIN || bin >= last {
            return 1.0;
        }
        let frequency = bin as f64 / periodogram.length as f64;
        let ratio = periodogram.density[bin] / background.density(frequency);
        let below = 2.0 / background.log_variance(frequency);
        family_wise(f_tail(ratio, periodogram.degrees, below), tested)
    };
    (0..=last).map(p_of).collect()
}

/// The highest significant bin above its neighbours, farther than a window's lobe from those
/// already found: what remains near them is a line of varying frequency.
fn highest_peak(density: &[f64], p_values: &[f64], level: f64, taken: &[usize]) -> Option<usize> {
    let top = |bin: &usize| density[*bin] > density[bin - 1] && density[*bin] >= density[bin + 1];
    let apart = |bin: &usize| taken.iter().all(|other| other.abs_diff(*bin) > 2);
    let inner = 1..density.len().saturating_sub(1);
    let found = inner
        .filter(|bin| p_values[*bin] < level)
        .filter(top)
        .filter(apart);
    found.max_by(|a, b| density[*a].total_cmp(&density[*b]))
}

/// Frequency within `wide` of `rough` (cycles per sample) with the largest amplitude over the whole
/// record.
fn refine(values: &[f64], valid: &[bool], rough: f64, wide: f64) -> f64 {
    let step = 0.2 / values.len() as f64;
    let count = (wide / step).ceil() as i32;
    let at = |i: i32| rough + f64::from(i) * step;
    let size = |i: &i32| amplitude(values, valid, at(*i).max(step));
    let sizes: Vec<f64> = (-count..=count).map(|i| size(&i)).collect();
    let best = (0..sizes.len())
        .max_by(|a, b| sizes[*a].total_cmp(&sizes[*b]))
        .unwrap_or(0);
    let mut offset = 0.0;
    if best > 0 && best + 1 < sizes.len() {
        let [left, here, right] = [best - 1, best, best + 1].map(|i| sizes[i].ln());
        let bend = left - 2.0 * here + right;
        offset = if bend < 0.0 {
            (0.5 * (left - right) / bend).clamp(-0.5, 0.5)
        } else {
            0.0
        };
    }
    at(best as i32 - count) + offset * step
}

/// Amplitude of the best-fitting sine of this frequency (cycles per sample).
fn amplitude(values: &[f64], valid: &[bool], frequency: f64) -> f64 {
    let [cos, sin] = sine(values, valid, frequency);
    cos.hypot(sin)
}

/// Subtracts the best-fitting sine of this frequency from the valid samples.
fn take_out(values: &mut [f64], valid: &[bool], frequency: f64) {
    let [cos, sin] = sine(values, valid, frequency);
    for (row, value) in values.iter_mut().enumerate().filter(|(row, _)| valid[*row]) {
        let (s, c) = (std::f64::consts::TAU * frequency * row as f64).sin_cos();
        *value -= cos * c + sin * s;
    }
}

/// Cosine, sine and constant by least squares, under a Hann window over the record.
fn sine(values: &[f64], valid: &[bool], frequency: f64) -> [f64; 2] {
    let (turn_sin, turn_cos) = (std::f64::consts::TAU * frequency).sin_cos();
    let (mut cos, mut sin) = (1.0, 0.0);
    let mut normal = Matrix3::zeros();
    let mut right = Vector3::zeros();
    for (row, weight) in hann(values.len()).into_iter().enumerate() {
        if valid[row] {
            let basis = Vector3::new(1.0, cos, sin);
            normal += weight * basis * basis.transpose();
            right += weight * values[row] * basis;
        }
        (cos, sin) = (
            cos * turn_cos - sin * turn_sin,
            sin * turn_cos + cos * turn_sin,
        );
    }
    normal.cholesky().map_or([0.0; 2], |factor| {
        let solution = factor.solve(&right);
        [solution[1], solution[2]]
    })
}

fn describe(
    pair: &Pair<'_>,
    residual: &[f64],
    frequency: f64,
    interval_s: f64,
    p_value: f64,
    spindle_hz: Option<f64>,
) -> SpectralLine {
    let at = |values: &[f64]| amplitude(values, pair.valid, frequency);
    let (residual, measured, simulated) = (at(residual), at(pair.measured), at(pair.simulated));
    let kind = if simulated < 0.3 * residual {
        LineKind::Missing
    } else if measured < 0.3 * residual {
        LineKind::Extra
    } else {
        LineKind::Differs
    };
    let frequency_hz = frequency / interval_s;
    let duration_s = pair.measured.len() as f64 * interval_s;
    let per_revolution = spindle_hz.and_then(|spindle| {
        let multiple = (frequency_hz / spindle).round();
        // Half a line width of the record, and the spindle's slowing under load.
        let off = (frequency_hz - multiple * spindle).abs();
        let near = off < 0.5 / duration_s + 0.005 * frequency_hz;
        (near && (1.0..=HIGHEST_MULTIPLE).contains(&multiple)).then_some(multiple as u32)
    });
    SpectralLine {
        frequency_hz,
        kind,
        residual,
        measured,
        simulated,
        p_value,
        per_revolution,
    }
}
