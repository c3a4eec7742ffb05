//! What a simulation gets wrong against measured data, and why.
//!
//! | module | what it holds |
//! | --- | --- |
//! | [`diagnose`] | the search for effects that explain measured data |
//! | [`model`] | what that search needs of a simulation |
//! | [`trial`] | a scenario and its data as such a model |
//! | [`stats`] | statistics that hold for coloured noise |

#![warn(missing_docs)]

pub mod diagnose;
pub mod model;
pub mod stats;
pub mod trial;

#[cfg(test)]
mod testing;
