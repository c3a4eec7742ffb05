//! Spikes of a logger: single samples far off their neighbours.
//!
//! What an arm does within a few samples is smooth, so that a cubic through the neighbours on
//! either side says what a sample must be, up to the noise. A spike stands alone: the neighbours
//! fit the cubic, which those of a jump, and of a swing that is sampled coarsely, do not.

use nalgebra::{SMatrix, SVector};
use truecut_recording::measured::{Measured, MeasuredChannel, Role};
use truecut_recording::{ChannelSpec, Unit};
use truecut_scenario::{ProcessSpec, Scenario};

/// In deviations of what the cubics miss, in the whole record and beside the sample alike.
const SPIKE: f64 = 5.0;
/// Neighbours to either side that a cubic goes through.
const AROUND: usize = 8;
/// Median of the size of a normal deviation.
const MEDIAN_SIZE: f64 = 0.674_49;
/// Spikes near to others are seen once those are gone.
const PASSES: usize = 5;
const CUBIC: usize = 4;
const NEIGHBOURS: usize = 2 * AROUND;

/// The data with spikes of outputs replaced by what their neighbours say, with a note on each
/// channel that had some.
pub(crate) fn bridged(scenario: &Scenario, measured: &Measured) -> Measured {
    let mut bridged = measured.clone();
    for (index, found) in replaced(scenario, &mut bridged) {
        let note = told(&measured.channels[index], found);
        bridged
            .notes
            .push(format!("{note}, and were replaced by that"));
    }
    bridged
}

/// Sentences on outputs that have spikes, for data that are taken as they are.
pub fn notes(scenario: &Scenario, measured: &Measured) -> Vec<String> {
    let found = replaced(scenario, &mut measured.clone()).into_iter();
    let note = |(index, found): (usize, usize)| {
        let note = told(&measured.channels[index], found);
        format!("{note}; they are compared as they are")
    };
    found.map(note).collect()
}

/// How many values are spikes, of a column as it lies in a file; those that are no numbers are
/// gaps.
pub fn count(values: &[f64]) -> usize {
    let mut channel = MeasuredChannel {
        spec: ChannelSpec::new("", Unit::One, ""),
        role: Role::Output,
        valid: values.iter().map(|value| value.is_finite()).collect(),
        values: values.to_owned(),
        noise: None,
        white_kept: 1.0,
    };
    replace(&mut channel, &Cubic::new())
}

fn told(channel: &MeasuredChannel, found: usize) -> String {
    format!(
        "{}: {found} of {} samples are spikes, more than {SPIKE} deviations off what their \
         neighbours say",
        channel.spec.name,
        channel.values.len()
    )
}

/// Replaces spikes of outputs; the channels that had some, by index, and how many. Where a tool
/// touches something a peak may be the process's, and stays.
fn replaced(scenario: &Scenario, measured: &mut Measured) -> Vec<(usize, usize)> {
    if !matches!(
        scenario.process,
        ProcessSpec::Load(_) | ProcessSpec::Replay(_)
    ) {
        return Vec::new();
    }
    let cubic = Cubic::new();
    let outputs = measured.channels.iter_mut().enumerate();
    let outputs = outputs.filter(|(_, channel)| channel.role == Role::Output);
    let found = outputs.map(|(index, channel)| (index, replace(channel, &cubic)));
    found.filter(|(_, found)| *found > 0).collect()
}

/// Replaces spikes of a channel; how many there were.
fn replace(channel: &mut MeasuredChannel, cubic: &Cubic) -> usize {
    let mut found = 0;
    for _ in 0..PASSES {
        let missed: Vec<Option<Miss>> = (0..channel.values.len())
            .map(|k| cubic.missed(&channel.values, &channel.valid, k))
            .collect();
        let mut sizes: Vec<f64> = missed.iter().flatten().map(|one| one.by.abs()).collect();
        if sizes.is_empty() {
            break;
        }
        let middle = sizes.len() / 2;
        let (_, median, _) = sizes.select_nth_unstable_by(middle, f64::total_cmp);
        let bar = SPIKE * *median / MEDIAN_SIZE;
        let mut replaced = 0;
        for (value, miss) in channel.values.iter_mut().zip(&missed) {
            let Some(miss) = miss else { continue };
            let size = miss.by.abs();
            if bar > 0.0 && size > bar && size > SPIKE * miss.deviation {
                *value -= miss.by;
                replaced += 1;
            }
        }
        found += replaced;
        if replaced == 0 {
            break;
        }
    }
    found
}

/// What a sample is off the cubic through its neighbours.
struct Miss {
    by: f64,
    /// Of that, from how well the neighbours themselves fit.
    deviation: f64,
}

/// Least squares of a cubic through the neighbours of a sample.
struct Cubic {
    /// Orthonormal columns that span the cubics at the neighbours.
    basis: SMatrix<f64, NEIGHBOURS, CUBIC>,
    /// The cubic's value at the sample, from its parts along the columns.
    here: SVector<f64, CUBIC>,
}

impl Cubic {
    fn new() -> Self {
        let reach = AROUND as f64;
        let power = |row: usize, power: usize| (place(row) / reach).powi(power as i32);
        let parted = SMatrix::<f64, NEIGHBOURS, CUBIC>::from_fn(power).qr();
        // the cubic at the sample is its constant: the first row of the inverse of R
        let constant = SVector::<f64, CUBIC>::ith(0, 1.0);
        let here = parted.r().transpose().solve_lower_triangular(&constant);
        Self {
            basis: parted.q(),
            here: here.unwrap_or_default(),
        }
    }

    /// `None` where a neighbour is missing.
    fn missed(&self, values: &[f64], valid: &[bool], k: usize) -> Option<Miss> {
        let first = k.checked_sub(AROUND)?;
        let window = values.get(first..=k + AROUND)?;
        if !valid[first..=k + AROUND].iter().all(|valid| *valid) {
            return None;
        }
        let neighbour = |row, _| window[row + usize::from(row >= AROUND)];
        let beside = SVector::<f64, NEIGHBOURS>::from_fn(neighbour);
        let parts = self.basis.tr_mul(&beside);
        let left = beside - self.basis * parts;
        let variance = left.norm_squared() / (NEIGHBOURS - CUBIC) as f64;
        Some(Miss {
            by: values[k] - self.here.dot(&parts),
            deviation: (variance * (1.0 + self.here.norm_squared())).sqrt(),
        })
    }
}

/// Samples from the one in the middle to a neighbour.
fn place(row: usize) -> f64 {
    let step = row as f64 - AROUND as f64;
    if row >= AROUND { step + 1.0 } else { step }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{Colour, noise};

    fn channel(values: Vec<f64>) -> MeasuredChannel {
        MeasuredChannel {
            spec: ChannelSpec::new("tool.position_x", Unit::Metre, "drawn"),
            role: Role::Output,
            valid: vec![true; values.len()],
            values,
            noise: None,
            white_kept: 1.0,
        }
    }

    /// A swing of a hundred times the noise whose frequency rises to a sixth of the rate, with
    /// friction's jumps: hardly a sample is replaced.
    #[test]
    fn verify_noise_swings_and_jumps_are_no_spikes() {
        for (seed, colour) in [Colour::White, Colour::Ar1(0.9)]
            .into_iter()
            .cycle()
            .take(20)
            .enumerate()
        {
            let drawn = noise(colour, 2000, seed as u64);
            let swept = |k: f64| (0.5 * k * k / 2000.0).sin() * (1.0 + 99.0 * (k / 2000.0).powi(2));
            let jump = |k: usize| {
                if (k / 333).is_multiple_of(2) {
                    40.0
                } else {
                    0.0
                }
            };
            let rows = drawn.iter().enumerate();
            let values: Vec<f64> = rows.map(|(k, n)| swept(k as f64) + jump(k) + n).collect();
            let found = replace(&mut channel(values), &Cubic::new());
            assert!(found <= 1, "seed {seed}: {found}");
        }
    }

    /// Noise that is loud for a part of the time, on a stage a metre away whose steps are
    /// nanometres.
    #[test]
    fn verify_loud_noise_is_no_spikes() {
        for seed in 0..20 {
            let drawn = noise(Colour::White, 2000, seed);
            let loud = |k: usize| if k / 400 % 3 == 1 { 1e-7 } else { 1e-9 };
            let rows = drawn.iter().enumerate();
            let values: Vec<f64> = rows.map(|(k, n)| 1.0 + loud(k) * n).collect();
            let found = replace(&mut channel(values), &Cubic::new());
            assert!(found <= 3, "seed {seed}: {found}");
        }
    }

    /// A cubic is met exactly, and its neighbours fit.
    #[test]
    fn verify_a_cubic_is_met_exactly() {
        let values: Vec<f64> = (0..40)
            .map(|k| f64::from(k) * 0.1)
            .map(|t| 3.0 - 2.0 * t + 0.5 * t * t - 0.7 * t.powi(3))
            .collect();
        let cubic = Cubic::new();
        for k in AROUND..40 - AROUND {
            let miss = cubic.missed(&values, &[true; 40], k).unwrap();
            assert!(miss.by.abs() < 1e-12 && miss.deviation < 1e-12, "{k}");
        }
    }

    /// Of spikes of 6 to 15 deviations of white noise most go, of 9 and more all but a few, and
    /// what takes their place is what was there, up to the noise.
    #[test]
    fn verify_spikes_are_replaced_by_what_was_there() {
        let (mut large, mut found, mut missed) = (0, 0, 0.0_f64);
        for seed in 0..20 {
            let drawn = noise(Colour::White, 2000, seed);
            let clean: Vec<f64> = (0..2000).map(|k| 30.0 * (0.1 * k as f64).sin()).collect();
            let noisy: Vec<f64> = clean.iter().zip(&drawn).map(|(x, n)| x + n).collect();
            let mut spiky = noisy.clone();
            let at: Vec<usize> = (0..20).map(|i| 50 + 97 * i + seed as usize).collect();
            for (i, &k) in at.iter().enumerate() {
                let size = 6.0 + 9.0 * i as f64 / 20.0;
                spiky[k] += if i.is_multiple_of(2) { size } else { -size };
            }
            let mut bridged = channel(spiky.clone());
            replace(&mut bridged, &Cubic::new());
            for (i, &k) in at.iter().enumerate() {
                let is_found = bridged.values[k] != spiky[k];
                large += usize::from(i >= 7);
                found += usize::from(i >= 7 && is_found);
                if is_found {
                    missed = missed.max((bridged.values[k] - clean[k]).abs());
                }
            }
        }
        assert!(found as f64 > 0.85 * large as f64, "{found} of {large}");
        assert!(missed < 5.0, "{missed}");
    }
}
