//! What any model could still gain: a flexible predictor of the residual, cross-validated by blocks.

use std::f64::consts::TAU;

use rayon::prelude::*;
use realfft::RealFftPlanner;

use super::answer::{Ceiling, Lock};
use super::data::{Observation, Rows};
use super::noise::{ChannelNoise, Noise, Prior, dot, solve, subtract};
use super::problem::Problem;
use super::validate::{batch_sums, error_of_sum};
use crate::model::Columns;

/// A group of features of one kind, one column each.
struct Group {
    name: String,
    features: Vec<Vec<f64>>,
}

/// The predictor's end: what it explains, and what it leaves.
pub(super) struct Bound {
    pub ceiling: Ceiling,
    /// Sum of whitened squares that it takes away.
    pub gain: f64,
    /// Residual less the prediction of all groups found, fitted to all rows.
    pub left: Columns,
}

/// Gains of a group must be beyond so many standard errors; dozens of groups are tried.
const LEAST_T: f64 = 4.5;
const LEAST_FRACTION: f64 = 0.01;
const FOLDS: usize = 6;
const MOST_GROUPS: usize = 4;

/// Bounds what can be explained of the residual.
pub(super) fn bound(
    problem: &Problem,
    predicted: &Columns,
    residual: &Columns,
    noise: &Noise,
) -> Bound {
    let rows = &problem.split.development;
    let orders: Vec<usize> = noise.channels.iter().map(|c| c.ar.len()).collect();
    let groups = groups(problem, predicted);
    let mut left = residual.clone();
    let (mut gain, mut sums, mut total) = (0.0, Vec::new(), 0.0);
    let mut locks = Vec::new();
    for c in 0..residual.len() {
        let mut chosen: Vec<&Group> = Vec::new();
        let lines = line_group(problem, &residual[c], c);
        let all: Vec<&Group> = groups.iter().chain(lines.iter()).collect();
        let mut noise = noise.channels[c].clone();
        let mut now = whitened_squares(&noise, &left[c], rows, c);
        let mut final_gains = vec![0.0; rows.per_channel[c].len()];
        for _ in 0..MOST_GROUPS {
            let scored = best_group(problem, c, &residual[c], &noise, &chosen, &all);
            let Some((group, gains)) = scored else { break };
            let already: f64 = final_gains.iter().sum();
            let step: Vec<f64> = gains.iter().zip(&final_gains).map(|(a, b)| a - b).collect();
            let error = error_of_sum(&batch_sums(&step));
            let added = gains.iter().sum::<f64>() - already;
            if added <= LEAST_T * error || added < LEAST_FRACTION * now {
                break;
            }
            locks.push(Lock {
                to: group.name.clone(),
                channel: problem.model.channels()[c].name.clone(),
                fraction: added / now,
                t: added / error,
            });
            chosen.push(group);
            left[c] = without_groups(&residual[c], &chosen, &noise, rows, c);
            // The noise is that of what is left: the autoregression had taken a part of the pattern for noise.
            noise = Noise::fit(&left, rows, &orders, &problem.floor).channels[c].clone();
            now = whitened_squares(&noise, &residual[c], rows, c);
            final_gains = cross_validated(problem, c, &residual[c], &noise, &chosen);
        }
        gain += final_gains.iter().sum::<f64>();
        sums.extend(batch_sums(&final_gains));
        total += now;
    }
    locks.sort_by(|a, b| b.fraction.total_cmp(&a.fraction));
    let error = error_of_sum(&sums);
    let ceiling = Ceiling {
        fraction: if total > 0.0 {
            (gain / total).max(0.0)
        } else {
            0.0
        },
        t: if error > 0.0 { gain / error } else { 0.0 },
        locks,
    };
    Bound {
        ceiling,
        gain: gain.max(0.0),
        left,
    }
}

fn whitened_squares(noise: &ChannelNoise, column: &[f64], rows: &Rows, c: usize) -> f64 {
    let e = whiten(noise, column, &rows.per_channel[c]);
    dot(&e, &e)
}

fn whiten(noise: &ChannelNoise, column: &[f64], rows: &[usize]) -> Vec<f64> {
    let whitener = Noise {
        channels: vec![noise.clone()],
    };
    let rows = Rows {
        per_channel: vec![rows.to_vec()],
    };
    whitener.whiten(&vec![column.to_vec()], &rows)
}

type Scored<'a> = Option<(&'a Group, Vec<f64>)>;

fn best_group<'a>(
    problem: &Problem,
    c: usize,
    residual: &[f64],
    noise: &ChannelNoise,
    chosen: &[&'a Group],
    all: &[&'a Group],
) -> Scored<'a> {
    let free: Vec<&&Group> = all
        .iter()
        .filter(|g| chosen.iter().all(|h| h.name != g.name))
        .collect();
    let scored: Vec<(f64, Vec<f64>)> = free
        .par_iter()
        .map(|group| {
            let set = [chosen, &[**group]].concat();
            let gains = cross_validated(problem, c, residual, noise, &set);
            (gains.iter().sum(), gains)
        })
        .collect();
    let best = (0..scored.len()).max_by(|&a, &b| scored[a].0.total_cmp(&scored[b].0))?;
    Some((free[best], scored[best].1.clone()))
}

/// For each development row of a channel, the fall of the whitened square by a prediction fitted to the other folds.
fn cross_validated(
    problem: &Problem,
    c: usize,
    residual: &[f64],
    noise: &ChannelNoise,
    groups: &[&Group],
) -> Vec<f64> {
    let rows = &problem.split.development.per_channel[c];
    let target = whiten(noise, residual, rows);
    let columns: Vec<Vec<f64>> = features(groups).map(|x| whiten(noise, x, rows)).collect();
    let blocks = &problem.split.blocks;
    let folds = FOLDS.min(blocks.len());
    let fold_of = |t: usize| blocks.iter().position(|b| b.contains(&t)).unwrap_or(0) % folds;
    let fold: Vec<usize> = rows.iter().map(|&t| fold_of(t)).collect();
    let mut gains = vec![0.0; rows.len()];
    for held_out in 0..folds {
        let pick = |x: &[f64]| -> Vec<f64> {
            let kept = x.iter().zip(&fold).filter(|(_, f)| **f != held_out);
            kept.map(|(x, _)| *x).collect()
        };
        let picked: Vec<Vec<f64>> = columns.iter().map(|x| pick(x)).collect();
        let coefficients = solve(&pick(&target), &picked, &ridge(&picked));
        for p in (0..rows.len()).filter(|p| fold[*p] == held_out) {
            let predicted: f64 = columns
                .iter()
                .zip(&coefficients)
                .map(|(x, b)| x[p] * b)
                .sum();
            gains[p] = target[p].powi(2) - (target[p] - predicted).powi(2);
        }
    }
    gains
}

fn features<'a>(groups: &'a [&'a Group]) -> impl Iterator<Item = &'a Vec<f64>> {
    groups.iter().flat_map(|g| &g.features)
}

/// A little shrinkage, so that bins with few samples do not matter.
fn ridge(columns: &[Vec<f64>]) -> Vec<Prior> {
    let precision = |x: &Vec<f64>| (dot(x, x) / x.len().max(1) as f64).sqrt();
    columns
        .iter()
        .map(|x| Prior {
            offset: 0.0,
            precision: precision(x),
        })
        .collect()
}

fn without_groups(
    residual: &[f64],
    groups: &[&Group],
    noise: &ChannelNoise,
    rows: &Rows,
    c: usize,
) -> Vec<f64> {
    let rows = &rows.per_channel[c];
    let columns: Vec<Vec<f64>> = features(groups).map(|x| whiten(noise, x, rows)).collect();
    let coefficients = solve(&whiten(noise, residual, rows), &columns, &ridge(&columns));
    let mut left = vec![residual.to_vec()];
    for (x, b) in features(groups).zip(&coefficients) {
        subtract(&mut left, &vec![x.clone()], *b);
    }
    left.remove(0)
}

/// What the residual may follow: predicted outputs and known signals, their rates, time.
fn groups(problem: &Problem, predicted: &Columns) -> Vec<Group> {
    let data = problem.data;
    let mut groups = vec![Group {
        name: "a constant".into(),
        features: vec![vec![1.0; data.time_s.len()]],
    }];
    let (first, last) = (data.time_s[0], data.time_s[data.time_s.len() - 1]);
    let relative: Vec<f64> = data
        .time_s
        .iter()
        .map(|t| 2.0 * (t - first) / (last - first) - 1.0)
        .collect();
    groups.push(Group {
        name: "time".into(),
        features: (0..4)
            .map(|k| relative.iter().map(|x| x.powi(k)).collect())
            .collect(),
    });
    let outputs = problem
        .model
        .channels()
        .iter()
        .map(|spec| spec.name.as_str())
        .zip(predicted.iter());
    let known = data.regressors.iter().filter(|r| !r.is_angle);
    for (name, values) in outputs.chain(known.map(|r| (r.name.as_str(), &r.values))) {
        if let Some(standard) = standardised(values) {
            signal_groups(name, &standard, data, &mut groups);
        }
    }
    for angle in data.regressors.iter().filter(|r| r.is_angle) {
        for harmonic in 1..=6 {
            let phase = |f: fn(f64) -> f64| {
                angle
                    .values
                    .iter()
                    .map(|x| f(harmonic as f64 * x))
                    .collect()
            };
            groups.push(Group {
                name: format!("{harmonic} per revolution of {}", angle.name),
                features: vec![phase(f64::cos), phase(f64::sin)],
            });
        }
    }
    groups
}

fn standardised(values: &[f64]) -> Option<Vec<f64>> {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let spread = (values.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / n).sqrt();
    (spread > 1e-12 * mean.abs() && spread > 0.0)
        .then(|| values.iter().map(|x| (x - mean) / spread).collect())
}

fn signal_groups(name: &str, x: &[f64], data: &Observation, groups: &mut Vec<Group>) {
    let starts: Vec<usize> = data.trajectories.iter().map(|r| r.start).collect();
    let shifted = |lag: usize| -> Vec<f64> {
        let first = |t: usize| starts.iter().rev().find(|s| **s <= t).copied().unwrap_or(0);
        (0..x.len())
            .map(|t| x[t.saturating_sub(lag).max(first(t))])
            .collect()
    };
    groups.push(Group {
        name: format!("{name}, linearly"),
        features: [0, 1, 2, 4, 8, 16, 32]
            .iter()
            .map(|lag| shifted(*lag))
            .collect(),
    });
    groups.push(Group {
        name: name.to_string(),
        features: bins(x, 8),
    });
    let before = shifted(2);
    let rate: Vec<f64> = x.iter().zip(&before).map(|(a, b)| a - b).collect();
    if let Some(rate) = standardised(&rate) {
        let signs: Vec<f64> = rate.iter().map(|v| (v * 20.0).tanh()).collect();
        groups.push(Group {
            name: format!("direction of {name}"),
            features: vec![signs.clone()],
        });
        groups.push(Group {
            name: format!("rate of {name}"),
            features: bins(&rate, 8),
        });
        let products = bins(x, 6)
            .into_iter()
            .map(|b| b.iter().zip(&signs).map(|(b, s)| b * s).collect());
        groups.push(Group {
            name: format!("{name} and its direction"),
            features: products.collect(),
        });
    }
}

/// Overlapping linear bins ("hats") between quantiles: together they follow any smooth curve.
fn bins(x: &[f64], count: usize) -> Vec<Vec<f64>> {
    let mut sorted = x.to_vec();
    sorted.sort_by(f64::total_cmp);
    let mut knots: Vec<f64> = (0..count)
        .map(|i| sorted[(sorted.len() - 1) * i / (count - 1)])
        .collect();
    knots.dedup_by(|a, b| (*a - *b).abs() < 1e-9);
    let hat = |i: usize, value: f64| {
        let rise = i
            .checked_sub(1)
            .map_or(1.0, |p| (value - knots[p]) / (knots[i] - knots[p]));
        let fall = knots
            .get(i + 1)
            .map_or(1.0, |next| (next - value) / (next - knots[i]));
        rise.min(fall).clamp(0.0, 1.0)
    };
    (0..knots.len())
        .map(|i| x.iter().map(|v| hat(i, *v)).collect())
        .collect()
}

/// The strongest line of a residual beyond its smooth spectrum, from the training rows.
fn line_group(problem: &Problem, residual: &[f64], c: usize) -> Option<Group> {
    let data = problem.data;
    let rows = &problem.split.train.per_channel[c];
    let interval = data.time_s[1] - data.time_s[0];
    let duration = data.time_s[data.time_s.len() - 1] - data.time_s[0];
    let orders = Noise::orders(
        &vec![residual.to_vec()],
        &Rows {
            per_channel: vec![rows.clone()],
        },
        &[0.0],
    );
    let white = Noise::fit(
        &vec![residual.to_vec()],
        &Rows {
            per_channel: vec![rows.clone()],
        },
        &[orders[0].min(2)],
        &[1e-300],
    );
    let e = whiten(&white.channels[0], residual, rows);
    // Samples that are no rows stay zero.
    let mut padded = vec![0.0; (2 * data.time_s.len()).next_power_of_two()];
    for (e, &t) in e.iter().zip(rows) {
        padded[t] = *e;
    }
    let length = padded.len();
    let transform = RealFftPlanner::<f64>::new().plan_fft_forward(length);
    let mut spectrum = transform.make_output_vec();
    transform.process(&mut padded, &mut spectrum).ok()?;
    let slowest = (2.0 * length as f64 * interval / duration).ceil() as usize;
    let powers = spectrum
        .iter()
        .map(|z| z.norm_sqr())
        .enumerate()
        .skip(slowest);
    let (peak, _) = powers.max_by(|a, b| a.1.total_cmp(&b.1))?;
    let frequency = peak as f64 / (length as f64 * interval);
    let wave = |f: fn(f64) -> f64| data.time_s.iter().map(|t| f(TAU * frequency * t)).collect();
    Some(Group {
        name: format!(
            "a line at {} Hz",
            truecut_recording::significant(frequency, 3)
        ),
        features: vec![wave(f64::cos), wave(f64::sin)],
    })
}
