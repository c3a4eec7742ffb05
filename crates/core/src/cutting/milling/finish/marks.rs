//! Marks on a finished surface that tests look for.

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
