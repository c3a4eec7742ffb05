//! The unknown is shown: what no effect of the library has the shape of is a curve over a joint's
//! position or speed, with its band.
//!
//! Curves are no candidates of the search: with many numbers each imitates much. They are asked
//! when the search has ended, beside the causes found and in place of those on the same joint, and
//! must be more likely by odds of 400 to 1 after the price of their numbers, better on blocks that
//! they were not fitted to, and no worse on the last part of the data.

use nalgebra::DVector;
use rayon::prelude::*;
use truecut_scenario::effect::{Effect, Target};

use super::DiagnoseError;
use super::ambiguity::OVERWHELMING;
use super::answer::{UnknownCurve, key_and_unit, target_name};
use super::choice::{LEAST_T, criterion};
use super::derivatives::difference;
use super::fit::{Fit, fit};
use super::memory::stands_out;
use super::noise::{Prior, fit_linear};
use super::problem::{PLACES, Point, Problem};
use super::screen::nuisance;
use super::search::{Outcome, settled};
use super::uncertainty::covariance;
use super::validate::compare;
use crate::model::Columns;
use crate::stats::ratio;

/// Curves that are fitted, the best of those that were looked at.
const FITTED: usize = 3;
/// Places at which a curve is told.
const TOLD_AT: usize = 61;
/// Normal quantile of a two-sided 95 % interval.
const Z95: f64 = 1.959_964;

/// A model with a curve.
pub(super) struct Shown {
    /// Fitted to the development part; predicted for all samples.
    pub fit: Fit,
    pub curve: UnknownCurve,
}

/// The curve that explains what the model chosen, `last`, does not, if one does. Where causes are
/// named only curves on their joints are asked, and one that takes no more than the part of the
/// discrepancy that causes may leave does not put them in doubt: no machine's friction is exactly
/// Coulomb's. `base` is the model without causes.
pub(super) fn shown(
    problem: &Problem,
    outcome: &Outcome,
    [base, last]: [&Fit; 2],
    is_named: bool,
) -> Result<Option<Shown>, DiagnoseError> {
    let chosen = &outcome.chosen;
    let joints: Vec<&Target> = (chosen.point.effects.iter())
        .map(|found| &problem.candidates[found.candidate].target)
        .collect();
    let wanted: Vec<usize> = (problem.curves())
        .filter(|&one| !is_named || joints.contains(&&problem.candidates[one].target))
        .collect();
    for (trial, orders) in earning(problem, outcome, promising(problem, outcome, wanted)) {
        let mut ended = fit(
            problem,
            trial.point,
            &problem.split.development,
            &orders,
            true,
        )?;
        let Ok(predicted) = problem.predict_whole(&ended.point) else {
            continue;
        };
        ended.residual = problem.data.residual(&predicted);
        ended.predicted = predicted;
        let (rows, noise) = (&problem.split.test, &ended.noise);
        let test = compare(&last.residual, &ended.residual, noise, rows);
        let share = share(problem, [base, last, &ended]);
        let matters = !is_named || share > problem.options.unknown_above;
        if matters && test.gain > 0.0 && test.t() > LEAST_T {
            let gain = criterion(problem, chosen, &orders) - criterion(problem, &ended, &orders);
            let curve = told(problem, &ended, gain)?;
            return Ok(Some(Shown { fit: ended, curve }));
        }
    }
    Ok(None)
}

/// Part of the discrepancy that the curve explains beyond the causes.
fn share(problem: &Problem, [base, last, ended]: [&Fit; 3]) -> f64 {
    let rows = &problem.split.development;
    let gain = |first: &Fit, second: &Fit| {
        compare(&first.residual, &second.residual, &ended.noise, rows)
            .gain
            .max(0.0)
    };
    ratio(gain(last, ended), gain(base, last) + gain(last, ended))
}

/// Those that would explain most of what is left, by their traces at typical sizes, coarse and
/// fine: none that does not pay for its numbers.
fn promising(problem: &Problem, outcome: &Outcome, wanted: Vec<usize>) -> Vec<usize> {
    let base = &outcome.chosen;
    let (nuisance, priors) = nuisance(problem, base);
    let left = |own: &[Columns]| {
        let design: Vec<&Columns> = own.iter().chain(nuisance.iter().copied()).collect();
        let priors = [&vec![Prior::default(); own.len()][..], &priors[..]].concat();
        let (train, orders) = (&problem.split.train, &outcome.orders);
        fit_linear(
            &base.residual,
            &design,
            &priors,
            train,
            &base.noise,
            orders,
            &problem.floor,
        )
        .objective
    };
    let zero = left(&[]);
    let n = problem.split.train.len() as f64;
    let places = |candidate: usize| problem.infos(candidate).len();
    // What each gains beyond the price of its numbers, most first; all that pay for so many.
    let gains = |wanted: Vec<usize>, least: fn(usize) -> usize| {
        let mut gains: Vec<(f64, usize)> = (wanted.into_par_iter())
            .filter_map(|one| {
                let gain = zero - left(&traces(problem, base, one)?);
                let pays = gain > least(places(one)) as f64 * n.ln();
                pays.then_some((gain - places(one) as f64 * n.ln(), one))
            })
            .collect();
        gains.sort_by(|a, b| b.0.total_cmp(&a.0));
        gains.truncate(FITTED);
        gains
    };
    let (screened, others): (Vec<usize>, Vec<usize>) =
        (wanted.into_iter()).partition(|one| places(*one) == PLACES[1]);
    let screened = gains(screened, |_| PLACES[0]);
    let alike = |a: usize, b: usize| {
        let (a, b) = (&problem.candidates[a], &problem.candidates[b]);
        a.kind == b.kind && a.target == b.target
    };
    let finer = (others.into_iter()).filter(|one| screened.iter().any(|(_, of)| alike(*one, *of)));
    let mut found = gains(finer.collect(), |places| places);
    found.extend(screened.into_iter().filter(|(net, _)| *net > 0.0));
    found.sort_by(|a, b| b.0.total_cmp(&a.0));
    found.truncate(FITTED);
    found.into_iter().map(|(_, one)| one).collect()
}

/// Change of the prediction for each value of a curve alone; `None` where one cannot be run.
fn traces(problem: &Problem, base: &Fit, candidate: usize) -> Option<Vec<Columns>> {
    let scale = &problem.candidates[candidate].scale;
    let trace = |i: usize| {
        let mut curve = problem.neutral(candidate);
        curve.values[i] = scale[i];
        let mut point = base.point.clone();
        point.effects.push(curve);
        let moved = problem.predict(&point).ok()?;
        Some(difference(&moved, &base.predicted, 1.0 / scale[i]))
    };
    (0..scale.len()).map(trace).collect()
}

/// Fits of these curves beside the causes, and in place of those on the same joint: those that earn
/// their place, with the orders of their noise, likeliest first.
fn earning(problem: &Problem, outcome: &Outcome, wanted: Vec<usize>) -> Vec<(Fit, Vec<usize>)> {
    let chosen = &outcome.chosen;
    let starts: Vec<Point> = (wanted.into_iter())
        .flat_map(|candidate| {
            let target = &problem.candidates[candidate].target;
            let mut beside = chosen.point.clone();
            let mut instead = chosen.point.clone();
            (instead.effects).retain(|own| problem.candidates[own.candidate].target != *target);
            let both = instead.effects.len() < beside.effects.len();
            for point in [&mut beside, &mut instead] {
                point.effects.push(problem.neutral(candidate));
            }
            [Some(beside), both.then_some(instead)]
        })
        .flatten()
        .collect();
    let fits: Vec<(Fit, Vec<usize>)> = (starts.into_par_iter())
        .filter_map(|start| {
            let train = &problem.split.train;
            let first = fit(problem, start, train, &outcome.orders, false).ok()?;
            settled(problem, first).ok()
        })
        .collect();
    let gain = |(trial, orders): &(Fit, Vec<usize>)| {
        criterion(problem, chosen, orders) - criterion(problem, trial, orders)
    };
    let earns = |one: &(Fit, Vec<usize>)| {
        let trial = &one.0;
        let paired = compare(
            &chosen.residual,
            &trial.residual,
            &trial.noise,
            &problem.split.validation,
        );
        gain(one) > OVERWHELMING
            && paired.t() > LEAST_T
            && paired.practical >= problem.options.min_gain
            && stands_out(problem, gain(one), &chosen.residual, &trial.residual)
    };
    let mut found: Vec<(Fit, Vec<usize>)> = fits.into_iter().filter(earns).collect();
    found.sort_by(|a, b| gain(b).total_cmp(&gain(a)));
    found
}

/// The curve of a fit, which is its last effect, with its band.
fn told(problem: &Problem, ended: &Fit, gain: f64) -> Result<UnknownCurve, DiagnoseError> {
    let found = ended.point.effects.last().expect("the curve was added");
    let candidate = &problem.candidates[found.candidate];
    let effect = problem.effect(found);
    let (ends, values) = effect
        .values
        .split_at(effect.values.len() - found.values.len());
    let rows = &problem.split.development;
    let all = covariance(problem, ended, rows)?;
    let first = problem.variables(&ended.point).len() - values.len();
    let own = all.map(|all| {
        all.view((first, first), (values.len(), values.len()))
            .into_owned()
    });
    let (from, to) = (ends[0], ends[1]);
    let x: Vec<f64> = (0..TOLD_AT)
        .map(|i| from + (to - from) * i as f64 / (TOLD_AT - 1) as f64)
        .collect();
    let value: Vec<f64> = x.iter().map(|x| at(&effect, *x)).collect();
    let error = |x: f64| {
        // A curve is linear in its values.
        let weight = |i: usize| {
            let mut one = effect.clone();
            one.values[ends.len()..].fill(0.0);
            one.values[ends.len() + i] = 1.0;
            at(&one, x)
        };
        let weights = DVector::from_fn(values.len(), |i, _| weight(i));
        let own = own.as_ref()?;
        Some((weights.dot(&(own * &weights))).max(0.0).sqrt())
    };
    let band = |sign: f64| -> Vec<Option<f64>> {
        let pairs = x.iter().zip(&value);
        pairs
            .map(|(x, value)| Some(value + sign * Z95 * error(*x)?))
            .collect()
    };
    let infos = candidate.kind.parameters();
    let x_unit = match candidate.rotary {
        true => infos[0].rotary_unit,
        false => infos[0].unit,
    };
    Ok(UnknownCurve {
        kind: candidate.kind.name().into(),
        target: target_name(candidate).unwrap_or_default(),
        x_unit: x_unit.to_string(),
        unit: key_and_unit(problem, found.candidate, 0).1,
        low: band(-1.0),
        high: band(1.0),
        x,
        value,
        log10_odds: 0.5 * gain / std::f64::consts::LN_10,
    })
}

fn at(effect: &Effect, x: f64) -> f64 {
    effect.curve().map_or(0.0, |curve| curve.value(x))
}
