//! Measured inputs that drive a model.
//!
//! | module | what it holds |
//! | --- | --- |
//! | [`inputs`] | which measured channel drives what, and whether it may |
//! | [`inverse`] | measured motion in, drive forces out |

pub(crate) mod inputs;
pub mod inverse;
mod regressors;
