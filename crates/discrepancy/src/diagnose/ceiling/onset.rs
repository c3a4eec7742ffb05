//! When something sets in.

use crate::diagnose::data::Fine;
use crate::diagnose::noise::Moments;

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

/// The edge, of the `inner` ones, at which a change of all sizes explains most: columns fitted
/// before and after it. None where no change explains anything.
pub(super) fn best_moment(
    columns: &[Vec<f64>],
    target: &[f64],
    edges: &[usize],
    inner: std::ops::Range<usize>,
) -> Option<usize> {
    let parts: Vec<Moments> = (edges.windows(2))
        .map(|pair| {
            let own: Vec<Vec<f64>> = (columns.iter())
                .map(|column| column[pair[0]..pair[1]].to_vec())
                .collect();
            Moments::new(&target[pair[0]..pair[1]], &own)
        })
        .collect();
    let mut whole = parts.first()?.clone();
    for part in &parts[1..] {
        whole = whole.plus(part);
    }
    let mut before = parts[0].clone();
    let mut best: Option<(f64, usize)> = None;
    for (edge, part) in parts.iter().enumerate().skip(1) {
        if inner.contains(&edge) {
            let gain = before.explained() + whole.minus(&before).explained();
            if best.is_none_or(|(most, _)| gain > most) {
                best = Some((gain, edge));
            }
        }
        before = before.plus(part);
    }
    best.map(|(_, edge)| edge)
}

/// Rounds in which one edge of a stretch is looked for beside the other.
const ROUNDS: usize = 3;

/// The two edges, neither of them the first or the last, between which columns of other sizes than
/// outside explain most: from the edge at which a single change does, one edge after the other.
/// None where there are not enough edges.
pub(super) fn best_window(
    columns: &[Vec<f64>],
    target: &[f64],
    edges: &[usize],
) -> Option<[usize; 2]> {
    let last = edges.len().checked_sub(2).filter(|last| *last >= 2)?;
    let mut held = best_moment(columns, target, edges, 1..last + 1)?;
    let until: Vec<Moments> = (edges.iter())
        .map(|edge| {
            let own: Vec<Vec<f64>> = columns.iter().map(|x| x[..*edge].to_vec()).collect();
            Moments::new(&target[..*edge], &own)
        })
        .collect();
    let whole = until.last()?;
    let gain = |a: usize, b: usize| {
        let inside = until[a.max(b)].minus(&until[a.min(b)]);
        inside.explained() + whole.minus(&inside).explained()
    };
    let mut moved = held;
    for _ in 0..ROUNDS {
        let others = (1..=last).filter(|edge| *edge != held);
        let best = others.max_by(|a, b| gain(held, *a).total_cmp(&gain(held, *b)))?;
        (held, moved) = (best, held);
    }
    Some([held.min(moved), held.max(moved)])
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
            let found = best_moment(&[column], &target, &edges, 1..100).unwrap();
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
            let found = best_window(&[column], &target, &edges).unwrap();
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
