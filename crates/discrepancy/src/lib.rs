//! What a simulation gets wrong against measured data.
//!
//! [`stats`] holds what its comparisons rest on: statistics
//! that stay right when the noise is coloured.

#![warn(missing_docs)]

pub mod stats;

#[cfg(test)]
mod testing;
