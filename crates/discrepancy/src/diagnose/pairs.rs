//! Pair look-ahead: effects that are insignificant alone and significant together.

use std::ops::Range;

use rayon::prelude::*;

use super::fit::Fit;
use super::moments::Moments;
use super::noise::{Noise, Prior, dot};
use super::problem::Problem;
use super::screen::{Ranked, critical, nuisance, projected};
use crate::model::Columns;

/// Pairs that gain most beyond their better half, from the signatures alone: two under the noise
/// model, and three under white noise, since the autoregression may have taken for noise what two
/// effects leave that mask each other.
pub(super) fn pairs(
    problem: &Problem,
    base: &Fit,
    ranking: &[Ranked],
    tests: usize,
) -> Vec<(Ranked, Ranked)> {
    let white = Noise::white(&base.residual, &problem.split.train, &problem.floor);
    let mut pairs = best_pairs(problem, base, ranking, tests, &base.noise, 2);
    pairs.extend(best_pairs(problem, base, ranking, tests, &white, 3));
    pairs
}

fn best_pairs(
    problem: &Problem,
    base: &Fit,
    ranking: &[Ranked],
    tests: usize,
    noise: &Noise,
    count: usize,
) -> Vec<(Ranked, Ranked)> {
    let together = Together::new(problem, base, ranking, noise);
    let single: Vec<f64> = (0..ranking.len())
        .into_par_iter()
        .map(|i| together.objective(&[i]))
        .collect();
    let best = single.iter().copied().fold(f64::INFINITY, f64::min);
    let indices: Vec<(usize, usize)> = (0..ranking.len())
        .flat_map(|i| (i + 1..ranking.len()).map(move |j| (i, j)))
        .collect();
    let worth = |&(i, j): &(usize, usize)| {
        let both = together.objective(&[i, j]);
        // Most are no better than the best of all alone, without a threshold.
        if both >= best {
            return None;
        }
        let dof = ranking[i].start.len().min(ranking[j].start.len());
        let bar = critical(problem.options.family_wise_error, tests * tests, dof);
        (both + bar < best).then_some((both, i, j))
    };
    let mut good: Vec<(f64, usize, usize)> = indices.par_iter().filter_map(worth).collect();
    good.sort_by(|a, b| a.0.total_cmp(&b.0));
    // Pairs of which each has something new: many pairs say nearly the same.
    let mut chosen: Vec<(usize, usize)> = Vec::new();
    for (_, i, j) in good {
        let new = chosen
            .iter()
            .all(|&(a, b)| ![a, b].contains(&i) && ![a, b].contains(&j));
        if chosen.len() < count && new {
            chosen.push((i, j));
        }
    }
    let good = chosen.into_iter();
    good.map(|(i, j)| {
        (
            paired_start(&ranking[i], problem),
            paired_start(&ranking[j], problem),
        )
    })
    .collect()
}

/// What candidates explain together of a residual, whitened and less what the present model can do.
struct Together {
    channels: Vec<Channel>,
    /// The columns of each candidate.
    own: Vec<Range<usize>>,
}

/// One channel: products of the columns of all candidates, and what they are to explain.
struct Channel {
    moments: Moments,
    count: f64,
    square: f64,
    /// What noise leaves at least.
    least: f64,
}

/// So often sizes are found anew under the noise that they leave in each channel.
const ROUNDS: usize = 2;

impl Together {
    fn new(problem: &Problem, base: &Fit, ranking: &[Ranked], noise: &Noise) -> Together {
        let train = &problem.split.train;
        let (known, priors) = nuisance(problem, base);
        let known: Vec<_> = known.iter().map(|x| noise.whiten(x, train)).collect();
        let beside = |x: &Columns| projected(&noise.whiten(x, train), &known, &priors);
        let target = beside(&base.residual);
        let columns: Vec<Vec<Vec<f64>>> = (ranking.par_iter())
            .map(|one| may_be(one, problem).into_iter().map(beside).collect())
            .collect();
        let mut own = Vec::new();
        let mut all = Vec::new();
        for columns in columns {
            own.push(all.len()..all.len() + columns.len());
            all.extend(columns);
        }
        let mut first = 0;
        let channels = (noise
            .channels
            .iter()
            .zip(&problem.floor)
            .zip(&train.per_channel))
        .map(|((noise, floor), rows)| {
            let range = first..first + rows.len();
            first = range.end;
            let part: Vec<Vec<f64>> = all.iter().map(|x| x[range.clone()].to_vec()).collect();
            let count = rows.len() as f64;
            Channel {
                moments: Moments::new(&target[range.clone()], &part),
                count,
                square: dot(&target[range.clone()], &target[range]),
                least: count * (floor / noise.sigma).powi(2).max(f64::MIN_POSITIVE),
            }
        })
        .collect();
        Together { channels, own }
    }

    /// Minus twice the log-likelihood of what some candidates leave, in noise of that size in each
    /// channel. In noise of the size of the whole residual, of which one explains nearly all, the
    /// other would be lost.
    fn objective(&self, candidates: &[usize]) -> f64 {
        let columns: Vec<usize> = (candidates.iter())
            .flat_map(|candidate| self.own[*candidate].clone())
            .collect();
        let parts: Vec<Moments> = (self.channels.iter())
            .map(|channel| channel.moments.of(&columns))
            .collect();
        let mut weights = vec![1.0; parts.len()];
        let mut objective = 0.0;
        for _ in 0..ROUNDS {
            let weighed = parts.iter().zip(&weights);
            let whole = weighed.map(|(part, weight)| part.times(*weight));
            let whole = whole.reduce(|sum, part| sum.plus(&part));
            let sizes = whole.map_or(Vec::new(), |whole| {
                whole.solve(&vec![Prior::default(); columns.len()])
            });
            objective = 0.0;
            for ((channel, part), weight) in self.channels.iter().zip(&parts).zip(&mut weights) {
                let left = channel.square - part.explained_by(&sizes);
                let variance = left.max(channel.least) / channel.count.max(1.0);
                *weight = 1.0 / variance;
                objective += channel.count * variance.ln();
            }
        }
        objective
    }
}

/// Whether a size of a candidate came out as nothing, or would have come out beyond its bound.
fn is_nothing(ranked: &Ranked, problem: &Problem, size: usize) -> bool {
    ranked.start[size] == problem.infos(ranked.candidate())[size].neutral
}

/// Changes by the sizes of a candidate that may be there: friction that drives in one direction
/// would explain an offset with dry friction as well as both do. All of them where it came out as
/// nothing alone.
fn may_be<'a>(ranked: &'a Ranked, problem: &Problem) -> Vec<&'a Columns> {
    let signature = &ranked.signature;
    let is_there = |size: &usize| !is_nothing(ranked, problem, *size);
    let is_idle = !signature.sizes.iter().any(is_there);
    let sizes = signature.sizes.iter().zip(&signature.columns);
    sizes
        .filter(|(size, _)| is_idle || is_there(size))
        .map(|(_, column)| column)
        .collect()
}

/// Alone it may have come out as nothing, so in a pair it starts from the size of its signature.
fn paired_start(ranked: &Ranked, problem: &Problem) -> Ranked {
    let mut ranked = ranked.clone();
    let mut sizes = ranked.signature.sizes.iter();
    let idle = sizes.all(|&size| is_nothing(&ranked, problem, size));
    if idle {
        ranked.start.clone_from(&ranked.signature.values);
    }
    ranked
}
