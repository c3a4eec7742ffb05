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
    let predicted = problem.predict(&start)?;
    let mut solver = Solver {
        problem,
        rows,
        orders,
        residual: problem.data.residual(&predicted),
        predicted,
        variables: problem.variables(&start),
        point: start,
        damping: 1e-3,
    };
    let white = if warm { 0 } else { WHITE_ITERATIONS };
    let mut noise = solver.noise(white == 0);
    let (mut converged, mut iterations, mut jacobian) =
        (solver.variables.is_empty(), 0, Vec::new());
    while !converged && iterations < MAX_ITERATIONS {
        jacobian = solver.jacobian()?;
        iterations += 1;
        let whitened = iterations > white;
        converged = match solver.step(&jacobian, &noise) {
            Step::Converged => whitened,
            Step::Stuck { close } => {
                if whitened {
                    converged = close;
                    break;
                }
                false
            }
            Step::Taken => false,
        };
        noise = solver.noise(iterations >= white);
    }
    noise = solver.noise(true);
    let objective = noise.objective(rows) + solver.penalty(&solver.variables);
    Ok(Fit {
        point: solver.point,
        predicted: solver.predicted,
        residual: solver.residual,
        noise,
        objective,
        converged,
        iterations,
        jacobian,
    })
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
    Taken,
    /// The step that is left is a small part of a standard error.
    Converged,
    /// No step lowers the error; `close` says whether the step wanted was within a standard error.
    Stuck {
        close: bool,
    },
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

    fn step(&mut self, jacobian: &[Columns], noise: &Noise) -> Step {
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
        if decrement < 0.02 + 1e-5 * before {
            return Step::Converged;
        }
        for _ in 0..MAX_REJECTED {
            let step = self.solve(&normal, &gradient, self.damping);
            let trial = self.moved(&free, &step);
            if let Ok(predicted) = self.problem.predict(&trial) {
                let residual = self.problem.data.residual(&predicted);
                let variables = self.problem.variables(&trial);
                let e = noise.whiten(&residual, self.rows);
                if dot(&e, &e) + self.penalty(&variables) < before {
                    (self.point, self.variables) = (trial, variables);
                    (self.predicted, self.residual) = (predicted, residual);
                    self.damping = (self.damping * 0.2).max(1e-6);
                    return Step::Taken;
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
