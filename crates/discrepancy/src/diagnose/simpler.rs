//! What a law holds as a limit, in its place.

use super::DiagnoseError;
use super::choice::{criterion, stands_out_of_special};
use super::fit::Fit;
use super::problem::{Found, Point, Problem};
use super::race::Race;
use super::search::{Outcome, Search, settled};
use super::unite::AS_WELL;

impl Search<'_, '_> {
    /// Takes the simpler law for each effect that does not stand out of it beside all others: what
    /// spoke for the larger one when it was added may have gone to those added since. Of more
    /// causes than are looked for one after the other, where effects that add up are the rule, and
    /// of a joint with several frictions, two of these for one that says the same, too: viscous and
    /// dry friction and an offset are what such a joint is told to have.
    pub(super) fn simplify(&mut self, outcome: &mut Outcome) -> Result<(), DiagnoseError> {
        let problem = self.problem;
        loop {
            let orders = outcome.orders.clone();
            let value = |end: &Fit| criterion(problem, end, &orders);
            let here = value(&outcome.chosen);
            let special = simpler(problem, &outcome.chosen.point);
            let mut found = self.fit_all(special, &orders, Race::None(None));
            found.retain(|end| {
                value(end) < here && !stands_out_of_special(problem, end, &outcome.chosen)
            });
            if found.is_empty() {
                let two = divided(problem, &outcome.chosen.point);
                found = self.fit_all(two, &orders, Race::None(None));
                found.retain(|end| value(end) <= here + AS_WELL);
            }
            let best = (found.into_iter()).min_by(|a, b| value(a).total_cmp(&value(b)));
            let Some(best) = best else { return Ok(()) };
            (outcome.chosen, outcome.orders) = settled(problem, best)?;
        }
    }
}

/// The points with one effect less general.
fn simpler(problem: &Problem, point: &Point) -> Vec<Point> {
    let with = |at: usize| {
        let specials = specials(problem, point, at).into_iter();
        specials.map(move |one| in_place(point, at, vec![problem.neutral(one)]))
    };
    (0..point.effects.len()).flat_map(with).collect()
}

/// The points with two effects that add up in place of one that holds one of them as a limit and
/// has no fewer numbers.
fn divided(problem: &Problem, point: &Point) -> Vec<Point> {
    let additive = problem.model.additive();
    let target = |candidate: usize| &problem.candidates[candidate].target;
    let numbers = |candidate: usize| problem.infos(candidate).len();
    let adds_up = |candidate: usize| {
        let kind = problem.candidates[candidate].kind;
        let is_limit = |&one: &usize| kind.generalises(problem.candidates[one].kind);
        additive.contains(&candidate) || additive.iter().any(is_limit)
    };
    let many = point.effects.len() > problem.options.max_effects;
    let mut found = Vec::new();
    for at in 0..point.effects.len() {
        let general = point.effects[at].candidate;
        let mut beside = point.candidates().into_iter().filter(|&one| one != general);
        if !many && !beside.any(|one| target(one) == target(general) && adds_up(one)) {
            continue;
        }
        let specials = specials(problem, point, at).into_iter();
        for special in specials.filter(|one| additive.contains(one)) {
            let others = additive.iter().copied().filter(|&other| {
                other != special
                    && !point.holds(other)
                    && target(other) == target(general)
                    && numbers(special) + numbers(other) <= numbers(general)
            });
            for other in others {
                let both = [special, other].map(|one| problem.neutral(one));
                found.push(in_place(point, at, both.to_vec()));
            }
        }
    }
    found
}

/// What an effect of the point holds as a limit, and the point does not have beside it.
fn specials(problem: &Problem, point: &Point, at: usize) -> Vec<usize> {
    let general = &problem.candidates[point.effects[at].candidate];
    let is_special = |&one: &usize| {
        let candidate = &problem.candidates[one];
        general.kind.generalises(candidate.kind)
            && general.target == candidate.target
            && !point.holds(one)
    };
    problem.searched().filter(is_special).collect()
}

fn in_place(point: &Point, at: usize, of_one: Vec<Found>) -> Point {
    let mut point = point.clone();
    point.effects.splice(at..=at, of_one);
    point
}
