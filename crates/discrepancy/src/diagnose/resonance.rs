//! A resonance that the model does not have, driven by something that it does have.

use std::f64::consts::TAU;

use rayon::prelude::*;

use super::features::Group;
use super::moments::explained;
use super::problem::Problem;
use crate::model::Columns;

/// Resonances per octave that are tried, and their damping ratios: closer ones have nearly equal
/// signatures.
const PER_OCTAVE: f64 = 12.0;
const DAMPING: [f64; 2] = [0.03, 0.1];
/// The fastest has so many samples in a period.
const SAMPLES: f64 = 8.0;
/// The slowest has so many periods in the record.
const PERIODS: f64 = 4.0;

/// The resonance, and the signal that drives it, that explain most of the residual; none if nothing
/// moves.
pub(super) fn resonance(
    problem: &Problem,
    predicted: &Columns,
    residual: &[f64],
    rows: &[usize],
) -> Option<Group> {
    let time = &problem.data.time_s;
    let (interval, duration) = (time[1] - time[0], time[time.len() - 1] - time[0]);
    let (slowest, fastest) = (PERIODS / duration, 1.0 / (SAMPLES * interval));
    let count = (PER_OCTAVE * (fastest / slowest).log2()).max(0.0) as usize;
    let signals = problem.signals(predicted);
    let target: Vec<f64> = rows.iter().map(|&t| residual[t]).collect();
    let tried: Vec<_> = signals
        .flat_map(|signal| (0..=count).map(move |step| (signal, step)))
        .flat_map(|(signal, step)| DAMPING.map(|damping| (signal, step, damping)))
        .collect();
    let hz = |step: usize| slowest * 2.0_f64.powf(step as f64 / PER_OCTAVE);
    let features = |index: usize| {
        let ((_, values), step, damping) = tried[index];
        response(problem, values, TAU * hz(step) * interval, damping)
    };
    let gains = (0..tried.len()).into_par_iter().map(|index| {
        let at_rows = |x: Vec<f64>| -> Vec<f64> { rows.iter().map(|&t| x[t]).collect() };
        let picked = features(index).map(at_rows);
        (explained(&target, &picked), index)
    });
    // Of equal gains the first one tried.
    let (_, best) = gains
        .filter(|(gain, _)| gain.is_finite())
        .reduce_with(|a, b| if b.0 > a.0 { b } else { a })?;
    let ((name, _), step, _) = tried[best];
    let hz = truecut_recording::significant(hz(step), 2);
    Some(Group {
        chosen: 2,
        ..Group::of_signal(
            format!("a resonance near {hz} Hz, driven by {name}"),
            features(best).into(),
        )
    })
}

/// Displacement and velocity of an oscillator of the angular frequency (per sample) whose base a
/// signal moves; exact for a signal that is held over each sample. It rests at the signal's first
/// value.
fn response(problem: &Problem, signal: &[f64], angular: f64, damping: f64) -> [Vec<f64>; 2] {
    let decay = (-damping * angular).exp();
    let damped = angular * (1.0 - damping * damping).sqrt();
    let (sin, cos) = damped.sin_cos();
    let ratio = damping * angular / damped;
    let mut out = [vec![0.0; signal.len()], vec![0.0; signal.len()]];
    for range in &problem.data.trajectories {
        let (mut x, mut v) = (0.0, 0.0);
        let first = signal[range.start];
        for t in range.clone() {
            let base = signal[t] - first;
            out[0][t] = x - base;
            out[1][t] = v / angular;
            // About the value that is held, the motion is free.
            let (a, b) = (x - base, v);
            x = base + decay * (a * (cos + ratio * sin) + b / damped * sin);
            v = decay * (b * (cos - ratio * sin) - a * angular * angular / damped * sin);
        }
    }
    out
}
