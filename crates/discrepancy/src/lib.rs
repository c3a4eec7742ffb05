//! What a simulation gets wrong against measured data, and why.
//!
//! | module | what it holds |
//! | --- | --- |
//! | [`compare`] | how they differ, before any cause |
//! | [`diagnose`] | the search for effects that explain measured data |
//! | [`identify`] | joint stiffness and modes from measurements of the arm itself |
//! | [`model`] | what that search needs of a simulation |
//! | [`trial`] | a scenario and its data as such a model |
//! | [`stats`] | statistics that stay right when the noise is coloured |

#![warn(missing_docs)]

pub mod compare;
pub mod diagnose;
pub mod identify;
pub mod model;
pub mod stats;
pub mod trial;

#[cfg(test)]
mod testing;
