//! Pair look-ahead: effects that are insignificant alone and significant together.

use rayon::prelude::*;

use super::fit::Fit;
use super::noise::{Noise, explained};
use super::problem::Problem;
use super::screen::{Ranked, critical, nuisance, projected};

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
    let train = &problem.split.train;
    let (columns, priors) = nuisance(problem, base);
    let columns: Vec<_> = columns.iter().map(|x| noise.whiten(x, train)).collect();
    let target = projected(&noise.whiten(&base.residual, train), &columns, &priors);
    let pieces: Vec<Vec<Vec<f64>>> = ranking
        .par_iter()
        .map(|r| {
            let whitened = r.signature.columns.iter().map(|x| noise.whiten(x, train));
            whitened.map(|x| projected(&x, &columns, &priors)).collect()
        })
        .collect();
    let single: Vec<f64> = pieces.par_iter().map(|x| explained(&target, x)).collect();
    let indices: Vec<(usize, usize)> = (0..ranking.len())
        .flat_map(|i| (i + 1..ranking.len()).map(move |j| (i, j)))
        .collect();
    let gains: Vec<f64> = indices
        .par_iter()
        .map(|&(i, j)| {
            let both = [pieces[i].as_slice(), &pieces[j]].concat();
            explained(&target, &both) - single[i].max(single[j])
        })
        .collect();
    let best = single.iter().copied().fold(0.0, f64::max);
    let mut good: Vec<(f64, usize, usize)> = indices
        .iter()
        .zip(&gains)
        .map(|(&(i, j), gain)| (gain + single[i].max(single[j]), i, j, *gain))
        .filter(|&(total, i, j, gain)| {
            let dof = ranking[i].start.len().min(ranking[j].start.len());
            let bar = critical(problem.options.family_wise_error, tests * tests, dof);
            gain > bar && total > best + bar
        })
        .map(|(total, i, j, _)| (total, i, j))
        .collect();
    good.sort_by(|a, b| b.0.total_cmp(&a.0));
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

/// Alone it may have come out as nothing, so in a pair it starts from the size of its signature.
fn paired_start(ranked: &Ranked, problem: &Problem) -> Ranked {
    let mut ranked = ranked.clone();
    let infos = problem.infos(ranked.candidate());
    let idle = ranked
        .signature
        .sizes
        .iter()
        .all(|&i| ranked.start[i] == infos[i].neutral);
    if idle {
        ranked.start.clone_from(&ranked.signature.values);
    }
    ranked
}
