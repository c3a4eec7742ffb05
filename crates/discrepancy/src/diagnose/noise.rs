//! Coloured noise as an autoregression for each channel, and least squares under it.

use std::ops::Range;

use nalgebra::{DMatrix, DVector};

use super::data::{LAGS, Rows};
use super::moments::solve;
use crate::model::Columns;

/// `n[t] = sum_k ar[k] n[t-1-k] + e[t]`, `e` white with standard deviation `sigma`.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct ChannelNoise {
    pub ar: Vec<f64>,
    pub sigma: f64,
}

/// Noise of all channels, taken to be independent of one another.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Noise {
    pub channels: Vec<ChannelNoise>,
}

/// Orders among which the Bayesian information criterion chooses.
const ORDERS: &[usize] = &[0, 1, 2, 3, 4, 6, 8, LAGS];

impl Noise {
    /// White noise of the residual's own level.
    pub fn white(residual: &Columns, rows: &Rows, floor: &[f64]) -> Noise {
        Noise::fit(residual, rows, &vec![0; residual.len()], floor)
    }

    /// Least squares of given orders. `floor` bounds each channel's sigma from below.
    pub fn fit(residual: &Columns, rows: &Rows, orders: &[usize], floor: &[f64]) -> Noise {
        let channels = (0..residual.len())
            .map(|c| ChannelNoise::fit(&residual[c], &rows.per_channel[c], orders[c], floor[c]));
        Noise {
            channels: channels.collect(),
        }
    }

    /// The order of each channel.
    pub fn own_orders(&self) -> Vec<usize> {
        self.channels.iter().map(|noise| noise.ar.len()).collect()
    }

    /// The order of each channel that the Bayesian information criterion prefers.
    pub fn orders(residual: &Columns, rows: &Rows, floor: &[f64]) -> Vec<usize> {
        (0..residual.len())
            .map(|c| {
                let rows = &rows.per_channel[c];
                let n = rows.len() as f64;
                let allowed = ORDERS.iter().filter(|p| **p * 20 <= rows.len());
                let mut best = (f64::INFINITY, 0);
                for &order in allowed {
                    let sigma = ChannelNoise::fit(&residual[c], rows, order, floor[c]).sigma;
                    let criterion = 2.0 * n * sigma.ln() + order as f64 * n.ln();
                    if criterion < best.0 {
                        best = (criterion, order);
                    }
                }
                best.1
            })
            .collect()
    }

    /// `sum n ln(sigma^2)`: minus twice the logarithm of the profile likelihood, less a constant.
    pub fn objective(&self, rows: &Rows) -> f64 {
        let terms = self.channels.iter().zip(&rows.per_channel);
        terms
            .map(|(noise, rows)| 2.0 * rows.len() as f64 * noise.sigma.ln())
            .sum()
    }

    /// Whitened to unit variance, channel after channel.
    pub fn whiten(&self, columns: &Columns, rows: &Rows) -> Vec<f64> {
        let mut out = Vec::with_capacity(rows.len());
        for ((noise, column), rows) in self.channels.iter().zip(columns).zip(&rows.per_channel) {
            noise.whiten_into(column, rows, &mut out);
        }
        out
    }
}

/// Rows that are whitened at once: as many independent sums.
const AT_ONCE: usize = 8;

impl ChannelNoise {
    /// White noise of unit variance.
    pub const WHITE: ChannelNoise = ChannelNoise {
        ar: Vec::new(),
        sigma: 1.0,
    };

    /// Least squares of a given order at the rows; `floor` bounds sigma from below.
    pub fn fit(residual: &[f64], rows: &[usize], order: usize, floor: f64) -> ChannelNoise {
        let n = rows.len().max(1) as f64;
        let mut moment = second_moments(residual, rows, order);
        moment.fill_lower_triangle_with_upper_triangle();
        let mut normal = moment.view((1, 1), (order, order)).into_owned();
        // A residual that is all but smooth leaves its moments singular to rounding.
        let ridge = 1e-10 * (moment[(0, 0)] + f64::MIN_POSITIVE);
        for i in 0..order {
            normal[(i, i)] += ridge;
        }
        let right = moment.view((1, 0), (order, 1)).into_owned();
        let ar = match normal.cholesky() {
            Some(factor) => factor.solve(&right).column(0).iter().copied().collect(),
            None => vec![0.0; order],
        };
        let coefficients = DVector::from_vec(ar);
        let sub = moment.view((1, 1), (order, order));
        let explained =
            2.0 * right.column(0).dot(&coefficients) - (sub * &coefficients).dot(&coefficients);
        let free = (n - order as f64).max(1.0);
        let sigma = ((moment[(0, 0)] - explained).max(0.0) / free).sqrt();
        ChannelNoise {
            ar: coefficients.iter().copied().collect(),
            sigma: sigma.max(floor),
        }
    }

    /// The column at the rows, whitened to unit variance.
    pub fn whiten(&self, column: &[f64], rows: &[usize]) -> Vec<f64> {
        let mut out = Vec::with_capacity(rows.len());
        self.whiten_into(column, rows, &mut out);
        out
    }

    fn whiten_into(&self, column: &[f64], rows: &[usize], out: &mut Vec<f64>) {
        let scale = 1.0 / self.sigma;
        for stretch in stretches(rows) {
            let mut first = stretch.start;
            while first < stretch.end {
                let count = AT_ONCE.min(stretch.end - first);
                let mut predicted = [0.0; AT_ONCE];
                for (k, a) in self.ar.iter().enumerate() {
                    let past = &column[first - 1 - k..][..count];
                    // Where their number is known beforehand the sums stay in registers.
                    match past.first_chunk::<AT_ONCE>() {
                        Some(past) => add(&mut predicted, past, *a),
                        None => add(&mut predicted, past, *a),
                    }
                }
                let now = &column[first..][..count];
                out.extend(now.iter().zip(&predicted).map(|(x, p)| (x - p) * scale));
                first += count;
            }
        }
    }
}

#[inline(always)]
fn add(sums: &mut [f64; AT_ONCE], x: &[f64], factor: f64) {
    for (sum, x) in sums.iter_mut().zip(x) {
        *sum += factor * x;
    }
}

/// Runs of rows without a gap.
fn stretches(rows: &[usize]) -> impl Iterator<Item = Range<usize>> {
    let runs = rows.chunk_by(|a, b| *b == a + 1);
    runs.map(|run| run[0]..run[0] + run.len())
}

/// Second moments of the present value and its predecessors, upper triangle. Within a run of rows,
/// a moment of later values is that of the same two a row earlier, but for what the shift brings in
/// and leaves behind.
fn second_moments(residual: &[f64], rows: &[usize], order: usize) -> DMatrix<f64> {
    let mut sums = DMatrix::zeros(order + 1, order + 1);
    let mut own = sums.clone();
    for stretch in stretches(rows) {
        let at = |row: usize, lag: usize| residual[row - lag];
        let behind = |lag: usize| &residual[stretch.start - lag..stretch.end - lag];
        for j in 0..=order {
            own[(0, j)] = dot(behind(0), behind(j));
            for i in 1..=j {
                own[(i, j)] = own[(i - 1, j - 1)] + at(stretch.start, i) * at(stretch.start, j)
                    - at(stretch.end, i) * at(stretch.end, j);
            }
        }
        sums += &own;
    }
    sums
}

/// What is known of a coefficient beforehand: `precision * (coefficient + offset)` is standard
/// normal; precision 0 means nothing.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Prior {
    pub offset: f64,
    pub precision: f64,
}

/// A linear model fitted together with its noise.
#[derive(Debug, Clone)]
pub(super) struct LinearFit {
    pub coefficients: Vec<f64>,
    /// Minus twice the log-likelihood with the prior's part.
    pub objective: f64,
}

/// Generalised least squares: coefficients and autoregression in turn (`cochrane1949`), so that the
/// noise model is that of what is left and not of what is to be found. Started from white noise and
/// from `start`; the better end counts.
pub(super) fn fit_linear(
    residual: &Columns,
    design: &[&Columns],
    priors: &[Prior],
    rows: &Rows,
    start: &Noise,
    orders: &[usize],
    floor: &[f64],
) -> LinearFit {
    let mut best: Option<LinearFit> = None;
    for first in [Noise::white(residual, rows, floor), start.clone()] {
        let mut noise = first;
        for _ in 0..3 {
            let target = noise.whiten(residual, rows);
            let columns: Vec<_> = design.iter().map(|x| noise.whiten(x, rows)).collect();
            let coefficients = solve(&target, &columns, priors);
            let mut left = residual.clone();
            for (x, b) in design.iter().zip(&coefficients) {
                add_columns(&mut left, x, -b);
            }
            noise = Noise::fit(&left, rows, orders, floor);
            let objective = noise.objective(rows) + penalty(&coefficients, priors);
            if best.as_ref().is_none_or(|b| objective < b.objective) {
                best = Some(LinearFit {
                    coefficients,
                    objective,
                });
            }
        }
    }
    best.expect("two starts were made")
}

/// `sum += factor * columns`, in every channel.
pub(super) fn add_columns(sum: &mut Columns, columns: &Columns, factor: f64) {
    for (sum, column) in sum.iter_mut().zip(columns) {
        add_column(sum, column, factor);
    }
}

/// `sum += factor * column`.
pub(super) fn add_column(sum: &mut [f64], column: &[f64], factor: f64) {
    for (sum, x) in sum.iter_mut().zip(column) {
        *sum += factor * x;
    }
}

pub(super) fn penalty(coefficients: &[f64], priors: &[Prior]) -> f64 {
    let terms = coefficients.iter().zip(priors);
    terms
        .map(|(b, p)| (p.precision * (b + p.offset)).powi(2))
        .sum()
}

/// Inner product, in eight independent sums.
pub(super) fn dot(a: &[f64], b: &[f64]) -> f64 {
    let ((a, a_rest), (b, b_rest)) = (a.as_chunks::<8>(), b.as_chunks::<8>());
    let mut sums = [0.0; 8];
    for (a, b) in a.iter().zip(b) {
        for i in 0..8 {
            sums[i] += a[i] * b[i];
        }
    }
    let rest: f64 = a_rest.iter().zip(b_rest).map(|(x, y)| x * y).sum();
    sums.iter().sum::<f64>() + rest
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{Colour, noise};

    /// Rows with gaps: one of a single row, one longer than rows whitened at once.
    fn rows() -> Vec<usize> {
        [12..13, 20..31, 45..120].into_iter().flatten().collect()
    }

    #[test]
    fn verify_moments_are_the_sums_of_products() {
        let (x, rows, order) = (noise(Colour::Ar1(0.9), 130, 4), rows(), LAGS);
        let moments = second_moments(&x, &rows, order);
        for i in 0..=order {
            for j in i..=order {
                let sum: f64 = rows.iter().map(|&t| x[t - i] * x[t - j]).sum();
                assert!((moments[(i, j)] - sum).abs() < 1e-12 * moments[(i, i)]);
            }
        }
    }

    #[test]
    fn verify_whitened_is_what_the_past_does_not_predict() {
        let (x, rows) = (noise(Colour::Ar1(0.9), 130, 5), rows());
        let noise = ChannelNoise {
            ar: vec![0.8, -0.3, 0.1],
            sigma: 0.25,
        };
        let whitened = noise.whiten(&x, &rows);
        assert_eq!(whitened.len(), rows.len());
        for (&t, e) in rows.iter().zip(&whitened) {
            let predicted = 0.8 * x[t - 1] - 0.3 * x[t - 2] + 0.1 * x[t - 3];
            assert!((e - (x[t] - predicted) / 0.25).abs() < 1e-12);
        }
    }
}
