//! What is drawn for nominal values that are not known exactly.

use statrs::distribution::{ContinuousCDF, Normal};

use crate::uncertain::UncertainSpec;

/// Standard deviations at which values end on either side, as in a diagnosis.
const MOST_SIGMAS: f64 = 3.0;

/// What is drawn for an uncertain value: a normal distribution that ends on both sides.
#[derive(Debug, Clone, PartialEq)]
pub struct UncertainLaw {
    /// Dotted key of the scenario.
    pub key: String,
    normal: Normal,
    /// Parts of the whole distribution below its ends.
    ends: [f64; 2],
}

impl UncertainLaw {
    /// That of a value, in SI, within three standard deviations and the range that its key may
    /// have.
    pub fn of(uncertain: &UncertainSpec, range: [f64; 2]) -> Self {
        let (middle, sigma) = (uncertain.value, uncertain.sigma);
        let normal = Normal::new(middle, sigma).unwrap_or_else(|_| Normal::standard());
        let reach = MOST_SIGMAS * sigma;
        let ends = [range[0].max(middle - reach), range[1].min(middle + reach)];
        Self {
            key: uncertain.key.clone(),
            ends: ends.map(|end| normal.cdf(end)),
            normal,
        }
    }

    /// The value, SI, below which a share, above 0 and below 1, of all lie.
    pub fn value_at(&self, share: f64) -> f64 {
        let [low, high] = self.ends;
        self.normal.inverse_cdf(low + (high - low) * share)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn law(value: f64, sigma: f64, range: [f64; 2]) -> UncertainLaw {
        let key = "robot.stiffness_scale".to_owned();
        UncertainLaw::of(&UncertainSpec { key, value, sigma }, range)
    }

    #[test]
    fn verify_quartiles_of_a_normal_spread() {
        let law = law(2.0, 0.1, [0.0, 1e18]);
        let quartile = 0.1 * 0.672_366;
        assert!((law.value_at(0.5) - 2.0).abs() < 1e-6);
        assert!(
            (law.value_at(0.75) - 2.0 - quartile).abs() < 1e-6,
            "{}",
            law.value_at(0.75)
        );
    }

    #[test]
    fn values_stay_within_three_deviations_and_their_range() {
        let last = 1.0 - f64::from(f32::EPSILON);
        let wide = law(1.0, 0.1, [0.0, 1e18]);
        assert!(
            (wide.value_at(1e-8) - 0.7).abs() < 1e-4 && (wide.value_at(last) - 1.3).abs() < 1e-4
        );
        let short = law(1.0, 0.6, [0.0, 1.5]);
        assert!(short.value_at(1e-8) > 0.0 && short.value_at(last) < 1.5);
    }
}
