//! Figures of a surface profile.

/// Arithmetic mean deviation Ra of a profile from its mean line, in the profile's unit.
///
/// No cut-off is applied: of a profile around a rim this is the roughness that vibration leaves
/// (`Ra = 2a/π` for a wave of amplitude a), not that of tool marks, which the profile does not
/// hold.
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

/// How polishing smooths: `Ra = Ra∞ + (Ra0 - Ra∞) e^{-D/D0}`, D the local dose `∫ p v dt`.
///
/// Commonly written over time; with the dose in its place a cell that the patch passes quickly, or
/// presses lightly, stays rougher, and at constant pressure and speed it is the same law with
/// `τ = D0/(p v)`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Polishing {
    /// Ra before, m.
    pub initial_m: f64,
    /// Ra that this abrasive leaves in the end, m.
    pub final_m: f64,
    /// Dose that takes away all but 1/e of the difference, J/m².
    pub dose_j_per_m2: f64,
}

impl Polishing {
    /// Ra after a dose, m.
    pub fn ra_m(&self, dose_j_per_m2: f64) -> f64 {
        let left = (-dose_j_per_m2 / self.dose_j_per_m2).exp();
        self.final_m + (self.initial_m - self.final_m) * left
    }

    /// The law that leaves `reached` (between initial and final Ra) after a dose, or none if no
    /// such law exists.
    pub fn through(
        initial_m: f64,
        final_m: f64,
        reached_m: f64,
        dose_j_per_m2: f64,
    ) -> Option<Self> {
        let left = (reached_m - final_m) / (initial_m - final_m);
        (left > 0.0 && left < 1.0 && dose_j_per_m2 > 0.0).then(|| Self {
            initial_m,
            final_m,
            dose_j_per_m2: -dose_j_per_m2 / left.ln(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `cai2016precession`: 0.8 µm before, 0.32 µm after. Two passes of half the dose are one of
    /// the whole.
    #[test]
    fn verify_roughness_follows_the_dose_however_it_is_given() {
        let (before, after, end) = (0.8e-6, 0.32e-6, 0.1e-6);
        let p = Polishing::through(before, end, after, 5e5).unwrap();
        assert!((p.ra_m(5e5) - after).abs() < 1e-15);
        assert_eq!(p.ra_m(0.0), before);
        let half = Polishing {
            initial_m: p.ra_m(2.5e5),
            ..p
        };
        assert!((half.ra_m(2.5e5) - after).abs() < 1e-15);
        assert!((p.ra_m(1e9) - end).abs() < 1e-15);
        assert!(Polishing::through(before, 0.4e-6, after, 5e5).is_none());
        // d Ra / d t = -(Ra - Ra_inf) p v / D0
        let rate = (p.ra_m(2e5 + 1.0) - p.ra_m(2e5 - 1.0)) / 2.0;
        assert!((rate / (-(p.ra_m(2e5) - end) / p.dose_j_per_m2) - 1.0).abs() < 1e-6);
    }

    /// `docs/physics/roughness.md`: vibration Ra = 2a/π; 2.5 µm of vibration is Ra 1.6 µm.
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
