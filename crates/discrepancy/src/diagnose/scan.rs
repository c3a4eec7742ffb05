//! Shapes searched anew at the sizes that were fitted: what is not linear in its size looks
//! different there, and a fit may have ended at another optimum of its shape.

use rayon::prelude::*;

use super::fit::Fit;
use super::noise::fit_linear;
use super::problem::{Point, Problem};
use super::race::Race;
use super::screen::nuisance;
use super::search::Search;

/// A shape with so many starts has optima between which a fit does not find its way.
const MANY_STARTS: usize = 16;
/// Of the best fit's gain, what a fit must have for its shape to be searched anew.
const NEAR_THE_BEST: f64 = 0.8;
/// Optima from which fits are started.
const FROM: usize = 2;

impl Search<'_, '_> {
    /// Fits of a last effect whose shape has many optima, from the best shapes at the sizes where
    /// its best fit ended.
    pub(super) fn scanned(&mut self, base: &Fit, trials: &[Fit], orders: &[usize]) -> Vec<Fit> {
        let problem = self.problem;
        let (of_one, most) = with_one_more(base, trials);
        let gain = |trial: &Fit| base.objective - trial.objective;
        let mut found = Vec::new();
        for candidate in problem.searched() {
            let Some(shape) = many_shaped(problem, candidate) else {
                continue;
            };
            let own = (of_one.iter().copied())
                .filter(|trial| last_candidate(&trial.point) == Some(candidate));
            let own: Vec<&Fit> = own.collect();
            let best = (own.iter().copied()).min_by(|a, b| a.objective.total_cmp(&b.objective));
            let Some(best) = best.filter(|best| gain(best) > NEAR_THE_BEST * most) else {
                continue;
            };
            let starts = self.optima(base, best, shape, &own, orders);
            found.extend(self.fit_all(starts, orders, Race::ToBeat(best.objective)));
        }
        found
    }

    /// The fit with other values of the shape in its last effect, at which it has the best optima
    /// and no fit has ended.
    fn optima(
        &self,
        base: &Fit,
        best: &Fit,
        shape: usize,
        ended: &[&Fit],
        orders: &[usize],
    ) -> Vec<Point> {
        let problem = self.problem;
        let candidate = last_candidate(&best.point).expect("it has an effect");
        let grid = problem.infos(candidate)[shape].starts;
        if problem.left() < grid.len() {
            return Vec::new();
        }
        let (columns, priors) = nuisance(problem, base);
        let at = |value: f64| {
            let mut point = best.point.clone();
            let last = point.effects.last_mut().expect("it has an effect");
            last.values[shape] = value;
            point
        };
        let objective = |value: &f64| -> f64 {
            let Ok(predicted) = problem.predict(&at(*value)) else {
                return f64::INFINITY;
            };
            let residual = problem.data.residual(&predicted);
            let rows = &problem.split.train;
            let floor = &problem.floor;
            fit_linear(
                &residual,
                &columns,
                &priors,
                rows,
                &best.noise,
                orders,
                floor,
            )
            .objective
        };
        let profile: Vec<f64> = grid.par_iter().map(objective).collect();
        let is_lowest = |i: &usize| {
            let beside = [i.checked_sub(1), Some(i + 1)].into_iter().flatten();
            profile[*i].is_finite()
                && beside
                    .filter_map(|j| profile.get(j))
                    .all(|x| *x >= profile[*i])
        };
        // Where a fit has ended between the neighbours of a value it was found already.
        let is_new = |i: &usize| {
            let low = if *i == 0 { 0.0 } else { grid[i - 1] };
            let high = grid.get(i + 1).copied().unwrap_or(f64::INFINITY);
            !ended.iter().any(|fit| {
                let value = fit.point.effects.last().map(|last| last.values[shape]);
                value.is_some_and(|value| low < value && value < high)
            })
        };
        let mut optima: Vec<usize> = (0..grid.len()).filter(is_lowest).filter(is_new).collect();
        optima.sort_by(|a, b| profile[*a].total_cmp(&profile[*b]));
        optima.truncate(FROM);
        optima.into_iter().map(|i| at(grid[i])).collect()
    }
}

/// Fits of one effect more than a model, and the most that one of them gains on it.
pub(super) fn with_one_more<'a>(base: &Fit, trials: &'a [Fit]) -> (Vec<&'a Fit>, f64) {
    let count = base.point.effects.len() + 1;
    let fits = trials.iter().filter(|fit| fit.point.effects.len() == count);
    let gains = fits.clone().map(|fit| base.objective - fit.objective);
    let most = gains.fold(0.0, f64::max);
    (fits.collect(), most)
}

/// The parameter of a candidate that is a shape with many starts.
fn many_shaped(problem: &Problem, candidate: usize) -> Option<usize> {
    let mut infos = problem.infos(candidate).iter();
    infos.position(|info| !info.is_size && info.starts.len() >= MANY_STARTS)
}

fn last_candidate(point: &Point) -> Option<usize> {
    point.effects.last().map(|last| last.candidate)
}
