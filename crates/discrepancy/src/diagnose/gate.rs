//! Whether the experiment excites the outputs beyond noise.

use super::problem::Problem;
use crate::model::Columns;
use crate::stats::deviation;

/// An output must move by so many times its noise; what can be seen in fainter motion is found by
/// the screening.
const LEAST_MOTION: f64 = 0.5;

/// What is missing, where no output moves beyond its noise.
pub(super) fn unexcited(problem: &Problem, nominal: &Columns) -> Option<Vec<String>> {
    if problem.model.is_steady() {
        return None;
    }
    let mut missing = Vec::new();
    for (c, spec) in problem.model.channels().iter().enumerate() {
        let output = &problem.data.outputs[c];
        let valid: Vec<usize> = (0..output.values.len())
            .filter(|&t| output.valid[t])
            .collect();
        let noise = output
            .noise
            .unwrap_or_else(|| noise_level(&output.values, &valid));
        let moved: Vec<f64> = valid.iter().map(|&t| nominal[c][t]).collect();
        let motion = deviation(&moved);
        if motion > LEAST_MOTION * noise {
            return None;
        }
        missing.push(format!(
            "`{}` moves by {} {unit} rms, its noise is {} {unit}",
            spec.name,
            truecut_recording::significant(motion, 2),
            truecut_recording::significant(noise, 2),
            unit = spec.unit,
        ));
    }
    Some(missing)
}

/// White noise on a smooth signal, from second differences.
fn noise_level(values: &[f64], rows: &[usize]) -> f64 {
    let triples = rows.windows(3).filter(|w| w[2] == w[0] + 2);
    let squares: Vec<f64> = triples
        .map(|w| (values[w[0]] - 2.0 * values[w[1]] + values[w[2]]).powi(2) / 6.0)
        .collect();
    (squares.iter().sum::<f64>() / squares.len().max(1) as f64).sqrt()
}
