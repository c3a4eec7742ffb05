//! Autoregressive models of coloured noise.

use super::blocks::contiguous_blocks;

/// `x[t] − mean = Σ a[k] (x[t−1−k] − mean) + e[t]`, with e white.
#[derive(Clone, Debug, PartialEq)]
pub struct Ar {
    /// Mean of the valid samples.
    pub mean: f64,
    /// `a`; its length is the order.
    pub coefficients: Vec<f64>,
    /// Variance of e.
    pub innovation_variance: f64,
    /// Number of samples used.
    pub samples: usize,
}

/// Highest order tried by default: 10 log₁₀ N, at most N/10 and 64.
pub fn default_order_cap(samples: usize) -> usize {
    let by_logarithm = (10.0 * (samples.max(1) as f64).log10()) as usize;
    by_logarithm.min(samples / 10).min(64)
}

/// Forward and backward prediction errors of one run of samples.
struct Errors {
    forward: Vec<f64>,
    backward: Vec<f64>,
}

impl Ar {
    /// Fits by Burg's method, jointly over all runs of valid samples (`dewaele2000`), with the
    /// order from 0 to `highest` that predicts best by Akaike's corrected criterion: never too
    /// short for whitening. Runs no longer than an order do not take part in it.
    ///
    /// `None` for fewer than eight samples, or a valid one that is not finite. A constant
    /// series gives order 0 and variance 0.
    pub fn fit(values: &[f64], valid: &[bool], highest: usize) -> Option<Ar> {
        let runs = contiguous_blocks(valid, 1);
        let samples: usize = runs.iter().map(ExactSizeIterator::len).sum();
        let counted = || runs.iter().flat_map(|run| &values[run.clone()]);
        if samples < 8 || counted().any(|value| !value.is_finite()) {
            return None;
        }
        let mean = counted().sum::<f64>() / samples as f64;
        let mut errors: Vec<Errors> = runs
            .iter()
            .map(|run| {
                let centred: Vec<f64> = values[run.clone()].iter().map(|x| x - mean).collect();
                Errors {
                    forward: centred.clone(),
                    backward: centred,
                }
            })
            .collect();
        let variance = counted().map(|x| (x - mean).powi(2)).sum::<f64>() / samples as f64;
        let mut best = Ar {
            mean,
            coefficients: Vec::new(),
            innovation_variance: variance,
            samples,
        };
        let mut current = best.clone();
        let mut best_score = best.score();
        // A constant up to rounding has no noise.
        if variance <= (8.0 * f64::EPSILON * mean.abs()).powi(2) {
            best.innovation_variance = 0.0;
            return Some(best);
        }
        for order in 1..=highest.min(samples.saturating_sub(4)) {
            let Some(reflection) = reflect(&mut errors, order) else {
                break;
            };
            current.lengthen(reflection);
            let score = current.score();
            if score < best_score {
                best_score = score;
                best = current.clone();
            }
        }
        Some(best)
    }

    /// Levinson's recursion.
    fn lengthen(&mut self, reflection: f64) {
        let old = self.coefficients.clone();
        for (new, mirrored) in self.coefficients.iter_mut().zip(old.iter().rev()) {
            *new -= reflection * mirrored;
        }
        self.coefficients.push(reflection);
        self.innovation_variance *= 1.0 - reflection * reflection;
    }

    /// The number of coefficients.
    pub fn order(&self) -> usize {
        self.coefficients.len()
    }

    /// The innovations of a series, in its unit, and which of them exist: not the first `order`
    /// of each run of valid samples.
    pub fn whiten(&self, values: &[f64], valid: &[bool]) -> (Vec<f64>, Vec<bool>) {
        let order = self.order();
        let mut filtered = vec![f64::NAN; values.len()];
        let mut exists = vec![false; values.len()];
        for run in contiguous_blocks(valid, order + 1) {
            for row in run.start + order..run.end {
                let past = values[row - order..row].iter().rev();
                let predicted: f64 = self
                    .coefficients
                    .iter()
                    .zip(past)
                    .map(|(a, x)| a * (x - self.mean))
                    .sum();
                filtered[row] = values[row] - self.mean - predicted;
                exists[row] = true;
            }
        }
        (filtered, exists)
    }

    /// Akaike's corrected criterion.
    fn score(&self) -> f64 {
        let samples = self.samples as f64;
        let parameters = self.order() as f64 + 2.0; // with mean and variance
        let room = (samples - parameters - 1.0).max(1.0);
        samples * self.innovation_variance.ln() + 2.0 * parameters * samples / room
    }
}

/// One step of Burg's recursion over all runs: the reflection coefficient of `order`, and the
/// errors of the new order. `None` if the prediction is exact.
fn reflect(errors: &mut [Errors], order: usize) -> Option<f64> {
    let (mut product, mut power) = (0.0, 0.0);
    for run in errors.iter() {
        // Errors of order m exist from row m on; the backward error is taken one row earlier.
        for row in order..run.forward.len() {
            let (ahead, behind) = (run.forward[row], run.backward[row - 1]);
            product += ahead * behind;
            power += ahead * ahead + behind * behind;
        }
    }
    if power.is_nan() || power <= 0.0 {
        return None;
    }
    let reflection = 2.0 * product / power;
    for run in errors.iter_mut() {
        for row in (order..run.forward.len()).rev() {
            let (ahead, behind) = (run.forward[row], run.backward[row - 1]);
            run.forward[row] = ahead - reflection * behind;
            run.backward[row] = behind - reflection * ahead;
        }
    }
    (reflection.abs() < 1.0).then_some(reflection)
}

#[cfg(test)]
mod tests;
