//! What readings leave by themselves: their rounding, and what noise of measured motion makes of a
//! prediction. Both follow the motion's signals.

use crate::diagnose::floor::EXCESS;
use crate::diagnose::problem::Problem;

/// Standard deviation of what rounding leaves of a channel whose readings hold still.
pub(super) fn rounding(problem: &Problem, channel: usize) -> f64 {
    problem.data.outputs[channel].held_step / 12_f64.sqrt()
}

/// Whether clearly more is taken of a residual than the noise of measured inputs, of this standard
/// deviation, puts there: that goes through the dynamics as the motion does.
pub(super) fn exceeds_inputs(rows: &[usize], residual: &[f64], left: &[f64], noise: f64) -> bool {
    let mean_square = |x: &[f64]| -> f64 {
        let squares = rows.iter().map(|&t| x[t].powi(2));
        squares.sum::<f64>() / rows.len().max(1) as f64
    };
    mean_square(residual) - mean_square(left) >= EXCESS * noise.powi(2)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{Colour, noise};

    /// A wave of the size of the inputs' noise is no finding, one of twice its size is.
    #[test]
    fn verify_what_is_taken_exceeds_the_noise_of_inputs_or_not() {
        for seed in 0..20 {
            let drawn = noise(Colour::White, 400, seed);
            let rows: Vec<usize> = (0..400).collect();
            let found = |size: f64| {
                let wave = |t: usize| 2_f64.sqrt() * size * (0.2 * t as f64).sin();
                let with: Vec<f64> = rows.iter().map(|&t| drawn[t] + wave(t)).collect();
                exceeds_inputs(&rows, &with, &drawn, 1.0)
            };
            assert!(!found(0.8) && found(2.0), "seed {seed}");
        }
    }
}
