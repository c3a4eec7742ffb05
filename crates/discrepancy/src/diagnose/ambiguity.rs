//! Alternative explanations, and experiments that would distinguish the causes.

use rayon::prelude::*;

use super::Stage;
use super::answer::Proposal;
use super::choice::{criterion, weight};
use super::data::{LAGS, Rows};
use super::derivatives::difference;
use super::fit::{Fit, fit};
use super::memory::{LEAST_GENERALISATION, distance as standing_out};
use super::noise::{Noise, dot};
use super::problem::{Point, Problem};
use super::screen::angle_deg;
use super::search::{DECISIVE, Outcome};
use super::validate::compare;
use crate::model::Columns;

/// Another model with as many effects as the one chosen, or with one that says what two do.
#[derive(Debug, Clone)]
pub(super) struct Rival {
    pub fit: Fit,
    pub angle_deg: f64,
    pub behind_t: f64,
    pub criterion_difference: f64,
    /// Whether the data do not decide.
    pub as_good: bool,
}

/// Signatures closer than this, in degrees, are practically equal: their difference is no larger
/// than the model's own error, and the odds must be overwhelming.
const NEAR_DEG: f64 = 6.0;
/// Odds of 400 to 1, as a difference of minus twice the log-likelihood, or of the information
/// criterion, which charges a model for its numbers.
pub(super) const OVERWHELMING: f64 = 12.0;

/// All rivals of the model chosen among these fits and those that unite two of its effects, closest
/// first.
pub(super) fn rivals(problem: &Problem, outcome: &Outcome, fits: &[Fit]) -> Vec<Rival> {
    let chosen = &outcome.chosen;
    let here = criterion(problem, chosen, &outcome.orders);
    let size = |fit: &Fit| weight(problem, fit);
    let n = problem.split.development.len() as f64;
    let others = fits
        .iter()
        .filter(|r| r.point.effects.len() == chosen.point.effects.len())
        .chain(&outcome.united);
    let mut rivals: Vec<Rival> = others
        .filter(|r| r.point.kinds() != chosen.point.kinds())
        .map(|rival| {
            let behind = compare(
                &rival.residual,
                &chosen.residual,
                &chosen.noise,
                &problem.split.validation,
            );
            let difference = criterion(problem, rival, &outcome.orders) - here;
            let likelihood = difference - (size(rival) - size(chosen)) * n.ln();
            let angle_deg = angle(problem, outcome, rival);
            let decisive = if angle_deg < NEAR_DEG {
                OVERWHELMING
            } else {
                DECISIVE
            };
            // Numbers that only let it fit as well count as well: what a mode at any frequency with
            // any damping explains no better is no rival of a damper.
            let close = likelihood < decisive && difference < OVERWHELMING;
            // A generalisation with the same prediction is no alternative, nor is one that fits
            // worse for its parameters.
            let more = generalises(problem, &rival.point, &chosen.point)
                && (difference > 0.0
                    || standing_out(problem, &chosen.residual, &rival.residual)
                        < LEAST_GENERALISATION);
            Rival {
                angle_deg,
                behind_t: behind.t(),
                criterion_difference: difference,
                as_good: close && !more,
                fit: rival.clone(),
            }
        })
        .collect();
    rivals.sort_by(|a, b| a.criterion_difference.total_cmp(&b.criterion_difference));
    // The best end of each, whatever lies between two of them.
    let mut seen: Vec<Vec<usize>> = Vec::new();
    rivals.retain(|rival| {
        let own = rival.fit.point.kinds();
        let is_new = !seen.contains(&own);
        if is_new {
            seen.push(own);
        }
        is_new
    });
    // Generalisations are removed from the alternatives, too.
    let points: Vec<Point> = rivals
        .iter()
        .filter(|r| r.as_good)
        .map(|r| r.fit.point.clone())
        .collect();
    for rival in &mut rivals {
        let known = |point: &Point| {
            generalises(problem, &rival.fit.point, point) || is_beside(&rival.fit.point, point)
        };
        rival.as_good &= !points.iter().any(known);
    }
    rivals
}

/// Whether the points differ in one effect, and that of the first holds that of the second as a
/// limit.
fn generalises(problem: &Problem, first: &Point, second: &Point) -> bool {
    let alone = |of: &Point, other: &Point| -> Vec<usize> {
        let (of, other) = (of.kinds(), other.kinds());
        of.into_iter().filter(|k| !other.contains(k)).collect()
    };
    let (larger, smaller) = (alone(first, second), alone(second, first));
    let ([larger], [smaller]) = (larger.as_slice(), smaller.as_slice()) else {
        return false;
    };
    let (larger, smaller) = (&problem.candidates[*larger], &problem.candidates[*smaller]);
    larger.target == smaller.target && larger.kind.generalises(smaller.kind)
}

/// Whether the first has all the effects of the second, and more: which the second does not need.
fn is_beside(first: &Point, second: &Point) -> bool {
    let (more, fewer) = (first.kinds(), second.kinds());
    more.len() > fewer.len() && fewer.iter().all(|kind| more.contains(kind))
}

/// Angle between what the two models, each with nominal parameters of its own, add to the model of
/// the effects that they share, whitened. Its sine is the difference of the two predictions
/// relative to what the effects explain.
fn angle(problem: &Problem, outcome: &Outcome, rival: &Fit) -> f64 {
    let chosen = &outcome.chosen;
    let common = common(problem, outcome, rival);
    let rows = &problem.split.development;
    let signature = |fit: &Fit| {
        let change = difference(&fit.predicted, &common, 1.0);
        chosen.noise.whiten(&change, rows)
    };
    angle_deg(&signature(chosen), &signature(rival))
}

/// Prediction of the model with the effects that the chosen one and its rival share, refitted.
fn common(problem: &Problem, outcome: &Outcome, rival: &Fit) -> Columns {
    let mut shared = outcome.chosen.point.clone();
    let others = rival.point.kinds();
    shared.effects.retain(|f| others.contains(&f.candidate));
    if shared.effects.is_empty() {
        return outcome.base.predicted.clone();
    }
    let train = &problem.split.train;
    match fit(problem, shared, train, &outcome.orders, true) {
        Ok(fit) => fit.predicted,
        Err(_) => outcome.base.predicted.clone(),
    }
}

/// The experiments that separate the causes best, at most three.
pub(super) fn experiments(problem: &Problem, chosen: &Fit, rival: &Fit) -> Vec<Proposal> {
    problem.report(Stage::Experiments);
    let rows = &problem.split.development;
    let now = distance(&chosen.predicted, &rival.predicted, &chosen.noise, rows);
    let experiments = problem.model.experiments();
    let separations: Vec<Option<f64>> = experiments
        .par_iter()
        .map(|experiment| {
            let predicted = |point: &Point| {
                problem.count_prediction();
                let (model, effects) = (problem.model, problem.effects(point));
                (model.predict_experiment(experiment, &point.nominal, &effects)).ok()
            };
            let (a, b) = (predicted(&chosen.point)?, predicted(&rival.point)?);
            let rows = Rows {
                per_channel: a
                    .iter()
                    .map(|column| (LAGS..column.len()).collect())
                    .collect(),
            };
            let fits = a.len() == b.len() && a.iter().zip(&b).all(|(a, b)| a.len() == b.len());
            fits.then(|| distance(&a, &b, &chosen.noise, &rows))
                .filter(|d| d.is_finite())
        })
        .collect();
    let mut proposals: Vec<Proposal> = experiments
        .into_iter()
        .zip(separations)
        .filter_map(|(experiment, separation)| {
            Some(Proposal {
                description: experiment.description,
                overrides: experiment.overrides,
                separation: separation?,
                separation_now: now,
            })
        })
        .collect();
    proposals.sort_by(|a, b| b.separation.total_cmp(&a.separation));
    proposals.truncate(3);
    proposals
}

fn distance(a: &Columns, b: &Columns, noise: &Noise, rows: &Rows) -> f64 {
    let whitened = noise.whiten(&difference(a, b, 1.0), rows);
    dot(&whitened, &whitened).sqrt()
}
