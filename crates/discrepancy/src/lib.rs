//! What a simulation gets wrong against measured data, and why.
//!
//! [`compare`] says how they differ, before any cause; [`stats`] holds what it rests on: statistics
//! that stay right when the noise is coloured. [`model`] is what a search needs of a simulation;
//! [`diagnose`] searches for the effects that explain the data.

#![warn(missing_docs)]

pub mod compare;
pub mod diagnose;
pub mod model;
pub mod stats;

#[cfg(test)]
mod testing;
