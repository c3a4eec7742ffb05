//! Size of the residual.

use serde::Serialize;

use super::series::{Estimate, Pair, centred, mean, rms};
use crate::stats::{Background, counted, sum_covariance};

/// Size of the residual, measured minus simulated.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Level {
    /// Valid samples.
    pub samples: usize,
    /// Effective number of independent samples: the residual's variance over the square of the
    /// standard error of its mean.
    pub effective_samples: f64,
    /// Root of the mean square residual, SI.
    pub rms_error: f64,
    /// `rms_error` over the range (largest minus smallest) of the measured samples.
    pub nrmse: f64,
    /// `rms_error` over the RMS of the measured samples.
    pub relative_rms_error: f64,
    /// Mean of the residual, SI.
    pub bias: Estimate,
    /// Largest absolute residual, SI.
    pub largest_error: f64,
    /// `rms_error` over the known standard deviation of the measurement's noise.
    pub error_over_noise: Option<f64>,
}

/// `background` is that of the residual; `None` if it has none.
pub fn level(pair: &Pair<'_>, residual: &[f64], background: Option<&Background>) -> Level {
    let samples = pair.valid.iter().filter(|valid| **valid).count();
    let rms_error = rms(residual, pair.valid);
    let bias = mean(residual, pair.valid);
    let variance = rms(&centred(residual, pair.valid), pair.valid).powi(2);
    let (standard_error, degrees) = standard_error_of_mean(pair.valid, background);
    // A spectrum that dips at frequency 0 may do so by chance: samples count for no more than if
    // they were independent.
    let standard_error = standard_error.max((variance / samples.max(1) as f64).sqrt());
    let bias = Estimate::new(bias, 0.0, standard_error, degrees);
    let measured = || counted(pair.measured, pair.valid);
    let range =
        measured().fold(f64::NEG_INFINITY, f64::max) - measured().fold(f64::INFINITY, f64::min);
    let effective = variance / bias.standard_error.powi(2);
    Level {
        samples,
        effective_samples: if effective.is_nan() {
            samples as f64
        } else {
            effective.clamp(1.0, samples as f64)
        },
        rms_error,
        nrmse: rms_error / range,
        relative_rms_error: rms_error / rms(pair.measured, pair.valid),
        bias,
        largest_error: residual
            .iter()
            .fold(0.0, |largest: f64, r| largest.max(r.abs())),
        error_over_noise: pair.noise.map(|noise| rms_error / noise),
    }
}

fn standard_error_of_mean(valid: &[bool], background: Option<&Background>) -> (f64, f64) {
    let Some(background) = background else {
        return (0.0, f64::INFINITY);
    };
    let ones: Vec<f64> = valid
        .iter()
        .map(|valid| f64::from(u8::from(*valid)))
        .collect();
    let count: f64 = ones.iter().sum();
    let covariance = sum_covariance(&[ones], &background.clone().levelled());
    (covariance.matrix[(0, 0)].sqrt() / count, covariance.degrees)
}
