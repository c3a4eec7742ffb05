//! Zeros of joints that drive forces show.

use truecut_scenario::effect::{Effect, EffectKind};

use super::Kind;
use crate::model::Candidate;

/// Part of the drive forces that must change for a zero to show; rounding changes less.
const SHOWN: f64 = 1e-9;

/// The candidates without zeros of joints that change no drive force, as that of a first joint
/// about the vertical.
pub(super) fn shown(engine: &Kind, mut candidates: Vec<Candidate>) -> Vec<Candidate> {
    let Kind::Inverse { model, .. } = engine else {
        return candidates;
    };
    let nominal = model.predict(&[]).unwrap_or_default();
    candidates.retain(|candidate| {
        if candidate.kind != EffectKind::JointZero {
            return true;
        }
        let effect = Effect {
            kind: candidate.kind,
            target: candidate.target.clone(),
            values: candidate.scale.clone(),
        };
        let Ok(with) = model.predict(&[effect]) else {
            return false;
        };
        let mut pairs = nominal.iter().zip(&with);
        pairs.any(|(nominal, with)| {
            let size = nominal.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
            let mut changes = nominal.iter().zip(with);
            changes.any(|(a, b)| (a - b).abs() > SHOWN * size)
        })
    });
    candidates
}
