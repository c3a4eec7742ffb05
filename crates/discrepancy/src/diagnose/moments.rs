//! Least squares by inner products: sums that parts of the rows, channels and columns share.

use nalgebra::{DMatrix, DVector};

use super::noise::{Prior, dot};

/// Least squares with priors; columns that are nothing but rounding get zero.
pub(super) fn solve(target: &[f64], columns: &[Vec<f64>], priors: &[Prior]) -> Vec<f64> {
    Moments::new(target, columns).solve(priors)
}

/// Sum of squares of the target that columns explain, of which nothing is known beforehand.
pub(super) fn explained(target: &[f64], columns: &[Vec<f64>]) -> f64 {
    Moments::new(target, columns).explained()
}

/// Inner products of columns with one another and with what they are to explain. Those of parts of
/// the rows add up.
#[derive(Debug, Clone)]
pub(super) struct Moments {
    columns: DMatrix<f64>,
    target: DVector<f64>,
}

impl Moments {
    pub(super) fn new(target: &[f64], columns: &[Vec<f64>]) -> Moments {
        let k = columns.len();
        let mut products = DMatrix::zeros(k, k);
        for i in 0..k {
            for j in i..k {
                products[(i, j)] = dot(&columns[i], &columns[j]);
                products[(j, i)] = products[(i, j)];
            }
        }
        Moments {
            columns: products,
            target: DVector::from_iterator(k, columns.iter().map(|x| dot(x, target))),
        }
    }

    pub(super) fn plus(&self, other: &Moments) -> Moments {
        Moments {
            columns: &self.columns + &other.columns,
            target: &self.target + &other.target,
        }
    }

    pub(super) fn minus(&self, other: &Moments) -> Moments {
        Moments {
            columns: &self.columns - &other.columns,
            target: &self.target - &other.target,
        }
    }

    /// Sum of squares of each column.
    pub(super) fn squares(&self) -> impl Iterator<Item = f64> + '_ {
        (0..self.target.len()).map(|i| self.columns[(i, i)].max(0.0))
    }

    /// Sum of squares of the target that the columns explain, of which nothing is known beforehand.
    pub(super) fn explained(&self) -> f64 {
        let coefficients = self.solve(&vec![Prior::default(); self.target.len()]);
        let parts = coefficients.iter().zip(self.target.iter());
        parts.map(|(b, product)| b * product).sum()
    }

    /// Those of some of the columns alone.
    pub(super) fn of(&self, kept: &[usize]) -> Moments {
        let k = kept.len();
        Moments {
            columns: DMatrix::from_fn(k, k, |i, j| self.columns[(kept[i], kept[j])]),
            target: DVector::from_fn(k, |i, _| self.target[kept[i]]),
        }
    }

    /// Of rows that weigh so much.
    pub(super) fn times(&self, weight: f64) -> Moments {
        Moments {
            columns: &self.columns * weight,
            target: &self.target * weight,
        }
    }

    /// Sum of squares of the target that the columns explain by these coefficients.
    pub(super) fn explained_by(&self, coefficients: &[f64]) -> f64 {
        let b = DVector::from_column_slice(coefficients);
        2.0 * b.dot(&self.target) - b.dot(&(&self.columns * &b))
    }

    /// The same by the best positive multiple of these coefficients; nothing where that is none.
    pub(super) fn explained_along(&self, coefficients: &[f64]) -> f64 {
        let b = DVector::from_column_slice(coefficients);
        let (with, own) = (b.dot(&self.target), b.dot(&(&self.columns * &b)));
        match with > 0.0 && own > 0.0 {
            true => with * with / own,
            false => 0.0,
        }
    }

    pub(super) fn solve(&self, priors: &[Prior]) -> Vec<f64> {
        let scale: Vec<f64> = (self.squares().zip(priors))
            .map(|(s, p)| 1.0 / s.sqrt().hypot(p.precision).max(f64::MIN_POSITIVE.sqrt()))
            .collect();
        let k = scale.len();
        let mut normal = DMatrix::from_fn(k, k, |i, j| self.columns[(i, j)] * scale[i] * scale[j]);
        for i in 0..k {
            normal[(i, i)] += (priors[i].precision * scale[i]).powi(2) + 1e-9;
        }
        let right = DVector::from_fn(k, |i, _| {
            scale[i] * (self.target[i] - priors[i].precision.powi(2) * priors[i].offset)
        });
        match normal.cholesky() {
            Some(factor) => {
                let solution = factor.solve(&right);
                (0..k).map(|i| solution[i] * scale[i]).collect()
            }
            None => vec![0.0; k],
        }
    }
}
