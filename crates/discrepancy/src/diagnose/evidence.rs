//! Causes with intervals and evidence; detectable sizes.

use rayon::prelude::*;

use truecut_scenario::si_symbol;

use super::DiagnoseError;
use super::ambiguity::Rival;
use super::answer::{
    Alternative, Cause, Evidence, Nominal, Parameter, SmallestSeen, key_and_unit, target_name,
};
use super::choice::{LEAST_T, weight};
use super::data::Rows;
use super::fit::{Fit, fit};
use super::memory::{LEAST_MEAN_DISTANCE, distance};
use super::noise::{add_columns, dot};
use super::problem::{Found, Problem};
use super::screen::{Ranked, critical, nuisance, projected};
use super::search::Outcome;
use super::starts::without;
use super::uncertainty::standard_errors;
use super::validate::{compare, gain_in_size, rms};
use crate::model::Columns;

/// Normal quantile of a two-sided 95 % interval.
const Z95: f64 = 1.959_964;
/// Normal quantile of a one-sided 95 % probability.
const Z95_ONE_SIDED: f64 = 1.644_854;
/// Largest detectable size, in typical sizes, for an effect to count as within reach.
const REACH: f64 = 3.0;
/// Those that have a name.
pub(super) fn causes(
    problem: &Problem,
    fit: &Fit,
    errors: &[Option<f64>],
) -> Result<Vec<Cause>, DiagnoseError> {
    let mut position = problem.nominal.len();
    let mut causes = Vec::new();
    for (i, found) in fit.point.effects.iter().enumerate() {
        let own = &errors[position..position + found.values.len()];
        position += found.values.len();
        if problem.curves().contains(&found.candidate) {
            continue;
        }
        let evidence = evidence(problem, fit, i)?;
        causes.push(cause(problem, found, own, evidence));
    }
    Ok(causes)
}

fn cause(problem: &Problem, found: &Found, errors: &[Option<f64>], evidence: Evidence) -> Cause {
    let candidate = &problem.candidates[found.candidate];
    let infos = problem.infos(found.candidate);
    let parameters = found
        .values
        .iter()
        .zip(errors)
        .enumerate()
        .map(|(i, (value, error))| {
            let (key, unit) = key_and_unit(problem, found.candidate, i);
            let parameter = Parameter {
                value: *value,
                low: error.map(|e| (value - Z95 * e).max(infos[i].min)),
                high: error.map(|e| (value + Z95 * e).min(infos[i].max)),
                unit,
            };
            (key, parameter)
        });
    Cause {
        kind: candidate.kind.name().into(),
        target: target_name(candidate),
        parameters: parameters.collect(),
        evidence,
    }
}

/// Loss without one of the effects, the others refitted.
fn evidence(problem: &Problem, full: &Fit, index: usize) -> Result<Evidence, DiagnoseError> {
    let (rows, orders) = (&problem.split.development, full.noise.own_orders());
    let small = fit(problem, without(&full.point, index), rows, &orders, false)?;
    let paired = compare(
        &small.residual,
        &full.residual,
        &full.noise,
        &problem.split.validation,
    );
    let likelihood_gain =
        small.objective - full.objective + gain_in_size(problem, &small, full, rows);
    let price = (weight(problem, full) - weight(problem, &small)) * (rows.len() as f64).ln();
    Ok(Evidence {
        likelihood_gain,
        log10_odds: 0.5 * (likelihood_gain - price) / std::f64::consts::LN_10,
        validation_t: paired.t(),
        practical_gain: paired.practical,
    })
}

pub(super) fn nominal(problem: &Problem, fit: &Fit, errors: &[Option<f64>]) -> Vec<Nominal> {
    let rows = problem.nominal.iter().zip(&fit.point.nominal).zip(errors);
    rows.map(|((parameter, value), error)| Nominal {
        key: parameter.key.clone(),
        before: parameter.value,
        after: Parameter {
            value: *value,
            low: error.map(|e| value - Z95 * e),
            high: error.map(|e| value + Z95 * e),
            unit: si_symbol(&parameter.key),
        },
    })
    .collect()
}

/// The rival is fitted to the rows that the model chosen is told for, in noise of the same orders:
/// what its causes gain is the difference of two likelihoods of the same data.
pub(super) fn alternative(
    problem: &Problem,
    rival: &Rival,
    orders: &[usize],
) -> Result<Alternative, DiagnoseError> {
    let rows = &problem.split.development;
    let whole = fit(problem, rival.fit.point.clone(), rows, orders, true)?;
    let errors = standard_errors(problem, &whole, rows)?;
    Ok(Alternative {
        causes: causes(problem, &whole, &errors)?,
        angle_deg: rival.angle_deg,
        behind_t: rival.behind_t,
        criterion_difference: rival.criterion_difference,
    })
}

/// For each size of each candidate: what would have been detected, and would have been worth
/// naming, with 95 % probability.
pub(super) fn smallest_seen(problem: &Problem, outcome: &Outcome) -> Vec<SmallestSeen> {
    let (fit, split) = (&outcome.chosen, &problem.split);
    let (columns, priors) = nuisance(problem, fit);
    let whitened = |rows| columns.iter().map(|x| fit.noise.whiten(x, rows)).collect();
    let [by_train, by_validation]: [Vec<_>; 2] = [&split.train, &split.validation].map(whitened);
    let norm = |change: &Columns, rows: &Rows, nuisance: &[Vec<f64>]| {
        let left = projected(&fit.noise.whiten(change, rows), nuisance, &priors);
        dot(&left, &left).sqrt()
    };
    let level = rms(&fit.residual, &split.train);
    // A gain of `norm^2` on the validation blocks has the standard error `2 norm`.
    let validation = 2.0 * (LEAST_T + Z95_ONE_SIDED);
    let practical = ((1.0 + problem.options.min_gain).powi(2) - 1.0).sqrt();
    let of_one = |Ranked { signature, .. }: &Ranked| -> Vec<SmallestSeen> {
        let infos = problem.infos(signature.candidate);
        let alpha = problem.options.family_wise_error;
        let detection = critical(alpha, outcome.tests, infos.len()).sqrt() + Z95_ONE_SIDED;
        let sizes = signature.sizes.iter().zip(&signature.columns);
        let of_size = |(&size, change): (&usize, &Columns)| {
            let info = &infos[size];
            let secant = (signature.values[size] - info.neutral).abs();
            let seen = rms(change, &split.train)
                .iter()
                .zip(&level)
                .map(|(a, b)| a / b)
                .fold(0.0, f64::max);
            let mut moved = fit.residual.clone();
            add_columns(&mut moved, change, 1.0);
            let factors = [
                detection / norm(change, &split.train, &by_train),
                validation / norm(change, &split.validation, &by_validation),
                (LEAST_MEAN_DISTANCE + Z95_ONE_SIDED) / distance(problem, &moved, &fit.residual),
                practical / seen,
            ];
            let needed = secant * factors.into_iter().fold(0.0, f64::max);
            let room = (info.max - info.neutral).max(info.neutral - info.min);
            let (parameter, unit) = key_and_unit(problem, signature.candidate, size);
            SmallestSeen {
                kind: problem.candidates[signature.candidate].kind.name().into(),
                target: target_name(&problem.candidates[signature.candidate]),
                parameter,
                size: (needed <= room).then_some(needed),
                unit,
            }
        };
        sizes.map(of_size).collect()
    };
    let seen = outcome.ranking.par_iter().flat_map_iter(of_one);
    let mut all: Vec<SmallestSeen> = seen.collect();
    all.sort_by(|a, b| (&a.kind, &a.target, &a.parameter).cmp(&(&b.kind, &b.target, &b.parameter)));
    all
}

/// Part of the sizes that are within reach of the experiment.
pub(super) fn visible(problem: &Problem, seen: &[SmallestSeen]) -> f64 {
    if seen.is_empty() {
        return 0.0;
    }
    let hidden = invisible(problem, seen).len();
    1.0 - hidden as f64 / seen.len() as f64
}

pub(super) fn invisible(problem: &Problem, seen: &[SmallestSeen]) -> Vec<String> {
    let reach = |entry: &SmallestSeen| {
        let candidate = problem
            .candidates
            .iter()
            .position(|c| c.kind.name() == entry.kind && target_name(c) == entry.target)?;
        let infos = problem.infos(candidate);
        let index =
            (0..infos.len()).find(|&i| key_and_unit(problem, candidate, i).0 == entry.parameter)?;
        Some(REACH * problem.candidates[candidate].scale[index])
    };
    let hidden = seen.iter().filter(|e| match (e.size, reach(e)) {
        (Some(size), Some(reach)) => size > reach,
        _ => true,
    });
    hidden
        .map(|e| {
            let target = e
                .target
                .as_deref()
                .map(|t| format!(" {t}"))
                .unwrap_or_default();
            format!(
                "{}{target} (`{}`) would be seen at no typical size",
                e.kind, e.parameter
            )
        })
        .collect()
}
