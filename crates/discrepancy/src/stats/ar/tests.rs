use super::*;
use crate::testing::{Colour, noise};

fn all(count: usize) -> Vec<bool> {
    vec![true; count]
}

fn autocorrelation(values: &[f64], lag: usize) -> f64 {
    let square: f64 = values.iter().map(|x| x * x).sum();
    let product: f64 = values[lag..].iter().zip(values).map(|(a, b)| a * b).sum();
    product / square
}

/// x[t] = 1.5 x[t−1] − 0.8 x[t−2] + e, five standard errors either way; then with a fifth of the
/// record cut out.
#[test]
fn verify_known_model_is_found_with_and_without_gaps() {
    let drive = noise(Colour::White, 20_000, 1);
    let mut values = vec![0.0; drive.len()];
    for row in 2..drive.len() {
        values[row] = 1.5 * values[row - 1] - 0.8 * values[row - 2] + drive[row];
    }
    values.iter_mut().for_each(|value| *value += 7.0);
    let mut valid = all(values.len());
    for gaps in [false, true] {
        if gaps {
            for start in (0..values.len()).step_by(500) {
                valid[start..start + 100].fill(false);
                values[start..start + 100].fill(f64::NAN);
            }
        }
        let model = Ar::fit(&values, &valid, 2).unwrap();
        assert_eq!(model.order(), 2, "{model:?}");
        assert!((model.coefficients[0] - 1.5).abs() < 0.024, "{model:?}");
        assert!((model.coefficients[1] + 0.8).abs() < 0.024, "{model:?}");
        assert!((model.innovation_variance - 1.0).abs() < 0.056, "{model:?}");
        let (white, exists) = model.whiten(&values, &valid);
        let kept: Vec<f64> = white
            .iter()
            .zip(&exists)
            .filter(|(_, e)| **e)
            .map(|(x, _)| *x)
            .collect();
        let lost = if gaps { 40 * 102 } else { 2 };
        assert_eq!(kept.len(), values.len() - lost);
        assert!(autocorrelation(&kept, 1).abs() < 5.0 / (kept.len() as f64).sqrt());
    }
}

#[test]
fn nothing_to_fit_is_said() {
    assert_eq!(Ar::fit(&[1.0; 7], &all(7), 3), None);
    let flat = Ar::fit(&[0.1; 50], &all(50), 3).unwrap();
    assert_eq!((flat.order(), flat.innovation_variance), (0, 0.0));
    let mut values = vec![1.0; 50];
    values[3] = f64::NAN;
    assert_eq!(Ar::fit(&values, &all(50), 3), None);
}
