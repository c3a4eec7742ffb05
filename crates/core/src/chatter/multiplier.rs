//! What a Floquet multiplier says of a cut.

use nalgebra::Complex;
use std::f64::consts::TAU;

use super::TipMode;

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
    /// it and its mirror image about every multiple of the tooth-passing frequency. The one near a
    /// natural frequency dominates.
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

    /// Of the frequencies of such a vibration the one that the tool answers most, Hz.
    pub fn chatter_hz(&self, modes: &[TipMode], tooth_period_s: f64) -> f64 {
        let natural = modes.iter().map(|m| m.natural_frequency_rad_s);
        let highest = natural.fold(0.0, f64::max) * 1.5;
        let answer = |omega: f64| -> f64 {
            let of_mode =
                |m: &TipMode| m.shape_per_sqrt_kg.norm_squared() * m.receptance_s2(omega).norm();
            modes.iter().map(of_mode).sum()
        };
        let frequencies = self.frequencies_rad_s(tooth_period_s, highest);
        let strongest = frequencies
            .into_iter()
            .max_by(|a, b| answer(*a).total_cmp(&answer(*b)));
        strongest.unwrap_or(0.0) / TAU
    }
}
