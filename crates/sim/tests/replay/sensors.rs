//! What sensors make of drive forces.

use truecut_scenario::effect::{Effect, EffectKind, Target};

use super::*;

/// States without an order are read by a sensor that is late like any others, be they more or fewer
/// than the samples of the data.
#[test]
fn verify_a_late_sensor_reads_unrelated_states() {
    let model = swinging_mass();
    // by one interval of the data
    let late = Effect {
        kind: EffectKind::SensorDelay,
        target: Target::Channel("joint1.drive_force".into()),
        values: vec![1.0 / 400.0],
    };
    for states in [150, 2000] {
        let model = model.in_any_state(states);
        let [prompt, late] =
            [vec![], vec![late.clone()]].map(|effects| model.predict(&effects).unwrap().remove(0));
        assert_eq!([prompt.len(), late.len()], [states, states]);
        for (before, after) in prompt.iter().zip(&late[1..]) {
            assert!((before - after).abs() < 1e-6 * before.abs().max(1.0));
        }
    }
}

/// A sensor's gain, offset and the rest act in one order, whatever the order of the entries.
#[test]
fn verify_a_sensor_is_the_same_in_any_order_of_its_effects() {
    let model = swinging_mass();
    let sensor = |kind, value| Effect {
        kind,
        target: Target::Channel("joint1.drive_force".into()),
        values: vec![value],
    };
    let gain = sensor(EffectKind::SensorGain, 1.25);
    let offset = sensor(EffectKind::SensorOffset, 8.0);
    let nominal = model.predict(&[]).unwrap();
    for effects in [[gain.clone(), offset.clone()], [offset, gain]] {
        let predicted = model.predict(&effects).unwrap();
        for (got, force) in predicted[0].iter().zip(&nominal[0]) {
            assert!((got - (1.25 * force + 8.0)).abs() < 1e-9, "{got} {force}");
        }
    }
}
