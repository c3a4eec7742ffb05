//! Readings that come in steps.

/// Step between readings most of which are those of the sample before: what rounding leaves of them
/// is no noise that another period would show. Zero where they are not.
pub(crate) fn held_step(values: &[f64], valid: &[bool]) -> f64 {
    let steps: Vec<f64> = (values.windows(2).zip(valid.windows(2)))
        .filter(|(_, valid)| valid[0] && valid[1])
        .map(|(pair, _)| (pair[1] - pair[0]).abs())
        .collect();
    let dust = 1e-9 * steps.iter().copied().fold(0.0, f64::max);
    let moved = || steps.iter().copied().filter(|step| *step > dust);
    match 2 * moved().count() < steps.len() {
        true => moved().reduce(f64::min).unwrap_or(0.0),
        false => 0.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{Colour, noise};

    /// Steps far above the noise hold readings still, and are told; noise of the size of a step
    /// moves them.
    #[test]
    fn verify_steps_are_told_where_they_hold_readings_still() {
        for seed in 0..20 {
            let drawn = noise(Colour::White, 3000, seed);
            let step = 0.5 + 0.1 * seed as f64;
            let rounded = |level: f64| -> Vec<f64> {
                let moved = |k: usize| 3.0 * (0.01 * k as f64 + seed as f64).sin();
                let rows = drawn.iter().enumerate();
                rows.map(|(k, n)| ((moved(k) + level * step * n) / step).round() * step)
                    .collect()
            };
            let valid = vec![true; 3000];
            let found = held_step(&rounded(0.05), &valid);
            assert!((found / step - 1.0).abs() < 1e-9, "{found} for {step}");
            assert_eq!(held_step(&rounded(1.0), &valid), 0.0);
        }
    }
}
