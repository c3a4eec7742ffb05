//! Two recordings as one set of data: their difference, or one after the other.

use std::ops::Range;

use crate::diagnose::{NoiseSample, Observation, Output, Regressor};

/// Rows of both recordings that belong together: so many from these on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Overlap {
    pub first: usize,
    pub second: usize,
    pub count: usize,
}

impl Overlap {
    /// Of recordings of so many rows, the second `later` rows late.
    pub fn of(rows: [usize; 2], later: i64) -> Overlap {
        let first = usize::try_from(-later).unwrap_or(0).min(rows[0]);
        let second = usize::try_from(later).unwrap_or(0).min(rows[1]);
        Overlap {
            first,
            second,
            count: (rows[0] - first).min(rows[1] - second),
        }
    }
}

/// The second less the first, at the times of the second.
pub(super) fn difference(first: &Observation, second: &Observation, at: Overlap) -> Observation {
    let rows = [
        at.first..at.first + at.count,
        at.second..at.second + at.count,
    ];
    let outputs = first.outputs.iter().zip(&second.outputs);
    let outputs = outputs.map(|(a, b)| {
        let values = b.values[rows[1].clone()]
            .iter()
            .zip(&a.values[rows[0].clone()]);
        let valid = b.valid[rows[1].clone()]
            .iter()
            .zip(&a.valid[rows[0].clone()]);
        Output {
            values: values.map(|(b, a)| b - a).collect(),
            valid: valid.map(|(b, a)| *b && *a).collect(),
            noise: a.noise.zip(b.noise).map(|(a, b)| a.hypot(b)),
            sample: both(a, b, std::f64::consts::SQRT_2),
            noise_without_memory: match a.noise_without_memory.min(b.noise_without_memory) > 0.0 {
                true => a.noise_without_memory.hypot(b.noise_without_memory),
                false => 0.0,
            },
            // Either rounding stays, whatever the other does.
            noise_error: a.noise_error.max(b.noise_error),
            held_step: a.held_step.hypot(b.held_step),
            noise_of_inputs: a.noise_of_inputs.hypot(b.noise_of_inputs),
        }
    });
    let shifted = |range: &Range<usize>| {
        let from = range.start.max(at.second) - at.second;
        let to = range
            .end
            .min(at.second + at.count)
            .saturating_sub(at.second);
        from..to.max(from)
    };
    let trajectories = second.trajectories.iter().map(shifted);
    let own = |one: &Regressor| Regressor {
        values: one.values[rows[1].clone()].to_vec(),
        ..one.clone()
    };
    let start_s = second.time_s[at.second];
    Observation {
        source: format!("{} less {}", second.source, first.source),
        scenario: second.scenario.clone(),
        time_s: second.time_s[rows[1].clone()]
            .iter()
            .map(|t| t - start_s)
            .collect(),
        trajectories: trajectories.filter(|range| !range.is_empty()).collect(),
        outputs: outputs.collect(),
        regressors: second.regressors.iter().map(own).collect(),
        fine: None,
        again: (second.again.iter())
            .filter(|pair| pair.iter().all(|row| rows[1].contains(row)))
            .map(|pair| pair.map(|row| row - at.second))
            .collect(),
    }
}

/// The first, then the second.
pub(super) fn one_after_the_other(first: &Observation, second: &Observation) -> Observation {
    let rows = first.time_s.len();
    let outputs = first.outputs.iter().zip(&second.outputs);
    let outputs = outputs.map(|(a, b)| {
        let mean = |a: f64, b: f64| a.hypot(b) / std::f64::consts::SQRT_2;
        Output {
            values: [a.values.as_slice(), &b.values].concat(),
            valid: [a.valid.as_slice(), &b.valid].concat(),
            noise: a.noise.zip(b.noise).map(|(a, b)| mean(a, b)),
            sample: both(a, b, 1.0),
            noise_without_memory: mean(a.noise_without_memory, b.noise_without_memory),
            noise_error: a.noise_error.max(b.noise_error),
            held_step: mean(a.held_step, b.held_step),
            noise_of_inputs: mean(a.noise_of_inputs, b.noise_of_inputs),
        }
    });
    let interval_s = (second.time_s.get(1)).map_or(0.0, |next| next - second.time_s[0]);
    let begins_s = first.time_s.last().map_or(0.0, |last| last + interval_s);
    let later = second
        .time_s
        .iter()
        .map(|t| t - second.time_s[0] + begins_s);
    let shifted = second
        .trajectories
        .iter()
        .map(|one| one.start + rows..one.end + rows);
    let regressors = first.regressors.iter().filter_map(|a| {
        let b = second.regressors.iter().find(|b| b.name == a.name)?;
        Some(Regressor {
            values: [a.values.as_slice(), &b.values].concat(),
            ..a.clone()
        })
    });
    Observation {
        source: format!("{}, then {}", first.source, second.source),
        scenario: second.scenario.clone(),
        time_s: first.time_s.iter().copied().chain(later).collect(),
        trajectories: first.trajectories.iter().cloned().chain(shifted).collect(),
        outputs: outputs.collect(),
        regressors: regressors.collect(),
        fine: None,
        again: (first.again.iter().copied())
            .chain(second.again.iter().map(|pair| pair.map(|row| row + rows)))
            .collect(),
    }
}

/// The noise of both by itself, so many times as large.
fn both(first: &Output, second: &Output, factor: f64) -> Option<NoiseSample> {
    let (a, b) = (first.sample.as_ref()?, second.sample.as_ref()?);
    let stretches = a.stretches.iter().chain(&b.stretches);
    let larger = |one: &Vec<f64>| one.iter().map(|x| factor * x).collect();
    Some(NoiseSample {
        source: a.source,
        stretches: stretches.map(larger).collect(),
        seen: a.seen.min(b.seen),
    })
}
