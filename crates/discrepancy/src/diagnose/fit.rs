//! Fits by simulation error: damped Gauss-Newton under coloured noise, within bounds.
//!
//! Library solvers do not serve here: the weights (the noise model) are estimated anew after each
//! step, a step whose simulation diverges is undone, and bounds are often active (an effect that is
//! not there has size zero, its bound).

use super::data::Rows;
use super::derivatives::{difference, jacobian};
use super::noise::{Noise, dot};
use super::problem::{Point, Problem};
use super::smooth::Smooth;
use super::step::{Solver, Step};
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
/// And so many more for each number of an effect that is not a size: what follows a frequency or a
/// place is far from linear.
const FOR_A_SHAPE: usize = 7;
/// The first steps are taken under white noise: what is to be found is still in the residual, and
/// its autoregression would hide it.
const WHITE_ITERATIONS: usize = 2;
/// Derivatives serve for so many further steps in a row.
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
    running.advance(usize::MAX)?;
    Ok(running.finish())
}

/// A fit in progress.
pub(super) struct Running<'a, 'b> {
    solver: Solver<'a, 'b>,
    noise: Noise,
    /// Iterations under white noise.
    white: usize,
    iterations: usize,
    most: usize,
    converged: bool,
    stuck: bool,
    jacobian: Vec<Columns>,
    /// Steps since the derivatives were taken, if they serve for another one.
    age: Option<usize>,
    /// Derivatives by the first variables that serve for the first step, which is under white
    /// noise.
    known: Vec<Columns>,
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
        let predicted = problem.predict_for(rows, &start)?;
        let solver = Solver {
            problem,
            rows,
            orders,
            residual: problem.data.residual(&predicted),
            predicted,
            variables: problem.variables(&start),
            smooth: Smooth::of(problem, &start),
            point: start,
            damping: 1e-3,
            decrement: f64::INFINITY,
            close: false,
        };
        let white = if warm { 0 } else { WHITE_ITERATIONS };
        let effects = solver.point.effects.iter();
        let infos = effects.flat_map(|found| problem.infos(found.candidate));
        let shapes = infos.filter(|info| !info.is_size).count();
        Ok(Self {
            most: MAX_ITERATIONS + FOR_A_SHAPE * shapes,
            noise: solver.noise(white == 0),
            white,
            iterations: 0,
            converged: solver.variables.is_empty(),
            stuck: false,
            jacobian: Vec::new(),
            age: None,
            known: Vec::new(),
            solver,
        })
    }

    /// Takes derivatives of the model that this one extends by effects as good enough for the first
    /// step.
    pub fn knowing(mut self, base: &Fit) -> Self {
        let (own, others) = (self.solver.point.candidates(), base.point.candidates());
        if self.white > 0 && own.starts_with(&others) {
            self.known.clone_from(&base.jacobian);
        }
        self
    }

    /// Goes on until it ends, or has made so many iterations in all.
    ///
    /// # Errors
    /// The simulation can be run on neither side of a point.
    pub fn advance(&mut self, iterations: usize) -> Result<(), PredictError> {
        while !self.has_ended() && self.iterations < iterations {
            let reused = self.age.is_some();
            if !reused {
                self.jacobian = self.solver.jacobian(std::mem::take(&mut self.known))?;
            }
            self.iterations += 1;
            let whitened = self.iterations > self.white;
            let before = self.age.take().unwrap_or(0);
            match self.solver.step(&mut self.jacobian, &self.noise) {
                // A fit that starts at its end serves with its derivatives: they are taken where it
                // ends.
                Step::Converged if reused && self.white == 0 => {}
                Step::Converged => self.converged = whitened,
                // With derivatives of this place it may go on.
                Step::Stuck { .. } if reused => {}
                Step::Stuck { close } if whitened => {
                    self.converged = close;
                    self.stuck = true;
                }
                Step::Stuck { .. } => {}
                Step::Taken { foreseen } => {
                    let serves = foreseen && before < LONGEST_REUSE;
                    self.age = serves.then_some(before + 1);
                }
            }
            self.noise = self.solver.noise(self.iterations >= self.white);
        }
        // Derivatives of what follows a frequency hold for short steps: a fit may creep about its
        // end.
        self.converged |= self.iterations >= self.most && self.solver.close;
        Ok(())
    }

    /// Whether it has ended.
    pub fn has_ended(&self) -> bool {
        self.converged || self.stuck || self.iterations >= self.most
    }

    /// Current value of minus twice the log-likelihood.
    pub fn objective(&self) -> f64 {
        self.noise.objective(self.solver.rows) + self.solver.penalty(&self.solver.variables)
    }

    /// Decrease of the weighted squares by the next step in the linear model.
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

    /// The current fit.
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
    let predicted = problem.predict_for(rows, &point)?;
    let residual = problem.data.residual(&predicted);
    let noise = Noise::fit(&residual, rows, orders, &problem.floor);
    Ok(Fit {
        jacobian: jacobian(problem, rows, &point, &predicted, Vec::new())?,
        objective: noise.objective(rows),
        point,
        predicted,
        residual,
        noise,
        converged: true,
        iterations: 0,
    })
}
