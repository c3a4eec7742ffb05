//! Fits by simulation error: damped Gauss-Newton under coloured noise, within bounds.
//!
//! Library solvers do not serve here: the weights (the noise model) are estimated anew after each step, a simulation that
//! diverges is a step to be taken back, and bounds are met often (an effect that is not there has size zero, its bound).

use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

use super::data::Rows;
use super::noise::{Noise, dot};
use super::problem::{Point, Problem, Variable};
use crate::model::{Columns, PredictError};

/// A point that was fitted.
#[derive(Debug, Clone)]
pub(super) struct Fit {
    pub point: Point,
    pub predicted: Columns,
    pub residual: Columns,
    pub noise: Noise,
    /// Minus twice the profile log-likelihood on the rows of the fit, with the priors' part.
    pub objective: f64,
    pub converged: bool,
    pub iterations: usize,
    /// Change of the prediction per unit of each variable, at or close to the point.
    pub jacobian: Vec<Columns>,
}

const MAX_ITERATIONS: usize = 14;
/// The first steps are taken under white noise: what is to be found is still in the residual, and its autoregression would hide it.
const WHITE_ITERATIONS: usize = 2;
const MAX_REJECTED: usize = 5;
/// Derivatives serve for another step, with Broyden's correction, if they foresaw the last one to this part of it,
const FORESEEN: f64 = 0.2;
/// and for so many in a row.
const LONGEST_REUSE: usize = 3;

/// Fits all parameters of `start` to the given rows.
///
/// # Errors
/// The simulation cannot be run at the start.
pub(super) fn fit(
    problem: &Problem,
    start: Point,
    rows: &Rows,
    orders: &[usize],
    warm: bool,
) -> Result<Fit, PredictError> {
    let mut running = Running::begin(problem, start, rows, orders, warm)?;
    running.advance(MAX_ITERATIONS)?;
    Ok(running.finish())
}

/// A fit under way.
pub(super) struct Running<'a, 'b> {
    solver: Solver<'a, 'b>,
    noise: Noise,
    /// Iterations under white noise.
    white: usize,
    iterations: usize,
    converged: bool,
    stuck: bool,
    jacobian: Vec<Columns>,
    /// Steps since the derivatives were taken, if they serve for another one.
    age: Option<usize>,
}

impl<'a, 'b> Running<'a, 'b> {
    /// Ready for the first iteration.
    ///
    /// # Errors
    /// The simulation cannot be run at the start.
    pub fn begin(
        problem: &'a Problem<'b>,
        start: Point,
        rows: &'a Rows,
        orders: &'a [usize],
        warm: bool,
    ) -> Result<Self, PredictError> {
        let predicted = problem.predict(&start)?;
        let solver = Solver {
            problem,
            rows,
            orders,
            residual: problem.data.residual(&predicted),
            predicted,
            variables: problem.variables(&start),
            point: start,
            damping: 1e-3,
            decrement: f64::INFINITY,
        };
        let white = if warm { 0 } else { WHITE_ITERATIONS };
        Ok(Self {
            noise: solver.noise(white == 0),
            white,
            iterations: 0,
            converged: solver.variables.is_empty(),
            stuck: false,
            jacobian: Vec::new(),
            age: None,
            solver,
        })
    }

    /// Goes on until it ends, or has made so many iterations in all.
    ///
    /// # Errors
    /// The simulation can be run on neither side of a point.
    pub fn advance(&mut self, iterations: usize) -> Result<(), PredictError> {
        while !self.has_ended() && self.iterations < iterations {
            let reused = self.age.is_some();
            if !reused {
                self.jacobian = self.solver.jacobian()?;
            }
            self.iterations += 1;
            let whitened = self.iterations > self.white;
            let before = self.age.take().unwrap_or(0);
            match self.solver.step(&mut self.jacobian, &self.noise) {
                Step::Converged => self.converged = whitened,
                // With derivatives of this place it may go on.
                Step::Stuck { .. } if reused => {}
                Step::Stuck { close } if whitened => {
                    self.converged = close;
                    self.stuck = true;
                }
                Step::Stuck { .. } => {}
                // A fit that starts at its end serves with its derivatives: they are taken where it ends.
                Step::Taken { foreseen } => {
                    let serves = foreseen && self.white > 0 && before < LONGEST_REUSE;
                    self.age = serves.then_some(before + 1);
                }
            }
            self.noise = self.solver.noise(self.iterations >= self.white);
        }
        Ok(())
    }

    /// Whether nothing is left to be done.
    pub fn has_ended(&self) -> bool {
        self.converged || self.stuck || self.iterations >= MAX_ITERATIONS
    }

    /// Minus twice the log-likelihood, as it now stands.
    pub fn objective(&self) -> f64 {
        self.noise.objective(self.solver.rows) + self.solver.penalty(&self.solver.variables)
    }

    /// By how much the next step would lower the weighted squares if all were linear.
    pub fn decrement(&self) -> f64 {
        self.solver.decrement
    }

    pub fn point(&self) -> &Point {
        &self.solver.point
    }

    pub fn iterations(&self) -> usize {
        self.iterations
    }

    /// Squared distance between two predictions, whitened.
    pub fn distance(&self, other: &Self) -> f64 {
        let apart = difference(&self.solver.predicted, &other.solver.predicted, 1.0);
        let apart = self.noise.whiten(&apart, self.solver.rows);
        dot(&apart, &apart)
    }

    /// The fit as it now stands.
    pub fn finish(self) -> Fit {
        let solver = self.solver;
        let noise = solver.noise(true);
        Fit {
            objective: noise.objective(solver.rows) + solver.penalty(&solver.variables),
            point: solver.point,
            predicted: solver.predicted,
            residual: solver.residual,
            noise,
            converged: self.converged,
            iterations: self.iterations,
            jacobian: self.jacobian,
        }
    }
}

/// A point as it is, with its noise and derivatives.
///
/// # Errors
/// The simulation cannot be run there.
pub(super) fn unfitted(
    problem: &Problem,
    point: Point,
    rows: &Rows,
    orders: &[usize],
) -> Result<Fit, PredictError> {
    let predicted = problem.predict(&point)?;
    let residual = problem.data.residual(&predicted);
    let noise = Noise::fit(&residual, rows, orders, &problem.floor);
    Ok(Fit {
        jacobian: jacobian(problem, &point, &predicted)?,
        objective: noise.objective(rows),
        point,
        predicted,
        residual,
        noise,
        converged: true,
        iterations: 0,
    })
}

enum Step {
    Taken {
        /// The derivatives, since corrected, foresaw what it would do.
        foreseen: bool,
    },
    /// The step that is left is a small part of a standard error.
    Converged,
    /// No step lowers the error; `close` says whether the step wanted was within a standard error.
    Stuck { close: bool },
}

struct Solver<'a, 'b> {
    problem: &'a Problem<'b>,
    rows: &'a Rows,
    orders: &'a [usize],
    point: Point,
    variables: Vec<Variable>,
    predicted: Columns,
    residual: Columns,
    damping: f64,
    /// Of the last step.
    decrement: f64,
}

impl Solver<'_, '_> {
    fn noise(&self, coloured: bool) -> Noise {
        let floor = &self.problem.floor;
        if coloured {
            Noise::fit(&self.residual, self.rows, self.orders, floor)
        } else {
            Noise::white(&self.residual, self.rows, floor)
        }
    }

    fn penalty(&self, variables: &[Variable]) -> f64 {
        let terms = variables.iter().map(|v| v.prior.precision * v.prior.offset);
        terms.map(|x| x * x).sum()
    }

    fn jacobian(&self) -> Result<Vec<Columns>, PredictError> {
        jacobian(self.problem, &self.point, &self.predicted)
    }

    fn step(&mut self, jacobian: &mut [Columns], noise: &Noise) -> Step {
        let target = noise.whiten(&self.residual, self.rows);
        let columns: Vec<Vec<f64>> = jacobian
            .par_iter()
            .map(|x| noise.whiten(x, self.rows))
            .collect();
        let before = dot(&target, &target) + self.penalty(&self.variables);
        let (normal, gradient, free) = self.normal_equations(&target, &columns);
        if free.is_empty() {
            return Step::Converged;
        }
        let undamped = self.solve(&normal, &gradient, 0.0);
        let decrement = gradient.dot(&undamped);
        self.decrement = decrement;
        if decrement < 0.02 + 1e-5 * before {
            return Step::Converged;
        }
        for tries in 0..MAX_REJECTED {
            let step = self.solve(&normal, &gradient, self.damping);
            let trial = self.moved(&free, &step);
            if let Ok(predicted) = self.problem.predict(&trial) {
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
        Step::Stuck {
            close: decrement < 1.0 + 1e-3 * before,
        }
    }

    /// Scaled normal equations of the variables that are not held at a bound.
    fn normal_equations(
        &self,
        target: &[f64],
        columns: &[Vec<f64>],
    ) -> (DMatrix<f64>, DVector<f64>, Vec<usize>) {
        let slope: Vec<f64> = (0..columns.len())
            .map(|i| {
                let prior = self.variables[i].prior;
                dot(&columns[i], target) - prior.precision.powi(2) * prior.offset
            })
            .collect();
        let free: Vec<usize> = (0..columns.len())
            .filter(|&i| {
                let v = &self.variables[i];
                !(v.value <= v.min && slope[i] <= 0.0 || v.value >= v.max && slope[i] >= 0.0)
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
            dot(&columns[i], &columns[j]) + prior
        });
        (normal, DVector::from_fn(k, |a, _| slope[free[a]]), free)
    }

    fn solve(&self, normal: &DMatrix<f64>, gradient: &DVector<f64>, damping: f64) -> DVector<f64> {
        let k = gradient.len();
        let scale = DVector::from_fn(k, |i, _| 1.0 / normal[(i, i)].sqrt().max(1e-150));
        let mut scaled = DMatrix::from_fn(k, k, |i, j| normal[(i, j)] * scale[i] * scale[j]);
        for i in 0..k {
            scaled[(i, i)] += damping + 1e-9;
        }
        match scaled.cholesky() {
            Some(factor) => factor
                .solve(&gradient.component_mul(&scale))
                .component_mul(&scale),
            None => DVector::zeros(k),
        }
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

/// Corrects derivatives by what a step did (Broyden's good update, variables scaled by the norm of their whitened derivatives). How
/// far the step was from what they foresaw, as a part of that.
fn corrected(
    jacobian: &mut [Columns],
    whitened: &[Vec<f64>],
    moved: &[f64],
    change: Columns,
    square: impl Fn(&Columns) -> f64,
) -> f64 {
    let mut foreseen: Columns = change.iter().map(|c| vec![0.0; c.len()]).collect();
    for (column, step) in jacobian.iter().zip(moved) {
        add(&mut foreseen, column, *step);
    }
    let unforeseen = difference(&change, &foreseen, 1.0);
    let weights: Vec<f64> = whitened.iter().map(|x| dot(x, x)).collect();
    let whole: f64 = (weights.iter().zip(moved)).map(|(w, s)| w * s * s).sum();
    if whole > 0.0 {
        for ((column, weight), step) in jacobian.iter_mut().zip(weights).zip(moved) {
            add(column, &unforeseen, weight * step / whole);
        }
    }
    (square(&unforeseen) / square(&foreseen).max(f64::MIN_POSITIVE)).sqrt()
}

/// `to += factor * columns`.
fn add(to: &mut Columns, columns: &Columns, factor: f64) {
    for (to, column) in to.iter_mut().zip(columns) {
        for (to, x) in to.iter_mut().zip(column) {
            *to += factor * x;
        }
    }
}

/// Change of the prediction per unit of each variable, by finite differences.
///
/// # Errors
/// The simulation can be run on neither side of the point.
pub(super) fn jacobian(
    problem: &Problem,
    point: &Point,
    predicted: &Columns,
) -> Result<Vec<Columns>, PredictError> {
    let variables = problem.variables(point);
    let values: Vec<f64> = variables.iter().map(|v| v.value).collect();
    let columns = variables.par_iter().enumerate().map(|(i, v)| {
        let sides = if v.value + v.step <= v.max {
            [v.step, -v.step]
        } else {
            [-v.step, v.step]
        };
        let mut failure = None;
        for step in sides {
            let mut moved = values.clone();
            moved[i] += step;
            match problem.predict(&problem.with_values(point, &moved)) {
                Ok(columns) => return Ok(difference(&columns, predicted, 1.0 / step)),
                Err(error) => failure = Some(error),
            }
        }
        Err(failure.expect("both sides failed"))
    });
    columns.collect()
}

/// `(a - b) * factor`.
pub(super) fn difference(a: &Columns, b: &Columns, factor: f64) -> Columns {
    let pairs = a.iter().zip(b);
    pairs
        .map(|(a, b)| a.iter().zip(b).map(|(x, y)| (x - y) * factor).collect())
        .collect()
}
