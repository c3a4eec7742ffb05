//! When something sets in.

use crate::diagnose::data::Fine;
use crate::diagnose::moments::Moments;

/// A step, through the filter that the data have gone through.
pub(super) struct Step {
    /// At the rate before the data were thinned; the step is in its middle.
    response: Vec<f64>,
    every: usize,
}

/// Moments about a sample at which a step is looked for, on either side.
const MOMENTS: usize = 12;

impl Step {
    pub fn of(fine: &Fine) -> Step {
        let count = fine.signals.first().map_or(0, |signal| signal.values.len());
        let mut step = vec![0.0; 2 * count];
        step[count..].fill(1.0);
        Step {
            response: fine.filter.zero_phase(&step),
            every: fine.every,
        }
    }

    /// Which part of a sample of the data is after a moment, a row before they were thinned.
    pub fn passed(&self, sample: usize, moment: usize) -> f64 {
        let row = self.response.len() / 2 + sample * self.every;
        match row.checked_sub(moment) {
            None => 0.0,
            Some(row) => *self.response.get(row).unwrap_or(&1.0),
        }
    }

    /// Which part of a sample is after the first of these moments and before the second, if there
    /// is one.
    pub fn between(&self, sample: usize, moments: &[usize]) -> f64 {
        let mut passed = moments.iter().map(|moment| self.passed(sample, *moment));
        let after = passed.next().unwrap_or(0.0);
        after - passed.next().unwrap_or(0.0)
    }

    /// Moments between the samples beside one.
    pub fn moments_about(&self, sample: usize) -> impl Iterator<Item = usize> {
        let middle = sample * self.every;
        let range = middle.saturating_sub(self.every)..=middle + self.every;
        range.step_by((self.every / MOMENTS).max(1))
    }
}

/// Rounds in which one edge of a stretch is looked for beside the other.
const ROUNDS: usize = 3;

/// What columns explain of a target, up to each of some edges, the first and the last of which are
/// the ends.
pub(super) struct Sums {
    until: Vec<Moments>,
}

impl Sums {
    /// `None` where there is nothing between the ends.
    pub fn new(columns: &[Vec<f64>], target: &[f64], edges: &[usize]) -> Option<Sums> {
        let of = |from: usize, to: usize| {
            let own: Vec<Vec<f64>> = columns.iter().map(|x| x[from..to].to_vec()).collect();
            Moments::new(&target[from..to], &own)
        };
        let first = *edges.first()?;
        let mut until = vec![of(first, first)];
        for pair in edges.windows(2) {
            until.push(until[until.len() - 1].plus(&of(pair[0], pair[1])));
        }
        (until.len() > 1).then_some(Sums { until })
    }

    /// What sizes of their own between two edges and outside explain.
    fn gain(&self, from: usize, to: usize) -> f64 {
        let inside = self.until[to].minus(&self.until[from]);
        let whole = &self.until[self.until.len() - 1];
        inside.explained() + whole.minus(&inside).explained()
    }

    /// The edge, of the `inner` ones, at which a change of all sizes explains most. None if there
    /// are none.
    pub fn best_moment(&self, inner: std::ops::Range<usize>) -> Option<usize> {
        let gains = inner.map(|edge| (self.gain(0, edge), edge));
        // Of equals the first.
        let best = gains.reduce(|best, one| if one.0 > best.0 { one } else { best });
        best.map(|(_, edge)| edge)
    }

    /// The two edges, neither of them an end, between which other sizes than outside explain most:
    /// from the edge at which a single change does, one edge after the other. None where there are
    /// not enough edges.
    pub fn best_window(&self) -> Option<[usize; 2]> {
        let inner = 1..self.until.len() - 1;
        let mut held = self.best_moment(inner.clone())?;
        let mut moved = held;
        for _ in 0..ROUNDS {
            let others = inner.clone().filter(|edge| *edge != held);
            let gain = |edge: usize| self.gain(held.min(edge), held.max(edge));
            let best = others.max_by(|a, b| gain(*a).total_cmp(&gain(*b)))?;
            (held, moved) = (best, held);
        }
        Some([held.min(moved), held.max(moved)])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnose::data::Regressor;
    use truecut_recording::filter::Butterworth;

    use crate::testing::{Colour, noise};

    /// A dry friction that sets in at a moment drawn from a seed, beside noise with a memory: the
    /// moment is found to a hundredth of the record.
    #[test]
    fn verify_the_moment_of_a_change_is_found() {
        for seed in 0..40 {
            let count = 1200;
            let moment = 150 + 22 * seed as usize;
            let sign = |t: usize| (0.05 * t as f64 + 0.3 * seed as f64).sin().signum();
            let drawn = noise(Colour::Ar1(0.8), count, seed);
            let target: Vec<f64> = (0..count)
                .map(|t| drawn[t] + if t >= moment { 8.0 * sign(t) } else { 0.0 })
                .collect();
            let column: Vec<f64> = (0..count).map(sign).collect();
            let edges: Vec<usize> = (0..=100).map(|part| 12 * part).collect();
            let sums = Sums::new(&[column], &target, &edges).unwrap();
            let found = sums.best_moment(1..100).unwrap();
            assert!(
                edges[found].abs_diff(moment) <= 12,
                "seed {seed}: {} for {moment}",
                edges[found]
            );
        }
    }

    /// A friction that drags between two moments drawn from a seed, for a fiftieth of the record to
    /// half of it, beside noise with a memory: both moments are found to a hundredth of the record.
    #[test]
    fn verify_both_moments_of_a_stretch_are_found() {
        for seed in 0..40 {
            let count = 1200;
            let from = 60 + 13 * seed as usize;
            let until = from + 24 + 14 * (seed as usize * 7 % 40);
            let sign = |t: usize| (0.05 * t as f64 + 0.3 * seed as f64).sin().signum();
            let drawn = noise(Colour::Ar1(0.8), count, seed);
            let target: Vec<f64> = (0..count)
                .map(|t| {
                    let drags = (from..until).contains(&t);
                    drawn[t] + if drags { 12.0 * sign(t) } else { 0.0 }
                })
                .collect();
            let column: Vec<f64> = (0..count).map(sign).collect();
            let edges: Vec<usize> = (0..=100).map(|part| 12 * part).collect();
            let found = Sums::new(&[column], &target, &edges);
            let found = found.and_then(|sums| sums.best_window()).unwrap();
            for (edge, truth) in found.into_iter().zip([from, until]) {
                let off = edges[edge].abs_diff(truth.min(count - 12));
                assert!(off <= 12, "seed {seed}: {} for {truth}", edges[edge]);
            }
        }
    }

    /// Wherever a step lies between two samples of the data, its course is that of the step through
    /// the filter.
    #[test]
    fn verify_a_step_goes_through_the_filter() {
        let filter = Butterworth::low_pass(4, 5.0, 100.0);
        let fine = Fine {
            signals: vec![Regressor::new("joint1.angle", vec![0.0; 3000])],
            every: 10,
            filter: filter.clone(),
        };
        let step = Step::of(&fine);
        for moment in 1000..1040 {
            let whole: Vec<f64> = (0..3000)
                .map(|k| f64::from(u8::from(k >= moment)))
                .collect();
            let filtered = filter.zero_phase(&whole);
            for sample in 0..300 {
                let off = step.passed(sample, moment) - filtered[10 * sample];
                assert!(off.abs() < 1e-9, "{moment} {sample}: {off}");
            }
        }
    }
}
