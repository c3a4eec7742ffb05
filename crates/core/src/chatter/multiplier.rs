//! What a Floquet multiplier says of a cut.

use nalgebra::Complex;
use std::f64::consts::TAU;

/// The dominant Floquet multiplier over a tooth period.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Multiplier {
    pub value: Complex<f64>,
}

impl Multiplier {
    /// |μ|; stable below 1.
    pub fn magnitude(&self) -> f64 {
        self.value.norm()
    }

    pub fn is_stable(&self) -> bool {
        self.magnitude() < 1.0
    }

    /// Growth rate of the vibration, 1/s: ln|μ| / T.
    pub fn growth_per_s(&self, tooth_period_s: f64) -> f64 {
        self.magnitude().ln() / tooth_period_s
    }

    /// arg μ / T in [0, π/T], rad/s: the lowest frequency that such a vibration can have.
    pub fn base_frequency_rad_s(&self, tooth_period_s: f64) -> f64 {
        self.value.arg().abs() / tooth_period_s
    }

    /// All frequencies of such a vibration up to `highest_rad_s`, rising: the base frequency, and
    /// it and its mirror image about every multiple of the tooth-passing frequency. Which of them
    /// is the strongest is asked of [`super::spectral_elements::AtSpeed::chatter_hz`].
    pub fn frequencies_rad_s(&self, tooth_period_s: f64, highest_rad_s: f64) -> Vec<f64> {
        let base = self.base_frequency_rad_s(tooth_period_s);
        let passing = TAU / tooth_period_s;
        let pairs = (0..).map(|k| passing * f64::from(k));
        let all = pairs
            .take_while(|center| center - base <= highest_rad_s)
            .flat_map(|center| [center - base, center + base]);
        let mut found: Vec<f64> = all.filter(|f| (0.0..=highest_rad_s).contains(f)).collect();
        found.sort_by(f64::total_cmp);
        found.dedup();
        found
    }
}
