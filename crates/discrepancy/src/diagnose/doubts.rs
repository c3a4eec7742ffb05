//! What is to be doubted about named causes: that they cancel one another, or lie at a bound.

use super::answer::{Cause, key_and_unit, target_name};
use super::fit::Fit;
use super::noise::{add_columns, dot};
use super::problem::Problem;
use crate::model::Columns;
use crate::stats::deviation;
use truecut_scenario::effect::{EffectKind, ParameterInfo};

/// Whether a value lies at an end of where it was looked for. What is gone altogether is no such
/// end: no friction, a sensor that is dead.
fn is_at_end(info: &ParameterInfo, value: f64) -> bool {
    (value == info.min || value == info.max) && value != info.neutral && value != 0.0
}

/// Two causes cancel if together they change less than this part of what each does.
const CANCELLING: f64 = 0.25;

/// The first size of an effect that lies at an end of its range, which is no size that was found.
pub(super) fn at_bound(problem: &Problem, fit: &Fit) -> Option<String> {
    fit.point.effects.iter().find_map(|effect| {
        let infos = problem.infos(effect.candidate);
        let mut sizes = infos.iter().zip(&effect.values).enumerate();
        let (i, (_, value)) =
            sizes.find(|(_, (info, value))| info.is_size && is_at_end(info, **value))?;
        let (key, unit) = key_and_unit(problem, effect.candidate, i);
        Some(format!(
            "`{key}` of {} lies at the end of its range, {} {unit}",
            name(problem, effect.candidate),
            truecut_recording::significant(*value, 3)
        ))
    })
}

/// One sentence for each doubt.
pub(super) fn doubts(problem: &Problem, fit: &Fit) -> Vec<String> {
    let mut position = problem.nominal.len();
    let (mut parts, mut found) = (Vec::new(), Vec::new());
    for effect in &fit.point.effects {
        let infos = problem.infos(effect.candidate);
        let mut change: Columns = fit.residual.iter().map(|x| vec![0.0; x.len()]).collect();
        for (i, (info, value)) in infos.iter().zip(&effect.values).enumerate() {
            if let Some(column) = fit.jacobian.get(position + i).filter(|_| info.is_size) {
                add_columns(&mut change, column, value - info.neutral);
            }
            if is_at_end(info, *value) {
                let (key, unit) = key_and_unit(problem, effect.candidate, i);
                found.push(format!(
                    "`{key}` of {} lies at the end of its range, {} {unit}: another cause may be behind it",
                    name(problem, effect.candidate),
                    truecut_recording::significant(*value, 3)
                ));
            }
        }
        position += effect.values.len();
        parts.push(change);
    }
    for (i, a) in parts.iter().enumerate() {
        for (j, b) in parts.iter().enumerate().skip(i + 1) {
            let channels = (0..a.len()).filter(|&c| cancel(problem, c, &a[c], &b[c]));
            if let Some(channel) = channels.into_iter().next() {
                let [one, other] = [i, j].map(|k| name(problem, fit.point.effects[k].candidate));
                let channel = &problem.model.channels()[channel].name;
                found.push(format!(
                    "{one} and {other} all but cancel in `{channel}`, and each is larger than what was measured: \
                     their sum is known, not their sizes"
                ));
            }
        }
    }
    found
}

/// A sensor whose gain may be 0 shows nothing of what is simulated for it.
pub(super) fn unrelated(cause: &Cause) -> Option<String> {
    let gain = cause.parameters.values().next()?;
    let holds_zero = gain.low? <= 0.0 && gain.high? >= 0.0;
    let channel = cause.target.as_ref()?;
    (holds_zero && cause.kind == EffectKind::SensorGain.name()).then(|| {
        format!(
            "`{channel}` has nothing to do with what is simulated for it (its gain may be 0): look whether its column is \
             another channel's, swapped, or dead"
        )
    })
}

/// Whether two changes of a channel are each beyond what it does, and next to nothing together.
fn cancel(problem: &Problem, channel: usize, a: &[f64], b: &[f64]) -> bool {
    let rows = &problem.split.development.per_channel[channel];
    let pick = |x: &[f64]| -> Vec<f64> { rows.iter().map(|&t| x[t]).collect() };
    let (a, b) = (pick(a), pick(b));
    let sum: Vec<f64> = a.iter().zip(&b).map(|(a, b)| a + b).collect();
    let size = |x: &[f64]| dot(x, x).sqrt();
    let measured = pick(&problem.data.outputs[channel].values);
    let own = deviation(&measured) * (rows.len() as f64).sqrt();
    size(&sum) < CANCELLING * size(&a).min(size(&b)) && size(&a).min(size(&b)) > own
}

fn name(problem: &Problem, candidate: usize) -> String {
    let candidate = &problem.candidates[candidate];
    match target_name(candidate) {
        Some(target) => format!("{} on {target}", candidate.kind.name()),
        None => candidate.kind.name().to_owned(),
    }
}
