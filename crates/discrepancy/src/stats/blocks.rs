//! Runs of valid samples, and tests on the means of blocks.

use std::ops::Range;

use super::distributions::t_tail;

/// Runs of at least `shortest` valid samples, in order.
pub fn contiguous_blocks(valid: &[bool], shortest: usize) -> Vec<Range<usize>> {
    let mut blocks = Vec::new();
    let mut start = 0;
    for end in 1..=valid.len() {
        if end == valid.len() || valid[end] != valid[start] {
            if valid[start] && end - start >= shortest.max(1) {
                blocks.push(start..end);
            }
            start = end;
        }
    }
    blocks
}

/// The record divided into blocks of `length` samples; blocks with fewer than half of their samples
/// valid are left out. A remainder shorter than half a block joins the last one.
pub fn blocks_of_length(valid: &[bool], length: usize) -> Vec<Range<usize>> {
    let length = length.max(1);
    let count = ((valid.len() as f64 / length as f64).round() as usize).max(1);
    (0..count)
        .map(|i| {
            i * length..if i + 1 == count {
                valid.len()
            } else {
                (i + 1) * length
            }
        })
        .filter(|block| {
            let counted = valid[block.clone()].iter().filter(|one| **one).count();
            counted > 0 && 2 * counted >= block.len()
        })
        .collect()
}

/// Paired test on block means of two losses.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PairedTest {
    /// Mean of (first − second) over the blocks; positive if the second is smaller.
    pub mean_difference: f64,
    /// Its standard error, from the scatter between blocks.
    pub standard_error: f64,
    /// Probability of a mean at least this large if there is no difference; Student's t with
    /// `blocks` − 1 degrees of freedom.
    pub p_second_smaller: f64,
    /// Number of blocks.
    pub blocks: usize,
}

/// Student's paired test on block means of two losses (squared errors, say) of the same samples.
///
/// Blocks must be much longer than the correlation time of the losses, else their means are not
/// independent. `None` for fewer than three blocks.
pub fn paired_block_test(
    first: &[f64],
    second: &[f64],
    valid: &[bool],
    blocks: &[Range<usize>],
) -> Option<PairedTest> {
    let mean = |block: &Range<usize>| {
        let rows = block.clone().filter(|row| valid[*row]);
        let (sum, count) = rows.fold((0.0, 0_usize), |(sum, count), row| {
            (sum + first[row] - second[row], count + 1)
        });
        (count > 0).then(|| sum / count as f64)
    };
    let means: Vec<f64> = blocks.iter().filter_map(mean).collect();
    if means.len() < 3 {
        return None;
    }
    let count = means.len() as f64;
    let mean_difference = means.iter().sum::<f64>() / count;
    let squares: f64 = means
        .iter()
        .map(|one| (one - mean_difference).powi(2))
        .sum();
    let standard_error = (squares / (count - 1.0) / count).sqrt();
    let p_second_smaller = if standard_error > 0.0 {
        t_tail(mean_difference / standard_error, count - 1.0)
    } else if mean_difference > 0.0 {
        0.0
    } else {
        1.0
    };
    Some(PairedTest {
        mean_difference,
        standard_error,
        p_second_smaller,
        blocks: means.len(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn runs_of_valid_samples_are_found() {
        let valid = [true, true, false, true, false, false, true, true, true];
        assert_eq!(contiguous_blocks(&valid, 1), [0..2, 3..4, 6..9]);
        assert_eq!(contiguous_blocks(&valid, 2), [0..2, 6..9]);
        assert!(contiguous_blocks(&[], 1).is_empty());
        assert!(contiguous_blocks(&[false; 3], 1).is_empty());
    }

    #[test]
    fn stretches_cover_the_record() {
        assert_eq!(blocks_of_length(&[true; 10], 4), [0..4, 4..8, 8..10]);
        assert_eq!(blocks_of_length(&[true; 9], 4), [0..4, 4..9]);
        let mut valid = [true; 12];
        valid[4..7].fill(false);
        assert_eq!(blocks_of_length(&valid, 4), [0..4, 8..12]);
    }

    /// Differences 1, 2, 3, 4, 5: mean 3, standard error √(2.5/5), t = 4.2426 with four degrees of
    /// freedom, p = 0.006617.
    #[test]
    fn verify_paired_test_by_hand() {
        let first: Vec<f64> = (0..10).map(|row| 10.0 + f64::from(row / 2 + 1)).collect();
        let second = [10.0; 10];
        let blocks = blocks_of_length(&[true; 10], 2);
        let test = paired_block_test(&first, &second, &[true; 10], &blocks).unwrap();
        assert_eq!((test.mean_difference, test.blocks), (3.0, 5));
        assert!((test.standard_error - 0.5_f64.sqrt()).abs() < 1e-12);
        assert!((test.p_second_smaller - 0.006_617).abs() < 1e-5, "{test:?}");
        assert_eq!(
            paired_block_test(&first, &second, &[true; 10], &blocks[..2]),
            None
        );
    }
}
