//! Bound on the gain of any further model: a flexible predictor of the residual, cross-validated by
//! blocks.

mod changes;
mod derived;
mod folds;
mod inputs;
mod onset;
mod waves;

pub(super) use waves::wave_over;

use std::sync::atomic::{AtomicBool, Ordering};

use rayon::prelude::*;

use self::folds::{Folds, features, ridge};
use self::inputs::{exceeds_inputs, rounding};
use super::answer::{Ceiling, Change, CorrelatedSignal};
use super::features::{Group, delay_by_size, groups};
use super::fit::Fit;
use super::memory::{Freedom, channel_distance};
use super::moments::Moments;
use super::noise::{ChannelNoise, add_column, dot};
use super::problem::Problem;
use super::resonance::resonance;
use super::signature::Signature;
use super::span::spans;
use super::validate::{differences, rms};
use crate::model::Columns;
use crate::stats::ratio;

/// Result of the predictor: what it explains, and its residual.
pub(super) struct Bound {
    pub ceiling: Ceiling,
    /// Sum of whitened squares that it explains.
    pub gain: f64,
    /// Residual less the prediction of all groups found, fitted to all rows; good on the
    /// development part.
    pub left: Columns,
    /// Part of the residual's square that they foretell on blocks that they were not fitted to, of
    /// each channel, as it is.
    pub foretold: Vec<f64>,
    /// Whether a signal foretells much of what is left of a channel on blocks that it was not
    /// fitted to, though it may be slow noise.
    pub is_hinted: bool,
    /// How many numbers made the groups found fit, of each channel.
    pub numbers: Vec<usize>,
    /// Root mean square of that on the test part; on the development part where a group was not
    /// simulated beyond it.
    pub floor: Vec<f64>,
    /// What changes over time.
    pub changes: Vec<Change>,
    /// Whether a channel follows time itself, which motion that comes again does not repeat.
    pub in_time: Vec<bool>,
}

/// Gains of a group must be beyond so many standard errors; a pattern that is strong in few places
/// has large ones.
const LEAST_T: f64 = 1.5;
/// Thresholds of a group.
#[derive(Clone, Copy)]
struct Least {
    fraction: f64,
    /// Significance in noise of any memory, against chance: a group has one or two dozen
    /// parameters, and a hundred groups are tried.
    standing_out: f64,
}

const LEAST: Least = Least {
    fraction: 0.03,
    standing_out: 11.0,
};
/// Under white noise, for which slow noise is much that can be explained.
const LEAST_PLAIN: Least = Least {
    fraction: 0.05,
    standing_out: 13.0,
};
/// Least mean crossings of a recurring feature.
const LEAST_CROSSINGS: usize = 6;
/// What is left changes over time where a course in time is more than this part of it.
/// Tuned on 160 sets of `tests/random_bench/changes.py`. It holds on 320 others (from 7750001 on):
/// a course found in what changes was 0.62 to 1 of it, one in what does not 0.13 at most.
const PREVAILS: f64 = 0.25;
const MOST_GROUPS: usize = 4;

/// One channel: what is to be explained, and where.
struct Target<'a> {
    problem: &'a Problem<'a>,
    residual: &'a [f64],
    /// Whether each sample was measured.
    valid: &'a [bool],
    rows: &'a [usize],
    order: usize,
    floor: f64,
    /// Standard deviation of what the noise of measured inputs makes of the prediction.
    of_inputs: f64,
    folds: Folds,
    /// Whether a signal foretells much that does not stand out of slow noise.
    is_hinted: AtomicBool,
}

/// Groups fitted together, with the noise of what they leave.
struct GroupTrial<'a> {
    groups: Vec<&'a Group>,
    noise: ChannelNoise,
    left: Vec<f64>,
    /// The whitened residual of each row.
    whole: Vec<f64>,
    /// The same less a prediction fitted to the other folds.
    errors: Vec<f64>,
}

/// Bounds what can be explained of the residual; of signatures those count whose effects the model
/// does not have.
pub(super) fn bound(problem: &Problem, base: &Fit, last: &Fit, signatures: &[Signature]) -> Bound {
    let (residual, noise) = (&last.residual, &last.noise);
    let others = signatures.iter();
    let others: Vec<&Signature> = others
        .filter(|one| !last.point.holds(one.candidate))
        .collect();
    let groups = groups(problem, &last.predicted);
    let mut left = residual.clone();
    let (mut floor, mut numbers) = (Vec::new(), vec![0; residual.len()]);
    let (mut foretold, mut is_hinted) = (vec![0.0; residual.len()], false);
    let (mut gain, mut sums, mut total) = (0.0, Vec::new(), 0.0);
    let mut correlated_signals = Vec::new();
    let (mut changes, mut in_time) = (Vec::new(), vec![false; residual.len()]);
    for c in 0..residual.len() {
        if rms(residual, &problem.split.development)[c] < rounding(problem, c) {
            // What rounding leaves follows the readings themselves.
            floor.push(rms(residual, &problem.split.test)[c]);
            continue;
        }
        let target = Target::new(problem, &residual[c], c, noise.channels[c].ar.len());
        let mut own = target.lines();
        own.extend(target.waves(&last.predicted));
        own.extend(target.through_dynamics(&groups));
        own.extend(delay_by_size(problem, c, &base.predicted[c]));
        own.extend(resonance(
            problem,
            &last.predicted,
            target.residual,
            target.rows,
        ));
        let mut simulated = spans(problem, &others, c);
        simulated.extend(target.changes(c, signatures));
        let all: Vec<&Group> = groups
            .iter()
            .chain(&simulated)
            .chain(&own)
            .filter(|g| !g.by_signal || target.comes_back(g))
            // Of laws that change it has been asked.
            .filter(|g| !g.is_of_time() || !g.traces.is_empty() || !target.comes_again(g))
            .collect();
        let known = correlated_signals.len();
        let trial = target.explain(
            &all,
            &problem.model.channels()[c].name,
            &mut correlated_signals,
        );
        let (own, chance) = differences(&trial.whole, &trial.errors);
        gain += own;
        sums.extend(chance);
        total += dot(&trial.whole, &trial.whole);
        let prevailing = trial.groups.iter().zip(&correlated_signals[known..]);
        let prevailing = prevailing.filter(|(_, signal)| signal.fraction > PREVAILS);
        for (group, signal) in prevailing.filter(|(group, _)| group.is_of_time()) {
            (group.reaches.iter().chain([&c])).for_each(|&one| in_time[one] = true);
            changes.extend(group.changes.map(|onset| Change {
                channel: signal.channel.clone(),
                from_s: onset.from_s,
                until_s: onset.until_s,
                what: match group.law.as_str() {
                    "" => group.name.clone(),
                    law => law.to_owned(),
                },
            }));
        }
        let of_search = |group: &&Group| simulated.iter().any(|own| std::ptr::eq(*group, own));
        let rows = if trial.groups.iter().any(of_search) {
            &problem.split.development
        } else {
            &problem.split.test
        };
        numbers[c] = trial.groups.iter().map(|group| group.numbers()).sum();
        foretold[c] = target.foretold(&trial.groups);
        is_hinted |= target.is_hinted.load(Ordering::Relaxed);
        left[c] = trial.left;
        floor.push(rms(&left, rows)[c]);
    }
    correlated_signals.sort_by(|a, b| b.fraction.total_cmp(&a.fraction));
    let error = dot(&sums, &sums).sqrt();
    let ceiling = Ceiling {
        fraction: ratio(gain, total).max(0.0),
        t: ratio(gain, error),
        correlated_signals,
    };
    Bound {
        ceiling,
        gain: gain.max(0.0),
        left,
        foretold,
        is_hinted,
        numbers,
        floor,
        changes,
        in_time,
    }
}

impl<'a> Target<'a> {
    fn new(problem: &'a Problem, residual: &'a [f64], c: usize, order: usize) -> Target<'a> {
        let rows = &problem.split.development.per_channel[c];
        Target {
            problem,
            residual,
            valid: &problem.data.outputs[c].valid,
            rows,
            order,
            floor: problem.floor[c],
            of_inputs: problem.data.outputs[c].noise_of_inputs,
            folds: Folds::of_blocks(&problem.split.blocks, rows),
            is_hinted: AtomicBool::new(false),
        }
    }

    /// Whether most features of a group return often: those that wander look like slow noise, which
    /// would be taken for them.
    fn comes_back(&self, group: &Group) -> bool {
        let returns = |x: &Vec<f64>| {
            let picked: Vec<f64> = self.rows.iter().map(|&t| x[t]).collect();
            let mean = picked.iter().sum::<f64>() / picked.len() as f64;
            let above: Vec<bool> = picked.iter().map(|x| *x > mean).collect();
            above.windows(2).filter(|w| w[0] != w[1]).count() >= LEAST_CROSSINGS
        };
        // What changes comes back if the law does, whenever it changes.
        let traces = match group.traces.is_empty() {
            true => &group.features,
            false => &group.traces,
        };
        2 * traces.iter().filter(|x| returns(x)).count() > traces.len()
    }

    /// Takes group after group while they gain clearly: under the noise model, else under white
    /// noise. A pattern with sharp edges is all but lost where the autoregression has taken a part
    /// of it for noise.
    fn explain<'g>(
        &self,
        all: &[&'g Group],
        channel: &str,
        correlated_signals: &mut Vec<CorrelatedSignal>,
    ) -> GroupTrial<'g> {
        let mut now = self.trial(Vec::new(), self.order);
        while now.groups.len() < MOST_GROUPS {
            // A line and a law that changes come back as often as a signal does, and an
            // autoregression of some order follows either.
            let comes_back = |g: &&Group| g.by_signal || g.is_of_time() && self.comes_back(g);
            let signals: Vec<&'g Group> = all.iter().copied().filter(comes_back).collect();
            let found = self.next(&now, all, self.order, LEAST);
            let found = found.or_else(|| self.next(&now, &signals, 0, LEAST_PLAIN));
            let Some((next, mut signal)) = found else {
                break;
            };
            signal.channel = channel.to_string();
            correlated_signals.push(signal);
            now = next;
        }
        now
    }

    /// The group that explains most in addition to those already taken, if significant.
    fn next<'g>(
        &self,
        now: &GroupTrial<'g>,
        all: &[&'g Group],
        order: usize,
        least: Least,
    ) -> Option<(GroupTrial<'g>, CorrelatedSignal)> {
        let free: Vec<&'g Group> = all
            .iter()
            .copied()
            .filter(|g| now.groups.iter().all(|h| h.name != g.name))
            .collect();
        let trials: Vec<GroupTrial> = free
            .par_iter()
            .map(|group| self.trial([now.groups.as_slice(), &[group]].concat(), order))
            .collect();
        let next = trials
            .into_iter()
            .min_by(|a, b| a.criterion().total_cmp(&b.criterion()))?;
        // Both under the noise of the larger, which has taken less of the pattern for noise.
        let smaller = self.errors(&now.groups, &next.noise, &self.folds(&next.groups));
        let (added, chance) = differences(&smaller, &next.errors);
        let (error, total) = (dot(&chance, &chance).sqrt(), dot(&next.whole, &next.whole));
        let signal = CorrelatedSignal {
            signal: next.groups[next.groups.len() - 1].name.clone(),
            channel: String::new(),
            fraction: added / total,
            t: added / error,
        };
        let clear = added > LEAST_T * error
            && added > least.fraction * total
            && exceeds_inputs(self.rows, self.residual, &next.left, self.of_inputs);
        let distance = || {
            let sum = |of: fn(&Group) -> usize| next.groups.iter().map(|group| of(group)).sum();
            let freedom = Freedom {
                parameters: sum(|group| group.features.len()),
                tuned: sum(Group::tuned),
            };
            channel_distance(self.problem, self.rows, &now.left, &next.left, freedom)
        };
        let stands_out = clear && distance() > least.standing_out;
        let by_signal = next.groups.last().is_some_and(|group| group.by_signal);
        if clear && !stands_out && by_signal && order == 0 && signal.fraction > PREVAILS {
            self.is_hinted.store(true, Ordering::Relaxed);
        }
        stands_out.then_some((next, signal))
    }

    /// Least squares under white noise, then twice under the noise of what is left: an
    /// autoregression of the residual as it is would take the pattern for noise.
    fn trial<'g>(&self, groups: Vec<&'g Group>, order: usize) -> GroupTrial<'g> {
        let mut noise = ChannelNoise::WHITE;
        let mut left = self.residual.to_vec();
        for _ in 0..3 {
            left = self.without(&groups, &noise);
            noise = self.noise(&left, order);
        }
        GroupTrial {
            whole: noise.whiten(self.residual, self.rows),
            errors: self.errors(&groups, &noise, &self.folds(&groups)),
            groups,
            noise,
            left,
        }
    }

    fn noise(&self, left: &[f64], order: usize) -> ChannelNoise {
        ChannelNoise::fit(left, self.rows, order, self.floor)
    }

    fn without(&self, groups: &[&Group], noise: &ChannelNoise) -> Vec<f64> {
        let columns = self.whitened(groups, noise);
        let moments = Moments::new(&noise.whiten(self.residual, self.rows), &columns);
        let coefficients = moments.solve(&ridge(moments.squares(), self.rows.len()));
        let mut left = self.residual.to_vec();
        for (x, b) in features(groups).zip(&coefficients) {
            add_column(&mut left, x, -b);
        }
        // Where nothing was measured nothing is left.
        let samples = left.iter_mut().zip(self.valid);
        (samples.filter(|(_, valid)| !**valid)).for_each(|(left, _)| *left = 0.0);
        left
    }

    fn whitened(&self, groups: &[&Group], noise: &ChannelNoise) -> Vec<Vec<f64>> {
        let columns = features(groups).map(|x| noise.whiten(x, self.rows));
        columns.collect()
    }

    /// Whitened residual less predictions fitted to the other folds.
    fn errors(&self, groups: &[&Group], noise: &ChannelNoise, folds: &Folds) -> Vec<f64> {
        let target = noise.whiten(self.residual, self.rows);
        let columns = self.whitened(groups, noise);
        let parts: Vec<Moments> = (0..folds.count)
            .map(|fold| {
                let pick = |x: &[f64]| -> Vec<f64> {
                    let kept = x.iter().zip(&folds.of_row).filter(|(_, f)| **f == fold);
                    kept.map(|(x, _)| *x).collect()
                };
                let picked: Vec<Vec<f64>> = columns.iter().map(|x| pick(x)).collect();
                Moments::new(&pick(&target), &picked)
            })
            .collect();
        let whole = parts
            .iter()
            .skip(1)
            .fold(parts[0].clone(), |sum, part| sum.plus(part));
        let mut errors = target.clone();
        for (held_out, part) in parts.iter().enumerate() {
            let others = whole.minus(part);
            let count = folds.of_row.iter().filter(|f| **f != held_out).count();
            let coefficients = others.solve(&ridge(others.squares(), count));
            for p in (0..self.rows.len()).filter(|p| folds.of_row[*p] == held_out) {
                let predicted: f64 = columns
                    .iter()
                    .zip(&coefficients)
                    .map(|(x, b)| x[p] * b)
                    .sum();
                errors[p] -= predicted;
            }
        }
        errors
    }
}
