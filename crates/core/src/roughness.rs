//! Figures of a surface profile.

/// Arithmetic mean deviation Ra of a profile from its mean line, in the profile's unit.
///
/// No cut-off is applied: of a profile around a rim this is the roughness that vibration leaves
/// (`Ra = 2a/π` for a wave of amplitude a), not that of tool marks, which the profile does not hold.
pub fn arithmetic_mean_deviation(profile: &[f64]) -> f64 {
    if profile.is_empty() {
        return 0.0;
    }
    let n = profile.len() as f64;
    let mean = profile.iter().sum::<f64>() / n;
    profile.iter().map(|x| (x - mean).abs()).sum::<f64>() / n
}

/// Largest minus smallest value of a profile.
pub fn spread(profile: &[f64]) -> f64 {
    let (low, high) = profile
        .iter()
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| {
            (l.min(*x), h.max(*x))
        });
    if low <= high { high - low } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `spec` section 5: vibration Ra = 2a/π; 2.5 µm of vibration is Ra 1.6 µm.
    #[test]
    fn verify_wave_of_amplitude_a_has_ra_two_a_over_pi() {
        let a = 2.5e-6;
        let profile: Vec<f64> = (0..1440)
            .map(|i| 1e-3 + a * (std::f64::consts::TAU * 7.0 * i as f64 / 1440.0).sin())
            .collect();
        let ra = arithmetic_mean_deviation(&profile);
        assert!((ra / (2.0 * a / std::f64::consts::PI) - 1.0).abs() < 1e-3);
        assert!((ra - 1.59e-6).abs() < 0.01e-6);
        assert!((spread(&profile) / (2.0 * a) - 1.0).abs() < 1e-4);
    }

    #[test]
    fn verify_flat_and_empty_profiles_have_none() {
        assert_eq!(arithmetic_mean_deviation(&[2.0; 5]), 0.0);
        assert_eq!(arithmetic_mean_deviation(&[]), 0.0);
        assert_eq!(spread(&[]), 0.0);
    }
}
