//! Drive forces from measured motion, against measured ones.

use crate::support::{data_file, fit, measured, on_joint, relative, residual, scenario};
use truecut_scenario::effect::{Effect, EffectKind};
use truecut_sim::InverseModel;

fn emps(file: &std::path::Path) -> InverseModel {
    let scenario = scenario("emps_inverse.toml");
    let data = measured(&scenario, file);
    InverseModel::new(&scenario, &data).unwrap_or_else(|e| panic!("{e}"))
}

/// Fits `effects` to one recording and returns their sizes and the error on the other.
fn emps_error(train: &InverseModel, test: &InverseModel, effects: &[Effect]) -> (Vec<f64>, f64) {
    let all = |model: &InverseModel| 0..model.measured().time_s.len();
    let sizes = fit(train, 0, effects, all(train));
    let fitted: Vec<Effect> = (effects.iter().zip(&sizes))
        .map(|(effect, size)| Effect {
            values: effect.values.iter().map(|value| value * size).collect(),
            ..effect.clone()
        })
        .collect();
    // Effects of one kind are one effect with several sizes.
    let mut merged: Vec<Effect> = Vec::new();
    for effect in fitted {
        match merged.iter_mut().find(|known| known.kind == effect.kind) {
            Some(known) => {
                for (sum, value) in known.values.iter_mut().zip(&effect.values) {
                    *sum += value;
                }
            }
            None => merged.push(effect),
        }
    }
    let error = relative(test, 0, &residual(test, 0, &merged), all(test));
    (sizes, error)
}

/// The published errors of three friction models on the recording with pulses, each fitted to the other
/// recording: 17.0 %, 6.1 % and 5.5 %; mass 95.1 kg.
#[test]
fn validate_emps_inverse_dynamics_error_is_the_published_one() {
    let name = "validate_emps_inverse_dynamics_error_is_the_published_one";
    let Some(train) = data_file(name, "emps/DATA_EMPS.csv") else {
        return;
    };
    let Some(test) = data_file(name, "emps/DATA_EMPS_PULSES.csv") else {
        return;
    };
    let (train, test) = (emps(&train), emps(&test));
    let one = |kind, values: &[f64]| on_joint(kind, 0, values);
    let viscous = one(EffectKind::JointViscous, &[1.0]);
    let coulomb = one(EffectKind::JointCoulomb, &[1.0]);
    let offset = one(EffectKind::JointOffset, &[1.0]);
    let ahead = one(EffectKind::JointAsymmetricViscous, &[1.0, 0.0]);
    let back = one(EffectKind::JointAsymmetricViscous, &[0.0, 1.0]);

    let (_, error) = emps_error(&train, &test, &[viscous.clone(), offset.clone()]);
    assert!((error - 0.170).abs() < 0.0005, "viscous only: {error}");
    let (sizes, error) = emps_error(&train, &test, &[viscous, coulomb.clone(), offset.clone()]);
    assert!((error - 0.061).abs() < 0.0005, "with Coulomb: {error}");
    // Published: 203.5 N s/m, 20.4 N, and 3.2 N that the drive need not give.
    for (found, published) in sizes.iter().zip([203.5, 20.4, 3.2]) {
        assert!((found / published - 1.0).abs() < 0.02, "{sizes:?}");
    }
    let (sizes, error) = emps_error(&train, &test, &[ahead, back, coulomb, offset]);
    assert!((error - 0.055).abs() < 0.0006, "with asymmetry: {error}");
    assert!(sizes[1] > 1.3 * sizes[0], "the slow direction: {sizes:?}");
}
