//! What both recordings share where their motions differ. The first alone may show it by another
//! name, or not at all: a change is one only if both together say so.

use truecut_scenario::effect::Effect;

use super::Between;
use super::change::{Change, Of};
use super::split::{both, twin};
use super::work::Work;
use crate::diagnose::{Answer, DiagnoseError, likelihood};
use crate::model::Model;

/// Odds of 20 to 1, as a difference of minus twice the log-likelihood.
const DECISIVE: f64 = 6.0;
/// A size that falls below this part of what it was has all but gone.
const GONE: f64 = 0.3;

/// Other effects that both share.
pub(super) struct Anew {
    pub shared: Vec<Effect>,
    /// An effect of the second recording of which the first does not show whether it has it.
    pub undecided: Option<String>,
}

/// Shared effects with which both recordings are explained as well as by the changes found, if
/// there are such: one that was named a change is there in both, or is what was found in the first
/// by another name.
///
/// # Errors
/// The simulation cannot be run.
pub(super) fn anew(
    pair: &Between,
    own: &[f64],
    model: &Change,
    found: &Answer,
    work: &mut Work,
) -> Result<Option<Anew>, DiagnoseError> {
    let data = &pair.observation;
    let (with, made) = likelihood(model, data, work.options, &found.nominal, &found.effects)?;
    work.made += made;
    let mut beyond = |shared: &[Effect], changes: &[Effect]| {
        let rival = Change::new(pair, Of::Both, own, shared.to_vec());
        let numbers: Vec<f64> = rival.nominal().iter().map(|one| one.value).collect();
        // What cannot be simulated is no explanation.
        let Ok((value, made)) = likelihood(&rival, data, work.options, &numbers, changes) else {
            return f64::INFINITY;
        };
        work.made += made;
        value - with
    };
    let is_new = |change: &&Effect| {
        !change.kind.is_curve() && twin(model.shared(), &[], change.kind, &change.target).is_none()
    };
    for change in found.effects.iter().filter(is_new) {
        let [_, effect] = both(change, None);
        if effect.is_neutral() {
            continue;
        }
        let others: Vec<Effect> = without(&found.effects, change);
        let shared = [model.shared(), std::slice::from_ref(&effect)].concat();
        let lost = beyond(&shared, &others);
        if lost < DECISIVE {
            let undecided = (lost > 0.0).then(|| effect.to_string());
            return Ok(Some(Anew { shared, undecided }));
        }
        // By another name: that goes, and this changed from what it was.
        for gone in found
            .effects
            .iter()
            .filter(|one| has_gone(one, model.shared()))
        {
            let rest = without(model.shared(), gone);
            let shared = [rest.as_slice(), &[halved(&effect)]].concat();
            let mut changes = without(&found.effects, gone);
            for one in changes.iter_mut().filter(|one| is_same(one, change)) {
                *one = halved(change);
            }
            if beyond(&shared, &changes) < DECISIVE {
                let undecided = None;
                return Ok(Some(Anew { shared, undecided }));
            }
        }
    }
    Ok(None)
}

fn is_same(a: &Effect, b: &Effect) -> bool {
    a.kind == b.kind && a.target == b.target
}

fn without(effects: &[Effect], gone: &Effect) -> Vec<Effect> {
    let kept = effects.iter().filter(|one| !is_same(one, gone));
    kept.cloned().collect()
}

/// The effect at half its size.
fn halved(effect: &Effect) -> Effect {
    let mut half = effect.clone();
    for (value, info) in half.values.iter_mut().zip(effect.kind.parameters()) {
        if info.is_size {
            *value = info.neutral + 0.5 * (*value - info.neutral);
        }
    }
    half
}

/// Whether a change takes away what both share of an effect.
fn has_gone(change: &Effect, shared: &[Effect]) -> bool {
    let Some(known) = twin(shared, &[], change.kind, &change.target) else {
        return false;
    };
    if change.kind.is_curve() {
        return false;
    }
    let [before, after] = both(change, Some(known));
    let size = |effect: &Effect| {
        let infos = effect.kind.parameters().iter().zip(&effect.values);
        let sizes = infos.filter(|(info, _)| info.is_size);
        sizes
            .map(|(info, value)| (value - info.neutral).powi(2))
            .sum::<f64>()
            .sqrt()
    };
    size(&after) < GONE * size(&before)
}

#[cfg(test)]
mod tests {
    use truecut_scenario::effect::{EffectKind, Target};

    use super::*;

    fn friction(kind: EffectKind, value: f64) -> Effect {
        Effect {
            kind,
            target: Target::Joint(0),
            values: vec![value],
        }
    }

    #[test]
    fn verify_what_falls_to_a_small_part_has_gone() {
        let shared = [friction(EffectKind::JointCoulomb, 2.0)];
        for (change, gone) in [(-1.9, true), (-2.0, true), (-1.0, false), (1.0, false)] {
            let change = friction(EffectKind::JointCoulomb, change);
            assert_eq!(has_gone(&change, &shared), gone, "{change}");
        }
        assert!(!has_gone(
            &friction(EffectKind::JointViscous, -2.0),
            &shared
        ));
        let half = halved(&friction(EffectKind::JointStiffness, 0.6));
        assert!((half.values[0] - 0.8).abs() < 1e-12);
    }
}
