//! What rows that a curve was not fitted to say of it.

use crate::diagnose::DiagnoseError;
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
/// that leaves `without`; `None` where it says nothing of them. A curve follows the noise a little
/// wherever it has values, and predicts rows that its law does not reach worse for that, by as much
/// as it changes them: only what is beyond its band counts against it.
pub(super) fn borne_out(
    problem: &Problem,
    without: &Columns,
    with: &Fit,
    [fitted, others]: [&Rows; 2],
) -> Result<Option<bool>, DiagnoseError> {
    if compare(without, &with.residual, &with.noise, others).gain > 0.0 {
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
    let beyond = beyond_its_band(problem, with, [fitted, others])?;
    let is_silent = beyond.is_some_and(|residual| squares(&residual, others) <= least);
    Ok((!is_silent).then_some(false))
}

/// What a model with a curve leaves of other rows than those to which it was `fitted`, if the curve
/// is nothing where its 99 % interval holds that.
fn beyond_its_band(
    problem: &Problem,
    with: &Fit,
    [fitted, others]: [&Rows; 2],
) -> Result<Option<Columns>, DiagnoseError> {
    let all = covariance(problem, with, fitted)?;
    let (Some(all), Some((first, curve))) = (all, problem.curve(&with.point)) else {
        return Ok(None);
    };
    let pairs = curve.values.iter().zip(problem.infos(curve.candidate));
    let values = pairs.enumerate().map(|(i, (value, info))| {
        let error = all[(first + i, first + i)].max(0.0).sqrt();
        match (value - info.neutral).abs() > Z99 * error {
            true => *value,
            false => info.neutral,
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
