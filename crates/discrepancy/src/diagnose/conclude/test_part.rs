//! The test part, which is opened last.

use std::collections::BTreeMap;

use crate::diagnose::answer::{Change, ChannelErrors, Diagnosis, Verdict};
use crate::diagnose::ceiling::Bound;
use crate::diagnose::data::Rows;
use crate::diagnose::fit::{Fit, fit};
use crate::diagnose::floor::{Floor, NoiseSource, memory};
use crate::diagnose::noise::{ChannelNoise, dot};
use crate::diagnose::problem::Problem;
use crate::diagnose::validate::{batch_sums, compare, error_of_sum, rms};
use crate::model::Columns;
use crate::stats::centred;
use crate::stats::distributions::{chi_squared_quantile, f_tail};

/// Errors on the test part.
pub(super) fn errors(
    problem: &Problem,
    before: &Columns,
    base: &Fit,
    last: &Fit,
    bound: &Bound,
    floors: &[Option<Floor>],
) -> BTreeMap<String, ChannelErrors> {
    let test = &problem.split.test;
    let nominal = rms(&problem.data.residual(before), test);
    let (refitted, after) = (rms(&base.residual, test), rms(&last.residual, test));
    let all = problem.split.development.joined(test);
    let most: Vec<f64> = (bound.floor.iter().enumerate())
        .map(|(c, floor)| floor.max(most_noise(&last.residual[c], &all.per_channel[c])))
        .collect();
    channel_errors(problem, floors, &nominal, &refitted, &after, &most)
}

/// Noise of which what is left of a channel would be as little only by one chance in so many.
const UNLIKELY_LITTLE: f64 = 0.05;

/// The most that a channel's noise may be: what is left in all its samples, and by how much noise
/// of the memory that this has may be larger than one record of it.
fn most_noise(residual: &[f64], rows: &[usize]) -> f64 {
    let left: Vec<f64> = rows.iter().map(|&t| residual[t]).collect();
    let degrees = (left.len() as f64 / memory(&[centred(&left)])).max(1.0);
    let least = chi_squared_quantile(1.0 - UNLIKELY_LITTLE, degrees) / degrees;
    (dot(&left, &left) / left.len().max(1) as f64 / least).sqrt()
}

/// Scores on the test part. It changes the verdict only where the test part contradicts it.
/// What changes all along needs no last part that is unlike the one before.
pub(super) fn open_test(
    problem: &Problem,
    base: &Fit,
    last: &Fit,
    changes: &[Change],
    diagnosis: &mut Diagnosis,
) {
    let test = &problem.split.test;
    if diagnosis.verdict == Verdict::FitFailed {
        return;
    }
    let paired = compare(&base.residual, &last.residual, &last.noise, test);
    // Before the test part is called different, what the part before leaves uncertain is settled by
    // both together.
    let all = problem.split.development.joined(test);
    let orders = last.noise.own_orders();
    let refitted_to_all = fit(problem, last.point.clone(), &all, &orders, true);
    let settled = refitted_to_all.unwrap_or_else(|_| last.clone());
    let worse = !last.point.effects.is_empty() && paired.t() < -2.0;
    let apart = changes.is_empty() && breaks_away(problem, &settled);
    if worse || apart {
        diagnosis.verdict = Verdict::UnknownCause;
        diagnosis.alternatives.clear();
        diagnosis.experiments.clear();
        let from = part_of(problem);
        diagnosis.reason = match apart {
            true => format!(
                "In the last part of the data, from {from} s on, there is a discrepancy that the part before does not \
                 have."
            ),
            false => format!(
                "The last part of the data, from {from} s on, contradicts the causes named: without them it is \
                 predicted better."
            ),
        };
    }
}

/// Where the test part begins, in seconds.
pub(super) fn part_of(problem: &Problem) -> String {
    let first = first_of(&problem.split.test);
    truecut_recording::significant(problem.data.time_s[first], 4)
}

fn first_of(rows: &Rows) -> usize {
    rows.per_channel
        .iter()
        .filter_map(|rows| rows.first().copied())
        .min()
        .unwrap_or(0)
}

/// Whether the error on the test part is clearly larger than before it: whitened, or as it is about
/// its median. Slow noise wanders, so a mean alone must be far away. What noise that is known comes
/// to by itself is no discrepancy, unless it has a pattern that the part before has nothing like;
/// repetition counts what a last part has alone as noise, and says nothing here.
fn breaks_away(problem: &Problem, last: &Fit) -> bool {
    let (before, test) = (&problem.split.development, &problem.split.test);
    (0..last.residual.len()).any(|c| {
        let (noise, column) = (&last.noise.channels[c], &last.residual[c]);
        let whitened = |rows: &Rows| noise.whiten(column, &rows.per_channel[c]);
        let plain = |rows: &Rows| ChannelNoise::WHITE.whiten(column, &rows.per_channel[c]);
        let (a, b) = (plain(before), plain(test));
        let known = problem.known[c].as_ref();
        let is_noise = known.is_some_and(|floor| {
            floor.source != NoiseSource::Repetition
                && floor.beyond(column, &test.per_channel[c]).is_none()
        });
        let (least, ratio) = if is_noise { (8.0, 4.0) } else { (6.0, 1.25) };
        is_larger(&whitened(before), &whitened(test), least, ratio)
            || is_larger(&about_median(&a), &about_median(&b), 8.0, 4.0)
            || is_larger(&a, &b, 8.0, 12.0)
    })
}

/// Whether what is left of one recording is clearly larger than what is left of another, about its
/// median.
pub(crate) fn breaks_away_from(before: &[f64], after: &[f64]) -> bool {
    is_larger(&about_median(before), &about_median(after), 8.0, 4.0)
}

/// A single sample far off moves a mean away from all others.
fn about_median(x: &[f64]) -> Vec<f64> {
    let mut sorted = x.to_vec();
    sorted.sort_by(f64::total_cmp);
    let middle = sorted.get(sorted.len() / 2).copied().unwrap_or(0.0);
    x.iter().map(|x| x - middle).collect()
}

/// A sample's square counts for at most so many times the mean square.
const SINGLE: f64 = 16.0;

/// A quantile: in noise alone, one comparison of two parts in so many exceeds it. Of a diagnosis of
/// seven channels, each looked at in three ways, one in two hundred.
const BY_CHANCE: f64 = 2.5e-4;

/// Whether the mean square is larger by the ratio, by so many standard errors, and by more than
/// noise with the memory of the earlier part comes to by chance. In noise alone both errors are
/// alike up to their lengths; where the later part is unlike, its own error is larger. A few
/// batches tell the error badly, the memory alone does not tell what is uneven.
fn is_larger(before: &[f64], after: &[f64], least: f64, ratio: f64) -> bool {
    let (n, m) = (before.len() as f64, after.len() as f64);
    // One sample about which an event comes a step early is no discrepancy of the whole part.
    let most = SINGLE * dot(before, before) / n;
    let squares = |x: &[f64]| -> Vec<f64> { x.iter().map(|x| (x * x).min(most)).collect() };
    let expected = error_of_sum(&batch_sums(&squares(before))) / n * (n / m).sqrt();
    let mean = |x: &[f64]| squares(x).iter().sum::<f64>() / x.len() as f64;
    let (a, b) = (mean(before), mean(after));
    if b <= ratio * a || b - a <= least * expected {
        return false;
    }
    let memory = memory(&[centred(before)]);
    f_tail(b / a, (m / memory).max(1.0), (n / memory).max(1.0)) < BY_CHANCE
}

/// What is left is noise without memory if it is larger than that by no more than this.
const WITHOUT_MEMORY: f64 = 1.15;

pub(super) fn channel_errors(
    problem: &Problem,
    floors: &[Option<Floor>],
    nominal: &[f64],
    refitted: &[f64],
    after: &[f64],
    bound: &[f64],
) -> BTreeMap<String, ChannelErrors> {
    let specs = problem.model.channels().iter().enumerate();
    specs
        .map(|(c, spec)| {
            // Where less is left than differences show, the motion is not smooth, and they say
            // nothing of the noise.
            let without_memory = problem.data.outputs[c].noise_without_memory;
            let without_memory = match without_memory <= WITHOUT_MEMORY * after[c] {
                true => without_memory,
                false => 0.0,
            };
            let (noise_floor, noise_source) = match &floors[c] {
                Some(floor) => (floor.whole, floor.source),
                None if after[c] <= WITHOUT_MEMORY * without_memory => {
                    (without_memory, NoiseSource::Differences)
                }
                None => (bound[c], NoiseSource::Bound),
            };
            let errors = ChannelErrors {
                before: nominal[c],
                refitted: refitted[c],
                after: after[c],
                noise_floor,
                noise_source,
                noise_without_memory: without_memory,
                unit: spec.unit.to_string(),
            };
            (spec.name.clone(), errors)
        })
        .collect()
}

/// What is left of a channel is at least this part of its noise, if that is as stated.
const OVERSTATED: f64 = 0.2;

/// The doubts about noise that is stated far larger than what is left of its channel.
pub(super) fn overstated(
    channels: &BTreeMap<String, ChannelErrors>,
) -> impl Iterator<Item = String> + '_ {
    let stated = (channels.iter()).filter(|(_, one)| one.noise_source == NoiseSource::Stated);
    let far = stated.filter(|(_, one)| 0.0 < one.after && one.after < OVERSTATED * one.noise_floor);
    far.map(|(name, one)| {
        format!(
            "the noise stated of `{name}` is {} times what is left of it: look at its unit",
            truecut_recording::significant(one.noise_floor / one.after, 3)
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{Colour, noise};

    /// One reversal that comes a sample early is no discrepancy of the whole part, however large it
    /// is beside the noise; a pattern in all of it is.
    #[test]
    fn regress_a_single_sample_is_no_part_that_breaks_away() {
        for seed in 0..40 {
            let drawn = noise(Colour::Ar1(0.6), 250, seed);
            let (before, after) = drawn.split_at(200);
            let mut single = after.to_vec();
            single[7 + seed as usize] += 300.0;
            let apart =
                |part: &[f64]| is_larger(&about_median(before), &about_median(part), 8.0, 4.0);
            assert!(!apart(&single), "seed {seed}");
            let wave = |k: usize| 12.0 * (0.4 * k as f64 + seed as f64).sin();
            let pattern: Vec<f64> = (after.iter().enumerate())
                .map(|(k, x)| x + wave(k))
                .collect();
            assert!(apart(&pattern), "seed {seed}");
        }
    }

    /// Parts of short records in noise of several memories: one in four hundred at most is called
    /// larger; by the errors of six batches alone it was up to one in ninety.
    #[test]
    fn verify_noise_alone_seldom_breaks_away() {
        let colours = [Colour::White, Colour::Ar1(0.5), Colour::Ar1(0.8)];
        for (seed, colour) in colours.into_iter().enumerate() {
            let drawn = noise(colour, 4000 * 168, seed as u64);
            let called = drawn.chunks_exact(168).filter(|part| {
                let (before, after) = part.split_at(136);
                is_larger(before, after, 6.0, 1.25)
            });
            let called = called.count();
            assert!(called <= 10, "{colour:?}: {called} of 4000");
        }
    }
}
