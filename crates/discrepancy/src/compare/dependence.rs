//! Whether the residual's mean changes with position, sign of velocity, spindle phase, load or
//! time.

use nalgebra::DVector;
use serde::Serialize;

use super::series::{Explanatory, Kind};
use crate::stats::distributions::f_tail;
use crate::stats::{Background, counted, ratio, sum_covariance};

/// The residual's mean over an explanatory signal.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Dependence {
    /// The signal.
    pub signal: String,
    /// What kind it is.
    pub kind: Kind,
    /// Bins in ascending order of the signal.
    pub bins: Vec<Bin>,
    /// Wald's statistic of equal means over its degrees of freedom.
    pub statistic: f64,
    /// Degrees of freedom above and below the line of the F distribution.
    pub degrees_of_freedom: [f64; 2],
    /// p-value of the hypothesis of equal means.
    pub p_value: f64,
    /// Fraction of the residual's variance that lies between the bins.
    pub share: f64,
}

/// Samples with similar values of the signal.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Bin {
    /// Mean of the signal, SI.
    pub signal: f64,
    /// Mean of the residual, SI.
    pub mean: f64,
    /// Standard error of its difference from the mean of all bins, under coloured noise.
    pub standard_error: f64,
    /// Number of samples.
    pub samples: usize,
}

/// Fewest samples of a bin.
const LEAST_SAMPLES: usize = 20;
/// Below this fraction of the largest speed a joint counts as at rest.
const AT_REST: f64 = 0.01;

/// Wald test of equal means. Their covariance comes from the coloured background of the residual
/// less its bin means, so that dependence on the signal does not count as noise. `None` if the
/// signal fills fewer than two bins, or nothing is left.
pub fn dependence(residual: &[f64], valid: &[bool], signal: &Explanatory) -> Option<Dependence> {
    let places = &bins(signal, valid);
    let count = 1 + places.iter().flatten().max()?;
    if count < 2 {
        return None;
    }
    let rows = |bin: usize| (0..residual.len()).filter(move |row| places[*row] == Some(bin));
    let sizes: Vec<f64> = (0..count).map(|bin| rows(bin).count() as f64).collect();
    let total: f64 = sizes.iter().sum();
    let used: Vec<f64> = places
        .iter()
        .map(|place| f64::from(u8::from(place.is_some())))
        .collect();
    let column = |bin: usize| -> Vec<f64> {
        let share = sizes[bin] / total;
        let own = |row: usize| f64::from(u8::from(places[row] == Some(bin)));
        (0..residual.len())
            .map(|row| used[row] * (own(row) - share))
            .collect()
    };
    let columns: Vec<Vec<f64>> = (0..count).map(column).collect();
    // The columns add up to zero: the last is redundant.
    let free = count - 1;
    let background = Background::of_regression(residual, valid, &columns[..free])?;
    let covariance = sum_covariance(&columns, &background);
    let sum = |column: &Vec<f64>| column.iter().zip(residual).map(|(a, r)| a * r).sum::<f64>();
    let sums = DVector::from_iterator(count, columns.iter().map(sum));
    let inner = covariance.matrix.view((0, 0), (free, free)).into_owned();
    let head = sums.rows(0, free).into_owned();
    let statistic = head.dot(&inner.cholesky()?.solve(&head)) / free as f64;
    let mean_of =
        |values: &[f64], bin: usize| rows(bin).map(|r| values[r]).sum::<f64>() / sizes[bin];
    let bins: Vec<Bin> = (0..count)
        .map(|bin| Bin {
            signal: mean_of(&shown(signal), bin),
            mean: mean_of(residual, bin),
            standard_error: covariance.matrix[(bin, bin)].sqrt() / sizes[bin],
            samples: sizes[bin] as usize,
        })
        .collect();
    Some(Dependence {
        signal: signal.spec.name.clone(),
        kind: signal.kind,
        share: share_between(residual, places, &bins),
        bins,
        statistic,
        degrees_of_freedom: [free as f64, covariance.degrees],
        p_value: f_tail(statistic, free as f64, covariance.degrees),
    })
}

/// Variance between the bins over all variance of the samples in them.
fn share_between(residual: &[f64], places: &[Option<usize>], bins: &[Bin]) -> f64 {
    let total: f64 = bins.iter().map(|bin| bin.samples as f64).sum();
    let mean = bins
        .iter()
        .map(|bin| bin.samples as f64 * bin.mean)
        .sum::<f64>()
        / total;
    let between = bins
        .iter()
        .map(|bin| bin.samples as f64 * (bin.mean - mean).powi(2))
        .sum::<f64>();
    let counted = residual
        .iter()
        .zip(places)
        .filter(|(_, place)| place.is_some());
    let all: f64 = counted.map(|(r, _)| (r - mean).powi(2)).sum();
    ratio(between, all)
}

/// The signal as binned: an angle modulo one turn.
fn shown(signal: &Explanatory) -> Vec<f64> {
    match signal.kind {
        Kind::SpindlePhase => {
            let turn = std::f64::consts::TAU;
            signal
                .values
                .iter()
                .map(|angle| angle.rem_euclid(turn))
                .collect()
        }
        _ => signal.values.clone(),
    }
}

/// Number of the bin of each sample; `None` for samples that do not count or fall in no bin.
fn bins(signal: &Explanatory, valid: &[bool]) -> Vec<Option<usize>> {
    let values = shown(signal);
    let edges = match signal.kind {
        Kind::Velocity => return signs(&values, valid),
        Kind::SpindlePhase => (1..12)
            .map(|i| std::f64::consts::TAU * f64::from(i) / 12.0)
            .collect(),
        Kind::Position | Kind::Load | Kind::Time => quantiles(&values, valid, 8),
    };
    let place = |value: f64| edges.partition_point(|edge| *edge <= value);
    let places: Vec<Option<usize>> = values
        .iter()
        .zip(valid)
        .map(|(value, valid)| valid.then(|| place(*value)))
        .collect();
    without_small(places, edges.len() + 1)
}

/// Backward and forward; samples at rest are in no bin.
fn signs(values: &[f64], valid: &[bool]) -> Vec<Option<usize>> {
    let fastest = values
        .iter()
        .fold(0.0, |fastest: f64, v| fastest.max(v.abs()));
    let place = |(value, valid): (&f64, &bool)| {
        (*valid && value.abs() > AT_REST * fastest).then(|| usize::from(*value > 0.0))
    };
    without_small(values.iter().zip(valid).map(place).collect(), 2)
}

/// Minus and plus one; zero at rest.
pub(super) fn direction(velocity: &Explanatory, valid: &[bool]) -> Vec<f64> {
    let sign = |place: Option<usize>| place.map_or(0.0, |bin| 2.0 * bin as f64 - 1.0);
    let places = signs(&velocity.values, valid).into_iter();
    places.map(sign).collect()
}

/// Inner edges of bins with equally many samples; equal edges are merged.
fn quantiles(values: &[f64], valid: &[bool], count: usize) -> Vec<f64> {
    let mut sorted: Vec<f64> = counted(values, valid).collect();
    sorted.sort_by(f64::total_cmp);
    let mut edges: Vec<f64> = (1..count)
        .filter_map(|i| sorted.get(i * sorted.len() / count).copied())
        .collect();
    edges.dedup();
    // Nothing lies below the smallest value.
    edges.retain(|edge| sorted.first().is_some_and(|first| first < edge));
    edges
}

/// Bins with too few samples are dropped and the others renumbered.
fn without_small(places: Vec<Option<usize>>, count: usize) -> Vec<Option<usize>> {
    let mut sizes = vec![0; count];
    places.iter().flatten().for_each(|place| sizes[*place] += 1);
    let mut next = 0..;
    let renamed: Vec<Option<usize>> = sizes
        .iter()
        .map(|size| {
            if *size >= LEAST_SAMPLES {
                next.next()
            } else {
                None
            }
        })
        .collect();
    places
        .into_iter()
        .map(|place| place.and_then(|place| renamed[place]))
        .collect()
}
