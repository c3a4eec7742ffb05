//! What a sensor would have to do so that a law of the machine fits exactly.
//!
//! No gear's friction is exactly a share of the load, none exactly Coulomb's. Where it is strong
//! beside the noise, the rest of its shape looks like a gain or an offset of the torque it is read
//! from; there causes of joints stay named beside a curve, too, if that takes no more than causes
//! may leave.

use crate::diagnose::answer::{Diagnosis, names};
use crate::diagnose::fit::Fit;
use crate::diagnose::problem::{Point, Problem};
use crate::diagnose::starts::without;
use crate::diagnose::validate::rms;
use crate::model::PredictError;
use truecut_scenario::effect::{EffectKind, Target};

/// Effects of a sensor that the rest of a law's shape looks like. A delay does not: no law of a
/// joint comes late.
const LIKE_A_LAW: [EffectKind; 2] = [EffectKind::SensorGain, EffectKind::SensorOffset];

/// The model without effects of sensors that take away no more of their channel's discrepancy than
/// causes may leave, beside a cause in the joint that is measured there; and a sentence on each.
pub(super) fn without_incidental(
    problem: &Problem,
    base: &Fit,
    mut last: Fit,
    to_all: impl Fn(&Point) -> Result<Fit, PredictError>,
) -> (Fit, Vec<String>) {
    let mut told = Vec::new();
    let mut index = 0;
    while index < last.point.effects.len() {
        let channel = measured_cause(problem, &last.point, index);
        let smaller = channel.and_then(|c| Some((c, to_all(&without(&last.point, index)).ok()?)));
        let rest = smaller.and_then(|(c, small)| {
            let rows = &problem.split.development;
            let part = rms(&small.residual, rows)[c] / rms(&base.residual, rows)[c];
            (part < problem.options.unknown_above).then_some((part, small))
        });
        let Some((part, small)) = rest else {
            index += 1;
            continue;
        };
        let mut alone = last.point.clone();
        alone.effects = vec![last.point.effects[index].clone()];
        told.push(format!(
            "{} would take away most of the {:.0} % that is left there: the law named may not be \
             exactly the machine's, or the sensor errs as well",
            names(problem, &alone).join(" + "),
            100.0 * part
        ));
        last = small;
    }
    (last, told)
}

/// As doubts of the causes that stay; what was compared with all of them is none of theirs.
pub(super) fn tell(told: Vec<String>, diagnosis: &mut Diagnosis) {
    if !told.is_empty() {
        diagnosis.alternatives.clear();
        diagnosis.further.clear();
        diagnosis.experiments.clear();
        diagnosis.runner_up = None;
    }
    diagnosis.doubts.extend(told);
}

/// The channel of an effect of a sensor, where the joint whose torque it measures has a cause.
fn measured_cause(problem: &Problem, point: &Point, index: usize) -> Option<usize> {
    let own = &problem.candidates[point.effects[index].candidate];
    let Target::Channel(name) = &own.target else {
        return None;
    };
    let is_of_joint = |found: usize| match problem.candidates[found].target {
        Target::Joint(joint) => name.starts_with(&format!("joint{}.", joint + 1)),
        _ => false,
    };
    let beside = point.candidates().into_iter().any(is_of_joint);
    let mut channels = problem.model.channels().iter();
    (beside && LIKE_A_LAW.contains(&own.kind))
        .then(|| channels.position(|spec| spec.name == *name))
        .flatten()
}
