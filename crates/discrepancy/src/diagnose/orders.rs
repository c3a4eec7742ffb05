//! Orders of ripples that the residual itself has: a transmission may have any number of teeth, and
//! between orders on a list a fit does not find its way.

use std::f64::consts::TAU;

use rayon::prelude::*;
use truecut_scenario::effect::{EffectKind, Target};

use super::ceiling::wave_over;
use super::fit::Fit;
use super::problem::Problem;
use super::signature::{Signature, shaped};

/// For each joint that may ripple the signatures at the order of the wave over its place that
/// explains the largest part of a channel.
pub(super) fn rippled(problem: &Problem, base: &Fit) -> Vec<Signature> {
    let ripples: Vec<usize> = (problem.searched())
        .filter(|&one| problem.candidates[one].kind == EffectKind::JointRipple)
        .filter(|&one| !base.point.holds(one))
        .collect();
    let found = ripples.into_par_iter().flat_map_iter(|candidate| {
        order(problem, base, candidate)
            .map(|cycles| shaped(problem, base, candidate, vec![cycles]))
            .unwrap_or_default()
    });
    found.collect()
}

/// Cycles per turn, or per metre.
fn order(problem: &Problem, base: &Fit, candidate: usize) -> Option<f64> {
    let Target::Joint(joint) = problem.candidates[candidate].target else {
        return None;
    };
    let rows = &problem.split.train.per_channel;
    let waves = (base.residual.iter().zip(rows))
        .filter_map(|(residual, rows)| wave_over(problem, &base.predicted, joint, residual, rows));
    let (_, periods) = waves.max_by(|a, b| a.0.total_cmp(&b.0))?;
    let cycles = match problem.candidates[candidate].rotary {
        true => TAU * periods,
        false => periods,
    };
    let info = problem.infos(candidate).iter().find(|info| !info.is_size)?;
    (info.min..=info.max).contains(&cycles).then_some(cycles)
}
