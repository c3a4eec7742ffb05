//! Paired comparison of two models on rows that neither was fitted to.

use super::data::Rows;
use super::fit::Fit;
use super::floor::loss;
use super::noise::{Noise, dot};
use super::problem::Problem;
use crate::model::Columns;
use crate::stats::ratio;

/// How much the second model's error is below the first's.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Paired {
    /// Sum of the whitened squares of the first less that of the second.
    pub gain: f64,
    /// Standard error of `gain`.
    pub error: f64,
    /// Largest relative fall of a channel's rms that is beyond its own standard error; not
    /// whitened.
    pub practical: f64,
}

impl Paired {
    pub fn t(&self) -> f64 {
        ratio(self.gain, self.error)
    }
}

/// Batches into which the rows are divided for standard errors; each is long compared with the
/// noise's memory.
const BATCHES: usize = 12;
const SHORTEST_BATCH: usize = 20;

/// Compares residuals on the rows; both are whitened alike.
///
/// With `e` the second model's error and `d` what the models differ by, squares differ by
/// `d^2 + 2 d e`. The first term is the gain itself, however unevenly it falls on the batches (a
/// transient may hold most of it); only the second is chance.
pub(super) fn compare(first: &Columns, second: &Columns, noise: &Noise, rows: &Rows) -> Paired {
    let (a, b) = (noise.whiten(first, rows), noise.whiten(second, rows));
    let (mut gain, mut sums, mut start) = (0.0, Vec::new(), 0);
    for channel in &rows.per_channel {
        let range = start..start + channel.len();
        start = range.end;
        let (own, chance) = differences(&a[range.clone()], &b[range]);
        gain += own;
        sums.extend(chance);
    }
    let practical = (0..first.len()).map(|c| {
        let pick =
            |x: &Columns| -> Vec<f64> { rows.per_channel[c].iter().map(|&t| x[c][t]).collect() };
        practical_gain(&pick(first), &pick(second))
    });
    // Whitened, the second model's error has unit variance if it is noise; batches cannot be surer
    // than that.
    let distance: f64 = a.iter().zip(&b).map(|(x, y)| (x - y).powi(2)).sum();
    Paired {
        gain,
        error: dot(&sums, &sums).max(4.0 * distance).sqrt(),
        practical: practical.fold(0.0, f64::max),
    }
}

/// The fall of the sum of squares, and what is chance in it by batches.
pub(super) fn differences(first: &[f64], second: &[f64]) -> (f64, Vec<f64>) {
    let gain = dot(first, first) - dot(second, second);
    let chance: Vec<f64> = first
        .iter()
        .zip(second)
        .map(|(a, b)| 2.0 * (a - b) * b)
        .collect();
    (gain, batch_sums(&chance))
}

fn practical_gain(first: &[f64], second: &[f64]) -> f64 {
    let (gain, chance) = differences(first, second);
    let before = dot(first, first);
    if before <= 0.0 || gain <= dot(&chance, &chance).sqrt() {
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

/// By how much the larger model brings what is left nearer to noise of the sizes that are known, in
/// minus twice the log-likelihood.
pub(super) fn gain_in_size(problem: &Problem, small: &Fit, large: &Fit, rows: &Rows) -> f64 {
    let [small, large] = [small, large].map(|fit| loss(&problem.known, &fit.residual, rows));
    small - large
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
