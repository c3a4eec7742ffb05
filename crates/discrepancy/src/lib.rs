//! What a simulation gets wrong against measured data.
//!
//! [`compare`] says how they differ, before any cause; [`stats`] holds what it rests on: statistics
//! that stay right when the noise is coloured.

#![warn(missing_docs)]

pub mod compare;
pub mod stats;

#[cfg(test)]
mod testing;
