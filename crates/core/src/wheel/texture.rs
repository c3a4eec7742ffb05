//! Texture of a wheel's running surface: seeded unevenness that comes round with every turn.
//!
//! Along the circle that touches, of circumference C, the radius deviates by a normal process of
//! correlation `exp(-s²/ℓ²)`, periodic in C: harmonics k of random phase and size with variances in
//! proportion to `exp(-(π k ℓ/C)²)`, k from 1 on. A patch of radius c feels its mean over the disc,
//! which leaves `2 J1(q c)/(q c)` of a wave of q = 2πk/C.

use super::quadrature::Quadrature;
use std::f64::consts::{PI, TAU};

/// Waves with less than this part of the largest one's variance are left out.
const LEAST: f64 = 1e-6;
/// Most waves on a circumference.
pub const MOST_WAVES: usize = 2000;

/// How uneven the surface is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Texture {
    /// Root of the mean square of the radius' deviation.
    pub rms_m: f64,
    /// Correlation length ℓ.
    pub length_m: f64,
}

/// Mean deviation under a patch by the angle of the wheel.
#[derive(Debug, Clone, PartialEq)]
pub struct PatchTexture {
    /// Cosine and sine of each harmonic, from the first on, m.
    waves_m: Vec<[f64; 2]>,
}

impl Texture {
    /// Waves on a circumference that count.
    pub fn waves(&self, circumference_m: f64) -> usize {
        let most = (-LEAST.ln()).sqrt() * circumference_m / (PI * self.length_m);
        (most.ceil() as usize).max(1)
    }

    /// What a patch feels of a texture; `normal` gives independent standard normal numbers.
    pub fn under_patch(
        &self,
        circumference_m: f64,
        patch_radius_m: f64,
        mut normal: impl FnMut() -> f64,
    ) -> PatchTexture {
        let waves = self.waves(circumference_m);
        let variance =
            |k: usize| (-(PI * k as f64 * self.length_m / circumference_m).powi(2)).exp();
        let all: f64 = (1..=waves).map(variance).sum();
        let nodes = Quadrature::new(64);
        let waves_m = (1..=waves).map(|k| {
            let size_m = self.rms_m * (variance(k) / all).sqrt();
            let turns = TAU * k as f64 / circumference_m * patch_radius_m;
            // mean of cos(q x) over a disc, x = c sin φ
            let felt = nodes.integrate(-0.5 * PI, 0.5 * PI, |phi| {
                2.0 / PI * phi.cos().powi(2) * (turns * phi.sin()).cos()
            });
            [size_m * felt * normal(), size_m * felt * normal()]
        });
        PatchTexture {
            waves_m: waves_m.collect(),
        }
    }
}

impl PatchTexture {
    /// Deviation (m) and its rate (m/s) at an angle of the wheel that turns at a rate.
    pub fn at(&self, angle_rad: f64, rate_rad_s: f64) -> [f64; 2] {
        let (mut deviation, mut slope) = (0.0, 0.0);
        let (sine, cosine) = angle_rad.sin_cos();
        let (mut s, mut c) = (sine, cosine);
        for (k, [a, b]) in (1..).zip(&self.waves_m) {
            deviation += a * c + b * s;
            slope += f64::from(k) * (b * c - a * s);
            (s, c) = (s * cosine + c * sine, c * cosine - s * sine);
        }
        [deviation, slope * rate_rad_s]
    }

    /// The highest harmonic that holds more than a thousandth of the variance, 0 for none.
    pub fn highest_harmonic(&self) -> usize {
        let square = |wave: &[f64; 2]| wave[0] * wave[0] + wave[1] * wave[1];
        let all: f64 = self.waves_m.iter().map(square).sum();
        let counts = |wave: &[f64; 2]| square(wave) > 1e-3 * all;
        self.waves_m.iter().rposition(counts).map_or(0, |k| k + 1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Signs in a fixed order: unit variance, and of a wave the same size whatever its phase.
    fn signs() -> impl FnMut() -> f64 {
        let mut k = 0_u32;
        move || {
            k += 1;
            if k.count_ones().is_multiple_of(2) {
                1.0
            } else {
                -1.0
            }
        }
    }

    #[test]
    fn verify_variance_correlation_and_rate() {
        let texture = Texture {
            rms_m: 10e-6,
            length_m: 3e-3,
        };
        let circumference = 43e-3;
        let surface = texture.under_patch(circumference, 0.0, signs());
        let n = 4096;
        let angle = |k: usize| TAU * k as f64 / n as f64;
        let at: Vec<f64> = (0..n).map(|k| surface.at(angle(k), 1.0)[0]).collect();
        let product = |shift: usize| {
            (0..n).map(|k| at[k] * at[(k + shift) % n]).sum::<f64>() / n as f64 / 1e-10
        };
        assert!((product(0) - 1.0).abs() < 1e-6);
        for shift in [100, 200, 300] {
            let way = circumference * shift as f64 / n as f64;
            let expected = (-(way / 3e-3_f64).powi(2)).exp();
            // without its mean (k = 0) a short circle lies lower by the share of that
            let mean = PI.sqrt() * 3e-3 / circumference;
            let expected = (expected - mean) / (1.0 - mean);
            assert!((product(shift) - expected).abs() < 2e-3, "{shift}");
        }
        let h = 1e-6;
        let difference = (surface.at(0.7 + h, 1.0)[0] - surface.at(0.7 - h, 1.0)[0]) / (2.0 * h);
        assert!((surface.at(0.7, 120.0)[1] / (120.0 * difference) - 1.0).abs() < 1e-6);
    }

    /// `2 J1(x)/x` by its series.
    #[test]
    fn verify_a_patch_feels_the_mean_over_its_disc() {
        let texture = Texture {
            rms_m: 1.0,
            length_m: 5e-3,
        };
        let (circumference, radius) = (43e-3, 4.5e-3);
        let sharp = texture.under_patch(circumference, 0.0, signs());
        let felt = texture.under_patch(circumference, radius, signs());
        for (k, (a, b)) in sharp.waves_m.iter().zip(&felt.waves_m).enumerate().take(8) {
            let x = TAU * (k + 1) as f64 / circumference * radius;
            let (mut term, mut sum) = (1.0, 1.0);
            for m in 1..40 {
                term *= -0.25 * x * x / f64::from(m * (m + 1));
                sum += term;
            }
            assert!((b[0] / a[0] - sum).abs() < 1e-9, "{k}");
        }
        assert!(felt.highest_harmonic() < sharp.highest_harmonic());
    }
}
