//! A record of several passes of one process, as the diagnosis sees it.

use truecut_discrepancy::model::Model;
use truecut_discrepancy::trial::Trial;
use truecut_recording::{Measured, MeasuredChannel, Pass, Role};
use truecut_scenario::Scenario;
use truecut_scenario::effect::{Effect, EffectKind, Target};

const RATE_HZ: f64 = 250.0;
const SAMPLES_OF_A_PASS: usize = 1001;

fn scenario(file: &str) -> Scenario {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/hidden_effects/scenarios/");
    let path = std::path::Path::new(folder).join(file);
    Scenario::load(&path, &[]).unwrap_or_else(|error| panic!("{file}: {error:?}"))
}

/// Three passes, each `late_s` after the sample that would be its first.
fn measured(scenario: &Scenario, late_s: f64) -> Measured {
    let count = 3 * SAMPLES_OF_A_PASS;
    let mapping = &scenario.data.as_ref().expect("it has data").mapping;
    let channels = mapping.channels.iter().map(|one| MeasuredChannel {
        spec: truecut_recording::ChannelSpec::new(one.channel.clone(), one.unit.unit, ""),
        role: Role::Output,
        values: (0..count).map(|k| (0.1 * k as f64).sin()).collect(),
        valid: vec![true; count],
        noise: None,
        white_kept: 1.0,
    });
    let pass = |k: usize| Pass {
        samples: k * SAMPLES_OF_A_PASS..(k + 1) * SAMPLES_OF_A_PASS,
        start_s: (k * SAMPLES_OF_A_PASS) as f64 / RATE_HZ - late_s,
    };
    Measured {
        source: "three holes".into(),
        time_s: (0..count).map(|k| k as f64 / RATE_HZ).collect(),
        channels: channels.collect(),
        passes: (0..3).map(pass).collect(),
        ..Measured::default()
    }
}

fn effect(kind: EffectKind, target: Target, value: f64) -> Effect {
    Effect {
        kind,
        target,
        values: vec![value],
    }
}

#[test]
fn every_pass_is_the_same_run_from_its_own_start() {
    let scenario = scenario("chamfer.toml");
    let predicted = |late_s: f64| {
        let trial =
            Trial::new(&scenario, &measured(&scenario, late_s)).unwrap_or_else(|e| panic!("{e}"));
        let nominal: Vec<f64> = trial.nominal().iter().map(|one| one.value).collect();
        trial
            .predict(&nominal, &[])
            .unwrap_or_else(|e| panic!("{e}"))
    };
    let columns = predicted(0.0);
    assert_eq!(columns.len(), 3);
    for column in &columns {
        let most = column.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
        for k in 0..2 * SAMPLES_OF_A_PASS {
            let again = column[k + SAMPLES_OF_A_PASS];
            assert!((again - column[k]).abs() < 1e-9 * most, "{k}");
        }
    }
    // Passes that began five samples earlier show the run five samples later.
    let later = predicted(5.0 / RATE_HZ);
    for (column, later) in columns.iter().zip(&later) {
        let most = column.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
        for k in 0..SAMPLES_OF_A_PASS - 5 {
            assert!((later[k] - column[k + 5]).abs() < 1e-9 * most, "{k}");
        }
    }
}

/// Sensors are applied to runs that are kept; the scenario that has the machine's effect already is
/// run with all of them.
#[test]
fn sensors_measure_a_kept_run_as_a_run_of_their_own() {
    let scenario = scenario("chamfer.toml");
    let data = measured(&scenario, 0.0);
    let machine = effect(EffectKind::CuttingCoefficient, Target::Whole, 1.15);
    let on = |channel: &str| Target::Channel(channel.to_owned());
    let sensors = [
        effect(EffectKind::SensorGain, on("dynamometer.force_x"), 1.2),
        effect(EffectKind::SensorDelay, on("tool.displacement_y"), 0.0071),
        effect(EffectKind::SensorLowPass, on("dynamometer.force_y"), 0.013),
    ];
    let trial = Trial::new(&scenario, &data).unwrap_or_else(|e| panic!("{e}"));
    let nominal: Vec<f64> = trial.nominal().iter().map(|one| one.value).collect();
    let all: Vec<Effect> = std::iter::once(machine.clone())
        .chain(sensors.clone())
        .collect();
    let kept = trial
        .predict(&nominal, &all)
        .unwrap_or_else(|e| panic!("{e}"));
    let worn = scenario
        .with_effects(&[machine])
        .unwrap_or_else(|e| panic!("{e}"));
    let trial = Trial::new(&worn, &data).unwrap_or_else(|e| panic!("{e}"));
    let own = trial
        .predict(&nominal, &sensors)
        .unwrap_or_else(|e| panic!("{e}"));
    assert_eq!((kept.len(), own.len()), (3, 3));
    for (kept, own) in kept.iter().zip(&own) {
        let most = own.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
        for (k, (a, b)) in kept.iter().zip(own).enumerate() {
            assert!((a - b).abs() < 1e-11 * most, "{k}: {a} {b}");
        }
    }
}
