//! Marks on a finished surface that tests look for.

use super::*;
use std::f64::consts::TAU;

/// A wave in a surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SurfaceWave {
    pub wavelength_m: f64,
    pub amplitude_m: f64,
}

/// Height of the feed marks that a steady cut leaves on a wall, m: the sagitta of half a feed mark,
/// r − √(r² − (c/2)²) ≈ c²/8r. `mark_m` is the feed per tooth if the cutter runs true, and the feed
/// per revolution if one tooth stands out by more than the others' marks are deep.
pub fn feed_mark_height_m(radius_m: f64, mark_m: f64) -> f64 {
    let half = 0.5 * mark_m;
    half * half / (radius_m + (radius_m * radius_m - half * half).sqrt())
}

/// The strongest wave in a profile with wavelengths from `shortest_m` to half the profile: chatter
/// marks, if the shortest is longer than the feed marks. Least squares of a wave and a constant at
/// each of the frequencies of a grid of a quarter line, so that a wave between two lines loses no
/// more than 5 % of its height.
///
/// `None` for profiles with fewer than eight rays or rays that were never cut, or if the range is
/// empty.
pub fn strongest_wave(left_m: &[f64], spacing_m: f64, shortest_m: f64) -> Option<SurfaceWave> {
    let count = left_m.len();
    if count < 8 || left_m.iter().any(|x| !x.is_finite()) {
        return None;
    }
    let length = spacing_m * count as f64;
    let mean = left_m.iter().sum::<f64>() / count as f64;
    let highest = (length / shortest_m.max(2.0 * spacing_m) * 4.0) as usize;
    let waves = (8..=highest).map(|quarter| {
        let cycles = quarter as f64 / 4.0;
        let step = TAU * cycles / count as f64;
        let (mut c, mut s) = (0.0, 0.0);
        for (i, x) in left_m.iter().enumerate() {
            let (sin, cos) = (step * i as f64).sin_cos();
            c += (x - mean) * cos;
            s += (x - mean) * sin;
        }
        SurfaceWave {
            wavelength_m: length / cycles,
            amplitude_m: 2.0 * c.hypot(s) / count as f64,
        }
    });
    waves.max_by(|a, b| a.amplitude_m.total_cmp(&b.amplitude_m))
}

#[test]
fn verify_figures_of_a_wave() {
    let (a, offset) = (3e-6, 8e-6);
    let wave: Vec<f64> = (0..4000)
        .map(|i| offset + a * (TAU * f64::from(i) * 12.3 / 4000.0).sin())
        .collect();
    let found = figures(&wave).expect("finite");
    assert!((found.location_error_m / offset - 1.0).abs() < 0.02);
    assert!((found.peak_to_valley_m / (2.0 * a) - 1.0).abs() < 1e-3);
    assert!((found.arithmetic_deviation_m / (2.0 * a / std::f64::consts::PI) - 1.0).abs() < 0.02);
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
