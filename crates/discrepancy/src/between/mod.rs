//! What changed between two recordings of one machine: wear, a loosened clamp, a new payload.
//!
//! What the model gets wrong of both is no change. Where the second recording repeats the motion of
//! the first, their difference is explained: common errors of the model go with it, whatever they
//! are. Where motions differ, effects that the first recording shows are carried to the second, all
//! shared numbers are refitted to both, and what the second has beyond is a change if it is none in
//! both. Either way changes are looked for by [`diagnose`](crate::diagnose), with its bars, odds,
//! floors and held-out parts.

mod answer;
mod change;
mod events;
mod join;
mod motion;
mod revised;
mod search;
mod shared;
mod split;
mod told;
mod words;
mod work;

use std::collections::{HashMap, HashSet};
use std::hash::{DefaultHasher, Hash, Hasher};

use thiserror::Error;
use truecut_recording::measured::{Measured, MeasuredChannel};
use truecut_scenario::Scenario;
use truecut_sim::SimError;

use crate::diagnose::{DiagnoseError, Observation};
use crate::model::Model;
use crate::spikes::bridged;
use crate::trial::Trial;
pub use answer::{
    Answer, Changed, ChangedParameter, Changes, Compared, Event, Recording, Rival, Verdict,
};
pub use motion::Motion;
pub use search::changes;
pub use work::SEARCHES;

/// Two recordings of one machine, and the scenario that both are held against.
pub struct Between {
    /// The earlier.
    pub first: Trial,
    /// The later.
    pub second: Trial,
    /// How their motions compare.
    pub motion: Motion,
    /// Rows that belong together, where the motion repeats.
    overlap: join::Overlap,
    /// Numbers of the scenario that may be refitted, the same in both.
    uncertain: usize,
    /// What is explained: the difference, or both.
    pub observation: Observation,
}

/// Two recordings between which no change can be looked for.
#[derive(Debug, Error)]
pub enum BetweenError {
    /// A recording that the scenario cannot be held against.
    #[error("{source_file}: {error}")]
    Sim {
        /// Where the recording comes from.
        source_file: String,
        /// Why.
        error: Box<SimError>,
    },
    /// The same samples in both.
    #[error(
        "{second}: from {from_s:.6} s on, {rows} samples in a row are those of {first}, to the last digit; \
         two recordings of a machine at different times never agree so far"
    )]
    SameSamples {
        /// The earlier recording.
        first: String,
        /// The later one.
        second: String,
        /// Where in the later one.
        from_s: f64,
        /// How many.
        rows: usize,
    },
    /// Channels of one that the other does not have.
    #[error(
        "{second} leaves {found} channels to be compared, {first} leaves {expected}: both must have the same ones"
    )]
    Channels {
        /// The earlier recording.
        first: String,
        /// The later one.
        second: String,
        /// Names of the earlier one's.
        expected: String,
        /// Names of the later one's.
        found: String,
    },
    /// Recordings of which the filter leaves another rate.
    #[error(
        "of {first} one sample in {}, of {second} one in {} is kept after the filter: a recording is too short; raise \
         process.replay.compare_cutoff_hz",
        every[0],
        every[1]
    )]
    Thinning {
        /// The earlier recording.
        first: String,
        /// The later one.
        second: String,
        /// Samples for one that is kept.
        every: [usize; 2],
    },
    /// Data that a search cannot use.
    #[error("{source_file}: {error}")]
    Diagnose {
        /// Where the data come from.
        source_file: String,
        /// Why.
        error: DiagnoseError,
    },
}

/// So many samples in a row are no chance.
const SAME_ROWS: usize = 10;
/// Of values read to a few counts, so many changes in a row, each in the same row: noise moves
/// every one of them by a row now and then.
const SAME_STEPS: usize = 40;

impl BetweenError {
    /// Of the data of this source.
    fn of(source: &str) -> impl Fn(DiagnoseError) -> BetweenError {
        move |error| BetweenError::Diagnose {
            source_file: source.to_owned(),
            error,
        }
    }
}

impl Between {
    /// Prepares both recordings: whether the motion repeats, and what is to be explained.
    ///
    /// # Errors
    /// Data that do not fit the scenario; recordings that hold the same samples, or do not have the
    /// same channels.
    pub fn new(
        scenario: &Scenario,
        first: &Measured,
        second: &Measured,
    ) -> Result<Between, BetweenError> {
        check_samples(first, second)?;
        let trial = |measured: &Measured| {
            Trial::new(scenario, measured).map_err(|error| BetweenError::Sim {
                source_file: measured.source.clone(),
                error: Box::new(error),
            })
        };
        // Spikes go before what is faster is smoothed, which would spread them.
        let [first, second] = &[first, second].map(|one| bridged(scenario, one));
        let interval_s = motion::common_interval_s(first, second);
        let first = &motion::resampled(first, interval_s, 0.0);
        let same_rate = motion::resampled(second, interval_s, 0.0);
        let later = motion::later(first, &same_rate);
        let first = trial(first)?;
        let every = every(&first);
        let (second, motion, rows) = match later {
            None => (same_rate, Motion::Different, 0),
            Some(found) => motion::placed(second, interval_s, found, every),
        };
        let second = trial(&second)?;
        check_alike(&first, &second)?;
        let count = |trial: &Trial| trial.observation.time_s.len();
        let overlap = join::Overlap::of([count(&first), count(&second)], rows);
        let (a, b) = (&first.observation, &second.observation);
        let observation = match motion {
            Motion::Repeated { .. } => join::difference(a, b, overlap),
            Motion::Different => join::one_after_the_other(a, b),
        };
        Ok(Between {
            uncertain: scenario.uncertain.len(),
            first,
            second,
            motion,
            overlap,
            observation,
        })
    }

    /// Whether the second recording repeats the motion of the first.
    pub fn repeats(&self) -> bool {
        matches!(self.motion, Motion::Repeated { .. })
    }
}

fn every(trial: &Trial) -> usize {
    trial.thinning().map_or(1, |thinning| thinning.every)
}

/// Refuses recordings of which one holds samples of the other.
fn check_samples(first: &Measured, second: &Measured) -> Result<(), BetweenError> {
    let outputs = |measured: &Measured, row: usize| -> Option<Vec<u64>> {
        let values = measured
            .outputs()
            .map(|one| one.valid[row].then(|| one.values[row].to_bits()));
        values.collect()
    };
    let same = |row: usize, rows: usize| BetweenError::SameSamples {
        first: first.source.clone(),
        second: second.source.clone(),
        from_s: second.time_s[row],
        rows,
    };
    if [first, second]
        .iter()
        .any(|one| one.outputs().all(is_coarse))
    {
        let [a, b] = [first, second].map(|one| steps(one, |row| outputs(one, row)));
        let known: HashSet<u64> = a.windows(SAME_STEPS).map(digest_of_steps).collect();
        let mut copied = b.windows(SAME_STEPS);
        let copied = copied.find(|steps| known.contains(&digest_of_steps(steps)));
        return copied.map_or(Ok(()), |steps| {
            let (begins, ends) = (steps[0].0, steps[SAME_STEPS - 1].0);
            Err(same(begins, ends - begins + 1))
        });
    }
    let mut places = HashMap::new();
    for row in 0..first.time_s.len() {
        if let Some(key) = outputs(first, row) {
            places.entry(key).or_insert(row);
        }
    }
    let (mut run, mut last) = (0, None);
    for row in 0..second.time_s.len() {
        let place = outputs(second, row).and_then(|key| places.get(&key).copied());
        // Values that stand still are the same row again and again: they do not count.
        run = match (place, last) {
            (Some(place), Some(last)) if place == last + 1 => run + 1,
            _ => 0,
        };
        last = place;
        if run >= SAME_ROWS {
            return Err(same(row - run, run + 1));
        }
    }
    Ok(())
}

/// Whether a channel is read to so few values that half of them at least come twice.
fn is_coarse(channel: &MeasuredChannel) -> bool {
    let values = channel.values.iter().map(|value| value.to_bits());
    let different: HashSet<u64> = values.collect();
    2 * different.len() < channel.values.len()
}

/// Rows in which a value changes, with a digest of the values and of how long the ones before
/// stood.
fn steps<K: Hash + PartialEq>(one: &Measured, key: impl Fn(usize) -> K) -> Vec<(usize, u64)> {
    let mut last = 0;
    let mut found = Vec::new();
    for row in 1..one.time_s.len() {
        let now = key(row);
        if now != key(row - 1) {
            found.push((row, digest(&(now, row - last))));
            last = row;
        }
    }
    found
}

fn digest(of: &impl Hash) -> u64 {
    let mut hasher = DefaultHasher::new();
    of.hash(&mut hasher);
    hasher.finish()
}

/// Of values and times between them, wherever they begin.
fn digest_of_steps(steps: &[(usize, u64)]) -> u64 {
    // How long the value before the first stood is no part of them.
    let rows = steps.iter().skip(1);
    digest(&rows.map(|(_, own)| *own).collect::<Vec<u64>>())
}

/// Refuses recordings that leave other channels, or another rate.
fn check_alike(first: &Trial, second: &Trial) -> Result<(), BetweenError> {
    let names = |trial: &Trial| {
        let names: Vec<&str> = trial
            .channels()
            .iter()
            .map(|one| one.name.as_str())
            .collect();
        names.join(", ")
    };
    let [expected, found] = [first, second].map(names);
    let source = |trial: &Trial| trial.measured().source.clone();
    if expected != found {
        return Err(BetweenError::Channels {
            first: source(first),
            second: source(second),
            expected,
            found,
        });
    }
    let every = [first, second].map(every);
    if every[0] != every[1] {
        return Err(BetweenError::Thinning {
            first: source(first),
            second: source(second),
            every,
        });
    }
    Ok(())
}

#[cfg(test)]
mod tests;
