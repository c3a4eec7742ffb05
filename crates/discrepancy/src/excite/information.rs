//! Information of a motion about parameters: standard errors, and what a criterion says of them.

use nalgebra::{DMatrix, DVector};
use truecut_scenario::Criterion;

/// Fisher's information of noise that is independent from row to row, `Jᵀ Σ⁻¹ J`.
#[derive(Debug, Clone)]
pub(super) struct Information {
    matrix: DMatrix<f64>,
}

/// Part of a parameter's own information that stands for none: what shows less is as good as not
/// seen.
const DARK: f64 = 1e-12;

impl Information {
    /// Of no row.
    pub fn none(parameters: usize) -> Information {
        Information {
            matrix: DMatrix::zeros(parameters, parameters),
        }
    }

    /// Adds rows of a channel, each a derivative by every parameter over the noise.
    pub fn add(&mut self, rows: &DMatrix<f64>) {
        self.matrix.gemm_tr(1.0, rows, rows, 1.0);
    }

    /// So many times as much.
    pub fn times(&self, factor: f64) -> Information {
        Information {
            matrix: &self.matrix * factor,
        }
    }

    /// Adds what is known of parameters beforehand, one over the square of a deviation each.
    pub fn with_prior(mut self, precisions: &[f64]) -> Information {
        for (i, precision) in precisions.iter().enumerate() {
            self.matrix[(i, i)] += precision;
        }
        self
    }

    /// Covariance of the estimates of the parameters.
    pub fn covariance(&self) -> DMatrix<f64> {
        let scale = self.matrix.diagonal().map(|square| match square > 0.0 {
            true => 1.0 / square.sqrt(),
            false => 1.0,
        });
        let n = self.matrix.nrows();
        let mut scaled = DMatrix::from_fn(n, n, |i, j| self.matrix[(i, j)] * scale[i] * scale[j]);
        for i in 0..n {
            scaled[(i, i)] += DARK;
        }
        // With that on its diagonal the matrix is positive, up to rounding.
        let inverse = match scaled.clone().cholesky() {
            Some(cholesky) => cholesky.inverse(),
            None => {
                let eigen = scaled.symmetric_eigen();
                let inverse = eigen.eigenvalues.map(|value| 1.0 / value.max(DARK));
                let vectors = &eigen.eigenvectors;
                vectors * DMatrix::from_diagonal(&inverse) * vectors.transpose()
            }
        };
        DMatrix::from_fn(n, n, |i, j| inverse[(i, j)] * scale[i] * scale[j])
    }

    /// Standard errors of all parameters.
    pub fn errors(&self) -> Vec<f64> {
        self.covariance()
            .diagonal()
            .iter()
            .map(|v| v.sqrt())
            .collect()
    }

    /// Ratio of the largest singular value of the weighted rows to the smallest, each parameter in
    /// units of `units`.
    pub fn condition(&self, units: &[f64]) -> f64 {
        let n = self.matrix.nrows();
        let scaled = DMatrix::from_fn(n, n, |i, j| self.matrix[(i, j)] * units[i] * units[j]);
        let values = scaled.symmetric_eigenvalues();
        let largest = values.max();
        (largest / values.min().max(f64::EPSILON * largest)).sqrt()
    }

    /// The logarithm that a criterion makes least of the parameters asked for, the others unknown,
    /// too, each in its `units`: of the mean half axis of their confidence ellipsoid (geometric),
    /// or of the longest.
    pub fn cost(&self, criterion: Criterion, asked: &[usize], units: &[f64]) -> f64 {
        let covariance = self.covariance();
        let n = asked.len();
        let own = DMatrix::from_fn(n, n, |i, j| {
            let (i, j) = (asked[i], asked[j]);
            covariance[(i, j)] / (units[i] * units[j])
        });
        match criterion {
            Criterion::E => 0.5 * own.symmetric_eigenvalues().max().ln(),
            Criterion::D => {
                let values = own.symmetric_eigenvalues();
                let logs = values.map(|value| value.max(f64::MIN_POSITIVE).ln());
                0.5 * logs.sum() / n as f64
            }
        }
    }

    /// Chi-squared by which a change of the parameters shows that no change of `others` undoes.
    pub fn separation(&self, change: &DVector<f64>, others: &[usize]) -> f64 {
        let whole = (change.transpose() * &self.matrix * change)[(0, 0)];
        if others.is_empty() {
            return whole;
        }
        let n = others.len();
        let own = Information {
            matrix: DMatrix::from_fn(n, n, |i, j| self.matrix[(others[i], others[j])]),
        };
        let shown = &self.matrix * change;
        let shared = DVector::from_iterator(n, others.iter().map(|i| shown[*i]));
        let undone = (shared.transpose() * own.covariance() * &shared)[(0, 0)];
        (whole - undone).max(0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A straight line through points at −1, 0 and 1 in noise of deviation σ: the textbook's
    /// variances σ²/n and σ²/Σx².
    #[test]
    fn verify_standard_errors_of_a_line() {
        let sigma = 0.2;
        let rows = DMatrix::from_row_slice(3, 2, &[1.0, -1.0, 1.0, 0.0, 1.0, 1.0]) / sigma;
        let mut information = Information::none(2);
        information.add(&rows);
        let errors = information.errors();
        assert!((errors[0] - sigma / 3f64.sqrt()).abs() < 1e-9);
        assert!((errors[1] - sigma / 2f64.sqrt()).abs() < 1e-9);
        let units = [1.0, 1.0];
        assert!((information.condition(&units) - 1.5f64.sqrt()).abs() < 1e-9);
        let both = information.cost(Criterion::D, &[0, 1], &units);
        assert!((both - 0.5 * (errors[0] * errors[1]).powi(2).ln() / 2.0).abs() < 1e-9);
        let worst = information.cost(Criterion::E, &[0, 1], &units);
        assert!((worst - errors[1].ln()).abs() < 1e-9);
    }

    /// Of a change of the slope nothing is undone by the constant; of a change of both the part
    /// that is constant is.
    #[test]
    fn verify_separation_is_what_others_cannot_undo() {
        let rows = DMatrix::from_row_slice(3, 2, &[1.0, 0.0, 1.0, 1.0, 1.0, 2.0]);
        let mut information = Information::none(2);
        information.add(&rows);
        let slope = DVector::from_vec(vec![0.0, 1.0]);
        // 0, 1, 2 less their mean: 1 + 1.
        assert!((information.separation(&slope, &[0]) - 2.0).abs() < 1e-9);
        assert!((information.separation(&slope, &[]) - 5.0).abs() < 1e-9);
    }
}
