//! Curves for what has no name, each over the motion of its joint.

use truecut_scenario::Scenario;
use truecut_scenario::effect::{Effect, EffectKind, Target};
use truecut_sim::misfit;

use super::candidates::SHARE;
use super::signals::Signals;
use crate::model::{Candidate, CurveCandidate};

/// Curves over the position and the speed of every joint that moves, from end to end of its motion.
pub(super) fn curves(scenario: &Scenario, signals: &Signals) -> Vec<CurveCandidate> {
    let kinds = EffectKind::ALL
        .iter()
        .copied()
        .filter(|kind| kind.is_curve());
    let of_kind = |kind: EffectKind| {
        let joints = signals.joints.iter().enumerate();
        joints.filter_map(move |(index, joint)| {
            let effect = Effect::neutral(kind, Target::Joint(index));
            let known = |own: &Effect| own.kind == kind && own.target == effect.target;
            let ends = joint.ends(kind)?;
            let size = SHARE * joint.effort;
            let shows = size.is_finite() && size > 0.0;
            if !shows || misfit(scenario, &effect).is_some() || scenario.effects.iter().any(known) {
                return None;
            }
            let candidate = Candidate {
                kind,
                rotary: joint.rotary,
                target: effect.target,
                scale: vec![size],
            };
            Some(CurveCandidate {
                candidate,
                ends,
                least: least(scenario, kind, index),
            })
        })
    };
    kinds.flat_map(of_kind).collect()
}

/// A friction is at least nothing where the scenario gives the joint none; where it does, a curve
/// may take it away.
fn least(scenario: &Scenario, kind: EffectKind, joint: usize) -> f64 {
    let own = |effect: &Effect| effect.target == Target::Joint(joint) && rubs(effect.kind);
    match rubs(kind) && !scenario.effects.iter().any(own) {
        true => 0.0,
        false => f64::NEG_INFINITY,
    }
}

/// Whether it is friction of a joint.
pub(crate) fn rubs(kind: EffectKind) -> bool {
    use EffectKind as E;
    matches!(
        kind,
        E::JointCoulomb
            | E::JointViscous
            | E::JointAsymmetricCoulomb
            | E::JointAsymmetricViscous
            | E::JointStribeck
            | E::JointLoadFriction
            | E::JointFrictionByPosition
            | E::JointFrictionBySpeed
    )
}
