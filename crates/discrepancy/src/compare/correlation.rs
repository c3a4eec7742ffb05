//! Whether the residual follows an input with any delay.

use nalgebra::DMatrix;
use serde::Serialize;
use truecut_recording::fft::{forward, inverse};

use super::series::centred;
use crate::stats::distributions::{f_tail, family_wise, t_quantile, t_tail};
use crate::stats::spectrum::padded_length;
use crate::stats::{Background, degrees, density_on_grid, unbiased};

/// The strongest cross-correlation of the residual with a signal.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct InputCorrelation {
    /// The signal.
    pub signal: String,
    /// Correlation coefficient at that delay.
    pub correlation: f64,
    /// Delay of the residual after the signal, s.
    pub delay_s: f64,
    /// 95 % quantile of the coefficient at one given delay if the two are independent.
    pub band_95: f64,
    /// p-value over all delays tried.
    pub p_value: f64,
}

/// Cross-correlates the residual with `signal` at delays 0, ±1, ±2, ±4, … samples up to a tenth of
/// the record. The variance of each is Bartlett's: the sum over all lags of the product of both
/// autocovariances (`bartlett1946`), that of the signal and that of the background of the residual
/// after regression on the signal. `None` for a constant signal.
pub fn input_correlation(
    residual: &[f64],
    valid: &[bool],
    name: &str,
    signal: &[f64],
    interval_s: f64,
) -> Option<InputCorrelation> {
    let length = padded_length(residual.len());
    let (input, output) = (centred(signal, valid), centred(residual, valid));
    let norm = |x: &[f64]| x.iter().map(|x| x * x).sum::<f64>().sqrt();
    let scale = norm(&input) * norm(&output);
    if scale.is_nan() || scale <= 0.0 || norm(&input) < 1e-9 * norm(signal) {
        return None;
    }
    let (x, y) = (forward(input.clone(), length), forward(output, length));
    let cross = inverse(
        x.iter().zip(&y).map(|(x, y)| x.conj() * y).collect(),
        length,
    );
    let lags = lags(residual.len());
    let index = |lag: isize| lag.rem_euclid(length as isize) as usize;
    let size = |lag: &&isize| cross[index(**lag)].abs();
    let lag = *lags.iter().max_by(|a, b| size(a).total_cmp(&size(b)))?;
    let background = Background::of_regression(residual, valid, &[delayed(&input, valid, lag)])?;
    let density = density_on_grid(&background, length);
    let power: Vec<f64> = x
        .iter()
        .zip(&density)
        .map(|(x, s)| x.norm_sqr() * s)
        .collect();
    let freedom = degrees(&power, &background, length);
    let covariance = autocovariance(&power, length);
    let deviation = (covariance[0] * unbiased(freedom)).sqrt();
    let correlations = DMatrix::from_fn(lags.len(), lags.len(), |i, j| {
        covariance[index(lags[i] - lags[j])] / covariance[0]
    });
    Some(InputCorrelation {
        signal: name.to_owned(),
        correlation: cross[index(lag)] / scale,
        delay_s: lag as f64 * interval_s,
        band_95: t_quantile(0.05, freedom) * deviation / scale,
        p_value: p_of_largest(cross[index(lag)].abs() / deviation, freedom, correlations),
    })
}

/// The signal delayed by a number of samples, without its mean; zero where unknown or invalid.
fn delayed(signal: &[f64], valid: &[bool], lag: isize) -> Vec<f64> {
    let at = |row: usize| {
        row.checked_add_signed(-lag)
            .and_then(|from| signal.get(from))
    };
    let moved: Vec<f64> = (0..signal.len())
        .map(|row| at(row).copied().unwrap_or(0.0))
        .collect();
    centred(&moved, valid)
}

/// From a one-sided power, in which inner bins also represent their mirror images.
fn autocovariance(power: &[f64], length: usize) -> Vec<f64> {
    let halved = power.iter().enumerate().map(|(bin, power)| {
        let mirrored = bin > 0 && bin < length / 2;
        (if mirrored { 0.5 * power } else { *power }).into()
    });
    inverse(halved.collect(), length)
}

/// Probability that the largest of correlated t-values is at least this.
fn p_of_largest(t: f64, freedom: f64, correlations: DMatrix<f64>) -> f64 {
    let tests = independent_tests(correlations);
    if tests <= 3.0 {
        // Few patterns make up all delays, as for a sine: the largest is at most their norm, and
        // close to it.
        let patterns = tests.ceil();
        return f_tail(t * t / patterns, patterns, freedom);
    }
    family_wise((2.0 * t_tail(t, freedom)).min(1.0), tests)
}

fn lags(samples: usize) -> Vec<isize> {
    let longest = (samples / 10) as isize;
    let powers = std::iter::successors(Some(1), |lag| Some(2 * lag));
    let later: Vec<isize> = powers.take_while(|lag| *lag <= longest).collect();
    let earlier = later.iter().rev().map(|lag| -lag);
    earlier
        .chain(std::iter::once(0))
        .chain(later.iter().copied())
        .collect()
}

/// Effective number of independent tests (`li2005`, from the eigenvalues of their correlations).
fn independent_tests(correlations: DMatrix<f64>) -> f64 {
    let eigenvalues = correlations.symmetric_eigen().eigenvalues;
    let part = |value: &f64| {
        let value = value.abs();
        f64::from(u8::from(value >= 1.0)) + value - value.floor()
    };
    eigenvalues.iter().map(part).sum()
}
