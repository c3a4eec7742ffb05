//! What a law does that changes with time: a friction that fades, a brake that drags from some
//! moment on, a load that is let go.
//!
//! Each signature of the screening is fitted with one size before a moment and another after it, or
//! with a size that goes with time. Neither needs the motion to come again.

use rayon::prelude::*;
use truecut_recording::significant;

use super::Target;
use super::onset::{Step, Sums};
use crate::diagnose::answer::target_name;
use crate::diagnose::features::{Group, Onset};
use crate::diagnose::moments::explained;
use crate::diagnose::noise::{ChannelNoise, dot};
use crate::diagnose::signature::Signature;
use crate::model::Columns;

/// Parts of the rows between which a change is looked for, and of the two parts beside the best
/// moment.
const PARTS: usize = 24;
/// Parts on either side of a change: what happens in less comes once and has no law.
const LEAST_PARTS: usize = 2;
/// Shortest stretch in which something is another, s: a gap of up to 0.05 s is bridged and a spike
/// replaced, and what is off beside them is no event.
const SHORTEST_S: f64 = 0.1;
/// And its samples: each is foretold by the others.
const FEWEST: usize = 3;
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
                true => [None, None, None],
                false => {
                    let course = Course::new(self, &law, &traces, &samples);
                    [
                        course.at_once(),
                        course.for_a_while(),
                        self.steadily(&law, &traces),
                    ]
                }
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
            let kind = |one: &Group| one.changes.map(|onset| onset.moments_s().count());
            let is_new =
                (best.iter()).all(|other| other.law != group.law || kind(other) != kind(&group));
            if is_new && best.len() < PROMISING && !self.comes_again(&group) {
                best.push(group);
            }
        }
        let refined = best.into_par_iter();
        refined.map(|group| self.refined(group, &samples)).collect()
    }

    /// Whether what goes with time does not show between passes or periods of the inputs: without
    /// it they differ by more. What comes again with the motion is no change over time.
    pub(super) fn comes_again(&self, group: &Group) -> bool {
        let left = self.without(&[group], &ChannelNoise::WHITE);
        let between = |x: &[f64]| -> f64 {
            let pairs = self.problem.data.again.iter();
            let pairs = pairs.filter(|pair| pair.iter().all(|&t| self.valid[t]));
            pairs.map(|&[t, later]| (x[later] - x[t]).powi(2)).sum()
        };
        between(&left) > between(self.residual)
    }

    /// A change at once, where its moments lie between samples, through the filter of the data.
    fn refined(&self, group: Group, samples: &[usize]) -> Group {
        let data = self.problem.data;
        let (Some(fine), Some(onset)) = (&data.fine, group.changes) else {
            return group;
        };
        let row = |moment_s: f64| data.time_s.partition_point(|time_s| *time_s < moment_s);
        let rows: Vec<usize> = onset.moments_s().map(row).collect();
        if rows.is_empty() {
            return group;
        }
        let step = Step::of(fine);
        let left: Vec<f64> = samples.iter().map(|&t| self.residual[t]).collect();
        let gain = |moments: &[usize]| {
            let picked = |x: Vec<f64>| samples.iter().map(|&t| x[t]).collect();
            let columns: Vec<Vec<f64>> = parted(&group.traces, |t| step.between(t, moments))
                .map(picked)
                .collect();
            explained(&left, &columns)
        };
        let mut moments: Vec<usize> = rows.iter().map(|row| row * fine.every).collect();
        for k in 0..rows.len() {
            let at = |moment: usize| {
                let mut moved = moments.clone();
                moved[k] = moment;
                moved
            };
            let about = step.moments_about(rows[k]);
            let best = about.max_by(|a, b| gain(&at(*a)).total_cmp(&gain(&at(*b))));
            if let Some(best) = best {
                moments[k] = best;
            }
        }
        let time_s = |k: usize| {
            let row = rows[k].max(1);
            let interval_s = data.time_s[row] - data.time_s[row - 1];
            let later = (moments[k] as f64 - (row * fine.every) as f64) / fine.every as f64;
            data.time_s[row] + interval_s * later
        };
        let onset = Onset {
            from_s: Some(time_s(0)),
            until_s: (rows.len() > 1).then(|| time_s(1)),
        };
        Group {
            name: at_about(&group.law, onset),
            changes: Some(onset),
            features: parted(&group.traces, |t| step.between(t, &moments)).collect(),
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
            changes: Some(Onset::STEADY),
            ..Group::of_time(
                format!("{law}, which changes with time"),
                features.collect(),
            )
        })
    }
}

/// The traces of a law in a channel, at all samples measured, and moments between which it may
/// change.
struct Course<'a> {
    target: &'a Target<'a>,
    law: &'a str,
    traces: &'a [&'a Vec<f64>],
    samples: &'a [usize],
    /// Traces and what is left, at the samples.
    picked: Vec<Vec<f64>>,
    left: Vec<f64>,
    /// Parts of the samples.
    edges: Vec<usize>,
    sums: Option<Sums>,
}

impl<'a> Course<'a> {
    fn new(
        target: &'a Target<'a>,
        law: &'a str,
        traces: &'a [&'a Vec<f64>],
        samples: &'a [usize],
    ) -> Course<'a> {
        let at = |x: &[f64]| -> Vec<f64> { samples.iter().map(|&t| x[t]).collect() };
        let picked: Vec<Vec<f64>> = traces.iter().map(|trace| at(trace)).collect();
        let left = at(target.residual);
        let edges: Vec<usize> = (0..=PARTS)
            .map(|part| samples.len() * part / PARTS)
            .collect();
        Course {
            sums: Sums::new(&picked, &left, &edges),
            target,
            law,
            traces,
            samples,
            picked,
            left,
            edges,
        }
    }

    /// Edges about these, so many for each, with the ends; and the sums between them.
    fn finer(&self, parts: &[usize]) -> Option<(Vec<usize>, Sums)> {
        let about = parts.iter().flat_map(|&part| {
            let (from, to) = (self.edges[part - 1], self.edges[part + 1]);
            (0..=PARTS).map(move |i| from + (to - from) * i / PARTS)
        });
        let mut fine: Vec<usize> = about.chain([0, self.samples.len()]).collect();
        fine.sort_unstable();
        fine.dedup();
        let sums = Sums::new(&self.picked, &self.left, &fine)?;
        Some((fine, sums))
    }

    fn group(&self, onset: Onset, passed: impl Fn(usize) -> bool + Copy) -> Group {
        let part = move |t| f64::from(u8::from(passed(t)));
        Group {
            chosen: onset.moments_s().count(),
            law: self.law.to_owned(),
            changes: Some(onset),
            ..Group::of_time(
                at_about(self.law, onset),
                parted(self.traces, part).collect(),
            )
        }
    }

    fn time_s(&self, row: usize) -> f64 {
        self.target.problem.data.time_s[row]
    }

    /// Another from a moment on.
    fn at_once(&self) -> Option<Group> {
        let inner = LEAST_PARTS..PARTS - LEAST_PARTS + 1;
        let part = self.sums.as_ref()?.best_moment(inner)?;
        let (fine, sums) = self.finer(&[part])?;
        let row = self.samples[fine[sums.best_moment(1..fine.len() - 1)?]];
        let onset = Onset {
            from_s: Some(self.time_s(row)),
            until_s: None,
        };
        Some(self.group(onset, |t| t >= row))
    }

    /// Another between two moments than before and after them: a brake that drags for a while, a
    /// blow, a part that is held and put down.
    fn for_a_while(&self) -> Option<Group> {
        let parts = self.sums.as_ref()?.best_window()?;
        let (fine, sums) = self.finer(&parts)?;
        let [from, until] = sums.best_window()?.map(|edge| self.samples[fine[edge]]);
        let [from_s, until_s] = [from, until].map(|row| self.time_s(row));
        if until_s - from_s < SHORTEST_S || until - from < FEWEST {
            return None;
        }
        let onset = Onset {
            from_s: Some(from_s),
            until_s: Some(until_s),
        };
        Some(self.group(onset, |t| (from..until).contains(&t)))
    }
}

fn at_about(law: &str, onset: Onset) -> String {
    let moments: Vec<String> = (onset.moments_s())
        .map(|moment_s| significant(moment_s, 3))
        .collect();
    match moments.as_slice() {
        [from, until] => format!("{law}, which is another from about {from} to {until} s"),
        _ => format!("{law}, which changes at about {} s", moments.concat()),
    }
}

/// Of each trace what is before a moment and what is after it, or what is outside of a stretch and
/// what is inside; `passed` is the part of a sample that is after it or inside.
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
