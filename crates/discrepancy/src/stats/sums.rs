//! Covariance of weighted sums of coloured noise.

use nalgebra::DMatrix;
use statrs::function::gamma::digamma;
use truecut_recording::fft::{Complex64, forward};

use super::background::Background;
use super::ratio;
use super::spectrum::padded_length;

/// Covariance of sums `Σ column[t] · noise[t]`.
#[derive(Clone, Debug, PartialEq)]
pub struct SumCovariance {
    /// One row and column for each column of weights.
    pub matrix: DMatrix<f64>,
    /// Degrees of freedom of the matrix's scale.
    pub degrees: f64,
}

/// Covariance of the sums of noise with this background under columns of weights, which are zero
/// where a sample is not valid: `∫ Bᵢ* Bⱼ S df`, on a grid fine enough that nothing wraps around.
///
/// Exact for the given density, for any weights: no model of the weights is assumed. For weights of
/// ones it is the variance of a sum; for a series it is Bartlett's formula for a cross-correlation
/// with the series as it is.
pub fn sum_covariance(columns: &[Vec<f64>], background: &Background) -> SumCovariance {
    let samples = columns.first().map_or(0, Vec::len);
    let length = padded_length(samples);
    let transforms: Vec<Vec<Complex64>> = columns
        .iter()
        .map(|column| forward(column.clone(), length))
        .collect();
    let density = density_on_grid(background, length);
    let entry = |i: usize, j: usize| -> f64 {
        let bins = transforms[i].iter().zip(&transforms[j]).zip(&density);
        bins.map(|((a, b), s)| (a.conj() * b).re * s).sum::<f64>() / length as f64
    };
    let count = columns.len();
    let mut matrix = DMatrix::zeros(count, count);
    for i in 0..count {
        for j in 0..=i {
            matrix[(i, j)] = entry(i, j);
            matrix[(j, i)] = matrix[(i, j)];
        }
    }
    let power: Vec<f64> = (0..density.len())
        .map(|bin| {
            let share = |i: usize| ratio(transforms[i][bin].norm_sqr(), matrix[(i, i)]);
            (0..count).map(share).sum::<f64>() * density[bin]
        })
        .collect();
    let degrees = degrees(&power, background, length);
    SumCovariance {
        matrix: matrix * unbiased(degrees),
        degrees,
    }
}

/// The density at the bins of a transform of `length`, doubled where a bin stands for its mirror
/// image too.
pub(crate) fn density_on_grid(background: &Background, length: usize) -> Vec<f64> {
    let width = 1.0 / length as f64;
    let last = length / 2;
    let inside = |bin: usize| background.density(bin as f64 * width);
    let mut density: Vec<f64> = (0..=last)
        .map(|bin| if bin == 0 { 0.0 } else { 2.0 * inside(bin) })
        .collect();
    density[0] = background.mean_density_below(0.5 * width);
    density[last] *= 0.5;
    density
}

/// Degrees of freedom of a mean of densities with these weights: 2 over the variance of its
/// logarithm. Errors of densities within an interval are fully correlated, others independent.
pub(crate) fn degrees(weights: &[f64], background: &Background, length: usize) -> f64 {
    let total: f64 = weights.iter().sum();
    let cell = (background.stretch() * length as f64).max(1.0) as usize;
    let deviation = |(bin, weight): (usize, &f64)| {
        weight * background.log_variance(bin as f64 / length as f64).sqrt()
    };
    let terms: Vec<f64> = weights.iter().enumerate().map(deviation).collect();
    let squares = terms
        .chunks(cell)
        .map(|cell| cell.iter().sum::<f64>().powi(2));
    let variance = squares.sum::<f64>() / (total * total);
    if variance > 0.0 {
        2.0 / variance
    } else {
        f64::INFINITY
    }
}

/// A variance estimated from densities is unbiased in its logarithm, the denominator of F and of
/// Student's t in its mean; this is the factor between them.
pub(crate) fn unbiased(degrees: f64) -> f64 {
    if degrees > 1e6 {
        1.0
    } else {
        (digamma(0.5 * degrees) - (0.5 * degrees).ln()).exp()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stats::distributions::t_quantile;
    use crate::testing::{Colour, noise};

    /// How often a sum over AR(1) noise lies outside the record's own 95 % interval: the mean, and
    /// a square wave. Within three standard errors of a rate found in 400 records.
    #[test]
    fn verify_stated_intervals_hold() {
        let samples = 2048;
        let square = |row: usize| {
            if (row / 100).is_multiple_of(2) {
                1.0
            } else {
                -1.0
            }
        };
        let columns = vec![vec![1.0; samples], (0..samples).map(square).collect()];
        let mut outside = [0; 2];
        for seed in 0..400 {
            let values = noise(Colour::Ar1(0.8), samples, seed);
            let background = Background::of(&values, &vec![true; samples]).unwrap();
            let covariance = sum_covariance(&columns, &background);
            for i in 0..2 {
                let sum: f64 = columns[i].iter().zip(&values).map(|(a, b)| a * b).sum();
                let width = t_quantile(0.05, covariance.degrees);
                outside[i] += usize::from(sum.abs() > width * covariance.matrix[(i, i)].sqrt());
            }
        }
        let share = outside.map(|count| count as f64 / 400.0);
        assert!(
            share.iter().all(|share| (0.017..0.083).contains(share)),
            "{share:?}"
        );
    }
}
