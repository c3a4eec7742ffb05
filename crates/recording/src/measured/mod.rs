//! Measured data: columns of a file become channels on one uniform time base.
//!
//! Reading the file is not done here; a [`Table`] of named columns comes in. [`measured`] maps its
//! columns to channels, checks them, masks what is not a measurement, and resamples. Everything
//! that was done to the data is said in [`Measured::notes`].

mod anew;
mod clocks;
mod columns;
mod combination;
mod error;
mod inspect;
mod outputs;
mod place;
mod resample;
mod smoothed;
mod spikes;
mod table;
#[cfg(test)]
mod tests;
mod time_unit;
mod times;

pub use clocks::{HEADER_STAMP, LOG_TIME};
pub use columns::{LARGEST, measured, measured_of};
pub use combination::{Term, formula};
pub use error::DataError;
pub use inspect::{ColumnFacts, Gap, TableFacts, TimeFacts, column_facts, facts};
pub use spikes::{SPIKE, replace_spikes};
pub use table::{Column, Table, Tables};
pub use time_unit::unit_of_times;
pub use times::time_note;

use std::ops::Range;

use crate::recording::{ChannelSpec, UnknownName};
use crate::unit::UserUnit;

/// Fewest samples of a channel that are worth anything.
pub const MIN_SAMPLES: usize = 200;

/// What a measured channel is for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Role {
    /// Drives the model.
    Input,
    /// Compared with the model.
    #[default]
    Output,
}

/// Where the times of the samples come from.
#[derive(Clone, Debug, PartialEq)]
pub enum TimeBase {
    /// A column, in a unit of time.
    Column {
        /// Its name, or its number counted from 1 in a file without header.
        column: String,
        /// Unit of its values.
        unit: UserUnit,
    },
    /// No column: rows follow each other at this rate, from 0 on.
    Rate {
        /// Samples per second.
        hz: f64,
    },
}

/// Which column, or which linear combination of columns, is which channel.
#[derive(Clone, Debug, PartialEq)]
pub struct ChannelMapping {
    /// What is read, at least one: the channel is `scale` · Σ factor · column + `offset`, in
    /// `unit`.
    pub terms: Vec<Term>,
    /// Name of the channel: that of the simulation's channel that it is compared with or drives.
    pub channel: String,
    /// Unit of `scale` times the columns' values, and of `offset`.
    pub unit: UserUnit,
    /// Factor on the column's values, or on their sum.
    pub scale: f64,
    /// What is added to them after that, in `unit`.
    pub offset: f64,
    /// What it is for.
    pub role: Role,
    /// Known standard deviation of its noise, SI.
    pub noise: Option<f64>,
    /// Readings of each column, as in the file, at or beyond which the sensor is at its end.
    pub saturation: Option<[f64; 2]>,
}

/// How a table becomes [`Measured`].
#[derive(Clone, Debug, PartialEq)]
pub struct Mapping {
    /// Where the times come from.
    pub time: TimeBase,
    /// Whether the unit of a column of times is said: else that counts which the file or the
    /// column's name gives, and the one of [`Mapping::time`] where they give none.
    pub is_time_unit_said: bool,
    /// Seconds of the result in one of the file.
    pub clock_rate: f64,
    /// The part of the file that is used, s, in the file's own time; ends are infinite if not
    /// given.
    pub window_s: [f64; 2],
    /// Rate of the result; `None` for the median rate of the file.
    pub resample_hz: Option<f64>,
    /// Longest gap that is bridged by a straight line, s.
    pub max_gap_s: f64,
    /// Times of the file at which the process begins anew, rising; empty if it begins once, with
    /// the first sample.
    pub starts_s: Vec<f64>,
    /// Whether single samples of an output that are far off their neighbours are a logger's faults
    /// and not the process's: they are replaced where the channel is smoothed, which would spread
    /// them.
    pub bridge_spikes: bool,
    /// The channels, in the order of the result.
    pub channels: Vec<ChannelMapping>,
}

/// Measured channels on one uniform time base.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct Measured {
    /// Where it comes from, for messages.
    pub source: String,
    /// Uniform times from 0 on, s.
    pub time_s: Vec<f64>,
    /// Runs of the process in these data, in order and without overlap; empty if there is one, from
    /// time 0 on.
    pub passes: Vec<Pass>,
    /// The channels; each has one value for every time.
    pub channels: Vec<MeasuredChannel>,
    /// What was done to the data, one sentence each.
    pub notes: Vec<String>,
}

/// One of several runs of the same process in one file: a hole of several, say.
#[derive(Clone, Debug, PartialEq)]
pub struct Pass {
    /// Its samples.
    pub samples: Range<usize>,
    /// Time at which it begins, s; at most that of its first sample.
    pub start_s: f64,
}

/// One measured channel.
#[derive(Clone, Debug, PartialEq)]
pub struct MeasuredChannel {
    /// Name, unit and meaning.
    pub spec: ChannelSpec,
    /// What it is for.
    pub role: Role,
    /// SI. Finite everywhere; where `valid` is false the value only fills a gap.
    pub values: Vec<f64>,
    /// Whether there is a measurement at each time.
    pub valid: Vec<bool>,
    /// Known standard deviation of its noise, SI.
    pub noise: Option<f64>,
    /// Mean part of white noise's variance that is left where the values lie between the file's
    /// samples; 1 at the samples themselves.
    pub white_kept: f64,
}

impl Measured {
    /// Time between samples, s; 0 if there are less than two.
    pub fn interval_s(&self) -> f64 {
        match (self.time_s.first(), self.time_s.last()) {
            (Some(first), Some(last)) if self.time_s.len() > 1 => {
                (last - first) / (self.time_s.len() - 1) as f64
            }
            _ => 0.0,
        }
    }

    /// Samples per second.
    pub fn rate_hz(&self) -> f64 {
        1.0 / self.interval_s()
    }

    /// Time from the first to the last sample, s.
    pub fn duration_s(&self) -> f64 {
        self.interval_s() * self.time_s.len().saturating_sub(1) as f64
    }

    /// The runs of the process in these data: at least one.
    pub fn passes(&self) -> Vec<Pass> {
        match self.passes.is_empty() {
            true => vec![Pass {
                samples: 0..self.time_s.len(),
                start_s: 0.0,
            }],
            false => self.passes.clone(),
        }
    }

    /// Time of every sample since the start of its pass, s. Samples before the first pass have
    /// negative times.
    pub fn process_time_s(&self) -> Vec<f64> {
        let passes = self.passes();
        let mut times: Vec<f64> = (self.time_s.iter())
            .map(|time| time - passes[0].start_s)
            .collect();
        for pass in &passes {
            for row in pass.samples.clone() {
                times[row] = self.time_s[row] - pass.start_s;
            }
        }
        times
    }

    /// Process times in stretches that rise: what lies before the first pass, if anything, then
    /// pass by pass.
    pub fn stretches_s(&self) -> Vec<Vec<f64>> {
        let times = self.process_time_s();
        let passes = self.passes();
        let before = 0..passes[0].samples.start;
        let stretches = std::iter::once(before).chain(passes.into_iter().map(|pass| pass.samples));
        stretches
            .filter(|samples| !samples.is_empty())
            .map(|samples| times[samples].to_vec())
            .collect()
    }

    /// A channel by name.
    ///
    /// # Errors
    /// A channel that is not there; the nearest one is named.
    pub fn channel(&self, name: &str) -> Result<&MeasuredChannel, UnknownName> {
        let mut channels = self.channels.iter();
        channels
            .find(|channel| channel.spec.name == name)
            .ok_or_else(|| {
                let known = self.channels.iter().map(|one| one.spec.name.as_str());
                UnknownName::new("measured channel", name, known)
            })
    }

    /// The channels that drive a model.
    pub fn inputs(&self) -> impl Iterator<Item = &MeasuredChannel> {
        let inputs = |one: &&MeasuredChannel| one.role == Role::Input;
        self.channels.iter().filter(inputs)
    }

    /// The channels that a model is compared with.
    pub fn outputs(&self) -> impl Iterator<Item = &MeasuredChannel> {
        let outputs = |one: &&MeasuredChannel| one.role == Role::Output;
        self.channels.iter().filter(outputs)
    }
}

impl MeasuredChannel {
    /// The first stretch of samples without a measurement, as sample numbers.
    pub fn first_gap(&self) -> Option<std::ops::Range<usize>> {
        let start = self.valid.iter().position(|valid| !valid)?;
        let length = self.valid[start..].iter().take_while(|valid| !**valid);
        Some(start..start + length.count())
    }
}
