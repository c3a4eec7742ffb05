//! Finding data, and fitting what is linear.

use nalgebra::{DMatrix, DVector};
use std::path::{Path, PathBuf};
use truecut_discrepancy::diagnose::{Answer, Options, diagnose};
use truecut_discrepancy::trial::Trial;
use truecut_recording::Measured;
use truecut_scenario::Scenario;
use truecut_scenario::effect::{Effect, EffectKind, Target};
use truecut_sim::InverseModel;

/// There is no measured data: `TRUECUT_DATA` names no folder.
pub struct NoData;

/// A file of measured data. One that is missing from a folder that is named is a failure.
pub fn data_file(file: &str) -> Result<PathBuf, NoData> {
    let folder = std::env::var_os("TRUECUT_DATA").ok_or(NoData)?;
    // Relative to the repository, where the tests are started from.
    let repository = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let path = repository.join(folder).join(file);
    assert!(path.exists(), "{} does not exist", path.display());
    Ok(path)
}

/// A shipped replay scenario.
pub fn scenario(name: &str) -> Scenario {
    let repository = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let path = repository.join("scenarios/replay").join(name);
    Scenario::load(&path, &[]).unwrap_or_else(|error| panic!("{name}: {error:?}"))
}

/// The filter under which the published errors of the EMPS hold.
pub const PUBLISHED_FILTER: [(&str, &str); 1] = [("process.replay.compare_cutoff_hz", "50")];

/// What `truecut diagnose` answers.
pub fn diagnosed(scenario: &Scenario, file: &Path) -> Answer {
    diagnosed_with(scenario, file, &Options::default())
}

/// The same with options.
pub fn diagnosed_with(scenario: &Scenario, file: &Path, options: &Options) -> Answer {
    let data = measured(scenario, file);
    let trial = Trial::new(scenario, &data).unwrap_or_else(|e| panic!("{e}"));
    let answer = diagnose(&trial, &trial.observation, options, &|_| ());
    let answer = answer.unwrap_or_else(|e| panic!("{e}"));
    eprintln!("{}", answer.diagnosis.reason);
    for (effect, cause) in answer.effects.iter().zip(&answer.diagnosis.causes) {
        eprintln!("{} {:?} {:.4?}", cause.kind, cause.target, effect.values);
    }
    answer
}

/// The scenario with the refitted values and the effects of an answer, as `extended.toml` has them.
pub fn extended_text(scenario: &Scenario, answer: &Answer) -> String {
    let refitted = scenario.uncertain.iter().zip(&answer.nominal);
    let overrides: Vec<(String, String)> = refitted
        .map(|(parameter, value)| (parameter.key.clone(), parameter.written(*value)))
        .collect();
    let refitted = (scenario.with_overrides(&overrides)).unwrap_or_else(|e| panic!("{e}"));
    let drives = scenario.robot != truecut_scenario::RobotSpec::NONE;
    let rotary = match drives {
        true => {
            let facts = truecut_sim::facts::robot_facts(scenario);
            let joints = facts.unwrap_or_else(|e| panic!("{e}")).joints;
            joints.iter().map(|joint| joint.rotary).collect()
        }
        false => Vec::new(),
    };
    refitted.extended_text(&answer.effects, &rotary)
}

/// The scenario of [`extended_text`].
pub fn extended(scenario: &Scenario, answer: &Answer) -> Scenario {
    let text = extended_text(scenario, answer);
    Scenario::from_str(scenario.path(), &text, &[]).unwrap_or_else(|e| panic!("{e}"))
}

/// The effects of an answer by kind, with the joint they act on (counted from 0).
pub fn named(answer: &Answer) -> Vec<(EffectKind, Option<usize>)> {
    let joint = |effect: &Effect| match effect.target {
        Target::Joint(joint) => Some(joint),
        _ => None,
    };
    let mut named: Vec<_> = (answer.effects.iter())
        .map(|effect| (effect.kind, joint(effect)))
        .collect();
    named.sort_by_key(|(kind, joint)| (kind.name(), *joint));
    named
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

/// Sizes of `effects`, each given with size 1, that leave least of the drive force `channel` in the
/// samples `part`.
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
