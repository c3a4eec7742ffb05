//! Paired comparison of two models on rows that neither was fitted to.

use super::data::Rows;
use super::noise::Noise;
use super::problem::Problem;
use crate::model::Columns;

/// How much the second model's error is below the first's.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Paired {
    /// Sum of the whitened squares of the first less that of the second.
    pub gain: f64,
    /// Standard error of `gain`.
    pub error: f64,
    /// Largest relative fall of a channel's rms that is beyond its own standard error; not whitened.
    pub practical: f64,
}

impl Paired {
    pub fn t(&self) -> f64 {
        if self.error > 0.0 {
            self.gain / self.error
        } else {
            0.0
        }
    }
}

/// Batches into which the rows are divided for standard errors; each is long beside the noise's memory.
const BATCHES: usize = 24;
const SHORTEST_BATCH: usize = 20;

/// Compares residuals on the rows; both are whitened alike.
pub(super) fn compare(first: &Columns, second: &Columns, noise: &Noise, rows: &Rows) -> Paired {
    let (a, b) = (noise.whiten(first, rows), noise.whiten(second, rows));
    let differences: Vec<f64> = a.iter().zip(&b).map(|(x, y)| x * x - y * y).collect();
    let (mut sums, mut start) = (Vec::new(), 0);
    for channel in &rows.per_channel {
        sums.extend(batch_sums(&differences[start..start + channel.len()]));
        start += channel.len();
    }
    let practical =
        (0..first.len()).map(|c| practical_gain(&first[c], &second[c], &rows.per_channel[c]));
    Paired {
        gain: differences.iter().sum(),
        error: error_of_sum(&sums),
        practical: practical.fold(0.0, f64::max),
    }
}

fn practical_gain(first: &[f64], second: &[f64], rows: &[usize]) -> f64 {
    let before: f64 = rows.iter().map(|&t| first[t].powi(2)).sum();
    let differences: Vec<f64> = rows
        .iter()
        .map(|&t| first[t].powi(2) - second[t].powi(2))
        .collect();
    let gain: f64 = differences.iter().sum();
    if before <= 0.0 || gain <= error_of_sum(&batch_sums(&differences)) {
        return 0.0;
    }
    1.0 - ((before - gain) / before).max(0.0).sqrt()
}

pub(super) fn batch_sums(values: &[f64]) -> Vec<f64> {
    let count = (values.len() / SHORTEST_BATCH).clamp(1, BATCHES);
    let edge = |i: usize| values.len() * i / count;
    (0..count)
        .map(|i| values[edge(i)..edge(i + 1)].iter().sum())
        .collect()
}

/// Standard error of the sum of batches.
pub(super) fn error_of_sum(sums: &[f64]) -> f64 {
    let n = sums.len() as f64;
    if n < 2.0 {
        return f64::INFINITY;
    }
    let mean = sums.iter().sum::<f64>() / n;
    let variance = sums.iter().map(|s| (s - mean).powi(2)).sum::<f64>() / (n - 1.0);
    (n * variance).sqrt()
}

/// Minus twice the profile log-likelihood of a residual on rows, with a noise model of its own.
pub(super) fn objective(
    problem: &Problem,
    residual: &Columns,
    rows: &Rows,
    orders: &[usize],
) -> f64 {
    Noise::fit(residual, rows, orders, &problem.floor).objective(rows)
}

/// Root mean square of each channel on the rows.
pub(super) fn rms(residual: &Columns, rows: &Rows) -> Vec<f64> {
    let pairs = residual.iter().zip(&rows.per_channel);
    pairs
        .map(|(column, rows)| {
            let sum: f64 = rows.iter().map(|&t| column[t].powi(2)).sum();
            (sum / rows.len().max(1) as f64).sqrt()
        })
        .collect()
}
