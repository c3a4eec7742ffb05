//! Measured inputs that drive a model.
//!
//! | module | what it holds |
//! | --- | --- |
//! | [`forward`] | commands and forces in, motion out |
//! | [`inputs`] | which measured channel drives what, and whether it may |
//! | [`inverse`] | measured motion in, drive forces out |
//! | [`steady`] | a steady machine: means, and a cut that turns |
//! | [`predict`] | replays without a plant; recordings at the times of data |

pub(crate) mod forward;
pub(crate) mod inputs;
pub mod inverse;
mod motion;
pub mod predict;
mod regressors;
pub mod steady;
