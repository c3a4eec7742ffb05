//! Delays of what measures the drive forces of an arm, beside the causes found or by
//! themselves: of each channel its own, or one of all where they agree.
//!
//! A delay by itself looks like friction, and friction like a delay: a torque that lags is one that
//! goes with the velocity. So both are fitted at once, to all channels.

use rayon::prelude::*;
use truecut_scenario::effect::Target;

use super::DiagnoseError;
use super::choice::{LEAST_T, criterion};
use super::fit::{Fit, fit};
use super::problem::{Found, Point, Problem};
use super::search::{DECISIVE, Outcome, Search, settled};
use super::together::thinned;
use crate::stats::mean;

/// Delays that differ from their mean by less than this part of the interval of the samples are
/// one: when a friction changes its sign is known to a sample.
const ALIKE: f64 = 0.5;

impl Search<'_, '_> {
    /// Takes the delays that stand out beside the causes found, if any, and all that adds up, if
    /// the model is clearly better for them; whether it is.
    pub(super) fn delays(&mut self, outcome: &mut Outcome) -> Result<bool, DiagnoseError> {
        let problem = self.problem;
        let train = &problem.split.train;
        let own: Vec<usize> = (problem.late.iter().copied())
            .filter(|&one| problem.candidates[one].target != Target::Whole)
            .collect();
        if own.is_empty() {
            return Ok(false);
        }
        let mut start = outcome.chosen.point.clone();
        let others = problem.model.additive().into_iter().chain(own);
        let absent: Vec<Found> = others
            .filter(|&one| !start.holds(one))
            .map(|one| problem.neutral(one))
            .collect();
        start.effects.extend(absent);
        let tests = outcome.tests.max(start.effects.len());
        let Ok(all) = fit(problem, start, train, &outcome.orders, true) else {
            return Ok(false);
        };
        let (all, orders) = settled(problem, all)?;
        let Some(point) = thinned(problem, &all, tests).filter(|one| is_late(problem, one)) else {
            return Ok(false);
        };
        let (mut found, mut orders) = settled(problem, fit(problem, point, train, &orders, true)?)?;
        // Far from no delay, where the fit ends, what stood out by a straight line may do nothing.
        if let Some(point) = thinned(problem, &found, tests)
            && point.effects.len() < found.point.effects.len()
        {
            (found, orders) = settled(problem, fit(problem, point, train, &orders, true)?)?;
        }
        if !is_late(problem, &found.point) {
            return Ok(false);
        }
        let (found, orders) = self.common(found, orders)?;
        let paired = self.paired(&outcome.chosen, &found);
        let better = criterion(problem, &found, &orders) + DECISIVE
            < criterion(problem, &outcome.chosen, &orders);
        if better && paired.t() > LEAST_T && paired.practical >= problem.options.min_gain {
            outcome.rivals = beside(problem, &outcome.rivals, &found, &orders);
            (outcome.chosen, outcome.orders) = (found, orders);
            return Ok(true);
        }
        Ok(false)
    }

    /// One delay of all that is measured in place of those of each channel, where these agree as
    /// nearly as samples tell, or where it does as well for its number of parameters; alone, or
    /// beside those of the few channels that have more or less of it.
    fn common(&self, found: Fit, orders: Vec<usize>) -> Result<(Fit, Vec<usize>), DiagnoseError> {
        let problem = self.problem;
        let mut late = problem.late.iter().copied();
        let clock = late.find(|&one| problem.candidates[one].target == Target::Whole);
        let delays: Vec<Found> = (of_delays(problem, &found.point).into_iter())
            .cloned()
            .collect();
        let Some(clock) = clock.filter(|_| delays.len() > 1) else {
            return Ok((found, orders));
        };
        let mut values: Vec<f64> = delays.iter().map(|delay| delay.values[0]).collect();
        let room_s = ALIKE * problem.candidates[clock].scale[0];
        let all = delays.len() + 1 == problem.late.len();
        let with = |common_s: f64, others: Vec<Found>| {
            let mut one = problem.neutral(clock);
            one.values[0] = common_s;
            let mut point = found.point.clone();
            (point.effects).retain(|own| !problem.late.contains(&own.candidate));
            point.effects.push(one);
            point.effects.extend(others);
            point
        };
        let common_s = mean(&values);
        let agree = all && values.iter().all(|one| (one - common_s).abs() < room_s);
        let mut points = vec![with(common_s, Vec::new())];
        values.sort_by(f64::total_cmp);
        let median_s = values[values.len() / 2];
        let mut others = delays.clone();
        others.retain(|one| (one.values[0] - median_s).abs() >= room_s);
        // Two channels with a delay each say nothing of both.
        if all && !others.is_empty() && others.len() + 1 < delays.len() {
            (others.iter_mut()).for_each(|one| one.values[0] -= median_s);
            points.push(with(median_s, others));
        }
        let train = &problem.split.train;
        let value = |fit: &Fit| criterion(problem, fit, &orders);
        let (mut best, mut own) = (found.clone(), orders.clone());
        for (i, point) in points.into_iter().enumerate() {
            let end = settled(problem, fit(problem, point, train, &orders, true)?)?;
            if value(&end.0) < value(&best) || agree && i == 0 {
                (best, own) = end;
            }
        }
        Ok((best, own))
    }
}

fn of_delays<'a>(problem: &Problem, point: &'a Point) -> Vec<&'a Found> {
    let effects = point.effects.iter();
    effects
        .filter(|one| problem.late.contains(&one.candidate))
        .collect()
}

fn is_late(problem: &Problem, point: &Point) -> bool {
    !of_delays(problem, point).is_empty()
}

/// Other models with the same delays.
fn beside(problem: &Problem, rivals: &[Fit], found: &Fit, orders: &[usize]) -> Vec<Fit> {
    let delays = of_delays(problem, &found.point);
    let fits = rivals.par_iter().filter_map(|rival| {
        let mut point = rival.point.clone();
        point
            .effects
            .extend(delays.iter().map(|one| (*one).clone()));
        let end = fit(problem, point, &problem.split.train, orders, true).ok()?;
        (end.converged && end.point.effects.len() == found.point.effects.len()).then_some(end)
    });
    fits.collect()
}
