//! The measured outputs as the search sees them, and how they are divided.

use std::ops::Range;

use nalgebra::{DMatrix, DVector};
use truecut_recording::filter::Butterworth;

use super::DiagnoseError;
use super::floor::NoiseSample;
use super::noise::add_column;
use crate::model::Columns;
use crate::stats::deviation;

/// One measured output.
#[derive(Debug, Clone, PartialEq)]
pub struct Output {
    /// SI, one per sample; whatever is not valid may be anything.
    pub values: Vec<f64>,
    /// Whether each sample is to be used.
    pub valid: Vec<bool>,
    /// Standard deviation of the noise, where it is stated.
    pub noise: Option<f64>,
    /// Of its square, relative: what a filter leaves of it is not known as it is itself.
    pub noise_error: f64,
    /// Noise by itself, where the data show it.
    pub sample: Option<NoiseSample>,
    /// Standard deviation of the noise if it has no memory, from differences in time; 0 if they
    /// were not taken.
    pub noise_without_memory: f64,
    /// Step of readings, as far as what rounding leaves of them goes through the filter and comes
    /// again with the motion. 0 where noise moves them on, or they come in no steps.
    pub held_step: f64,
    /// Standard deviation of what the noise of measured inputs makes of the prediction; 0 where it
    /// is not known or there are none.
    pub noise_of_inputs: f64,
}

impl Output {
    /// A prediction with as much of some laws as fits the output best.
    pub(crate) fn fitted(&self, predicted: &[f64], laws: &[Vec<f64>]) -> Vec<f64> {
        let rows: Vec<usize> = (0..predicted.len().min(self.values.len()))
            .filter(|row| self.valid[*row])
            .collect();
        let mut with = predicted.to_vec();
        if laws.is_empty() || rows.is_empty() {
            return with;
        }
        let matrix = DMatrix::from_fn(rows.len(), laws.len(), |i, law| laws[law][rows[i]]);
        let left = rows.iter().map(|&row| self.values[row] - predicted[row]);
        let left = DVector::from_iterator(rows.len(), left);
        let Ok(sizes) = matrix.svd(true, true).solve(&left, 1e-9) else {
            return with;
        };
        for (law, size) in laws.iter().zip(sizes.iter()) {
            add_column(&mut with, law, *size);
        }
        with
    }
}

/// A known signal that a residual may depend on: a measured input, a spindle angle.
#[derive(Debug, Clone, PartialEq)]
pub struct Regressor {
    /// Its name.
    pub name: String,
    /// SI, one per sample.
    pub values: Vec<f64>,
    /// Whether it is an angle in radians whose revolutions are all alike.
    pub is_angle: bool,
}

impl Regressor {
    /// A signal that is no angle.
    pub fn new(name: impl Into<String>, values: Vec<f64>) -> Regressor {
        Regressor {
            name: name.into(),
            values,
            is_angle: false,
        }
    }
}

/// Measured data on a uniform time base.
#[derive(Debug, Clone, PartialEq)]
pub struct Observation {
    /// Name of the data, for the answer.
    pub source: String,
    /// Name of the scenario, for the answer.
    pub scenario: String,
    /// Seconds, one per sample.
    pub time_s: Vec<f64>,
    /// Samples of each trajectory, in order, without overlap. Each is simulated from its own start.
    pub trajectories: Vec<Range<usize>>,
    /// Measured outputs, in the order of the model's channels.
    pub outputs: Vec<Output>,
    /// Known signals.
    pub regressors: Vec<Regressor>,
    /// What the outputs are filtered and thinned from, where they are.
    pub fine: Option<Fine>,
    /// Samples, and those at which the inputs, and what they were before, come again: of passes, or
    /// of periods.
    pub again: Vec<[usize; 2]>,
}

/// Places over which a residual may wave, at the rate before outputs were filtered and thinned.
#[derive(Debug, Clone, PartialEq)]
pub struct Fine {
    /// Where the joints are.
    pub signals: Vec<Regressor>,
    /// Samples for one of the data.
    pub every: usize,
    /// The filter, run forward and backward.
    pub filter: Butterworth,
}

/// Samples that are needed at least, valid ones and in each channel.
pub const MIN_SAMPLES: usize = 200;

impl Observation {
    pub(crate) fn check(&self, channels: usize) -> Result<(), DiagnoseError> {
        let n = self.time_s.len();
        if self.outputs.len() != channels {
            return Err(DiagnoseError::ChannelCount {
                expected: channels,
                found: self.outputs.len(),
            });
        }
        let length = |what: String, found: usize| DiagnoseError::Length {
            what,
            expected: n,
            found,
        };
        for (index, output) in self.outputs.iter().enumerate() {
            if output.values.len() != n || output.valid.len() != n {
                let found = output.values.len().min(output.valid.len());
                return Err(length(format!("output {}", index + 1), found));
            }
            let valid = || (0..n).filter(|&t| output.valid[t]);
            let output = index + 1;
            if let Some(sample) = valid().rfind(|&t| !self.outputs[index].values[t].is_finite()) {
                return Err(DiagnoseError::NotFinite { output, sample });
            }
            let found = valid().count();
            if found < MIN_SAMPLES {
                return Err(DiagnoseError::TooFewSamples { output, found });
            }
        }
        if let Some(regressor) = self.regressors.iter().find(|one| one.values.len() != n) {
            let what = format!("regressor `{}`", regressor.name);
            return Err(length(what, regressor.values.len()));
        }
        let mut end = 0;
        for range in &self.trajectories {
            if range.start < end || range.end > n || range.is_empty() {
                return Err(DiagnoseError::Trajectories);
            }
            end = range.end;
        }
        if self.trajectories.is_empty() {
            return Err(DiagnoseError::Trajectories);
        }
        Ok(())
    }

    /// Deviation of what an output does by itself at the rows: a joint that follows its command
    /// does so in the simulation, too, however far, and what that errs by is a part of the
    /// difference.
    pub(super) fn own_motion(&self, output: usize, rows: &[usize]) -> f64 {
        let measured = &self.outputs[output].values;
        let beside = |known: Option<&Regressor>| {
            let rows = rows.iter();
            let apart = rows.map(|&t| measured[t] - known.map_or(0.0, |known| known.values[t]));
            deviation(&apart.collect::<Vec<f64>>())
        };
        let known = self.regressors.iter().filter(|known| !known.is_angle);
        let beside_known = known.map(|known| beside(Some(known)));
        beside_known.fold(beside(None), f64::min)
    }

    /// Measured minus predicted; zero where the data are not valid.
    pub(super) fn residual(&self, predicted: &Columns) -> Columns {
        let outputs = self.outputs.iter().zip(predicted);
        outputs
            .map(|(output, column)| {
                let rows = output.values.iter().zip(&output.valid).zip(column);
                rows.map(|((y, valid), p)| if *valid { y - p } else { 0.0 })
                    .collect()
            })
            .collect()
    }
}

/// Samples of each channel that may serve as rows: each has [`LAGS`] valid predecessors in its
/// block.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Rows {
    /// Ascending.
    pub per_channel: Vec<Vec<usize>>,
}

impl Rows {
    pub fn len(&self) -> usize {
        self.per_channel.iter().map(Vec::len).sum()
    }

    /// Number of samples up to the last row.
    pub fn reach(&self) -> usize {
        let last = self.per_channel.iter().filter_map(|rows| rows.last());
        last.max().map_or(0, |row| row + 1)
    }

    pub fn joined(&self, other: &Rows) -> Rows {
        let pairs = self.per_channel.iter().zip(&other.per_channel);
        let per_channel = pairs
            .map(|(a, b)| {
                let mut all = [a.as_slice(), b.as_slice()].concat();
                all.sort_unstable();
                all
            })
            .collect();
        Rows { per_channel }
    }
}

/// Longest memory of the noise model, in samples.
pub(super) const LAGS: usize = 10;

/// The division into rows for fitting, for choosing, and for the final test.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Split {
    pub train: Rows,
    pub validation: Rows,
    /// Training and validation together.
    pub development: Rows,
    pub test: Rows,
    /// Contiguous sample ranges of the development part, in order.
    pub blocks: Vec<Range<usize>>,
    /// Number of samples up to the end of the development part.
    pub searched: usize,
}

/// Part of the data that is opened last.
const TEST_PART: f64 = 0.22;
/// With at least as many trajectories, whole ones are set aside for the last test.
const WHOLE_TRAJECTORIES: usize = 3;
/// With at least as many, they are not divided further.
const UNDIVIDED_TRAJECTORIES: usize = 6;

impl Split {
    /// Contiguous blocks: the last part is the test, the rest serves in turn for training (two
    /// blocks) and validation (one). In every trajectory other blocks validate, so that each
    /// stretch of a process that runs the same way again does both.
    pub fn new(data: &Observation) -> Split {
        let count = data.trajectories.len();
        let held_out = match count >= WHOLE_TRAJECTORIES {
            true => ((count as f64 * TEST_PART).round() as usize).max(1),
            false => 0,
        };
        let (divided, whole) = data.trajectories.split_at(count - held_out);
        let (mut development, mut validates) = (Vec::new(), Vec::new());
        let mut test = whole.to_vec();
        for (index, range) in divided.iter().enumerate() {
            if count >= UNDIVIDED_TRAJECTORIES {
                development.push(range.clone());
                validates.push(index % 3 == 1);
                continue;
            }
            let tail = match held_out {
                0 => (range.len() as f64 * TEST_PART).round() as usize,
                _ => 0,
            };
            let blocks = blocks_of(range.start..range.end - tail, divided.len());
            validates.extend((0..blocks.len()).map(|block| (block + index) % 3 == 1));
            development.extend(blocks);
            if tail > 0 {
                test.push(range.end - tail..range.end);
            }
        }
        let of = |validating: bool| {
            let ranges = development.iter().zip(&validates);
            let ranges: Vec<_> = ranges
                .filter(|(_, validates)| **validates == validating)
                .map(|(range, _)| range)
                .collect();
            rows_of(data, &ranges)
        };
        let (train, validation) = (of(false), of(true));
        Split {
            development: train.joined(&validation),
            train,
            validation,
            test: rows_of(data, &test.iter().collect::<Vec<_>>()),
            searched: development.iter().map(|block| block.end).max().unwrap_or(0),
            blocks: development,
        }
    }
}

impl Split {
    /// Refuses data whose gaps leave too little.
    pub fn check(&self) -> Result<(), DiagnoseError> {
        let parts = [
            ("fitting", &self.train),
            ("choosing", &self.validation),
            ("the test", &self.test),
        ];
        for (part, rows) in parts {
            for (index, rows) in rows.per_channel.iter().enumerate() {
                if rows.len() < MIN_ROWS {
                    return Err(DiagnoseError::TooFewRows {
                        output: index + 1,
                        part,
                        found: rows.len(),
                    });
                }
            }
        }
        Ok(())
    }
}

/// Rows that each part needs, in each channel.
const MIN_ROWS: usize = 20;

/// Equal blocks, long enough that the gap at their start costs little.
fn blocks_of(range: Range<usize>, trajectories: usize) -> Vec<Range<usize>> {
    let most = (12 / trajectories).max(3);
    let count = (range.len() / 60).clamp(3, most);
    let edge = |i: usize| range.start + range.len() * i / count;
    (0..count).map(|i| edge(i)..edge(i + 1)).collect()
}

/// The guard gap: the first samples of a block are not used as rows, so that neither the noise's
/// memory nor a lagged value reaches across a border.
fn rows_of(data: &Observation, ranges: &[&Range<usize>]) -> Rows {
    let per_channel = data.outputs.iter().map(|output| {
        let mut rows = Vec::new();
        for range in ranges {
            let guard = LAGS.max((range.len() / 8).min(2 * LAGS));
            let mut run = 0;
            for t in range.start..range.end {
                run = if output.valid[t] { run + 1 } else { 0 };
                if run > LAGS && t >= range.start + guard {
                    rows.push(t);
                }
            }
        }
        rows
    });
    Rows {
        per_channel: per_channel.collect(),
    }
}
