//! Features for a flexible predictor of the residual.

use super::data::Observation;
use super::problem::Problem;
use crate::model::Columns;
use crate::stats::{deviation, mean};

/// A group of features of one kind, one column each.
pub(super) struct Group {
    pub name: String,
    /// Whether it follows a signal that comes back many times; time and lines do not, and slow
    /// noise may look like them.
    pub by_signal: bool,
    /// How many numbers were chosen so that the features fit: a frequency, a damping.
    pub chosen: usize,
    /// Numbers of a filter that was taken from the residual itself.
    pub filtered_by: usize,
    /// Whether it is something that changes over time.
    pub changes: Option<Onset>,
    /// The law that changes.
    pub law: String,
    /// Channels in which that law is anything; none but its own if it is left empty.
    pub reaches: Vec<usize>,
    /// Its traces if it does not change.
    pub traces: Vec<Vec<f64>>,
    pub features: Vec<Vec<f64>>,
}

/// The name of what goes with time and nothing else.
pub(super) const TIME: &str = "time";

/// When something changes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Onset {
    /// Of the data, in seconds; none if it changes all the time.
    pub from_s: Option<f64>,
    /// When it is again what it was; none if it stays.
    pub until_s: Option<f64>,
}

impl Onset {
    /// All the time.
    pub const STEADY: Onset = Onset {
        from_s: None,
        until_s: None,
    };

    /// The moments that it has.
    pub fn moments_s(self) -> impl Iterator<Item = f64> {
        self.from_s.into_iter().chain(self.until_s)
    }
}

impl Group {
    /// Features that follow a signal.
    pub fn of_signal(name: impl Into<String>, features: Vec<Vec<f64>>) -> Group {
        Group {
            name: name.into(),
            by_signal: true,
            chosen: 0,
            filtered_by: 0,
            changes: None,
            law: String::new(),
            reaches: Vec::new(),
            traces: Vec::new(),
            features,
        }
    }

    /// Features that depend on time alone.
    pub fn of_time(name: impl Into<String>, features: Vec<Vec<f64>>) -> Group {
        Group {
            by_signal: false,
            ..Group::of_signal(name, features)
        }
    }

    /// Whether it goes with time itself.
    pub fn is_of_time(&self) -> bool {
        !self.by_signal && (self.chosen > 0 || self.changes.is_some())
    }

    /// All numbers that make it fit.
    pub fn numbers(&self) -> usize {
        self.features.len() + self.chosen + self.filtered_by
    }

    /// Number of parameters chosen to explain most, those of the features included; 0 if none was.
    pub fn tuned(&self) -> usize {
        match self.chosen {
            0 => 0,
            chosen => self.features.len() + chosen,
        }
    }
}

/// Signals that the residual may depend on: predicted outputs and known signals, their rates, time.
pub(super) fn groups(problem: &Problem, predicted: &Columns) -> Vec<Group> {
    let data = problem.data;
    let (first, last) = (data.time_s[0], data.time_s[data.time_s.len() - 1]);
    let relative: Vec<f64> = (data.time_s.iter())
        .map(|t| 2.0 * (t - first) / (last - first) - 1.0)
        .collect();
    let power = |k: i32| relative.iter().map(|x| x.powi(k)).collect();
    let mut groups = vec![
        Group::of_time("a constant", vec![vec![1.0; data.time_s.len()]]),
        Group {
            changes: Some(Onset::STEADY),
            ..Group::of_time(TIME, (0..4).map(power).collect())
        },
    ];
    for (name, values) in problem.signals(predicted) {
        if let Some(standard) = standardised(values) {
            signal_groups(name, &standard, data, &mut groups);
        }
    }
    for angle in data.regressors.iter().filter(|r| r.is_angle) {
        for harmonic in 1..=6 {
            let phase = |f: fn(f64) -> f64| {
                let angles = angle.values.iter();
                angles.map(|x| f(f64::from(harmonic) * x)).collect()
            };
            groups.push(Group::of_signal(
                format!("{harmonic} per revolution of {}", angle.name),
                vec![phase(f64::cos), phase(f64::sin)],
            ));
        }
    }
    groups
}

fn standardised(values: &[f64]) -> Option<Vec<f64>> {
    let (mean, spread) = (mean(values), deviation(values));
    (spread > 1e-12 * mean.abs() && spread > 0.0)
        .then(|| values.iter().map(|x| (x - mean) / spread).collect())
}

/// Delays of an output in samples, and the sizes at which they may differ.
const DELAYS: [usize; 6] = [0, 2, 5, 10, 18, 30];
const SIZES: usize = 4;

/// A channel that comes late by a time which goes with its size. The output is the nominal model's:
/// what effects of sensors make of it is late already.
pub(super) fn delay_by_size(problem: &Problem, channel: usize, output: &[f64]) -> Option<Group> {
    let x = standardised(output)?;
    let sizes: Vec<f64> = output.iter().map(|x| x.abs()).collect();
    let sizes = bins(&standardised(&sizes)?, SIZES);
    let delayed = DELAYS.iter().map(|lag| shifted(&x, problem.data, *lag));
    let name = &problem.model.channels()[channel].name;
    Some(Group::of_signal(
        format!("delay of {name}, by its size"),
        delayed.flat_map(|x| products(&sizes, &x)).collect(),
    ))
}

fn products(bins: &[Vec<f64>], factor: &[f64]) -> Vec<Vec<f64>> {
    bins.iter()
        .map(|b| b.iter().zip(factor).map(|(b, f)| b * f).collect())
        .collect()
}

/// A signal so many samples before, within its pass.
fn shifted(x: &[f64], data: &Observation, lag: usize) -> Vec<f64> {
    let starts: Vec<usize> = data.trajectories.iter().map(|r| r.start).collect();
    let first = |t: usize| starts.iter().rev().find(|s| **s <= t).copied().unwrap_or(0);
    (0..x.len())
        .map(|t| x[t.saturating_sub(lag).max(first(t))])
        .collect()
}

fn signal_groups(name: &str, x: &[f64], data: &Observation, groups: &mut Vec<Group>) {
    let lags = [0, 1, 2, 4, 8, 16, 32];
    let lagged = lags.iter().map(|lag| shifted(x, data, *lag)).collect();
    groups.push(Group::of_signal(format!("{name}, linearly"), lagged));
    groups.push(Group::of_signal(name, bins(x, 12)));
    let before = shifted(x, data, 2);
    let rate: Vec<f64> = x.iter().zip(&before).map(|(a, b)| a - b).collect();
    let Some(rate) = standardised(&rate) else {
        return;
    };
    let signs: Vec<f64> = rate.iter().map(|v| (v * 20.0).tanh()).collect();
    let of_rate = [
        (format!("direction of {name}"), vec![signs.clone()]),
        (format!("rate of {name}"), bins(&rate, 8)),
        (
            format!("rate of {name}, by its size"),
            products(&bins(x, 8), &rate),
        ),
        (
            format!("place of {name} and its direction"),
            harmonics(x, &signs),
        ),
        (
            format!("{name} and its direction"),
            products(&bins(x, 12), &signs),
        ),
    ];
    groups.extend(of_rate.map(|(name, features)| Group::of_signal(name, features)));
}

/// Half waves over the range of a signal.
const HARMONICS: usize = 14;

/// Waves over the range of a signal, with a sign.
fn harmonics(x: &[f64], signs: &[f64]) -> Vec<Vec<f64>> {
    let low = x.iter().copied().fold(f64::INFINITY, f64::min);
    let high = x.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let mut waves = vec![signs.to_vec()];
    for k in 1..=HARMONICS {
        for wave in [f64::cos, f64::sin] {
            let phase = |v: f64| std::f64::consts::PI * k as f64 * (v - low) / (high - low);
            let pairs = x.iter().zip(signs);
            waves.push(pairs.map(|(v, s)| wave(phase(*v)) * s).collect());
        }
    }
    waves
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
