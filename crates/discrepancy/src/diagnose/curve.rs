//! The unknown is shown: what no effect of the library has the shape of is a curve over a joint's
//! position or speed, with its band.
//!
//! Curves are no candidates of the search: with many numbers each imitates much. They are asked
//! when the search has ended, beside the causes found and in place of those on the same joint, and
//! must be more likely by odds of 400 to 1, times the number of curves that are asked, with all
//! their values integrated out, and borne out by what they were not fitted to: blocks that choose,
//! and the last part of the data. What acts at an end of the travel alone, as an elastic stop does,
//! may be met in one of the two and not in the other, which then says nothing of it.

mod borne_out;

use nalgebra::DVector;
use rayon::prelude::*;
use truecut_scenario::effect::{Effect, EffectKind, Target};

use self::borne_out::borne_out;
use super::ambiguity::OVERWHELMING;
use super::answer::{UnknownCurve, key_and_unit, target_name};
use super::choice::{criterion, criterion_at};
use super::fit::{Fit, Running, fit};
use super::memory::stands_out;
use super::noise::Noise;
use super::problem::{Found, PLACES, Point, Problem};
use super::screen::critical;
use super::search::{Outcome, settled};
use super::uncertainty::covariance;
use super::validate::{compare, objective};
use super::{DiagnoseError, Stage};
use crate::stats::ratio;

/// Curves that are fitted, the best of those that were looked at.
const FITTED: usize = 3;
/// Iterations after which it is seen what a curve may explain.
const SKETCHED_IN: usize = 3;
/// Below this weight of its bending a curve may want more values: as likely a weight for about four
/// waves over its range, each of more than ten values of the coarse one.
const BENDS_MUCH: f64 = 1e-5;
/// Frictions from which fits start, in typical sizes.
const LEVELS: [f64; 5] = [0.03, 0.1, 0.3, 1.0, 3.0];
/// Places at which a curve is told.
const TOLD_AT: usize = 61;
/// Normal quantile of a two-sided 95 % interval.
const Z95: f64 = 1.959_964;

/// As many numbers a curve is worth, however many values it has: its bending has a price.
const NUMBERS: usize = 10;

/// What a curve must be beyond.
#[derive(Clone, Copy)]
struct Bar {
    /// By as much it must be likelier, in minus twice the logarithm.
    gain: f64,
    /// And by so much further out of noise of any memory than one number.
    scale: f64,
}

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
    problem.report(Stage::Curve);
    let chosen = &outcome.chosen;
    let joints: Vec<&Target> = (chosen.point.effects.iter())
        .map(|found| &problem.candidates[found.candidate].target)
        .collect();
    let wanted: Vec<usize> = (problem.curves())
        .filter(|&one| problem.infos(one).len() == PLACES[0])
        .filter(|&one| !is_named || joints.contains(&&problem.candidates[one].target))
        .collect();
    let rows = &problem.split.development;
    // Each of those asked is as likely as any other: the best of many has had as many chances.
    let asked = wanted.len().max(1);
    let critical = |numbers| critical(problem.options.family_wise_error, asked, numbers);
    let bar = Bar {
        gain: OVERWHELMING + 2.0 * (asked as f64).ln(),
        scale: (critical(NUMBERS) / critical(1)).sqrt(),
    };
    let starts = promising(problem, outcome, wanted);
    for earned in earning(problem, outcome, (last, bar), starts) {
        let mut ended = earned.fit;
        let Ok(predicted) = problem.predict_whole(&ended.point) else {
            continue;
        };
        ended.residual = problem.data.residual(&predicted);
        ended.predicted = predicted;
        let share = share(problem, [base, last, &ended]);
        let matters = !is_named || share > problem.options.unknown_above;
        if !matters {
            continue;
        }
        let on_test = borne_out(problem, &last.residual, &ended, [rows, &problem.split.test])?;
        if on_test.unwrap_or(earned.is_borne_out) {
            let curve = told(problem, &ended, earned.gain)?;
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

/// Starts of fits that promise most: each curve is first fitted beside the causes for a few steps,
/// which is enough to see what it may explain, or in place of those on the same joint, beside which
/// it may have to be what it cannot be. Friction is not linear in its values: it stops a joint, and
/// less than none is none.
fn promising(problem: &Problem, outcome: &Outcome, wanted: Vec<usize>) -> Vec<Found> {
    let base = &outcome.chosen;
    let sketched = |point: Point, candidate: usize| -> Option<(f64, Found)> {
        let start = started(problem, point, candidate, &outcome.orders)?;
        let train = &problem.split.train;
        let mut running = Running::begin(problem, start, train, &outcome.orders, false).ok()?;
        running.advance(SKETCHED_IN).ok()?;
        let found = running.finish();
        let orders = Noise::orders(&found.residual, train, &problem.floor);
        // Blocks that choose may pass other places, where nothing is known of a curve so far.
        let value = |fit: &Fit| criterion_at(problem, fit, &orders, train);
        let gain = value(base) - value(&found);
        (gain > 0.0).then(|| Some((gain, found.point.effects.last()?.clone())))?
    };
    let best = |candidate: usize| {
        let points = [
            Some(base.point.clone()),
            in_place(problem, &base.point, candidate),
        ];
        let found = points.into_iter().flatten();
        let found = found.filter_map(|point| sketched(point, candidate));
        found.max_by(|a, b| a.0.total_cmp(&b.0))
    };
    let mut found: Vec<(f64, Found)> = wanted.into_par_iter().filter_map(best).collect();
    found.sort_by(|a, b| b.0.total_cmp(&a.0));
    found.truncate(FITTED);
    found.into_iter().map(|(_, found)| found).collect()
}

/// The causes that are not on the joint of a curve, if any is.
fn in_place(problem: &Problem, point: &Point, curve: usize) -> Option<Point> {
    let target = &problem.candidates[curve].target;
    let mut rest = point.clone();
    (rest.effects).retain(|own| problem.candidates[own.candidate].target != *target);
    (rest.effects.len() < point.effects.len()).then_some(rest)
}

/// A point with one more curve, the same everywhere: a friction as large as explains most, since
/// about none at all it is not linear in its values.
fn started(problem: &Problem, point: Point, candidate: usize, orders: &[usize]) -> Option<Point> {
    let at = |level: f64| {
        let mut curve = problem.neutral(candidate);
        curve
            .values
            .fill(level * problem.candidates[candidate].scale[0]);
        let mut with = point.clone();
        with.effects.push(curve);
        with
    };
    if problem.candidates[candidate].kind == EffectKind::JointPositionCurve {
        return Some(at(0.0));
    }
    let left = |point: &Point| {
        let predicted = problem.predict(point).ok()?;
        let residual = problem.data.residual(&predicted);
        let white = vec![0; orders.len()];
        Some(objective(problem, &residual, &problem.split.train, &white))
    };
    // A friction that may be taken away may have become less.
    let falls = problem.infos(candidate)[0].min < 0.0;
    let levels = LEVELS.iter().flat_map(|level| match falls {
        true => vec![*level, -level],
        false => vec![*level],
    });
    let tried = levels.map(at);
    let tried = tried.filter_map(|point| Some((left(&point)?, point)));
    tried
        .min_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, point)| point)
}

/// A curve that earns its place.
struct Earned {
    /// To the development part.
    fit: Fit,
    /// How much likelier it makes the data, all its values integrated out, in minus twice the
    /// logarithm.
    gain: f64,
    /// Whether blocks that choose bear it out; else they say nothing of it.
    is_borne_out: bool,
}

/// A fit with a curve to the blocks for fitting, if that earns its place beside or instead of the
/// causes `chosen`; `last` are these, fitted to the development part. It must be above the `bar`.
fn earned(
    problem: &Problem,
    [chosen, last]: [&Fit; 2],
    bar: Bar,
    (found, orders): (Fit, Vec<usize>),
) -> Option<Earned> {
    let split = &problem.split;
    let parts = [&split.train, &split.validation];
    let on_validation = borne_out(problem, &chosen.residual, &found, parts).ok()?;
    if on_validation == Some(false) {
        return None;
    }
    // A short record passes other places in the blocks that choose than in those that were fitted,
    // where a curve is what its neighbours are: how much it matters is a matter of both.
    let both = &split.development;
    let ended = fit(problem, found.point, both, &orders, true).ok()?;
    let gain = criterion(problem, last, &orders) - criterion(problem, &ended, &orders);
    let on_both = compare(&last.residual, &ended.residual, &ended.noise, both);
    let is_likely = gain > bar.gain
        && on_both.practical >= problem.options.min_gain
        && stands_out(problem, gain, bar.scale, [&last.residual, &ended.residual]);
    is_likely.then(|| Earned {
        is_borne_out: on_validation == Some(true),
        fit: ended,
        gain,
    })
}

/// Fits of these curves beside the causes, and in place of those on the same joint: those that earn
/// their place, likeliest first.
fn earning(
    problem: &Problem,
    outcome: &Outcome,
    (last, bar): (&Fit, Bar),
    wanted: Vec<Found>,
) -> Vec<Earned> {
    let chosen = &outcome.chosen;
    let starts: Vec<Point> = (wanted.into_iter())
        .flat_map(|curve| {
            let mut beside = chosen.point.clone();
            let instead = in_place(problem, &chosen.point, curve.candidate)
                .and_then(|rest| started(problem, rest, curve.candidate, &outcome.orders));
            beside.effects.push(curve);
            [Some(beside), instead]
        })
        .flatten()
        .collect();
    let train = &problem.split.train;
    let fitted = |start: Point| {
        let first = fit(problem, start, train, &outcome.orders, false).ok()?;
        earned(problem, [chosen, last], bar, settled(problem, first).ok()?)
    };
    let mut found: Vec<Earned> = starts.into_par_iter().filter_map(fitted).collect();
    found.sort_by(|a, b| b.gain.total_cmp(&a.gain));
    // Twice as many values where the likeliest has too few.
    let finer = found.first().and_then(|best| {
        let finer = fitted(finer(problem, &best.fit.point)?)?;
        (finer.gain > best.gain + OVERWHELMING).then_some(finer)
    });
    if let Some(finer) = finer {
        found.insert(0, finer);
    }
    found
}

/// The same curve with more values; `None` for one that has enough.
fn finer(problem: &Problem, point: &Point) -> Option<Point> {
    let (_, curve) = problem.curve(point)?;
    let next = PLACES.iter().find(|places| **places > curve.values.len())?;
    if curve.smoothing > BENDS_MUCH {
        return None;
    }
    let own = &problem.candidates[curve.candidate];
    let candidate = problem.curves().find(|&one| {
        let other = &problem.candidates[one];
        other.kind == own.kind && other.target == own.target && problem.infos(one).len() == *next
    })?;
    let effect = problem.effect(curve);
    let (from, to) = (effect.values[0], effect.values[1]);
    let places = problem.infos(candidate).iter().enumerate();
    let values = places.map(|(i, info)| {
        let x = from + (to - from) * i as f64 / (next - 1) as f64;
        at(&effect, x).max(info.min)
    });
    let mut finer = point.clone();
    *finer.effects.last_mut()? = Found {
        candidate,
        values: values.collect(),
        smoothing: curve.smoothing,
    };
    Some(finer)
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
    let least = problem.infos(found.candidate)[0].min;
    let value: Vec<f64> = x.iter().map(|x| at(&effect, *x).max(least)).collect();
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
            .map(|(x, value)| Some((value + sign * Z95 * error(*x)?).max(least)))
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

#[cfg(test)]
mod tests;
