//! Parts of the rows that are predicted by fits to the others.

use std::ops::Range;

use super::{GroupTrial, Target};
use crate::diagnose::features::{Group, Onset};
use crate::diagnose::noise::{ChannelNoise, Prior, dot};
use crate::stats::ratio;

const FOLDS: usize = 6;

/// The fold of each row, of so many.
#[derive(Clone)]
pub(super) struct Folds {
    pub of_row: Vec<usize>,
    pub count: usize,
}

impl Folds {
    /// Whole blocks.
    pub fn of_blocks(blocks: &[Range<usize>], rows: &[usize]) -> Folds {
        let count = FOLDS.min(blocks.len());
        let block = |t: &usize| blocks.iter().position(|b| b.contains(t)).unwrap_or(0);
        Folds {
            of_row: rows.iter().map(|t| block(t) % count).collect(),
            count,
        }
    }

    /// Parts of the rows before, between and after moments: each of these is divided by itself.
    /// What sets in within the last of three blocks is not predicted by a fit to the other two.
    pub fn about(moments_s: &[f64], times_s: impl Iterator<Item = f64>) -> Folds {
        let passed = |time_s: f64| moments_s.iter().filter(|from_s| time_s >= **from_s).count();
        let stretches: Vec<usize> = times_s.map(passed).collect();
        let of_stretch = stretches.chunk_by(|a, b| a == b);
        let part = |rows: &[usize]| {
            let count = rows.len();
            (0..count).map(move |row| FOLDS * row / count)
        };
        Folds {
            of_row: of_stretch.flat_map(part).collect(),
            count: FOLDS,
        }
    }
}

impl Target<'_> {
    /// Part of the residual's square, as it is, that groups fitted to the other folds foretell.
    pub(super) fn foretold(&self, groups: &[&Group]) -> f64 {
        if groups.is_empty() {
            return 0.0;
        }
        let whole: f64 = self.rows.iter().map(|&t| self.residual[t].powi(2)).sum();
        let errors = self.errors(groups, &ChannelNoise::WHITE, &self.folds(groups));
        1.0 - ratio(dot(&errors, &errors), whole)
    }

    /// The folds by which groups are cross-validated.
    pub(super) fn folds(&self, groups: &[&Group]) -> Folds {
        let mut onsets = groups.iter().filter_map(|group| group.changes).peekable();
        match onsets.peek() {
            None => self.folds.clone(),
            Some(_) => {
                let moments_s: Vec<f64> = onsets.flat_map(Onset::moments_s).collect();
                let times_s = self.rows.iter().map(|&t| self.problem.data.time_s[t]);
                Folds::about(&moments_s, times_s)
            }
        }
    }
}

impl GroupTrial<'_> {
    /// Schwarz's, with all numbers that make the groups fit: what a wave of one frequency does, a
    /// signal seen through a filter of many numbers does nearly, too.
    pub(super) fn criterion(&self) -> f64 {
        let n = self.errors.len() as f64;
        let numbers: usize = self.groups.iter().map(|group| group.numbers()).sum();
        n * self.innovation().max(f64::MIN_POSITIVE).ln() + numbers as f64 * n.ln()
    }

    /// Variance of what cannot be predicted, cross-validated.
    fn innovation(&self) -> f64 {
        self.noise.sigma.powi(2) * dot(&self.errors, &self.errors)
    }
}

/// All features of these groups.
pub(super) fn features<'a>(groups: &'a [&'a Group]) -> impl Iterator<Item = &'a Vec<f64>> {
    groups.iter().flat_map(|g| &g.features)
}

/// A little shrinkage, so that bins with few samples do not matter. From the sum of squares of each
/// column over `count` rows.
pub(super) fn ridge(squares: impl Iterator<Item = f64>, count: usize) -> Vec<Prior> {
    let priors = squares.map(|sum| Prior {
        offset: 0.0,
        precision: (sum / count.max(1) as f64).sqrt(),
    });
    priors.collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Wherever something sets in, every fold has rows before and after it, and the parts of a fold
    /// are in one piece on either side.
    #[test]
    fn verify_folds_are_on_either_side_of_a_moment() {
        for seed in 0..40 {
            let moment_s = 0.4 + 0.06 * f64::from(seed);
            let times_s: Vec<f64> = (0..300).map(|k| 0.01 * f64::from(k)).collect();
            let folds = Folds::about(&[moment_s], times_s.iter().copied());
            let count = times_s.iter().filter(|t| **t < moment_s).count();
            for side in [&folds.of_row[..count], &folds.of_row[count..]] {
                let pieces: Vec<usize> = side.chunk_by(|a, b| a == b).map(|own| own[0]).collect();
                assert_eq!(pieces, (0..FOLDS).collect::<Vec<_>>(), "{moment_s}");
            }
        }
    }
}
