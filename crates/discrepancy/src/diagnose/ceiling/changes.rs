//! What a law does that changes with time: a friction that fades, a brake that drags from some
//! moment on, a load that is let go.
//!
//! Each signature of the screening is fitted with one size before a moment and another after it, or
//! with a size that goes with time. Neither needs the motion to come again.

use rayon::prelude::*;
use truecut_recording::significant;

use super::Target;
use super::onset::{Step, best_moment};
use crate::diagnose::answer::target_name;
use crate::diagnose::features::{Group, Onset};
use crate::diagnose::noise::{dot, explained};
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
        let samples = self.samples();
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
                    self.at_once(&law, &traces, &samples),
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
        let refined = best.into_par_iter();
        refined.map(|group| self.refined(group, &samples)).collect()
    }

    /// A change at once, where its moment lies between samples, through the filter of the data.
    fn refined(&self, group: Group, samples: &[usize]) -> Group {
        let data = self.problem.data;
        let (Some(fine), Some(onset)) = (&data.fine, group.changes) else {
            return group;
        };
        let Some(from_s) = onset.from_s else {
            return group;
        };
        let row = data.time_s.partition_point(|time_s| *time_s < from_s);
        let step = Step::of(fine);
        let left: Vec<f64> = samples.iter().map(|&t| self.residual[t]).collect();
        let gain = |moment: usize| {
            let picked = |x: Vec<f64>| samples.iter().map(|&t| x[t]).collect();
            let columns: Vec<Vec<f64>> = parted(&group.traces, |t| step.passed(t, moment))
                .map(picked)
                .collect();
            explained(&left, &columns)
        };
        let Some(moment) = step
            .moments_about(row)
            .max_by(|a, b| gain(*a).total_cmp(&gain(*b)))
        else {
            return group;
        };
        let interval_s = data.time_s[row] - data.time_s[row - 1];
        let later = (moment as f64 - (row * fine.every) as f64) / fine.every as f64;
        let from_s = data.time_s[row] + interval_s * later;
        Group {
            name: at_about(&group.law, from_s),
            changes: Some(Onset {
                from_s: Some(from_s),
            }),
            features: parted(&group.traces, |t| step.passed(t, moment)).collect(),
            ..group
        }
    }

    fn law(&self, signature: &Signature) -> String {
        let candidate = &self.problem.candidates[signature.candidate];
        match target_name(candidate) {
            Some(target) => format!("{} of {target}", candidate.kind.name()),
            None => candidate.kind.name().to_owned(),
        }
    }

    /// What is measured at the borders of blocks, too: nothing is fitted there, but it says when.
    fn samples(&self) -> Vec<usize> {
        let all = self.problem.split.blocks.iter().cloned().flatten();
        all.filter(|&t| self.valid[t]).collect()
    }

    fn at_once(&self, law: &str, traces: &[&Vec<f64>], samples: &[usize]) -> Option<Group> {
        let at = |x: &[f64]| -> Vec<f64> { samples.iter().map(|&t| x[t]).collect() };
        let picked: Vec<Vec<f64>> = traces.iter().map(|trace| at(trace)).collect();
        let left = at(self.residual);
        let count = samples.len();
        let edge = |part: usize| count * part / PARTS;
        let coarse: Vec<usize> = (0..=PARTS).map(edge).collect();
        let inner = LEAST_PARTS..PARTS - LEAST_PARTS + 1;
        let part = best_moment(&picked, &left, &coarse, inner)?;
        let (from, to) = (coarse[part - 1], coarse[part + 1]);
        let mut fine = vec![0];
        fine.extend((0..=PARTS).map(|i| from + (to - from) * i / PARTS));
        fine.push(count);
        fine.dedup();
        let inner = 1..fine.len() - 1;
        let row = samples[fine[best_moment(&picked, &left, &fine, inner)?]];
        let from_s = self.problem.data.time_s[row];
        let features = parted(traces, |t| if t >= row { 1.0 } else { 0.0 });
        Some(Group {
            chosen: 1,
            law: law.to_owned(),
            changes: Some(Onset {
                from_s: Some(from_s),
            }),
            ..Group::of_time(at_about(law, from_s), features.collect())
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

fn at_about(law: &str, from_s: f64) -> String {
    format!("{law}, which changes at about {} s", significant(from_s, 3))
}

/// Of each trace what is before a moment and what is after it; `passed` is the part of a sample
/// that is after it.
fn parted<'a, T: AsRef<[f64]>>(
    traces: &'a [T],
    passed: impl Fn(usize) -> f64 + Copy + 'a,
) -> impl Iterator<Item = Vec<f64>> + 'a {
    traces.iter().flat_map(move |trace| {
        [false, true].map(|is_late| {
            let part = |t| if is_late { passed(t) } else { 1.0 - passed(t) };
            let rows = trace.as_ref().iter().enumerate();
            rows.map(|(t, x)| part(t) * x).collect()
        })
    })
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
