//! Figures of a finished surface.

/// Figures of one row of the surface, all along the feed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FinishFigures {
    /// Surface location error: mean of what is left above the nominal surface, m; negative if too
    /// much was taken.
    pub location_error_m: f64,
    /// Largest minus smallest, m: the scallop of a steady cut.
    pub peak_to_valley_m: f64,
    /// Ra about the mean, m.
    pub arithmetic_deviation_m: f64,
    /// Rq about the mean, m.
    pub rms_deviation_m: f64,
}

/// Figures of a profile (m); `None` if it is empty or holds a ray that was never cut.
pub fn figures(left_m: &[f64]) -> Option<FinishFigures> {
    if left_m.is_empty() || left_m.iter().any(|x| !x.is_finite()) {
        return None;
    }
    let count = left_m.len() as f64;
    let mean = left_m.iter().sum::<f64>() / count;
    let squares = left_m.iter().map(|x| (x - mean).powi(2)).sum::<f64>();
    Some(FinishFigures {
        location_error_m: mean,
        peak_to_valley_m: crate::roughness::spread(left_m),
        arithmetic_deviation_m: crate::roughness::arithmetic_mean_deviation(left_m),
        rms_deviation_m: (squares / count).sqrt(),
    })
}

#[cfg(test)]
pub(crate) mod marks;

#[cfg(test)]
mod tests {
    use super::marks::{feed_mark_height_m, strongest_wave};
    use super::*;
    use std::f64::consts::TAU;

    #[test]
    fn verify_figures_of_a_wave() {
        let (a, offset) = (3e-6, 8e-6);
        let wave: Vec<f64> = (0..4000)
            .map(|i| offset + a * (TAU * f64::from(i) * 12.3 / 4000.0).sin())
            .collect();
        let found = figures(&wave).expect("finite");
        assert!((found.location_error_m / offset - 1.0).abs() < 0.02);
        assert!((found.peak_to_valley_m / (2.0 * a) - 1.0).abs() < 1e-3);
        assert!(
            (found.arithmetic_deviation_m / (2.0 * a / std::f64::consts::PI) - 1.0).abs() < 0.02
        );
        assert!((found.rms_deviation_m / (a / 2f64.sqrt()) - 1.0).abs() < 0.02);
        let strongest = strongest_wave(&wave, 1e-5, 1e-4).expect("a wave");
        assert!((strongest.wavelength_m / (0.04 / 12.3) - 1.0).abs() < 0.01);
        assert!((strongest.amplitude_m / a - 1.0).abs() < 0.05);
    }

    #[test]
    fn unfinished_profiles_have_no_figures() {
        assert!(figures(&[]).is_none());
        assert!(figures(&[1.0, f64::NAN]).is_none());
        assert!(strongest_wave(&[0.0; 4], 1.0, 2.0).is_none());
    }

    #[test]
    fn verify_feed_mark_is_a_sagitta() {
        let exact = 8e-3 - (8e-3_f64.powi(2) - 5e-5_f64.powi(2)).sqrt();
        assert!((feed_mark_height_m(8e-3, 1e-4) / exact - 1.0).abs() < 1e-6);
        assert!((feed_mark_height_m(8e-3, 1e-4) / (1e-8 / 64e-3) - 1.0).abs() < 1e-4);
    }
}
