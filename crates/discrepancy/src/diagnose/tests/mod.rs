//! The search on models written here, whose data come from code of their own: closed forms and a
//! Runge-Kutta integration with finer steps than the model's. Nothing of the simulator is used.

mod changing;
mod clean;
mod force;
mod single;
mod slide;
mod special;

use truecut_scenario::effect::Effect;

use super::{Answer, Observation, Options, Output, Verdict, diagnose};
use crate::model::{Columns, Model};
use crate::testing::{Colour, noise};

const WHITE: Colour = Colour::White;
const COLOURED: Colour = Colour::Ar1(0.9);

/// `columns` plus noise whose rms in each channel is `levels`.
pub(in crate::diagnose) fn observed(
    columns: &Columns,
    levels: &[f64],
    colour: Colour,
    seed: u64,
    interval_s: f64,
) -> Observation {
    let samples = columns[0].len();
    let outputs = columns
        .iter()
        .zip(levels)
        .enumerate()
        .map(|(c, (column, level))| {
            let noise = noise(colour, samples, 100 * seed + c as u64);
            let rms = (noise.iter().map(|n| n * n).sum::<f64>() / samples as f64).sqrt();
            Output {
                values: column
                    .iter()
                    .zip(noise)
                    .map(|(y, n)| y + level * n / rms)
                    .collect(),
                valid: vec![true; samples],
                noise: None,
                sample: None,
                noise_without_memory: 0.0,
                held_step: 0.0,
                noise_of_inputs: 0.0,
                noise_error: 0.0,
            }
        });
    Observation {
        source: "measured".into(),
        scenario: "analytic".into(),
        outputs: outputs.collect(),
        time_s: (0..samples).map(|i| i as f64 * interval_s).collect(),
        trajectories: std::iter::once(0..samples).collect(),
        regressors: Vec::new(),
        fine: None,
        again: Vec::new(),
    }
}

/// Noise levels at which the change from `nominal` to `changed` is `ratio` times the noise in the
/// channel where it shows most, and noise is the same part of every channel's signal.
fn levels(nominal: &Columns, changed: &Columns, ratio: f64) -> Vec<f64> {
    let rms = |x: &mut dyn Iterator<Item = f64>| {
        let squares: Vec<f64> = x.map(|v| v * v).collect();
        (squares.iter().sum::<f64>() / squares.len() as f64).sqrt()
    };
    let signal: Vec<f64> = nominal
        .iter()
        .map(|x| rms(&mut x.iter().copied()))
        .collect();
    let change = nominal.iter().zip(changed).zip(&signal);
    let most = change
        .map(|((a, b), signal)| rms(&mut a.iter().zip(b).map(|(a, b)| b - a)) / signal)
        .fold(0.0, f64::max);
    signal.iter().map(|s| s * most / ratio).collect()
}

fn run(model: &dyn Model, data: &Observation) -> Answer {
    diagnose(model, data, &Options::default(), &|_| {}).unwrap()
}

fn names(effects: &[Effect]) -> Vec<String> {
    let name = |effect: &Effect| format!("{} {:?}", effect.kind.name(), effect.target);
    let mut names: Vec<String> = effects.iter().map(name).collect();
    names.sort();
    names
}

fn describe(answer: &Answer) -> String {
    let d = &answer.diagnosis;
    let rivals: Vec<_> = d
        .alternatives
        .iter()
        .map(|a| a.causes.iter().map(|c| c.kind.clone()).collect::<Vec<_>>())
        .collect();
    format!(
        "{:?} {:?} fits {:?} alternatives {rivals:?} unexplained {:.2} correlated_signals {:?} work {:?} -- {}",
        d.verdict,
        answer.effects,
        d.fits
            .iter()
            .map(|f| (f.effects.join("+"), f.converged, f.iterations))
            .collect::<Vec<_>>(),
        d.unexplained_fraction,
        d.ceiling.correlated_signals.first(),
        d.work,
        d.reason
    )
}

/// Named, or in an ambiguous set, is what was hidden.
fn is_found(answer: &Answer, hidden: &[Effect]) -> bool {
    let named = names(&answer.effects) == names(hidden);
    match answer.diagnosis.verdict {
        Verdict::Named => named,
        Verdict::Ambiguous => {
            let kinds: Vec<&str> = hidden.iter().map(|e| e.kind.name()).collect();
            let close = |a: &super::Alternative| {
                a.angle_deg < 10.0 && a.causes.iter().all(|c| kinds.contains(&c.kind.as_str()))
            };
            named || answer.diagnosis.alternatives.iter().any(close)
        }
        _ => false,
    }
}
