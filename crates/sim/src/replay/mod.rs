//! Measured inputs that drive a model.
//!
//! | module | what it holds |
//! | --- | --- |
//! | [`along`] | drive forces that a planned motion asks for |
//! | `beginning` | where a measured joint begins |
//! | `forward` | commands and forces in, motion out |
//! | `inputs` | which measured channel drives what, and whether it may |
//! | [`inverse`] | measured motion in, drive forces out |
//! | [`start`] | starts that are read off the data as unknowns |
//! | [`steady`] | a steady machine: means, and a cut that turns |
//! | `predict` | replays without a plant |
//! | `rigid` | drive forces of the rigid arm along a motion |
#![deny(clippy::wildcard_enum_match_arm)]

pub mod along;
mod beginning;
mod drive_forces;
pub(crate) mod forward;
pub(crate) mod inputs;
pub mod inverse;
mod motion;
pub(crate) mod predict;
mod regressors;
pub(crate) mod rigid;
pub mod start;
pub mod steady;

use crate::effect::{Effects, misfit};
use crate::error::SimError;
use crate::measurement::ChannelModel;
use truecut_recording::ChannelSpec;
use truecut_scenario::Scenario;
use truecut_scenario::effect::Effect;

/// The scenario's `own` effects and further `effects`, which replace those of the same kind and
/// target.
fn in_force<'a>(own: &'a [Effect], effects: &'a [Effect]) -> Vec<&'a Effect> {
    let replaced = |own: &&Effect| {
        let twin = |other: &Effect| other.kind == own.kind && other.target == own.target;
        effects.iter().any(twin)
    };
    let kept = own.iter().filter(|own| !replaced(own));
    kept.chain(effects).collect()
}

/// Refuses an effect, at a key of its entry.
fn refused(scenario: &Scenario, effect: &Effect, key: &str, message: String) -> SimError {
    SimError::scenario(place(&scenario.effects, effect, key), message)
}

/// Refuses an effect that plays no part in the model of the scenario.
fn check_part(scenario: &Scenario, effect: &Effect) -> Result<(), SimError> {
    match misfit(scenario, effect).or_else(|| unfit(effect)) {
        Some(message) => Err(refused(scenario, effect, "kind", message)),
        None => Ok(()),
    }
}

/// What the sensors make of predicted columns.
fn sense(effects: &Effects, specs: &[ChannelSpec], time_s: &[f64], columns: &mut [Vec<f64>]) {
    for (spec, column) in specs.iter().zip(columns) {
        let model = effects.sensors.of(&spec.name);
        if model != ChannelModel::default() {
            model.apply(time_s, column);
        }
    }
}

/// Why the effect has not the target and the number of values of its kind. Its bounds are for
/// files.
fn unfit(effect: &Effect) -> Option<String> {
    let fits = effect.typed().is_some();
    (!fits).then(|| effect.check().err()).flatten()
}

/// The key of an effect among the scenario's `own`; of their list for one that is not in the file.
fn place(own: &[Effect], effect: &Effect, key: &str) -> String {
    let index = own.iter().position(|one| one == effect);
    index.map_or("effect".to_owned(), |index| format!("effect.{index}.{key}"))
}
