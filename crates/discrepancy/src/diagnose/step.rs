//! One step of a fit: damped normal equations within bounds, and what a step teaches about the
//! derivatives.

use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

use super::data::Rows;
use super::derivatives::{difference, jacobian};
use super::noise::{Noise, add_columns, dot};
use super::problem::{Point, Problem, Variable};
use super::smooth::Smooth;
use crate::model::{Columns, PredictError};

const MAX_REJECTED: usize = 5;
/// Derivatives serve for another step, with Broyden's correction, if they foresaw the last one to
/// this part of it.
const FORESEEN: f64 = 0.2;
/// A variable is left where it is if the step of its finite difference, about a ten-thousandth of
/// its typical size, moves the whitened prediction by less than this: what derivatives say of it is
/// rounding, and to follow it keeps the others from converging.
const LEAST_FELT: f64 = 1e-6;
/// Relative accuracy of derivatives. Where two of them differ by less, the step that their
/// difference asks for is no reason to call a fit unfinished.
const ACCURACY: f64 = 1e-3;

pub(super) enum Step {
    Taken {
        /// The derivatives, since corrected, foresaw what it would do.
        foreseen: bool,
    },
    /// The step that is left is a small part of a standard error.
    Converged,
    /// No step lowers the error; `close` says whether the step wanted was within a standard error.
    Stuck { close: bool },
}

pub(super) struct Solver<'a, 'b> {
    pub problem: &'a Problem<'b>,
    pub rows: &'a Rows,
    pub orders: &'a [usize],
    pub point: Point,
    pub variables: Vec<Variable>,
    pub predicted: Columns,
    pub residual: Columns,
    pub damping: f64,
    /// Of the last step.
    pub decrement: f64,
    /// Whether that is within a standard error.
    pub close: bool,
    /// The price of a curve's bending.
    pub smooth: Option<Smooth>,
}

/// Rounds in which values that would fall below their bound are held there.
const BOUND_ROUNDS: usize = 10;

/// Whether a step that would lower the weighted squares by so much is within a standard error.
fn is_close(decrement: f64, squares: f64) -> bool {
    decrement < 1.0 + 1e-3 * squares
}

/// Normal equations with what damps them.
struct Normal {
    form: DMatrix<f64>,
    /// Of each diagonal, the part that is of the data and of priors. What bends no curve, a line or
    /// a level, is as free with a high price of bending as with a low one: damped in proportion to
    /// the price it would not move.
    measured: DVector<f64>,
}

/// Relative, of what is measured and of all: singular where nothing else is.
const JITTER: f64 = 1e-9;
const LEAST_JITTER: f64 = 1e-13;

impl Normal {
    fn new(form: DMatrix<f64>, smooth: Option<&Smooth>, free: &[usize]) -> Normal {
        let measured = DVector::from_fn(free.len(), |a, _| match smooth {
            None => 1.0,
            Some(smooth) => {
                let stiff = smooth.stiffness(free[a], free[a]);
                LEAST_JITTER / JITTER + (1.0 - stiff / form[(a, a)]).max(0.0)
            }
        });
        Normal { form, measured }
    }

    /// Those of some variables.
    fn part(&self, of: &[usize]) -> Normal {
        let k = of.len();
        Normal {
            form: DMatrix::from_fn(k, k, |a, b| self.form[(of[a], of[b])]),
            measured: DVector::from_fn(k, |a, _| self.measured[of[a]]),
        }
    }

    fn solve(&self, gradient: &DVector<f64>, damping: f64) -> DVector<f64> {
        let (k, form) = (gradient.len(), &self.form);
        let scale = DVector::from_fn(k, |i, _| 1.0 / form[(i, i)].sqrt().max(1e-150));
        let mut scaled = DMatrix::from_fn(k, k, |i, j| form[(i, j)] * scale[i] * scale[j]);
        for i in 0..k {
            scaled[(i, i)] += (damping + JITTER) * self.measured[i];
        }
        match scaled.cholesky() {
            Some(factor) => factor
                .solve(&gradient.component_mul(&scale))
                .component_mul(&scale),
            None => DVector::zeros(k),
        }
    }
}

impl Solver<'_, '_> {
    pub fn noise(&self, coloured: bool) -> Noise {
        let floor = &self.problem.floor;
        if coloured {
            Noise::fit(&self.residual, self.rows, self.orders, floor)
        } else {
            Noise::white(&self.residual, self.rows, floor)
        }
    }

    pub fn penalty(&self, variables: &[Variable]) -> f64 {
        let terms = variables.iter().map(|v| v.prior.precision * v.prior.offset);
        let bending = self.smooth.as_ref().map_or(0.0, |s| s.penalty(variables));
        terms.map(|x| x * x).sum::<f64>() + bending
    }

    pub fn jacobian(&self, known: Vec<Columns>) -> Result<Vec<Columns>, PredictError> {
        jacobian(self.problem, self.rows, &self.point, &self.predicted, known)
    }

    pub fn step(&mut self, jacobian: &mut [Columns], noise: &Noise) -> Step {
        let target = noise.whiten(&self.residual, self.rows);
        let columns: Vec<Vec<f64>> = jacobian
            .par_iter()
            .map(|x| noise.whiten(x, self.rows))
            .collect();
        self.choose_weight(&target, &columns);
        let before = dot(&target, &target) + self.penalty(&self.variables);
        let (normal, gradient, free) = self.normal_equations(&target, &columns);
        let normal = Normal::new(normal, self.smooth.as_ref(), &free);
        if free.is_empty() {
            return Step::Converged;
        }
        let undamped = self.wanted(&normal, &gradient, &free, 0.0);
        let decrement = match self.smooth {
            None => gradient.dot(&undamped),
            // What a bound stops is no least square.
            Some(_) => 2.0 * gradient.dot(&undamped) - undamped.dot(&(&normal.form * &undamped)),
        };
        self.decrement = decrement;
        self.close = is_close(decrement, before);
        if decrement < 0.02 + 1e-5 * before {
            return Step::Converged;
        }
        for tries in 0..MAX_REJECTED {
            let step = self.wanted(&normal, &gradient, &free, self.damping);
            let trial = self.moved(&free, &step);
            if let Ok(predicted) = self.problem.predict_for(self.rows, &trial) {
                let residual = self.problem.data.residual(&predicted);
                let variables = self.problem.variables(&trial);
                let e = noise.whiten(&residual, self.rows);
                if dot(&e, &e) + self.penalty(&variables) < before {
                    let moved: Vec<f64> = (variables.iter().zip(&self.variables))
                        .map(|(after, before)| after.value - before.value)
                        .collect();
                    let change = difference(&predicted, &self.predicted, 1.0);
                    let apart = corrected(jacobian, &columns, &moved, change, |x| {
                        let x = noise.whiten(x, self.rows);
                        dot(&x, &x)
                    });
                    (self.point, self.variables) = (trial, variables);
                    (self.predicted, self.residual) = (predicted, residual);
                    self.damping = (self.damping * 0.2).max(1e-6);
                    return Step::Taken {
                        foreseen: tries == 0 && apart < FORESEEN,
                    };
                }
            }
            self.damping *= 8.0;
        }
        let wanted = gradient.dot(&self.wanted(&normal, &gradient, &free, ACCURACY.powi(2)));
        Step::Stuck {
            close: is_close(wanted, before),
        }
    }

    /// The weight of a curve's bending, anew for derivatives and noise of this place.
    fn choose_weight(&mut self, target: &[f64], columns: &[Vec<f64>]) {
        if self.smooth.is_none() {
            return;
        }
        let (normal, gradient, free) = self.normal_equations(target, columns);
        let Some(mut smooth) = self.smooth.take() else {
            return;
        };
        // Channels that the curve does not change have noise of their own, and say nothing of its.
        let bent = smooth.channels(self.rows, columns);
        let own = bent.iter().map(|rows| &target[rows.clone()]);
        let squares = own.map(|x| dot(x, x)).sum::<f64>() + self.penalty(&self.variables);
        let rows = bent.iter().map(ExactSizeIterator::len).sum();
        // Without the price that they have so far.
        let pulls = smooth.pulls(&self.variables);
        let k = self.variables.len();
        let (mut whole, mut slope) = (DMatrix::zeros(k, k), DVector::zeros(k));
        for (a, &i) in free.iter().enumerate() {
            slope[i] = gradient[a] + pulls[i];
            for (b, &j) in free.iter().enumerate() {
                whole[(i, j)] = normal[(a, b)] - smooth.stiffness(i, j);
            }
        }
        smooth.choose(&self.variables, (&whole, &slope), &free, squares, rows);
        if let Some(curve) = self.point.effects.last_mut() {
            curve.smoothing = smooth.weight;
        }
        self.smooth = Some(smooth);
    }

    /// The step that the normal equations want; a curve's values that it would lead below their
    /// bound stay there, and the others make do with it.
    fn wanted(
        &self,
        normal: &Normal,
        gradient: &DVector<f64>,
        free: &[usize],
        damping: f64,
    ) -> DVector<f64> {
        let mut step = normal.solve(gradient, damping);
        let Some(smooth) = &self.smooth else {
            return step;
        };
        let mut held = vec![false; free.len()];
        for _ in 0..BOUND_ROUNDS {
            let mut changed = false;
            for (a, &i) in free.iter().enumerate() {
                let v = &self.variables[i];
                if smooth.holds(i) && !held[a] && v.value + step[a] < v.min {
                    (held[a], step[a], changed) = (true, v.min - v.value, true);
                }
            }
            let rest: Vec<usize> = (0..free.len()).filter(|&a| !held[a]).collect();
            if !changed || rest.is_empty() {
                break;
            }
            let right = DVector::from_fn(rest.len(), |a, _| {
                let by_held = (0..held.len()).filter(|&b| held[b]);
                let pull = by_held.map(|b| normal.form[(rest[a], b)] * step[b]);
                gradient[rest[a]] - pull.sum::<f64>()
            });
            let moved = normal.part(&rest).solve(&right, damping);
            (rest.iter().zip(moved.iter())).for_each(|(&a, x)| step[a] = *x);
        }
        step
    }

    /// Scaled normal equations of the variables that are not held at a bound.
    fn normal_equations(
        &self,
        target: &[f64],
        columns: &[Vec<f64>],
    ) -> (DMatrix<f64>, DVector<f64>, Vec<usize>) {
        let smooth = self.smooth.as_ref();
        let pulls = smooth.map(|one| one.pulls(&self.variables));
        let slope: Vec<f64> = (0..columns.len())
            .map(|i| {
                let prior = self.variables[i].prior;
                let pull = pulls.as_ref().map_or(0.0, |pulls| pulls[i]);
                dot(&columns[i], target) - prior.precision.powi(2) * prior.offset - pull
            })
            .collect();
        let free: Vec<usize> = (0..columns.len())
            .filter(|&i| {
                let v = &self.variables[i];
                let felt = dot(&columns[i], &columns[i]).sqrt() * v.step;
                let held = smooth.is_some_and(|one| one.holds(i));
                (felt > LEAST_FELT || held)
                    && !(v.value <= v.min && slope[i] <= 0.0 || v.value >= v.max && slope[i] >= 0.0)
            })
            .collect();
        let k = free.len();
        let normal = DMatrix::from_fn(k, k, |a, b| {
            let (i, j) = (free[a], free[b]);
            let prior = if i == j {
                self.variables[i].prior.precision.powi(2)
            } else {
                0.0
            };
            let stiff = smooth.map_or(0.0, |one| one.stiffness(i, j));
            dot(&columns[i], &columns[j]) + prior + stiff
        });
        (normal, DVector::from_fn(k, |a, _| slope[free[a]]), free)
    }

    fn moved(&self, free: &[usize], step: &DVector<f64>) -> Point {
        let mut values: Vec<f64> = self.variables.iter().map(|v| v.value).collect();
        for (a, &i) in free.iter().enumerate() {
            let v = &self.variables[i];
            values[i] = (v.value + step[a]).clamp(v.min, v.max);
        }
        self.problem.with_values(&self.point, &values)
    }
}

/// Corrects derivatives by what a step did (Broyden's good update, variables scaled by the norm of
/// their whitened derivatives). How far the step was from what they foresaw, as a part of that.
fn corrected(
    jacobian: &mut [Columns],
    whitened: &[Vec<f64>],
    moved: &[f64],
    change: Columns,
    square: impl Fn(&Columns) -> f64,
) -> f64 {
    let mut foreseen: Columns = change.iter().map(|c| vec![0.0; c.len()]).collect();
    for (column, step) in jacobian.iter().zip(moved) {
        add_columns(&mut foreseen, column, *step);
    }
    let unforeseen = difference(&change, &foreseen, 1.0);
    let weights: Vec<f64> = whitened.iter().map(|x| dot(x, x)).collect();
    let whole: f64 = (weights.iter().zip(moved)).map(|(w, s)| w * s * s).sum();
    if whole > 0.0 {
        for ((column, weight), step) in jacobian.iter_mut().zip(weights).zip(moved) {
            add_columns(column, &unforeseen, weight * step / whole);
        }
    }
    (square(&unforeseen) / square(&foreseen).max(f64::MIN_POSITIVE)).sqrt()
}
