//! Runs of valid samples.

use std::ops::Range;

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
}
