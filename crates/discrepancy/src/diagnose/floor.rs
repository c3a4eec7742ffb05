//! The noise floor: how large an output's noise is, known from something that no answer can reach.
//!
//! What an autoregression can follow it takes for noise, so that noise read off what an answer
//! leaves is at most all of it, and no evidence for the answer. Here noise is stated with the data,
//! or seen where no model is needed.

use serde::{Deserialize, Serialize};

use super::data::{Observation, Output, Rows};
use super::noise::{ChannelNoise, dot};
use crate::stats::distributions::{chi_squared_quantile, normal_tail};
use crate::stats::{centred, deviation, mean};

/// Where the size of a noise is known from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum NoiseSource {
    /// From nothing but what is left: an upper bound.
    #[default]
    Bound,
    /// Stated with the data.
    Stated,
    /// Passes, or periods of the inputs, less the ones before them.
    Repetition,
    /// Outputs while all inputs stand still.
    Standstill,
    /// What is left is no larger than noise without memory, as differences in time show it.
    Differences,
}

impl NoiseSource {
    /// In a few words.
    pub fn description(self) -> &'static str {
        match self {
            NoiseSource::Bound => "at most: what is left",
            NoiseSource::Stated => "stated",
            NoiseSource::Repetition => "repetition",
            NoiseSource::Standstill => "standstill",
            NoiseSource::Differences => "differences in time",
        }
    }
}

/// Noise of an output by itself, at the interval of the data.
#[derive(Debug, Clone, PartialEq)]
pub struct NoiseSample {
    /// Where it is seen.
    pub source: NoiseSource,
    /// Stretches without gaps, each about its own mean.
    pub stretches: Vec<Vec<f64>>,
    /// Part of the standard deviation of the noise of the whole record that these have.
    pub seen: f64,
}

impl NoiseSample {
    /// `None` if there are fewer samples than `least`.
    pub fn of(
        source: NoiseSource,
        mut stretches: Vec<Vec<f64>>,
        least: usize,
    ) -> Option<NoiseSample> {
        stretches.retain(|one| one.len() > 1);
        let count: usize = stretches.iter().map(Vec::len).sum();
        let stretches: Vec<_> = stretches.iter().map(|one| centred(one)).collect();
        (count >= least).then_some(NoiseSample {
            source,
            stretches,
            seen: 1.0,
        })
    }

    /// Mean length of a stretch.
    fn length(&self) -> usize {
        let count: usize = self.stretches.iter().map(Vec::len).sum();
        (count / self.stretches.len().max(1)).max(2)
    }
}

/// Where the noise is known: least significant ratio of the residual's variance to it.
pub(super) const EXCESS: f64 = 1.25;
/// And in standard errors of the logarithm of that ratio.
const LEAST_T: f64 = 4.0;
/// Longest memory of a sample's autoregression, and samples for each coefficient.
const LAGS: usize = 4;
const SAMPLES_PER_LAG: usize = 40;
/// Samples of a stretch, from which on an autoregression is fitted to it.
const LONG: usize = 200;
/// Part of an output's own noise from which on that of the inputs changes its colour.
const OF_INPUTS: f64 = 0.3;
/// Standard deviations of rounding in half of a step and a little more: noise of that size carries
/// a reading over the next step as often as not, so that rounding is noise like it.
const ROUNDED: f64 = 2.0;
/// A model's own numerical error, as a part of what an output does by itself (benches/README.md).
const NUMERICAL: f64 = 3e-3;

/// What is known of the noise of one output.
#[derive(Debug, Clone)]
pub(super) struct Floor {
    pub source: NoiseSource,
    /// Standard deviation, about the mean of so many samples.
    pub rms: f64,
    /// Of the whole record, with what is slower.
    pub whole: f64,
    window: Option<usize>,
    /// Relative error of the variance.
    error: f64,
    /// Factor by which memory raises the variance of a mean square, where the colour is known.
    memory: Option<f64>,
    whitening: Option<ChannelNoise>,
    /// Standard deviation of what the model's own numerical error may be.
    numerical: f64,
}

/// What is left beyond the floor.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Beyond {
    /// Variance left over that of the noise.
    pub ratio: f64,
    /// Variance left, less that of the noise.
    pub variance: f64,
    /// Of the ratio, relative.
    pub error: f64,
}

impl Floor {
    /// Of an output whose own motion has this deviation; `None` if nothing is known.
    pub fn of(output: &Output, own_motion: f64) -> Option<Floor> {
        let rounding = output.held_step / 12_f64.sqrt();
        let numerical = NUMERICAL * own_motion;
        if let Some(noise) = output.noise {
            let noise = noise.max(rounding);
            let noise = noise.hypot(output.noise_of_inputs);
            return Some(Floor {
                source: NoiseSource::Stated,
                rms: noise,
                whole: noise,
                window: None,
                error: output.noise_error,
                memory: None,
                whitening: None,
                numerical,
            });
        }
        let sample = output.sample.as_ref()?;
        let (mut squares, mut free) = (0.0, 0.0);
        for stretch in &sample.stretches {
            squares += dot(stretch, stretch);
            free += stretch.len() as f64 - 1.0;
        }
        let memory = memory(&sample.stretches);
        // Noise of less than half a step is hidden by rounding, which comes again with the motion:
        // of size, memory and colour the sample then says too little.
        let seen = (squares / free).sqrt();
        let is_rounded = seen < ROUNDED * rounding;
        let own = if is_rounded {
            seen.hypot(rounding)
        } else {
            seen
        };
        let rms = own.hypot(output.noise_of_inputs);
        Some(Floor {
            source: sample.source,
            rms,
            whole: (own / sample.seen).hypot(output.noise_of_inputs),
            window: Some(sample.length()),
            error: (2.0 * memory / free).sqrt(),
            memory: (!is_rounded).then_some(memory),
            // What comes from the inputs has another colour.
            whitening: (output.noise_of_inputs < OF_INPUTS * own && !is_rounded)
                .then(|| whitening(sample, rms))
                .flatten(),
            numerical,
        })
    }

    /// What is left of a channel at the rows beyond the floor, if that is no chance: as it is, or
    /// whitened.
    pub fn beyond(&self, residual: &[f64], rows: &[usize]) -> Option<Beyond> {
        let constant = self.constant(residual, rows);
        let found = self.larger(residual, rows).into_iter().chain(constant);
        found.max_by(|a, b| a.ratio.total_cmp(&b.ratio))
    }

    /// By how much a residual at the rows is larger than noise can be, as minus twice a
    /// log-likelihood: the square of the standard errors by which its size is, and of its mean in
    /// standard deviations of the noise, each beyond what noise of any memory comes to.
    pub fn loss(&self, residual: &[f64], rows: &[usize]) -> f64 {
        let values: Vec<f64> = rows.iter().map(|&t| residual[t]).collect();
        let apart = (self.away(&values) / LEAST_T).powi(2) - 1.0;
        let larger = (self.larger(residual, rows).into_iter())
            .map(|beyond| (beyond.ratio.ln() / (LEAST_T * beyond.error)).powi(2) - 1.0)
            .fold(0.0, f64::max);
        LEAST_T.powi(2) * apart.max(larger)
    }

    /// Mean in standard deviations, of the noise as it is known, which is about the mean of short
    /// stretches, and as these values vary about theirs.
    fn away(&self, values: &[f64]) -> f64 {
        let varies = deviation(values).hypot(self.numerical).hypot(self.rms);
        mean(values).abs() / varies.max(f64::MIN_POSITIVE)
    }

    /// What the mean adds, if that is no noise: one that is known from stretches about their own
    /// means says nothing of it.
    fn constant(&self, residual: &[f64], rows: &[usize]) -> Option<Beyond> {
        let values: Vec<f64> = rows.iter().map(|&t| residual[t]).collect();
        let away = self.away(&values);
        (values.len() > 1 && away > LEAST_T).then(|| Beyond {
            ratio: 1.0 + (mean(&values) / self.rms).powi(2),
            variance: mean(&values).powi(2),
            error: self.error,
        })
    }

    /// What is larger than noise, as it is and whitened.
    fn larger(&self, residual: &[f64], rows: &[usize]) -> Vec<Beyond> {
        let whitened = (self.whitening.as_ref())
            .and_then(|noise| self.test(&[noise.whiten(residual, rows)], noise.sigma, 1.0));
        self.plain(residual, rows)
            .into_iter()
            .chain(whitened)
            .collect()
    }

    fn plain(&self, residual: &[f64], rows: &[usize]) -> Option<Beyond> {
        let values: Vec<f64> = rows.iter().map(|&t| residual[t]).collect();
        let stretches: Vec<Vec<f64>> = match self.window {
            Some(length) => values.chunks(length).map(centred).collect(),
            None => vec![values],
        };
        let memory = self.memory.unwrap_or_else(|| memory(&stretches));
        let unit = |x: &Vec<f64>| x.iter().map(|x| x / self.rms).collect();
        let stretches: Vec<Vec<f64>> = stretches.iter().map(unit).collect();
        self.test(&stretches, self.rms, memory)
    }

    /// Of stretches that have unit variance if they are noise, whose size is `sigma`.
    fn test(&self, stretches: &[Vec<f64>], sigma: f64, memory: f64) -> Option<Beyond> {
        let centred = f64::from(u8::from(self.window.is_some() && stretches.len() > 1));
        let (mut squares, mut free) = (0.0, 0.0);
        for stretch in stretches.iter().filter(|one| one.len() > 1) {
            squares += dot(stretch, stretch);
            free += stretch.len() as f64 - centred;
        }
        if free < 2.0 {
            return None;
        }
        let expected = 1.0 + (self.numerical / sigma).powi(2);
        let ratio = squares / free / expected;
        let error = by_chance(free / memory).hypot(self.error);
        (ratio > EXCESS && ratio.ln() > LEAST_T * error).then(|| Beyond {
            ratio,
            variance: (ratio - 1.0) * expected * self.rms.powi(2),
            error,
        })
    }
}

/// Relative error of a mean square of noise with so many degrees of freedom: by [`LEAST_T`] of them
/// its logarithm exceeds by chance no more often than a normal variable its mean. What follows
/// itself through the whole record, as a constant does, has one degree of freedom at least.
fn by_chance(degrees: f64) -> f64 {
    let degrees = degrees.max(1.0);
    (chi_squared_quantile(normal_tail(LEAST_T), degrees) / degrees).ln() / LEAST_T
}

/// Of each output, where it is known.
pub(super) fn floors(data: &Observation) -> Vec<Option<Floor>> {
    let floor = |(c, output): (usize, &Output)| {
        let valid: Vec<usize> = (0..output.values.len())
            .filter(|&t| output.valid[t])
            .collect();
        Floor::of(output, data.own_motion(c, &valid))
    };
    data.outputs.iter().enumerate().map(floor).collect()
}

/// An autoregression of the sample, of an order that its length allows.
fn whitening(sample: &NoiseSample, rms: f64) -> Option<ChannelNoise> {
    let (mut values, mut rows) = (Vec::new(), Vec::new());
    for stretch in &sample.stretches {
        let from = values.len();
        values.extend(stretch);
        rows.extend((from + LAGS).min(values.len())..values.len());
    }
    let order = LAGS.min(rows.len() / SAMPLES_PER_LAG);
    // About the mean of a short stretch noise has another memory than it has.
    (order > 0 && sample.length() >= LONG)
        .then(|| ChannelNoise::fit(&values, &rows, order, 1e-3 * rms))
}

/// Sum of the squared autocorrelations: the factor by which the variance of a mean square exceeds
/// that of white noise.
pub(super) fn memory(stretches: &[Vec<f64>]) -> f64 {
    let whole: f64 = stretches.iter().map(|x| dot(x, x)).sum();
    let longest = stretches.iter().map(Vec::len).max().unwrap_or(0);
    let count: usize = stretches.iter().map(Vec::len).sum();
    let at = |lag: usize| -> f64 {
        let long = stretches.iter().filter(|x| x.len() > lag);
        long.map(|x| dot(&x[lag..], &x[..x.len() - lag]))
            .sum::<f64>()
            / whole.max(f64::MIN_POSITIVE)
    };
    let lags = (longest / 2).min(count / 5).min(200);
    1.0 + 2.0 * (1..lags).map(|lag| at(lag).powi(2)).sum::<f64>()
}

/// By how much residuals are larger than noise of the sizes that are known can be, as minus twice a
/// log-likelihood; see [`Floor::loss`].
pub(super) fn loss(floors: &[Option<Floor>], residual: &[Vec<f64>], rows: &Rows) -> f64 {
    let channels = floors.iter().zip(residual).zip(&rows.per_channel);
    let losses = channels.filter_map(|((floor, x), rows)| Some(floor.as_ref()?.loss(x, rows)));
    losses.sum()
}

/// Root mean square of each channel on the rows, over the noise, where that is known and less is no
/// chance.
pub(super) fn left_beyond(
    floors: &[Option<Floor>],
    residual: &[Vec<f64>],
    rows: &Rows,
) -> Vec<Option<Beyond>> {
    let channels = floors.iter().zip(residual).zip(&rows.per_channel);
    let beyond = channels.map(|((floor, x), rows)| floor.as_ref()?.beyond(x, rows));
    beyond.collect()
}

#[cfg(test)]
mod tests;
