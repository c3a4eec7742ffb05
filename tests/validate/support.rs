//! Finding data, and fitting what is linear.

use nalgebra::{DMatrix, DVector};
use std::path::{Path, PathBuf};
use truecut_recording::Measured;
use truecut_scenario::Scenario;
use truecut_scenario::effect::{Effect, EffectKind, Target};
use truecut_sim::InverseModel;

/// A file of measured data; `None`, said on standard error with the test's name, if there is none.
pub fn data_file(test: &str, file: &str) -> Option<PathBuf> {
    let Some(folder) = std::env::var_os("TRUECUT_DATA") else {
        eprintln!("skipped: {test} (TRUECUT_DATA names no folder of measured data)");
        return None;
    };
    // Relative to the repository, where the tests are started from.
    let repository = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let path = repository.join(folder).join(file);
    assert!(path.exists(), "{} does not exist", path.display());
    Some(path)
}

/// A shipped replay scenario.
pub fn scenario(name: &str) -> Scenario {
    let repository = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let path = repository.join("scenarios/replay").join(name);
    Scenario::load(&path, &[]).unwrap_or_else(|error| panic!("{name}: {error:?}"))
}

/// The data of a replay scenario.
pub fn measured(scenario: &Scenario, file: &Path) -> Measured {
    let data = scenario
        .data
        .as_ref()
        .expect("a replay scenario has [data]");
    let table = truecut_telemetry::read_table(file, data.header).unwrap_or_else(|e| panic!("{e}"));
    truecut_recording::measured::measured(&table, &data.mapping).unwrap_or_else(|e| panic!("{e}"))
}

/// An effect on a joint, counted from 0.
pub fn on_joint(kind: EffectKind, joint: usize, values: &[f64]) -> Effect {
    Effect {
        kind,
        target: Target::Joint(joint),
        values: values.to_vec(),
    }
}

/// What is left of the measured drive force `channel` by the prediction with `effects`.
pub fn residual(model: &InverseModel, channel: usize, effects: &[Effect]) -> Vec<f64> {
    let predicted = model.predict(effects).unwrap_or_else(|e| panic!("{e}"));
    let measured = &model.measured().channels[channel].values;
    (measured.iter().zip(&predicted[channel]))
        .map(|(a, b)| a - b)
        .collect()
}

/// Sizes of `effects`, each given with size 1, that leave least of the drive force `channel` in the samples
/// `part`.
pub fn fit(
    model: &InverseModel,
    channel: usize,
    effects: &[Effect],
    part: std::ops::Range<usize>,
) -> Vec<f64> {
    let nominal = residual(model, channel, &[]);
    let columns: Vec<DVector<f64>> = (effects.iter())
        .map(|effect| {
            let with = residual(model, channel, std::slice::from_ref(effect));
            DVector::from_iterator(part.len(), part.clone().map(|k| nominal[k] - with[k]))
        })
        .collect();
    let matrix = DMatrix::from_columns(&columns);
    let wanted = DVector::from_iterator(part.len(), part.map(|k| nominal[k]));
    let found = matrix.svd(true, true).solve(&wanted, 1e-12);
    found
        .expect("both sides were asked for")
        .iter()
        .copied()
        .collect()
}

/// Size of `residual` relative to the measured drive force, in the samples `part`.
pub fn relative(
    model: &InverseModel,
    channel: usize,
    residual: &[f64],
    part: std::ops::Range<usize>,
) -> f64 {
    let square = |values: &[f64]| values[part.clone()].iter().map(|x| x * x).sum::<f64>();
    (square(residual) / square(&model.measured().channels[channel].values)).sqrt()
}
