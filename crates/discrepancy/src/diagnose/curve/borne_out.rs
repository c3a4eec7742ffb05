//! What rows that a curve was not fitted to say of it.

use truecut_scenario::effect::EffectKind;

use crate::diagnose::DiagnoseError;
use crate::diagnose::choice::LEAST_T;
use crate::diagnose::data::Rows;
use crate::diagnose::derivatives::difference;
use crate::diagnose::fit::Fit;
use crate::diagnose::noise::dot;
use crate::diagnose::problem::Problem;
use crate::diagnose::uncertainty::covariance;
use crate::diagnose::validate::compare;
use crate::model::Columns;

/// Whitened squares of what a curve changes in a part of the data, from which on that part can
/// speak against it.
const LEAST_ACTS: f64 = 9.0;
/// And so large a part of what it changes where it was fitted, row by row in the mean: beside a law
/// that is large a spline's rounding of it is not.
const FAINT: f64 = 0.01;
/// Normal quantile of a two-sided 99 % interval.
const Z99: f64 = 2.575_829;

/// Whether other rows than those to which a model with a curve was `fitted` bear it out against one
/// that leaves `without`, beyond chance: by a hair every second curve of noise predicts other noise
/// better. `None` where it says nothing of them. A curve follows the noise a little
/// wherever it has values, and predicts rows that its law does not reach worse for that, by as much
/// as it changes them: only what is beyond its band counts against it, and for it as well. A
/// friction in the place of the causes on its joint is its own mean where it was not seen.
pub(super) fn borne_out(
    problem: &Problem,
    without: &Columns,
    with: &Fit,
    [fitted, others]: [&Rows; 2],
) -> Result<Option<bool>, DiagnoseError> {
    let is_better = |left: &Columns| compare(without, left, &with.noise, others).t() > LEAST_T;
    if is_better(&with.residual) {
        return Ok(Some(true));
    }
    let squares = |residual: &Columns, rows: &Rows| {
        let change = difference(without, residual, 1.0);
        let change = with.noise.whiten(&change, rows);
        dot(&change, &change)
    };
    let share = others.len() as f64 / fitted.len() as f64;
    let least = LEAST_ACTS.max(FAINT * share * squares(&with.residual, fitted));
    if squares(&with.residual, others) <= least {
        return Ok(None);
    }
    let limited = within_its_band(problem, with, [fitted, others])?;
    if limited.as_ref().is_some_and(is_better) {
        return Ok(Some(true));
    }
    let is_silent = limited.is_some_and(|residual| squares(&residual, others) <= least);
    Ok((!is_silent).then_some(false))
}

/// Whether a curve is of friction, and nothing else acts on its joint.
fn is_alone(problem: &Problem, with: &Fit) -> bool {
    let Some((curve, others)) = with.point.effects.split_last() else {
        return false;
    };
    let own = &problem.candidates[curve.candidate];
    let mut others = others
        .iter()
        .map(|one| &problem.candidates[one.candidate].target);
    own.kind != EffectKind::JointPositionCurve && others.all(|target| *target != own.target)
}

/// What a model with a curve leaves of other rows than those to which it was `fitted`, if the curve
/// is nothing where its 99 % interval holds that; one that is alone is its mean there.
fn within_its_band(
    problem: &Problem,
    with: &Fit,
    [fitted, others]: [&Rows; 2],
) -> Result<Option<Columns>, DiagnoseError> {
    let all = covariance(problem, with, fitted)?;
    let (Some(all), Some((first, curve))) = (all, problem.curve(&with.point)) else {
        return Ok(None);
    };
    let variance = |i: usize| all[(first + i, first + i)].max(f64::MIN_POSITIVE);
    // As each value is known.
    let weighed = |of: &dyn Fn(f64) -> f64| -> f64 {
        let values = curve.values.iter().enumerate();
        values.map(|(i, value)| of(*value) / variance(i)).sum()
    };
    let mean = weighed(&|value| value) / weighed(&|_| 1.0);
    let is_alone = is_alone(problem, with);
    let pairs = curve.values.iter().zip(problem.infos(curve.candidate));
    let values = pairs.enumerate().map(|(i, (value, info))| {
        let unseen = if is_alone { mean } else { info.neutral };
        match (value - unseen).abs() > Z99 * variance(i).sqrt() {
            true => *value,
            false => unseen,
        }
    });
    let values: Vec<f64> = values.collect();
    let mut point = with.point.clone();
    if let Some(own) = point.effects.last_mut() {
        own.values = values;
    }
    let predicted = problem.predict_for(others, &point);
    Ok(predicted
        .ok()
        .map(|columns| problem.data.residual(&columns)))
}
