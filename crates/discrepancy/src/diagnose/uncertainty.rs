//! Standard errors of a fit's variables.

use nalgebra::{DMatrix, DVector};

use super::DiagnoseError;
use super::data::Rows;
use super::derivatives::jacobian;
use super::fit::Fit;
use super::noise::dot;
use super::problem::Problem;
use super::smooth::Smooth;

/// One for each variable of the fit: from the whitened Gauss-Newton covariance, or from leaving out
/// blocks in turn, whichever is larger. None where the data do not determine it.
///
/// # Errors
/// The simulation cannot be run around the fit.
pub(super) fn standard_errors(
    problem: &Problem,
    fit: &Fit,
    rows: &Rows,
) -> Result<Vec<Option<f64>>, DiagnoseError> {
    let variables = problem.variables(&fit.point).len();
    let mut errors = vec![None; variables];
    let Some(normal) = normal(problem, fit, rows)? else {
        return Ok(errors);
    };
    for (a, &i) in normal.felt.iter().enumerate() {
        let variance = normal.inverse[(a, a)] * normal.widening(a).powi(2);
        let error = variance.sqrt() * normal.scale[a];
        // A variance inflated so much by the other variables is rounding.
        errors[i] = (normal.inverse[(a, a)] < 1e8 && error.is_finite()).then_some(error);
    }
    Ok(errors)
}

/// Covariance of the fit's variables, as wide as their standard errors; zero for those that the
/// data do not feel. None where they do not determine the others.
///
/// # Errors
/// The simulation cannot be run around the fit.
pub(super) fn covariance(
    problem: &Problem,
    fit: &Fit,
    rows: &Rows,
) -> Result<Option<DMatrix<f64>>, DiagnoseError> {
    let variables = problem.variables(&fit.point).len();
    let Some(normal) = normal(problem, fit, rows)? else {
        return Ok(None);
    };
    let mut whole = DMatrix::zeros(variables, variables);
    let size = |a: usize| normal.widening(a) * normal.scale[a];
    for (a, &i) in normal.felt.iter().enumerate() {
        for (b, &j) in normal.felt.iter().enumerate() {
            whole[(i, j)] = normal.inverse[(a, b)] * size(a) * size(b);
        }
    }
    Ok(Some(whole))
}

/// Normal equations at a fit's end, in scaled variables.
struct Normal {
    /// Variables that the data feel.
    felt: Vec<usize>,
    scale: Vec<f64>,
    inverse: DMatrix<f64>,
    /// Variances by leaving out blocks.
    jackknife: Option<DVector<f64>>,
}

impl Normal {
    /// How much wider the spread over blocks is.
    fn widening(&self, a: usize) -> f64 {
        let jackknife = self.jackknife.as_ref().map_or(0.0, |v| v[a]);
        (jackknife / self.inverse[(a, a)]).max(1.0).sqrt()
    }
}

fn normal(problem: &Problem, fit: &Fit, rows: &Rows) -> Result<Option<Normal>, DiagnoseError> {
    let variables = problem.variables(&fit.point);
    let columns = jacobian(problem, rows, &fit.point, &fit.predicted, Vec::new())?;
    let columns: Vec<Vec<f64>> = columns.iter().map(|x| fit.noise.whiten(x, rows)).collect();
    let target = fit.noise.whiten(&fit.residual, rows);
    let smooth = Smooth::of(problem, &fit.point);
    let stiff = |i: usize, j: usize| smooth.as_ref().map_or(0.0, |one| one.stiffness(i, j));
    let pulls = smooth.as_ref().map(|one| one.pulls(&variables));
    let norm = |i: usize| {
        let prior = variables[i].prior.precision.powi(2) + stiff(i, i);
        (dot(&columns[i], &columns[i]) + prior).sqrt()
    };
    // Of a variable that moves nothing the others must not suffer.
    let felt: Vec<usize> = (0..variables.len())
        .filter(|&i| norm(i) * variables[i].step > LEAST_FELT)
        .collect();
    let k = felt.len();
    let scale: Vec<f64> = felt.iter().map(|&i| 1.0 / norm(i)).collect();
    let columns: Vec<&[f64]> = felt.iter().map(|&i| columns[i].as_slice()).collect();
    let normal = DMatrix::from_fn(k, k, |a, b| {
        let prior = variables[felt[a]].prior.precision.powi(2);
        let own = if a == b { prior } else { 0.0 };
        (dot(columns[a], columns[b]) + own + stiff(felt[a], felt[b])) * scale[a] * scale[b]
    });
    let gradient = DVector::from_fn(k, |a, _| {
        let v = &variables[felt[a]];
        match &pulls {
            // What a bound holds is at rest there.
            Some(_) if v.value <= v.min || v.value >= v.max => 0.0,
            Some(pulls) => (dot(columns[a], &target) - pulls[felt[a]]) * scale[a],
            None => dot(columns[a], &target) * scale[a],
        }
    });
    let Some(inverse) = normal.clone().cholesky().map(|c| c.inverse()) else {
        return Ok(None);
    };
    let jackknife = leave_out(problem, rows, &columns, &target, &normal, &gradient, &scale);
    Ok(Some(Normal {
        felt,
        scale,
        inverse,
        jackknife,
    }))
}

/// A variable counts if the step of its finite difference, about a ten-thousandth of its typical
/// size, moves the whitened prediction by more than this: less is rounding.
const LEAST_FELT: f64 = 1e-10;

/// Variances of the scaled variables by the block jackknife, each time with one Gauss-Newton step
/// from the whole.
fn leave_out(
    problem: &Problem,
    rows: &Rows,
    columns: &[&[f64]],
    target: &[f64],
    normal: &DMatrix<f64>,
    gradient: &DVector<f64>,
    scale: &[f64],
) -> Option<DVector<f64>> {
    let k = columns.len();
    let samples: Vec<usize> = rows.per_channel.iter().flatten().copied().collect();
    let mut shifts = Vec::new();
    for block in &problem.split.blocks {
        let inside: Vec<usize> = (0..samples.len())
            .filter(|&p| block.contains(&samples[p]))
            .collect();
        let part = |a: &[f64], b: &[f64]| inside.iter().map(|&p| a[p] * b[p]).sum::<f64>();
        let less = DMatrix::from_fn(k, k, |i, j| {
            normal[(i, j)] - part(columns[i], columns[j]) * scale[i] * scale[j]
        });
        let right = DVector::from_fn(k, |i, _| gradient[i] - part(columns[i], target) * scale[i]);
        shifts.push(less.cholesky()?.solve(&right));
    }
    let count = shifts.len() as f64;
    let mean = shifts.iter().fold(DVector::zeros(k), |sum, x| sum + x) / count;
    let squares = shifts
        .iter()
        .fold(DVector::zeros(k), |sum, x| sum + (x - &mean).map(|d| d * d));
    Some(squares * ((count - 1.0) / count))
}
