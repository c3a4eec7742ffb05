//! A change as effects of both recordings.

use truecut_scenario::effect::{Effect, EffectKind, ParameterInfo, Target};

use crate::trial::curves::rubs;

/// The effect of this kind and target that both recordings have, if any: one that was found, or of
/// the scenario itself.
pub(super) fn twin<'a>(
    shared: &'a [Effect],
    held: &'a [Effect],
    kind: EffectKind,
    target: &Target,
) -> Option<&'a Effect> {
    (shared.iter().chain(held)).find(|one| one.kind == kind && one.target == *target)
}

/// The bounds of a change, of those of an effect. A size that is never below its neutral value may
/// fall, too: then it was there before.
pub(super) fn bounds(infos: Vec<ParameterInfo>, twin: Option<&Effect>) -> Vec<ParameterInfo> {
    let infos = infos.into_iter().enumerate();
    let widened = infos.map(|(i, mut info)| {
        if info.is_size {
            let offset = twin.map_or(0.0, |one| one.values[i] - info.neutral);
            let room = info.max - info.neutral;
            info.min = match info.min < info.neutral {
                true => info.min - offset,
                false => info.neutral - room,
            };
            info.max -= offset;
        }
        info
    });
    widened.collect()
}

/// Effects of the first and of the second recording. Sizes change from what both share; what would
/// be below its bound in the second was there in the first. Shapes are those of what both share,
/// where there is such.
pub(super) fn split(shared: &[Effect], held: &[Effect], changes: &[Effect]) -> [Vec<Effect>; 2] {
    let mut sides = [shared.to_vec(), shared.to_vec()];
    for change in changes {
        let known = twin(shared, held, change.kind, &change.target);
        let own = match change.kind.is_curve() {
            true => both_curves(change, rubs_already(shared, held, &change.target)),
            false => both(change, known),
        };
        for (side, effect) in sides.iter_mut().zip(own) {
            let place = |own: &Effect| own.kind == effect.kind && own.target == effect.target;
            match side.iter().position(place) {
                Some(place) => side[place] = effect,
                None if known.is_none() && effect.is_neutral() => {}
                None => side.push(effect),
            }
        }
    }
    sides
}

/// Whether both recordings have friction in a joint, which a change may take away.
fn rubs_already(shared: &[Effect], held: &[Effect], target: &Target) -> bool {
    let mut known = shared.iter().chain(held);
    known.any(|one| rubs(one.kind) && one.target == *target)
}

/// A curve before and after. No friction drives a joint: where it has become less, and none is
/// known that it could take away, it was there before.
fn both_curves(change: &Effect, rubs_already: bool) -> [Effect; 2] {
    let mut sides = [change.clone(), change.clone()];
    let ends = 2.min(change.values.len());
    let was_there = rubs(change.kind) && !rubs_already;
    for (i, value) in change.values.iter().enumerate().skip(ends) {
        let before = if was_there { (-value).max(0.0) } else { 0.0 };
        sides[0].values[i] = before;
        sides[1].values[i] = value + before;
    }
    sides
}

/// One effect before and after a change.
pub(super) fn both(change: &Effect, known: Option<&Effect>) -> [Effect; 2] {
    let mut sides = [change.clone(), change.clone()];
    for (i, info) in change.kind.parameters().iter().enumerate() {
        let own = known.map(|one| one.values[i]);
        let [before, after] = if info.is_size {
            let grown = change.values[i] - info.neutral;
            let after = (own.unwrap_or(info.neutral) + grown).clamp(info.min, info.max);
            [(after - grown).clamp(info.min, info.max), after]
        } else {
            [own.unwrap_or(change.values[i]); 2]
        };
        sides[0].values[i] = before;
        sides[1].values[i] = after;
    }
    sides
}

#[cfg(test)]
mod tests {
    use super::*;

    fn friction(value: f64) -> Effect {
        Effect {
            kind: EffectKind::JointCoulomb,
            target: Target::Joint(1),
            values: vec![value],
        }
    }

    #[test]
    fn verify_what_grows_is_added_to_what_both_share() {
        for (shared, grown) in [(3.0, 2.0), (3.0, -1.0), (0.5, 0.25)] {
            let [before, after] = split(&[friction(shared)], &[], &[friction(grown)]);
            assert_eq!(before, vec![friction(shared)]);
            assert_eq!(after, vec![friction(shared + grown)]);
            let [before, after] = split(&[], &[friction(shared)], &[friction(grown)]);
            assert_eq!(before, vec![friction(shared)]);
            assert_eq!(after, vec![friction(shared + grown)]);
        }
    }

    #[test]
    fn verify_what_falls_below_its_bound_was_there_before() {
        let [before, after] = split(&[], &[], &[friction(-2.0)]);
        assert_eq!((before, after), (vec![friction(2.0)], vec![]));
        let [before, after] = split(&[friction(1.0)], &[], &[friction(-2.5)]);
        assert_eq!((before, after), (vec![friction(2.5)], vec![friction(0.0)]));
        let [before, after] = split(&[], &[], &[friction(2.0)]);
        assert_eq!((before, after), (vec![], vec![friction(2.0)]));
    }

    /// Friction that has become less at some places was there before: none of a recording's drives
    /// the joint. A force may push either way, and so may what takes from friction that is known.
    #[test]
    fn verify_no_friction_drives_a_joint() {
        let curve = |kind: EffectKind, values: &[f64]| Effect {
            kind,
            target: Target::Joint(1),
            values: [&[-1.0, 1.0], values].concat(),
        };
        for kind in [
            EffectKind::JointFrictionByPosition,
            EffectKind::JointFrictionBySpeed,
        ] {
            let change = [curve(kind, &[2.0, -3.0, 0.5, -1.0])];
            let [before, after] = split(&[], &[], &change);
            assert_eq!(before, [curve(kind, &[0.0, 3.0, 0.0, 1.0])]);
            assert_eq!(after, [curve(kind, &[2.0, 0.0, 0.5, 0.0])]);
            let [_, after] = split(&[friction(4.0)], &[], &change);
            assert_eq!(after[1], change[0]);
        }
        let force = [curve(EffectKind::JointPositionCurve, &[2.0, -3.0])];
        assert_eq!(split(&[], &[], &force)[1], force);
    }

    #[test]
    fn verify_a_factor_changes_from_what_it_was() {
        let stiffness = |value: f64| Effect {
            kind: EffectKind::JointStiffness,
            target: Target::Joint(0),
            values: vec![value],
        };
        let [before, after] = split(&[stiffness(0.8)], &[], &[stiffness(0.9)]);
        assert_eq!(before, vec![stiffness(0.8)]);
        assert!((after[0].values[0] - 0.7).abs() < 1e-12);
    }
}
