//! Diagnosis of a six-joint arm without load, and of the same arm with a payload that nobody told
//! of.

use std::path::Path;

use crate::support::{
    NoData, data_file, diagnosed_with, extended_text, measured, named, relative, residual, scenario,
};
use truecut_discrepancy::diagnose::{Options, Verdict};
use truecut_scenario::Scenario;
use truecut_scenario::effect::EffectKind;
use truecut_sim::InverseModel;

/// Part of each recording that the diagnosis fits and chooses by; what comes after is opened when
/// the choice is frozen.
const DEVELOPMENT: f64 = 0.78;
/// While the loaded arm moves, in its file's time, s.
const LOADED_S: [f64; 2] = [1887.7, 1933.221];

/// Held-out errors with and without load of the models found before delays were looked for, per
/// cent of the torque.
const WITHOUT_DELAYS: [[f64; 6]; 2] = [
    [6.9, 1.8, 1.7, 7.6, 6.8, 4.7],
    [7.9, 1.7, 1.8, 8.5, 7.3, 3.8],
];

fn options() -> Options {
    Options {
        max_effects: 16,
        max_predictions: 60_000,
        ..Options::default()
    }
}

fn with(scenario: &Scenario, values: &[(&str, f64)]) -> Scenario {
    let overrides: Vec<_> = (values.iter())
        .map(|(key, value)| ((*key).to_owned(), format!("{value:?}")))
        .collect();
    scenario
        .with_overrides(&overrides)
        .unwrap_or_else(|e| panic!("{e}"))
}

/// A scenario without the entries that leave its links uncertain.
fn links_known(text: &str) -> String {
    let mut document: toml::Table = text.parse().expect("an extended scenario");
    let uncertain = document.get_mut("uncertain").expect("uncertain links");
    let uncertain = uncertain.as_array_mut().expect("a list");
    uncertain.retain(|entry| !entry["key"].as_str().expect("a key").starts_with("robot."));
    if uncertain.is_empty() {
        document.remove("uncertain");
    }
    document.to_string()
}

/// Errors of the drive torques in the part that no diagnosis has seen: in N m, and relative to the
/// torque, in per cent.
fn held_out(scenario: &Scenario, file: &Path) -> (Vec<f64>, Vec<f64>) {
    let model =
        InverseModel::new(scenario, &measured(scenario, file)).unwrap_or_else(|e| panic!("{e}"));
    let samples = model.measured().time_s.len();
    let part = (samples as f64 * DEVELOPMENT) as usize..samples;
    (0..model.channels().len())
        .map(|joint| {
            let valid = &model.measured().channels[joint].valid;
            let end = part
                .clone()
                .rev()
                .find(|k| valid[*k])
                .map_or(part.start, |k| k + 1);
            let left = residual(&model, joint, &[]);
            let squares: f64 = left[part.start..end].iter().map(|x| x * x).sum();
            let rms = (squares / (end - part.start) as f64).sqrt();
            (rms, 100.0 * relative(&model, joint, &left, part.start..end))
        })
        .unzip()
}

/// Without load: dry and viscous friction of every joint and the lag of its current, and no
/// payload. With it: the payload of 2.805 kg within 12 %, its centre off the flange, and errors of
/// at most 1.25 times those that a model without delays has without load. On the loaded recording,
/// on which delays were not found, no joint is predicted worse than without delays.
pub fn validate_ur10e_friction_is_named_without_load_and_the_payload_with_it() -> Result<(), NoData>
{
    let unloaded = data_file("ur10e/ur-20_02_19_14harm50sec.csv")?;
    let loaded = data_file("ur10e/ur-20_02_19_14harm50secLoad.csv")?;
    let nominal = scenario("ur10e_inverse.toml");
    let answer = diagnosed_with(&nominal, &unloaded, &options());
    assert_eq!(answer.diagnosis.verdict, Verdict::Named);
    let found = named(&answer);
    let friction = |kind: EffectKind| {
        let name = kind.name();
        name.contains("viscous") || name.contains("coulomb") || name == "joint_load_friction"
    };
    for joint in 0..6 {
        assert!(
            found
                .iter()
                .any(|(kind, at)| friction(*kind) && *at == Some(joint)),
            "joint {joint}: {found:?}"
        );
    }
    let late = |kind: EffectKind| kind == EffectKind::SensorDelay;
    assert!(
        (found.iter()).all(|(kind, _)| friction(*kind) || late(*kind)),
        "only friction, and delays of the currents: {found:?}"
    );
    // A regression of each joint by itself finds 6, 12, 8, 18, 18 and 22 ms.
    let delays = answer.effects.iter().filter(|one| late(one.kind));
    let delays: Vec<f64> = delays.map(|one| 1e3 * one.values[0]).collect();
    eprintln!("currents lag by {delays:.1?} ms");
    assert_eq!(delays.len(), 6);
    assert!(delays.iter().all(|ms| (4.0..40.0).contains(ms)));

    // What was found is the model now: the links stay what they are. Friction of a gear is not
    // known to the digit on another day.
    let mut text = links_known(&extended_text(&nominal, &answer));
    for (index, effect) in answer.effects.iter().enumerate() {
        for info in effect.kind.parameters() {
            text += &format!(
                "\n[[uncertain]]\nkey = \"effect.{index}.{}\"\nrelative = 0.15\n",
                info.rotary_key
            );
        }
    }
    let arm = Scenario::from_str(nominal.path(), &text, &[]).unwrap_or_else(|e| panic!("{e}"));
    let (without_n_m, without) = held_out(&arm, &unloaded);
    let arm = with(
        &arm,
        &[("data.from_s", LOADED_S[0]), ("data.to_s", LOADED_S[1])],
    );
    let answer = diagnosed_with(&arm, &loaded, &options());
    assert_eq!(answer.diagnosis.verdict, Verdict::Named);
    let payload = answer
        .effects
        .iter()
        .find(|e| e.kind == EffectKind::Payload);
    let [mass, x, y, z] = payload.expect("a payload").values[..] else {
        panic!("a payload has a mass and a centre")
    };
    eprintln!("payload {mass:.3} kg at {x:.3}, {y:.3}, {z:.3} m");
    assert!((mass / 2.805 - 1.0).abs() < 0.12, "{mass} kg");
    assert!((0.05..0.3).contains(&x.hypot(y)), "centre {x}, {y}, {z} m");
    assert_eq!(
        answer.effects.len(),
        1,
        "the payload alone: {:?}",
        named(&answer)
    );

    let arm = Scenario::from_str(nominal.path(), &extended_text(&arm, &answer), &[])
        .unwrap_or_else(|e| panic!("{e}"));
    let (with_payload_n_m, with_payload) = held_out(&arm, &loaded);
    eprintln!("held out, unloaded {without_n_m:.2?} N m, loaded {with_payload_n_m:.2?} N m");
    eprintln!("held out, unloaded {without:.1?} %, loaded {with_payload:.1?} %");
    let better = without.iter().zip(WITHOUT_DELAYS[0]);
    let better: f64 = better.map(|(now, before)| (now / before).ln()).sum();
    assert!(
        better < 0.0,
        "{without:.2?} beside {:?} %",
        WITHOUT_DELAYS[0]
    );
    for (joint, with) in with_payload.iter().enumerate() {
        let [unloaded, loaded] = WITHOUT_DELAYS.map(|errors| errors[joint]);
        assert!(
            *with <= 1.25 * unloaded && *with <= 1.05 * loaded,
            "joint {}: {with} % beside {unloaded} % and {loaded} %",
            joint + 1
        );
    }
    Ok(())
}
