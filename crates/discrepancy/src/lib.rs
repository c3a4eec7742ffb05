//! What a simulation gets wrong against measured data, and why.

pub mod model;
pub mod trial;
