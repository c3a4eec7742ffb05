//! One effect for two.

use super::choice::criterion;
use super::fit::{Fit, fit};
use super::problem::{Point, Problem};
use super::search::Outcome;

/// What one effect may fall short of two, as minus twice a log-likelihood: where both say the same,
/// their fits end within less.
pub(super) const AS_WELL: f64 = 1.0;

/// Models with one effect in place of two, one of which it holds as a limit, that do as well with
/// no more numbers: dry friction beside a constant force is dry friction that differs between the
/// directions. None for more causes than are looked for one after the other.
pub(super) fn united(problem: &Problem, outcome: &Outcome) -> Vec<Fit> {
    let point = &outcome.chosen.point;
    if point.effects.len() > problem.options.max_effects {
        return Vec::new();
    }
    let value = |fit: &Fit| criterion(problem, fit, &outcome.orders);
    let here = value(&outcome.chosen) + AS_WELL;
    let fits = unions(problem, point).into_iter().filter_map(|point| {
        let rows = &problem.split.train;
        fit(problem, point, rows, &outcome.orders, true).ok()
    });
    fits.filter(|one| one.converged && value(one) <= here)
        .collect()
}

/// The point with one effect for two of it.
fn unions(problem: &Problem, point: &Point) -> Vec<Point> {
    let kind = |candidate: usize| problem.candidates[candidate].kind;
    let target = |candidate: usize| &problem.candidates[candidate].target;
    let numbers = |candidate: usize| problem.infos(candidate).len();
    let held = point.candidates();
    let mut found = Vec::new();
    for &limit in &held {
        let larger = (0..problem.candidates.len()).filter(|&one| {
            kind(one).generalises(kind(limit)) && target(one) == target(limit) && !point.holds(one)
        });
        for one in larger {
            let others = held.iter().filter(|&&other| other != limit);
            for &other in others {
                if numbers(one) <= numbers(limit) + numbers(other) {
                    let mut united = point.clone();
                    (united.effects).retain(|own| ![limit, other].contains(&own.candidate));
                    united.effects.push(problem.neutral(one));
                    found.push(united);
                }
            }
        }
    }
    found
}
