//! Where a measured joint begins: its first sample has the noise of a sample, and may be a spike.

use nalgebra::{DMatrix, DVector};

/// Samples that are looked at, from the first on.
const FEWEST: usize = 8;
const MOST: usize = 512;
/// Highest degree that the path of a stretch may have; two more are held against it.
const DEGREE: usize = 2;
/// Gain of two further degrees that chance reaches in 5 % of stretches (chi-square, two degrees of
/// freedom), in variances of the noise.
const CHANCE: f64 = 6.0;
/// In deviations of the noise from the median of the neighbours.
const SPIKE: f64 = 6.0;
/// Median of the size of a normal deviation.
const MEDIAN_SIZE: f64 = 0.674_49;

/// Where a joint was measured to begin.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Beginning {
    /// Coordinate at the first sample, rad or m.
    pub at: f64,
    /// Deviation of the samples about it: more than its error where noise is white, and a bound
    /// where it has a memory.
    pub spread: f64,
}

/// The coordinate at the first sample: that of the polynomial of low degree, through as many
/// samples from the first on as it describes up to noise, which tells it best.
pub(super) fn beginning(values: &[f64], valid: &[bool]) -> Option<Beginning> {
    let rows = (values.iter().zip(valid).enumerate()).take(MOST);
    let rows = rows.filter(|(_, (_, valid))| **valid);
    let rows: Vec<(f64, f64)> = rows.map(|(i, (value, _))| (i as f64, *value)).collect();
    let noise = noise(&rows);
    let rows = without_spikes(&rows, noise);
    let mut best: Option<(f64, Beginning)> = None;
    let mut count = FEWEST;
    while count <= rows.len() {
        let stretch = &rows[..count];
        let fits: Vec<(f64, f64)> = (0..=DEGREE + 2).map(|d| polynomial(stretch, d)).collect();
        for degree in 0..=DEGREE {
            let gain = fits[degree].1 - fits[degree + 2].1;
            // At the end of its stretch a polynomial is told as badly as by so few samples.
            let error = (degree + 1) as f64 / (count as f64).sqrt();
            let fits_up_to_noise = gain <= CHANCE * noise * noise;
            if fits_up_to_noise && best.is_none_or(|(least, _)| error < least) {
                let spread = (fits[degree].1 / count as f64).sqrt();
                let at = fits[degree].0;
                best = Some((error, Beginning { at, spread }));
            }
        }
        count += (count / 2).max(1);
    }
    let first = rows.first().map(|row| Beginning {
        at: row.1,
        spread: noise,
    });
    best.map(|(_, best)| best).or(first)
}

/// Deviation of the noise, from differences of third order: what moves smoothly is gone from them.
fn noise(rows: &[(f64, f64)]) -> f64 {
    let windows = rows.windows(4);
    let third = windows.map(|w| (w[3].1 - 3.0 * w[2].1 + 3.0 * w[1].1 - w[0].1).abs());
    // 1 + 9 + 9 + 1 times the variance of a sample.
    median(third.collect()) / MEDIAN_SIZE / 20f64.sqrt()
}

/// Without what lies far from the median of the five samples about it.
fn without_spikes(rows: &[(f64, f64)], noise: f64) -> Vec<(f64, f64)> {
    let last = rows.len();
    let near = |i: usize| {
        let from = i.saturating_sub(2).min(last.saturating_sub(5));
        rows[from..(from + 5).min(last)].iter().map(|row| row.1)
    };
    let is_spike = |i: usize| {
        let middle = median(near(i).collect());
        let moved = median(near(i).map(|value| (value - middle).abs()).collect());
        (rows[i].1 - middle).abs() > SPIKE * noise.max(moved)
    };
    (0..last)
        .filter(|&i| !is_spike(i))
        .map(|i| rows[i])
        .collect()
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(0.0)
}

/// Value at the first sample of the least squares, and the sum of squares that it leaves.
fn polynomial(rows: &[(f64, f64)], degree: usize) -> (f64, f64) {
    let (first, last) = (rows[0].0, rows[rows.len() - 1].0);
    let place = |row: usize| (rows[row].0 - first) / (last - first).max(1.0);
    let powers = DMatrix::from_fn(rows.len(), degree + 1, |r, c| place(r).powi(c as i32));
    let values = DVector::from_iterator(rows.len(), rows.iter().map(|row| row.1 - rows[0].1));
    let Ok(found) = powers.clone().svd(true, true).solve(&values, 1e-12) else {
        return (rows[0].1, f64::INFINITY);
    };
    let left = values - powers * &found;
    (rows[0].1 + found[0], left.norm_squared())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A uniform sequence that repeats nothing in these lengths (Weyl's, with the golden ratio),
    /// with deviation 1.
    fn scatter(i: usize) -> f64 {
        ((i as f64 * 0.618_033_988_75).fract() - 0.5) * 12f64.sqrt()
    }

    #[test]
    fn verify_a_joint_at_rest_begins_at_its_mean() {
        let values: Vec<f64> = (0..300).map(|i| 0.7 + 1e-3 * scatter(i)).collect();
        let found = beginning(&values, &[true; 300]).unwrap().at;
        assert!((found - 0.7).abs() < 1e-4, "{found}");
    }

    #[test]
    fn verify_one_that_sets_off_begins_where_its_path_does() {
        for (speed, acceleration) in [(0.0, 3e-5), (-2e-3, 0.0), (1e-3, 2e-5)] {
            let path = |i: usize| 0.3 + speed * i as f64 + acceleration * (i * i) as f64;
            let values: Vec<f64> = (0..400).map(|i| path(i) + 1e-3 * scatter(i)).collect();
            let found = beginning(&values, &[true; 400]).unwrap().at;
            assert!(
                (found - 0.3).abs() < 7e-4,
                "{speed} {acceleration}: {found}"
            );
        }
    }

    #[test]
    fn a_spike_or_a_gap_at_the_first_sample_is_no_beginning() {
        let mut values: Vec<f64> = (0..200).map(|i| 1e-3 * scatter(i)).collect();
        values[0] = 0.5;
        assert!(beginning(&values, &[true; 200]).unwrap().at.abs() < 2e-4);
        let mut valid = [true; 200];
        valid[0] = false;
        assert!(beginning(&values, &valid).unwrap().at.abs() < 2e-4);
        assert_eq!(beginning(&values, &[false; 200]), None);
    }

    #[test]
    fn a_record_too_short_or_without_noise_begins_at_its_first_sample() {
        assert_eq!(beginning(&[0.25, 0.25], &[true; 2]).unwrap().at, 0.25);
        let found = beginning(&[0.25; 64], &[true; 64]).unwrap().at;
        assert!((found - 0.25).abs() < 1e-15);
    }
}
