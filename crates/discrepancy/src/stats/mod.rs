//! Statistics of evenly spaced series with gaps and coloured noise.
//!
//! A series is a slice of values and a slice of flags that says which of them are valid. Values
//! that are not valid are never read and may be NaN.

mod ar;
mod background;
mod blocks;
pub mod distributions;
pub(crate) mod spectrum;
mod sums;

pub use ar::{Ar, default_order_cap};
pub use background::Background;
pub use blocks::contiguous_blocks;
pub(crate) use spectrum::quiet_density;
pub use spectrum::{Periodogram, welch};
pub use sums::{SumCovariance, sum_covariance};
pub(crate) use sums::{degrees, density_on_grid, unbiased};

/// Mean of all values.
pub(crate) fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

/// Root of their mean square.
pub(crate) fn rms(values: &[f64]) -> f64 {
    (values.iter().map(|x| x * x).sum::<f64>() / values.len() as f64).sqrt()
}

/// Values less their mean.
pub(crate) fn centred(values: &[f64]) -> Vec<f64> {
    let mean = mean(values);
    values.iter().map(|x| x - mean).collect()
}

/// Standard deviation about their mean.
pub(crate) fn deviation(values: &[f64]) -> f64 {
    rms(&centred(values))
}

/// Values that are valid.
pub(crate) fn counted(values: &[f64], valid: &[bool]) -> impl Iterator<Item = f64> {
    let rows = values.iter().zip(valid);
    rows.filter(|(_, valid)| **valid).map(|(value, _)| *value)
}

/// `a / b`; 0 where `b` is nothing to measure by.
pub(crate) fn ratio(a: f64, b: f64) -> f64 {
    if b > 0.0 { a / b } else { 0.0 }
}
