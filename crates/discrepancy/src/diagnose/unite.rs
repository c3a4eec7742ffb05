//! One effect for two.

use super::DiagnoseError;
use super::choice::criterion;
use super::fit::{Fit, fit};
use super::problem::{Point, Problem};
use super::search::{Outcome, Search, settled};

/// What one effect may fall short of two, as minus twice a log-likelihood: where both say the same,
/// their fits end within less.
const AS_WELL: f64 = 1.0;

impl Search<'_, '_> {
    /// Takes one effect in place of two, one of which it holds as a limit, where it does as well
    /// with no more numbers: dry friction beside a constant force is dry friction that differs
    /// between the directions.
    pub(super) fn unite(&mut self, outcome: &mut Outcome) -> Result<(), DiagnoseError> {
        let problem = self.problem;
        let value = |fit: &Fit| criterion(problem, fit, &outcome.orders);
        let here = value(&outcome.chosen) + AS_WELL;
        let united = (unions(problem, &outcome.chosen.point).into_iter())
            .filter_map(|point| {
                let rows = &problem.split.train;
                fit(problem, point, rows, &outcome.orders, true).ok()
            })
            .filter(|one| one.converged && value(one) <= here)
            .min_by(|a, b| value(a).total_cmp(&value(b)));
        let Some(united) = united else {
            return Ok(());
        };
        (outcome.chosen, outcome.orders) = settled(problem, united)?;
        if outcome.chosen.point.effects.len() == 1 {
            outcome.rivals.clone_from(&outcome.singles);
        } else {
            self.replace(outcome)?;
        }
        Ok(())
    }
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
