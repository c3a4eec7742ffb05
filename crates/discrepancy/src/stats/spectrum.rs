//! Periodograms of series with gaps.

use truecut_recording::fft::{Complex64, forward};

use super::ratio;

/// A fast transform length of at least twice the series, so that nothing wraps around.
pub(crate) fn padded_length(samples: usize) -> usize {
    (2 * samples).next_power_of_two()
}

/// The periodic Hann window.
pub(crate) fn hann(length: usize) -> Vec<f64> {
    let turn = std::f64::consts::TAU / length as f64;
    (0..length)
        .map(|row| 0.5 - 0.5 * (turn * row as f64).cos())
        .collect()
}

/// Power over frequency, averaged over segments of the record.
#[derive(Clone, Debug, PartialEq)]
pub struct Periodogram {
    /// Samples in each segment; bin k lies at k/length cycles per sample.
    pub length: usize,
    /// Two-sided density, so that the integral from −½ to ½ cycles per sample is the variance;
    /// bins 0 to length/2.
    pub density: Vec<f64>,
    /// Degrees of freedom ν of each bin: `density` scatters as χ²(ν)/ν.
    pub degrees: f64,
    /// First samples of the segments.
    pub starts: Vec<usize>,
}

/// Fraction of the samples of a segment that must be valid.
pub(super) const SHARE_VALID: f64 = 0.8;

/// Welch's estimate (`welch1967`): segments of `length` samples under a Hann window, overlapping by
/// half, each linearly detrended. Invalid samples are zero; segments with more than a fifth of them
/// are left out. One segment as long as the record gives the plain periodogram. `None` without a
/// segment.
pub fn welch(values: &[f64], valid: &[bool], length: usize) -> Option<Periodogram> {
    let starts = stretches(valid, length);
    let window = hann(length);
    let mut density = vec![0.0; length / 2 + 1];
    for &start in &starts {
        let rows = start..start + length;
        let (tapered, power) = tapered(&values[rows.clone()], &valid[rows], &window);
        for (sum, bin) in density.iter_mut().zip(forward(tapered, length)) {
            *sum += bin.norm_sqr() / power / starts.len() as f64;
        }
    }
    (!starts.is_empty()).then(|| Periodogram {
        length,
        density,
        degrees: degrees_of_freedom(starts.len()),
        starts,
    })
}

/// Density as in [`Periodogram`] of what is there at all times, besides what comes and goes: of
/// each bin the value below which a part `share` of the segments lies, over what it is for Gaussian
/// noise, whose power in a bin is exponentially distributed. `None` without a segment.
pub(crate) fn quiet_density(
    values: &[f64],
    valid: &[bool],
    length: usize,
    share: f64,
) -> Option<Vec<f64>> {
    let starts = stretches(valid, length);
    let window = hann(length);
    let segments: Vec<Vec<f64>> = (starts.iter())
        .map(|&start| {
            let rows = start..start + length;
            let (tapered, power) = tapered(&values[rows.clone()], &valid[rows], &window);
            let bins = forward(tapered, length).into_iter();
            bins.map(|bin| bin.norm_sqr() / power).collect()
        })
        .collect();
    let rank = (share * segments.len().checked_sub(1)? as f64).round() as usize;
    let density = (0..length / 2 + 1).map(|bin| {
        let mut powers: Vec<f64> = segments.iter().map(|one| one[bin]).collect();
        *powers.select_nth_unstable_by(rank, f64::total_cmp).1 / -(1.0 - share).ln()
    });
    Some(density.collect())
}

/// Cross power of two series over the same segments as [`welch`] of both: (first, second, cross).
pub(crate) fn cross_welch(
    first: &[f64],
    second: &[f64],
    valid: &[bool],
    length: usize,
) -> Option<(Periodogram, Periodogram, Vec<Complex64>)> {
    let [one, other] = [welch(first, valid, length)?, welch(second, valid, length)?];
    let window = hann(length);
    let mut cross = vec![Complex64::default(); length / 2 + 1];
    for &start in &one.starts {
        let rows = start..start + length;
        let (x, power) = tapered(&first[rows.clone()], &valid[rows.clone()], &window);
        let (y, _) = tapered(&second[rows.clone()], &valid[rows], &window);
        let bins = forward(x, length).into_iter().zip(forward(y, length));
        for (sum, (x, y)) in cross.iter_mut().zip(bins) {
            *sum += x.conj() * y / power / one.starts.len() as f64;
        }
    }
    Some((one, other, cross))
}

fn stretches(valid: &[bool], length: usize) -> Vec<usize> {
    if length < 8 || length > valid.len() {
        return Vec::new();
    }
    let step = (length / 2).max(1);
    // Spread evenly, so that the end of the record is used as well.
    let count = (valid.len() - length) / step + 1;
    let room = (valid.len() - length) as f64;
    let place = |i: usize| (room * i as f64 / (count - 1).max(1) as f64).round() as usize;
    let counted = |start: &usize| {
        let counted = valid[*start..start + length]
            .iter()
            .filter(|one| **one)
            .count();
        counted as f64 >= SHARE_VALID * length as f64
    };
    (0..count).map(place).filter(counted).collect()
}

/// Of a mean of half-overlapping periodograms under a Hann window (`percival1993`,
/// eq. 292b).
fn degrees_of_freedom(stretches: usize) -> f64 {
    let count = stretches as f64;
    36.0 * count * count / (19.0 * count - 1.0)
}

/// A detrended segment under the window, and the sum of squares of the weights.
fn tapered(values: &[f64], valid: &[bool], window: &[f64]) -> (Vec<f64>, f64) {
    let (mean, slope, middle) = line(values, valid);
    let mut power = 0.0;
    let rows = values.iter().zip(valid).zip(window).enumerate();
    let tapered = rows
        .map(|(row, ((value, valid), weight))| {
            if !*valid {
                return 0.0;
            }
            power += weight * weight;
            (value - mean - slope * (row as f64 - middle)) * weight
        })
        .collect();
    (tapered, power)
}

/// The straight line of least squares: mean, slope per row, row of the mean.
pub(crate) fn line(values: &[f64], valid: &[bool]) -> (f64, f64, f64) {
    let rows = || {
        values
            .iter()
            .zip(valid)
            .enumerate()
            .filter(|(_, (_, valid))| **valid)
    };
    let count = rows().count().max(1) as f64;
    let mean = rows().map(|(_, (value, _))| value).sum::<f64>() / count;
    let middle = rows().map(|(row, _)| row as f64).sum::<f64>() / count;
    let (mut moment, mut spread) = (0.0, 0.0);
    for (row, (value, _)) in rows() {
        let arm = row as f64 - middle;
        moment += arm * (value - mean);
        spread += arm * arm;
    }
    (mean, ratio(moment, spread), middle)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{Colour, noise};

    #[test]
    fn verify_density_of_white_noise_is_its_variance_also_with_gaps() {
        let mut values = noise(Colour::White, 40_000, 3);
        let mut valid = vec![true; values.len()];
        for gap in (0..values.len()).step_by(1000) {
            values[gap..gap + 100].fill(f64::NAN);
            valid[gap..gap + 100].fill(false);
        }
        let estimate = welch(&values, &valid, 1000).unwrap();
        let mean = estimate.density[2..498].iter().sum::<f64>() / 496.0;
        assert!((mean - 1.0).abs() < 0.03, "{mean}");
        let scatter = estimate.density[2..498]
            .iter()
            .map(|d| (d - 1.0).powi(2))
            .sum::<f64>()
            / 496.0;
        assert!(
            (scatter * estimate.degrees / 2.0 - 1.0).abs() < 0.3,
            "{scatter}"
        );
    }

    /// Noise that is loud for half of the time counts as it is in the other half.
    #[test]
    fn verify_quiet_density_is_that_of_what_is_always_there() {
        let drawn = noise(Colour::White, 40_000, 5);
        let loud = |k: usize| if k % 2000 < 800 { 20.0 } else { 1.0 };
        let rows = drawn.iter().enumerate();
        let values: Vec<f64> = rows.map(|(k, x)| loud(k) * x).collect();
        let valid = vec![true; values.len()];
        let steady = quiet_density(&drawn, &valid, 64, 0.3).unwrap();
        let quiet = quiet_density(&values, &valid, 64, 0.3).unwrap();
        let mean = |density: &[f64]| density[2..31].iter().sum::<f64>() / 29.0;
        assert!((mean(&steady) - 1.0).abs() < 0.03, "{}", mean(&steady));
        // three tenths of all segments are so many of those that hold nothing loud
        let share = 0.3 / (0.6 - 64.0 / 2000.0);
        let wanted = (1.0_f64 - share).ln() / 0.7_f64.ln();
        let found = mean(&quiet);
        assert!((found / wanted - 1.0).abs() < 0.05, "{found} of {wanted}");
        assert_eq!(quiet_density(&drawn[..20], &[true; 20], 64, 0.3), None);
    }

    #[test]
    fn verify_cross_power_of_a_delayed_series_turns_with_frequency() {
        let drive = noise(Colour::White, 20_004, 4);
        let (now, late) = (&drive[4..], &drive[1..20_001]); // late by three samples
        let valid = vec![true; now.len()];
        let (_, _, cross) = cross_welch(now, late, &valid, 500).unwrap();
        for bin in [10, 50, 100] {
            let expected = -std::f64::consts::TAU * 3.0 * bin as f64 / 500.0;
            let turned = cross[bin] * Complex64::from_polar(1.0, -expected);
            assert!(
                turned.arg().abs() < 0.1 && (turned.norm() - 1.0).abs() < 0.4,
                "{turned}"
            );
        }
    }

    #[test]
    fn too_short_a_record_gives_nothing() {
        assert_eq!(welch(&[0.0; 20], &[true; 20], 21), None);
        assert_eq!(welch(&[0.0; 20], &[false; 20], 10), None);
    }
}
