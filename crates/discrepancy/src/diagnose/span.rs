//! What whole families of effects could do together, in any mixture: a friction of any course over
//! speed, a transmission of any shape. The library holds a few courses; a residual that a free
//! mixture of them follows has a place, if no name.

use truecut_scenario::effect::{Signal, Target};

use super::features::Group;
use super::noise::{add_column, dot};
use super::problem::Problem;
use super::signature::Signature;
use crate::model::Candidate;

/// The mixtures, as features of one channel; their traces come from full simulations, dynamics
/// included.
pub(super) fn spans(problem: &Problem, signatures: &[&Signature], channel: usize) -> Vec<Group> {
    let mut groups: Vec<Group> = Vec::new();
    for signature in signatures {
        let candidate = &problem.candidates[signature.candidate];
        let Some(name) = family(candidate) else {
            continue;
        };
        let columns = signature.columns.iter().map(|x| x[channel].clone());
        match groups.iter_mut().find(|g| g.name == name) {
            Some(group) => group.features.extend(columns),
            None => groups.push(Group::of_signal(name, columns.collect())),
        }
    }
    for group in &mut groups {
        group.features = independent(&group.features);
    }
    groups.retain(|group| group.features.len() > 1);
    groups
}

fn family(candidate: &Candidate) -> Option<String> {
    let signal = candidate.kind.follows()?;
    let Target::Joint(joint) = candidate.target else {
        return Some("the load of the foot, as a friction would".to_owned());
    };
    let joint = joint + 1;
    Some(match signal {
        Signal::Speed => format!("the speed of joint {joint}, as a friction would"),
        Signal::Load => format!("the load of joint {joint}, as its transmission would"),
        Signal::Angle => format!("the angle of joint {joint}, as its transmission would"),
    })
}

/// A part of the square of a feature that must not be that of those before it.
const NEW: f64 = 1e-3;

/// Orthogonal features that span all but the same: many sizes of one effect leave nearly one trace.
fn independent(features: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let mut basis: Vec<Vec<f64>> = Vec::new();
    for feature in features {
        let whole = dot(feature, feature);
        let mut left = feature.clone();
        for known in &basis {
            let share = dot(&left, known) / dot(known, known);
            add_column(&mut left, known, -share);
        }
        let square = dot(&left, &left);
        if square > NEW * whole && square > 0.0 {
            let scale = (left.len() as f64 / square).sqrt();
            basis.push(left.into_iter().map(|x| x * scale).collect());
        }
    }
    basis
}
