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
