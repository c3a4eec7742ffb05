//! What a law does that changes with time: a friction that fades, a brake that drags from some
//! moment on, a load that is let go.
//!
//! Each signature of the screening is fitted with one size before a moment and another after it, or
//! with a size that goes with time. Neither needs the motion to come again.

use rayon::prelude::*;
use truecut_recording::significant;

use super::Target;
use crate::diagnose::answer::target_name;
use crate::diagnose::features::{Group, Onset};
use crate::diagnose::noise::{Moments, dot, explained};
use crate::diagnose::signature::Signature;
use crate::model::Columns;

/// Parts of the rows between which a change is looked for, and of the two parts beside the best
/// moment.
const PARTS: usize = 24;
/// Parts on either side of a change: what happens in less comes once and has no law.
const LEAST_PARTS: usize = 2;
/// Changes that are tried at most, by what they explain under white noise for their numbers.
const PROMISING: usize = 8;

impl Target<'_> {
    /// For each signature its trace in the channel, changing at the moment at which that explains
    /// most, and changing steadily.
    pub(super) fn changes(&self, channel: usize, signatures: &[Signature]) -> Vec<Group> {
        let left: Vec<f64> = self.rows.iter().map(|&t| self.residual[t]).collect();
        let whole = dot(&left, &left).max(f64::MIN_POSITIVE);
        let picked = |x: &Vec<f64>| -> Vec<f64> { self.rows.iter().map(|&t| x[t]).collect() };
        let found = signatures.par_iter().flat_map_iter(|signature| {
            let moments = signature.moments.iter().map(|one| &one.column[channel]);
            let traces: Vec<&Vec<f64>> = (signature.columns.iter().map(|one| &one[channel]))
                .chain(moments)
                .filter(|trace| self.rows.iter().any(|&t| trace[t] != 0.0))
                .collect();
            let law = self.law(signature);
            let courses = match traces.is_empty() {
                true => [None, None],
                false => [
                    self.at_once(&law, &traces, &left),
                    self.steadily(&law, &traces),
                ],
            };
            let n = self.rows.len() as f64;
            let weighed = courses.into_iter().flatten().map(|group| {
                let columns: Vec<Vec<f64>> = group.features.iter().map(picked).collect();
                let share = 1.0 - explained(&left, &columns) / whole;
                let value = n * share.max(1e-12).ln() + group.numbers() as f64 * n.ln();
                let law = Group {
                    reaches: reached(signature),
                    traces: traces.iter().map(|trace| (*trace).clone()).collect(),
                    ..group
                };
                (value, law)
            });
            weighed.collect::<Vec<_>>()
        });
        let mut found: Vec<(f64, Group)> = found.filter(|(value, _)| value.is_finite()).collect();
        found.sort_by(|a, b| a.0.total_cmp(&b.0));
        // Signatures of one law at other sizes say the same.
        let mut best: Vec<Group> = Vec::new();
        for (_, group) in found {
            let kind = |one: &Group| one.changes.is_some_and(|onset| onset.from_s.is_some());
            let is_new =
                (best.iter()).all(|other| other.law != group.law || kind(other) != kind(&group));
            if is_new && best.len() < PROMISING {
                best.push(group);
            }
        }
        best
    }

    fn law(&self, signature: &Signature) -> String {
        let candidate = &self.problem.candidates[signature.candidate];
        match target_name(candidate) {
            Some(target) => format!("{} of {target}", candidate.kind.name()),
            None => candidate.kind.name().to_owned(),
        }
    }

    fn at_once(&self, law: &str, traces: &[&Vec<f64>], left: &[f64]) -> Option<Group> {
        let picked: Vec<Vec<f64>> = (traces.iter())
            .map(|trace| self.rows.iter().map(|&t| trace[t]).collect())
            .collect();
        let count = self.rows.len();
        let edge = |part: usize| count * part / PARTS;
        let coarse: Vec<usize> = (0..=PARTS).map(edge).collect();
        let inner = LEAST_PARTS..PARTS - LEAST_PARTS + 1;
        let part = best_moment(&picked, left, &coarse, inner)?;
        let (from, to) = (coarse[part - 1], coarse[part + 1]);
        let mut fine = vec![0];
        fine.extend((0..=PARTS).map(|i| from + (to - from) * i / PARTS));
        fine.push(count);
        fine.dedup();
        let inner = 1..fine.len() - 1;
        let row = self.rows[fine[best_moment(&picked, left, &fine, inner)?]];
        let from_s = self.problem.data.time_s[row];
        let features = (traces.iter()).flat_map(|trace| {
            [false, true].map(|is_late| {
                let rows = trace.iter().enumerate();
                rows.map(|(t, x)| if (t >= row) == is_late { *x } else { 0.0 })
                    .collect()
            })
        });
        let name = format!("{law}, which changes at about {} s", significant(from_s, 3));
        Some(Group {
            chosen: 1,
            law: law.to_owned(),
            changes: Some(Onset {
                from_s: Some(from_s),
            }),
            ..Group::of_time(name, features.collect())
        })
    }

    fn steadily(&self, law: &str, traces: &[&Vec<f64>]) -> Option<Group> {
        let (first, last) = (*self.rows.first()?, *self.rows.last()?);
        let time = &self.problem.data.time_s;
        let relative = |t: usize| (time[t] - time[first]) / (time[last] - time[first]);
        let features = traces.iter().flat_map(|trace| {
            [0, 1, 2].map(|power| {
                let rows = trace.iter().enumerate();
                rows.map(|(t, x)| x * relative(t).powi(power)).collect()
            })
        });
        Some(Group {
            law: law.to_owned(),
            changes: Some(Onset { from_s: None }),
            ..Group::of_time(
                format!("{law}, which changes with time"),
                features.collect(),
            )
        })
    }
}

/// The channels in which a signature is anything.
fn reached(signature: &Signature) -> Vec<usize> {
    let moments = signature.moments.iter().map(|one| &one.column);
    let all: Vec<&Columns> = signature.columns.iter().chain(moments).collect();
    let channels = all.first().map_or(0, |columns| columns.len());
    (0..channels)
        .filter(|&c| {
            all.iter()
                .any(|columns| columns[c].iter().any(|x| *x != 0.0))
        })
        .collect()
}

/// The edge, of the `inner` ones, at which a change of all sizes explains most: columns fitted
/// before and after it. None where no change explains anything.
fn best_moment(
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
    for edge in 1..edges.len() - 1 {
        if inner.contains(&edge) {
            let gain = before.explained() + whole.minus(&before).explained();
            if best.is_none_or(|(most, _)| gain > most) {
                best = Some((gain, edge));
            }
        }
        before = before.plus(&parts[edge]);
    }
    best.map(|(_, edge)| edge)
}

#[cfg(test)]
mod tests {
    use super::*;
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
}
