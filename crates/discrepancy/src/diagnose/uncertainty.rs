//! Standard errors of a fit's variables.

use nalgebra::{DMatrix, DVector};

use super::DiagnoseError;
use super::data::Rows;
use super::fit::{Fit, jacobian};
use super::noise::dot;
use super::problem::Problem;

/// One for each variable of the fit: from the whitened Gauss-Newton covariance, or from leaving out blocks in turn, whichever is
/// larger. None where the data do not determine it.
///
/// # Errors
/// The simulation cannot be run around the fit.
pub(super) fn standard_errors(
    problem: &Problem,
    fit: &Fit,
    rows: &Rows,
) -> Result<Vec<Option<f64>>, DiagnoseError> {
    let variables = problem.variables(&fit.point);
    let columns = jacobian(problem, &fit.point, &fit.predicted)?;
    let columns: Vec<Vec<f64>> = columns.iter().map(|x| fit.noise.whiten(x, rows)).collect();
    let target = fit.noise.whiten(&fit.residual, rows);
    let k = variables.len();
    let prior = |i: usize| variables[i].prior.precision.powi(2);
    let scale: Vec<f64> = (0..k)
        .map(|i| {
            1.0 / (dot(&columns[i], &columns[i]) + prior(i))
                .sqrt()
                .max(1e-150)
        })
        .collect();
    let normal = DMatrix::from_fn(k, k, |i, j| {
        let own = if i == j { prior(i) } else { 0.0 };
        (dot(&columns[i], &columns[j]) + own) * scale[i] * scale[j]
    });
    let gradient = DVector::from_fn(k, |i, _| dot(&columns[i], &target) * scale[i]);
    let Some(inverse) = normal.clone().cholesky().map(|c| c.inverse()) else {
        return Ok(vec![None; k]);
    };
    let jackknife = leave_out(problem, rows, &columns, &target, &normal, &gradient, &scale);
    Ok((0..k)
        .map(|i| {
            let variance = inverse[(i, i)].max(jackknife.as_ref().map_or(0.0, |v| v[i]));
            let error = variance.sqrt() * scale[i];
            // A variance inflated so much by the other variables is rounding.
            (inverse[(i, i)] < 1e8 && error.is_finite()).then_some(error)
        })
        .collect())
}

/// Variances of the scaled variables by the block jackknife, each time with one Gauss-Newton step from the whole.
fn leave_out(
    problem: &Problem,
    rows: &Rows,
    columns: &[Vec<f64>],
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
            normal[(i, j)] - part(&columns[i], &columns[j]) * scale[i] * scale[j]
        });
        let right = DVector::from_fn(k, |i, _| gradient[i] - part(&columns[i], target) * scale[i]);
        shifts.push(less.cholesky()?.solve(&right));
    }
    let count = shifts.len() as f64;
    let mean = shifts.iter().fold(DVector::zeros(k), |sum, x| sum + x) / count;
    let squares = shifts
        .iter()
        .fold(DVector::zeros(k), |sum, x| sum + (x - &mean).map(|d| d * d));
    Some(squares * ((count - 1.0) / count))
}
