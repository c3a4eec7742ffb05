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

pub use ar::{Ar, Criterion, default_order_cap};
pub use background::Background;
pub use blocks::contiguous_blocks;
pub use spectrum::{Periodogram, welch};
pub use sums::{SumCovariance, sum_covariance};
pub(crate) use sums::{degrees, density_on_grid, unbiased};
