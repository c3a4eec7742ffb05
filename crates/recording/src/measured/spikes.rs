//! Spikes of a logger: single samples far off their neighbours.
//!
//! What an arm does within a few samples is smooth, so that a cubic through the neighbours on
//! either side says what a sample must be, up to the noise. A spike stands alone: the neighbours
//! fit the cubic, which those of a jump, and of a swing that is sampled coarsely, do not.

use nalgebra::{SMatrix, SVector};

/// In deviations of what the cubics miss, in the whole record and beside the sample alike.
pub const SPIKE: f64 = 5.0;
/// Neighbours to either side that a cubic goes through.
const AROUND: usize = 8;
/// Median of the size of a normal deviation.
const MEDIAN_SIZE: f64 = 0.674_49;
/// Spikes near to others are seen once those are gone.
const PASSES: usize = 5;
const CUBIC: usize = 4;
const NEIGHBOURS: usize = 2 * AROUND;

/// Replaces spikes of a series of samples at even times by what their neighbours say; how many
/// there were. `valid` says where there is a measurement.
pub fn replace_spikes(values: &mut [f64], valid: &[bool]) -> usize {
    let cubic = Cubic::new();
    let mut found = 0;
    for _ in 0..PASSES {
        let missed: Vec<Option<Miss>> = (0..values.len())
            .map(|k| cubic.missed(values, valid, k))
            .collect();
        let mut sizes: Vec<f64> = missed.iter().flatten().map(|one| one.by.abs()).collect();
        if sizes.is_empty() {
            break;
        }
        let middle = sizes.len() / 2;
        let (_, median, _) = sizes.select_nth_unstable_by(middle, f64::total_cmp);
        let bar = SPIKE * *median / MEDIAN_SIZE;
        let mut replaced = 0;
        for (value, miss) in values.iter_mut().zip(&missed) {
            let Some(miss) = miss else { continue };
            let size = miss.by.abs();
            if bar > 0.0 && size > bar && size > SPIKE * miss.deviation {
                *value -= miss.by;
                replaced += 1;
            }
        }
        found += replaced;
        if replaced == 0 {
            break;
        }
    }
    found
}

/// What a sample is off the cubic through its neighbours.
struct Miss {
    by: f64,
    /// Of that, from how well the neighbours themselves fit.
    deviation: f64,
}

/// Least squares of a cubic through the neighbours of a sample.
struct Cubic {
    /// Orthonormal columns that span the cubics at the neighbours.
    basis: SMatrix<f64, NEIGHBOURS, CUBIC>,
    /// The cubic's value at the sample, from its parts along the columns.
    here: SVector<f64, CUBIC>,
}

impl Cubic {
    fn new() -> Self {
        let reach = AROUND as f64;
        let power = |row: usize, power: usize| (place(row) / reach).powi(power as i32);
        let parted = SMatrix::<f64, NEIGHBOURS, CUBIC>::from_fn(power).qr();
        // the cubic at the sample is its constant: the first row of the inverse of R
        let constant = SVector::<f64, CUBIC>::ith(0, 1.0);
        let here = parted.r().transpose().solve_lower_triangular(&constant);
        Self {
            basis: parted.q(),
            here: here.unwrap_or_default(),
        }
    }

    /// `None` where a neighbour is missing.
    fn missed(&self, values: &[f64], valid: &[bool], k: usize) -> Option<Miss> {
        let first = k.checked_sub(AROUND)?;
        let window = values.get(first..=k + AROUND)?;
        if !valid[first..=k + AROUND].iter().all(|valid| *valid) {
            return None;
        }
        let neighbour = |row, _| window[row + usize::from(row >= AROUND)];
        let beside = SVector::<f64, NEIGHBOURS>::from_fn(neighbour);
        let parts = self.basis.tr_mul(&beside);
        let left = beside - self.basis * parts;
        let variance = left.norm_squared() / (NEIGHBOURS - CUBIC) as f64;
        Some(Miss {
            by: values[k] - self.here.dot(&parts),
            deviation: (variance * (1.0 + self.here.norm_squared())).sqrt(),
        })
    }
}

/// Samples from the one in the middle to a neighbour.
fn place(row: usize) -> f64 {
    let step = row as f64 - AROUND as f64;
    if row >= AROUND { step + 1.0 } else { step }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A cubic is met exactly, and its neighbours fit.
    #[test]
    fn verify_a_cubic_is_met_exactly() {
        let values: Vec<f64> = (0..40)
            .map(|k| f64::from(k) * 0.1)
            .map(|t| 3.0 - 2.0 * t + 0.5 * t * t - 0.7 * t.powi(3))
            .collect();
        let cubic = Cubic::new();
        for k in AROUND..40 - AROUND {
            let miss = cubic.missed(&values, &[true; 40], k).unwrap();
            assert!(miss.by.abs() < 1e-12 && miss.deviation < 1e-12, "{k}");
        }
    }
}
