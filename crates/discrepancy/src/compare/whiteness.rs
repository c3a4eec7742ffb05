//! Colour of the residual.

use serde::Serialize;

use crate::stats::distributions::chi_squared_tail;
use crate::stats::{Ar, Background, default_order_cap, ratio};

/// The residual's colour, and tests of whiteness before and after whitening.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Whiteness {
    /// Correlation of neighbouring samples.
    pub lag_one_correlation: f64,
    /// Order of the autoregressive model that predicts best.
    pub order: usize,
    /// Slope of the background's logarithmic power over logarithmic frequency at its low end: 0
    /// white, −1 as 1/f.
    pub lowest_slope: f64,
    /// Ljung and Box's test of the residual, over 20 lags: p-value, small if it is coloured.
    pub p_raw: f64,
    /// The same for the model's innovations: small if the residual is not a stationary linear
    /// process, as with bursts or a change within the record.
    pub p_whitened: f64,
}

/// Lags of the tests, beyond the order of the model.
const LAGS: usize = 20;

/// `None` where no autoregressive model can be fitted.
pub fn whiteness(residual: &[f64], valid: &[bool], background: &Background) -> Option<Whiteness> {
    let samples = valid.iter().filter(|one| **one).count();
    let model = Ar::fit(residual, valid, default_order_cap(samples))?;
    let raw: Vec<f64> = residual.iter().map(|r| r - model.mean).collect();
    let (white, exists) = model.whiten(residual, valid);
    Some(Whiteness {
        lag_one_correlation: autocorrelation(&raw, valid, 1).0,
        order: model.order(),
        lowest_slope: background.lowest_slope(),
        p_raw: ljung_box(&raw, valid, LAGS, 0),
        p_whitened: ljung_box(&white, &exists, model.order() + LAGS, model.order()),
    })
}

/// Autocorrelation at a lag, and its number of pairs.
fn autocorrelation(values: &[f64], valid: &[bool], lag: usize) -> (f64, f64) {
    let (mut squares, mut products, mut pairs) = (0.0, 0.0, 0.0);
    for row in 0..values.len() {
        if !valid[row] {
            continue;
        }
        squares += values[row] * values[row];
        if row >= lag && valid[row - lag] {
            products += values[row] * values[row - lag];
            pairs += 1.0;
        }
    }
    (products / squares, pairs)
}

/// p-value of G. M. Ljung and G. E. P. Box, Biometrika 65, 1978; with gaps each lag is weighted by
/// its pairs. At least `fitted` + 1 lags; `fitted` coefficients cost as many degrees of freedom.
fn ljung_box(values: &[f64], valid: &[bool], lags: usize, fitted: usize) -> f64 {
    let samples = valid.iter().filter(|one| **one).count() as f64;
    let term = |lag: usize| {
        let (correlation, pairs) = autocorrelation(values, valid, lag);
        ratio(correlation * correlation, pairs)
    };
    let sum: f64 = (1..=lags).map(term).sum();
    chi_squared_tail(samples * (samples + 2.0) * sum, (lags - fitted) as f64)
}
