//! Spikes of a logger in data that a model is compared with.

use truecut_recording::measured::{Measured, MeasuredChannel, Role, SPIKE, replace_spikes};
use truecut_scenario::Scenario;
use truecut_sim::run::Rows;

use crate::trial::sampling;

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

/// The data with those spikes replaced, too, that hide in what swings: in what a run of the model
/// leaves of the outputs, which is smoother than they are.
pub(crate) fn bridged_beside(scenario: &Scenario, measured: &Measured, rows: &Rows) -> Measured {
    let times_s = measured.process_time_s();
    let mut left = measured.clone();
    for channel in &mut left.channels {
        let mut specs = rows.channels.iter();
        let index = specs.position(|spec| spec.name == channel.spec.name);
        let model = index.map(|index| sampling::at(&rows.time_s, &rows.columns[index], &times_s));
        let pairs = channel.values.iter_mut().zip(model.iter().flatten());
        pairs.for_each(|(value, model)| *value -= model);
    }
    let before = left.clone();
    let mut bridged = measured.clone();
    for (index, found) in replaced(scenario, &mut left) {
        let changes = left.channels[index]
            .values
            .iter()
            .zip(&before.channels[index].values);
        let values = bridged.channels[index].values.iter_mut();
        values
            .zip(changes)
            .for_each(|(value, (after, before))| *value += after - before);
        bridged.notes.push(format!(
            "{} beside a run of the model, and were replaced by that",
            told(&measured.channels[index], found)
        ));
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
    let valid: Vec<bool> = values.iter().map(|value| value.is_finite()).collect();
    replace_spikes(&mut values.to_owned(), &valid)
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
    let data = scenario.data.as_ref();
    if !data.is_some_and(|data| data.mapping.bridge_spikes) {
        return Vec::new();
    }
    let outputs = measured.channels.iter_mut().enumerate();
    let outputs = outputs.filter(|(_, channel)| channel.role == Role::Output);
    let found = outputs.map(|(index, channel)| {
        let found = replace_spikes(&mut channel.values, &channel.valid);
        (index, found)
    });
    found.filter(|(_, found)| *found > 0).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{Colour, noise};

    fn replaced_in(values: &mut [f64]) -> usize {
        let valid = vec![true; values.len()];
        replace_spikes(values, &valid)
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
            let mut values: Vec<f64> = rows.map(|(k, n)| swept(k as f64) + jump(k) + n).collect();
            let found = replaced_in(&mut values);
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
            let mut values: Vec<f64> = rows.map(|(k, n)| 1.0 + loud(k) * n).collect();
            let found = replaced_in(&mut values);
            assert!(found <= 3, "seed {seed}: {found}");
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
            let mut bridged = spiky.clone();
            replaced_in(&mut bridged);
            for (i, &k) in at.iter().enumerate() {
                let is_found = bridged[k] != spiky[k];
                large += usize::from(i >= 7);
                found += usize::from(i >= 7 && is_found);
                if is_found {
                    missed = missed.max((bridged[k] - clean[k]).abs());
                }
            }
        }
        assert!(found as f64 > 0.85 * large as f64, "{found} of {large}");
        assert!(missed < 5.0, "{missed}");
    }
}
