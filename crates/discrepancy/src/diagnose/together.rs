//! Effects that add up, all at once: where every joint has friction, each hides the others from a
//! search that adds one after another.

use nalgebra::{DMatrix, DVector};

use super::DiagnoseError;
use super::choice::{LEAST_T, criterion};
use super::fit::{Fit, fit};
use super::memory::stands_out;
use super::noise::{add_columns, dot};
use super::problem::{Point, Problem};
use super::screen::critical;
use super::search::{DECISIVE, Outcome, Search, settled};
use crate::model::Columns;

impl Search<'_, '_> {
    /// Fits all effects that add up, takes away what the data do not ask for, and takes what is
    /// left if it is clearly better than the model chosen. Whether it was.
    pub(super) fn together(&mut self, outcome: &mut Outcome) -> Result<bool, DiagnoseError> {
        let problem = self.problem;
        let mut start = outcome.base.point.clone();
        let additive = problem.model.additive();
        start
            .effects
            .extend(additive.into_iter().map(|one| problem.neutral(one)));
        if start.effects.len() < 2 {
            return Ok(false);
        }
        let train = &problem.split.train;
        let tests = outcome.tests.max(start.effects.len());
        let Ok(all) = fit(problem, start, train, &outcome.orders, false) else {
            return Ok(false);
        };
        let (all, orders) = settled(problem, all)?;
        let Some(point) = thinned(problem, &all, tests) else {
            return Ok(false);
        };
        let (found, orders) = settled(problem, fit(problem, point, train, &orders, true)?)?;
        let paired = self.paired(&outcome.chosen, &found);
        let better = criterion(problem, &found, &orders) + DECISIVE
            < criterion(problem, &outcome.chosen, &orders);
        if !better || paired.t() <= LEAST_T || paired.practical < problem.options.min_gain {
            return Ok(false);
        }
        (outcome.chosen, outcome.orders) = (found, orders);
        outcome.rivals.clear();
        outcome.pairs.clear();
        Ok(true)
    }

    /// Takes away effects that the data no longer ask for beside those added since.
    pub(super) fn thin(&self, outcome: &mut Outcome) -> Result<(), DiagnoseError> {
        let problem = self.problem;
        let before = outcome.chosen.point.effects.len();
        match thinned(problem, &outcome.chosen, outcome.tests) {
            Some(point) if point.effects.len() < before => {
                let train = &problem.split.train;
                let small = fit(problem, point, train, &outcome.orders, true)?;
                (outcome.chosen, outcome.orders) = settled(problem, small)?;
            }
            _ => {}
        }
        Ok(())
    }
}

/// The point without effects that do not stand out beside the others, the weakest first; the rest
/// moves along, linearly. `None` where no effect is left.
pub(super) fn thinned(problem: &Problem, fit: &Fit, tests: usize) -> Option<Point> {
    let mut local = Local::new(problem, fit)?;
    loop {
        let mut gains: Vec<(f64, usize)> = (0..local.effects.len())
            .filter(|&i| local.effects[i].is_some())
            .map(|i| (local.gain(i), i))
            .collect();
        gains.sort_by(|a, b| a.0.total_cmp(&b.0));
        if gains.is_empty() {
            return None;
        }
        let idle = gains.iter().find(|(gain, i)| {
            let sizes = local.effects[*i].as_ref().map_or(0, Vec::len);
            let bar = critical(problem.options.family_wise_error, tests, sizes);
            let without = || local.residual_without(*i);
            *gain < bar || !stands_out(problem, *gain, 1.0, [&without(), &local.residual])
        });
        let Some((_, idle)) = idle else { break };
        local.remove(*idle);
    }
    Some(local.point(problem, fit))
}

/// What it takes to do without an effect.
struct WayToNothing {
    /// Loss of minus twice the log-likelihood.
    gain: f64,
    /// How far the variables move.
    change: DVector<f64>,
    /// By how much their covariance falls.
    certainty: DMatrix<f64>,
}

/// A fit and its linear model.
struct Local<'a> {
    jacobian: &'a [Columns],
    /// Inverse of the normal matrix, of the variables that are left.
    covariance: DMatrix<f64>,
    values: DVector<f64>,
    residual: Columns,
    /// Of each effect that is left: its sizes among the variables, and their distance from doing
    /// nothing.
    effects: Vec<Option<Vec<(usize, f64)>>>,
}

impl<'a> Local<'a> {
    fn new(problem: &Problem, fit: &'a Fit) -> Option<Local<'a>> {
        let variables = problem.variables(&fit.point);
        let rows = &problem.split.train;
        let whitened: Vec<Vec<f64>> = (fit.jacobian.iter())
            .map(|column| fit.noise.whiten(column, rows))
            .collect();
        let count = variables.len();
        if whitened.len() != count {
            return None;
        }
        let scale: Vec<f64> = (whitened.iter().zip(&variables))
            .map(|(x, v)| 1.0 / dot(x, x).sqrt().hypot(v.prior.precision).max(1e-150))
            .collect();
        let unit = DMatrix::from_fn(count, count, |i, j| {
            let own = (variables[i].prior.precision * scale[i]).powi(2) + 1e-9;
            let product = dot(&whitened[i], &whitened[j]) * scale[i] * scale[j];
            product + if i == j { own } else { 0.0 }
        });
        let inverse = unit.cholesky()?.inverse();
        let mut position = problem.nominal.len();
        let effects = fit.point.effects.iter().map(|found| {
            let infos = problem.infos(found.candidate).iter().enumerate();
            let sizes = infos.filter(|(_, info)| info.is_size);
            let own = sizes.map(|(i, info)| (position + i, found.values[i] - info.neutral));
            let own = own.collect();
            position += found.values.len();
            Some(own)
        });
        Some(Local {
            effects: effects.collect(),
            jacobian: &fit.jacobian,
            covariance: DMatrix::from_fn(count, count, |i, j| {
                inverse[(i, j)] * scale[i] * scale[j]
            }),
            values: DVector::from_iterator(count, variables.iter().map(|v| v.value)),
            residual: fit.residual.clone(),
        })
    }

    /// What it takes to do without an effect. `None` where it is gone.
    fn way_to_nothing(&self, effect: usize) -> Option<WayToNothing> {
        let (own, distance): (Vec<usize>, Vec<f64>) =
            self.effects[effect].as_ref()?.iter().copied().unzip();
        let columns = self.covariance.select_columns(&own);
        let factor = columns.select_rows(&own).cholesky()?;
        let distance = DVector::from_vec(distance);
        let pull = factor.solve(&distance);
        Some(WayToNothing {
            gain: distance.dot(&pull),
            change: &columns * pull,
            certainty: &columns * factor.solve(&columns.transpose()),
        })
    }

    fn gain(&self, effect: usize) -> f64 {
        self.way_to_nothing(effect).map_or(0.0, |way| way.gain)
    }

    fn residual_without(&self, effect: usize) -> Columns {
        let mut residual = self.residual.clone();
        if let Some(way) = self.way_to_nothing(effect) {
            for (column, step) in self.jacobian.iter().zip(way.change.iter()) {
                add_columns(&mut residual, column, *step);
            }
        }
        residual
    }

    fn remove(&mut self, effect: usize) {
        if let Some(way) = self.way_to_nothing(effect) {
            self.residual = self.residual_without(effect);
            self.values -= &way.change;
            for (variable, distance) in self.effects.iter_mut().flatten().flatten() {
                *distance -= way.change[*variable];
            }
            self.covariance -= way.certainty;
        }
        self.effects[effect] = None;
    }

    fn point(&self, problem: &Problem, fit: &Fit) -> Point {
        let variables = problem.variables(&fit.point);
        let values: Vec<f64> = (self.values.iter().zip(&variables))
            .map(|(value, v)| value.clamp(v.min, v.max))
            .collect();
        let mut point = problem.with_values(&fit.point, &values);
        let mut left = self.effects.iter().map(Option::is_some);
        point.effects.retain(|_| left.next().unwrap_or(false));
        point
    }
}
