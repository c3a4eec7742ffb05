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

use truecut_scenario::effect::Effect;

/// The key of an effect among the scenario's `own`; of their list for one that is not in the file.
fn place(own: &[Effect], effect: &Effect, key: &str) -> String {
    let index = own.iter().position(|one| one == effect);
    index.map_or("effect".to_owned(), |index| format!("effect.{index}.{key}"))
}
