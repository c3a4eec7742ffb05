//! What a search may propose.

use std::path::Path;

use truecut_recording::{ChannelSpec, Measured, MeasuredChannel, Role, Unit};
use truecut_scenario::Scenario;
use truecut_scenario::effect::{Effect, EffectKind};

use super::Trial;
use crate::model::Model;

const RATE_HZ: f64 = 1000.0;

/// A mass on a slide that is pushed by measured forces and has no transmission.
fn pushed() -> (Scenario, Measured) {
    let text = r#"
name = "pushed"
[robot]
urdf = "../../assets/robots/emps/robot.urdf"
gravity = false
drive = "force"
[process.replay]
mode = "forward"
[data]
time = "t"
[[data.channel]]
column = "f"
channel = "joint1.drive_force"
unit = "N"
role = "input"
[[data.channel]]
column = "q"
channel = "joint1.position"
unit = "m"
"#;
    let at = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios/replay/of_a_test.toml");
    let scenario = Scenario::from_str(&at, text, &[]).unwrap_or_else(|e| panic!("{e:?}"));
    let channel = |name: &str, unit, role, size: f64| MeasuredChannel {
        spec: ChannelSpec::new(name, unit, ""),
        role,
        values: (0..400)
            .map(|k| size * (12.0 * f64::from(k) / RATE_HZ).sin())
            .collect(),
        valid: vec![true; 400],
        noise: None,
        white_kept: 1.0,
    };
    let measured = Measured {
        source: "made".into(),
        time_s: (0..400).map(|k| f64::from(k) / RATE_HZ).collect(),
        channels: vec![
            channel("joint1.drive_force", Unit::Newton, Role::Input, 40.0),
            channel("joint1.position", Unit::Metre, Role::Output, 0.003),
        ],
        ..Measured::default()
    };
    (scenario, measured)
}

#[test]
fn no_candidate_is_refused_by_the_simulator() {
    let (scenario, measured) = pushed();
    let trial = Trial::new(&scenario, &measured).unwrap_or_else(|e| panic!("{e}"));
    let candidates = trial.candidates();
    let has = |kind| candidates.iter().any(|one| one.kind == kind);
    assert!(has(EffectKind::JointCoulomb) && has(EffectKind::SensorGain));
    for candidate in &candidates {
        let mut effect = Effect::neutral(candidate.kind, candidate.target.clone());
        for (value, scale) in effect.values.iter_mut().zip(&candidate.scale) {
            *value += scale;
        }
        let name = effect.to_string();
        if let Err(error) = trial.predict(&[], &[effect]) {
            assert!(error.0.contains("not fast enough"), "{name}: {error}");
        }
    }
}
