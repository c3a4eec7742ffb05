//! What a simulation gets wrong, and why.
//!
//! [`model`] is what the search needs of a simulation; [`diagnose`] searches for the effects that explain measured data.

#![warn(missing_docs)]

pub mod diagnose;
pub mod model;
