//! The answer of the search in words of changes.

use truecut_scenario::effect::Effect;

use super::answer::{Changed, ChangedParameter, Changes, Compared, Rival, VERSION};
use super::change::{Change, shared_key};
use super::split::{both, twin};
use super::words::verdict;
use super::{Between, Motion};
use crate::diagnose::{self, Alternative, Cause, Diagnosis, Nominal, Parameter};
use crate::model::{Candidate, Model};
use crate::trial::Trial;

/// The answer of the search.
pub(super) fn told(
    pair: &Between,
    model: &Change,
    shared: &[Effect],
    found: &Diagnosis,
    undecided: Vec<String>,
) -> Changes {
    let compared = match pair.motion {
        Motion::Repeated { later_s, unlike } => Compared {
            repeated: true,
            later_s: Some(later_s),
            unlike: Some(unlike),
        },
        Motion::Different => Compared::default(),
    };
    let source = |trial: &Trial| trial.measured().source.clone();
    let (verdict, reason) = verdict(found, &undecided);
    let rival = |one: &Alternative| Rival {
        changes: changed_of(pair, model, shared, &one.causes),
        angle_deg: one.angle_deg,
        criterion_difference: one.criterion_difference,
    };
    Changes {
        version: VERSION,
        scenario: found.scenario.clone(),
        first: source(&pair.first),
        second: source(&pair.second),
        compared,
        verdict,
        reason,
        changes: changed_of(pair, model, shared, &found.causes),
        alternatives: found.alternatives.iter().map(rival).collect(),
        runner_up: found.runner_up.as_ref().map(rival),
        further: found.further.clone(),
        curve: found.curve.clone(),
        undecided,
        unexplained_fraction: found.unexplained_fraction,
        channels: found.channels.clone(),
        smallest_seen: found.smallest_seen.clone(),
        missing: found.missing.clone(),
        doubts: found.doubts.clone(),
        ceiling: found.ceiling.clone(),
        ..Changes::default()
    }
}

/// Causes of the search as what they are before and after.
pub(super) fn changed_of(
    pair: &Between,
    model: &Change,
    shared: &[Effect],
    causes: &[Cause],
) -> Vec<Changed> {
    let all = causes.iter();
    all.map(|cause| changed(pair, model, shared, cause))
        .collect()
}

/// What the scenario lacks in both recordings, with the numbers of a fit to both: `shared` of which
/// neither side has lost all; `known` are causes of the same names.
pub(super) fn shared_causes(
    pair: &Between,
    known: &[Cause],
    sides: [&[Effect]; 2],
    shared: &[Effect],
    numbers: &[Nominal],
) -> Vec<Cause> {
    let candidates = [pair.second.candidates(), pair.second.held().to_vec()].concat();
    let is_there = |effect: &&Effect| {
        let on = |side: &[Effect]| twin(side, &[], effect.kind, &effect.target).cloned();
        sides
            .iter()
            .all(|side| on(side).is_some_and(|one| !one.is_neutral()))
    };
    let told = |effect: &Effect| {
        let is_own = |one: &&Candidate| one.kind == effect.kind && one.target == effect.target;
        let own = candidates.iter().find(is_own)?;
        let is_named =
            |one: &&Cause| one.kind == own.kind.name() && one.target == diagnose::target_name(own);
        let mut cause = known.iter().find(is_named)?.clone();
        for (info, value) in own.kind.parameters().iter().zip(&effect.values) {
            let key = match own.rotary {
                true => info.rotary_key,
                false => info.key,
            };
            let number = numbers
                .iter()
                .find(|one| one.key == shared_key(effect, info));
            let ends = number.map(|one| [one.after.low, one.after.high]);
            let [low, high] = ends.unwrap_or_default();
            if let Some(parameter) = cause.parameters.get_mut(key) {
                *parameter = Parameter {
                    value: *value,
                    low: low.map(|low| low.max(info.min)),
                    high: high.map(|high| high.min(info.max)),
                    unit: parameter.unit.clone(),
                };
            }
        }
        Some(cause)
    };
    shared.iter().filter(is_there).filter_map(told).collect()
}

/// A cause of the search as what it is before and after.
fn changed(pair: &Between, model: &Change, shared: &[Effect], cause: &Cause) -> Changed {
    let candidates = model.candidates();
    let own = candidates
        .iter()
        .find(|one| one.kind.name() == cause.kind && diagnose::target_name(one) == cause.target);
    let sides = own.map(|own| {
        let value = |key: &str| cause.parameters.get(key).map_or(0.0, |one| one.value);
        let infos = own.kind.parameters().iter();
        let keys: Vec<&str> = infos
            .map(|info| {
                if own.rotary {
                    info.rotary_key
                } else {
                    info.key
                }
            })
            .collect();
        let effect = Effect {
            kind: own.kind,
            target: own.target.clone(),
            values: keys.iter().map(|key| value(key)).collect(),
        };
        let held = &pair.second.scenario().effects;
        let known = twin(shared, held, own.kind, &own.target);
        (keys, own.kind.parameters(), both(&effect, known))
    });
    let parameters = cause.parameters.iter().map(|(key, found)| {
        let place = sides.as_ref().and_then(|(keys, infos, sides)| {
            let at = keys.iter().position(|one| one == key)?;
            let neutral = if infos[at].is_size {
                infos[at].neutral
            } else {
                0.0
            };
            Some((sides[0].values[at], sides[1].values[at], neutral))
        });
        let (before, after, neutral) = place.unwrap_or((0.0, found.value, 0.0));
        let parameter = ChangedParameter {
            before,
            after,
            change: found.value - neutral,
            low: found.low.map(|low| low - neutral),
            high: found.high.map(|high| high - neutral),
            unit: found.unit.clone(),
        };
        (key.clone(), parameter)
    });
    Changed {
        kind: cause.kind.clone(),
        target: cause.target.clone(),
        parameters: parameters.collect(),
        evidence: cause.evidence.clone(),
    }
}
