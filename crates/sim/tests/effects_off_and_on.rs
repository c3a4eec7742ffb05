//! Every kind of effect: at its neutral size it is the nominal run to the last bit, at another size
//! it shows.

use crate::support::{self, ARM_POSTURE, belt, brush, chamfer, load, polish, run, wheel};
use std::path::Path;
use truecut_recording::Recording;
use truecut_scenario::Scenario;
use truecut_scenario::effect::{Effect, EffectKind, Family, Model, Target, TargetKind};

fn target(kind: EffectKind) -> Target {
    match kind.target() {
        TargetKind::Whole => Target::Whole,
        TargetKind::Joint => Target::Joint(1),
        TargetKind::Axis => Target::Axis(1),
        TargetKind::Channel => Target::Channel("tool.velocity_y".into()),
    }
}

/// Scenarios in which effects of the kind have something to act on that is recorded.
fn stages(kind: EffectKind) -> Vec<Scenario> {
    match kind.family() {
        Family::Wheel => match kind {
            EffectKind::WheelStiffness
            | EffectKind::WheelEccentricity
            | EffectKind::WheelFriction => vec![wheel(), polish(), short_belt(), short_brush()],
            EffectKind::WheelRemoval => vec![polish(), short_belt(), short_brush()],
            EffectKind::WheelEdgeGrains => vec![polish_near_an_edge()],
            _ => vec![polish()],
        },
        _ => vec![stage(kind)],
    }
}

/// Down onto the face, and some of the first line.
fn short_belt() -> Scenario {
    belt(&[("run.duration_s".to_owned(), "0.9".to_owned())])
}

/// Onto the edge and along some of it.
fn short_brush() -> Scenario {
    brush(
        "../brush/over_edge.csv",
        &[("run.duration_s".to_owned(), "0.9".to_owned())],
    )
}

/// A slot by the arm. A tool mode asks for a finer step.
fn milling() -> Scenario {
    let overrides = [("run.duration_s", "0.1"), ("run.time_step_ms", "0.04")];
    from_file("scenarios/milling/own_surface.toml", &overrides)
}

/// A wheel that runs inward over the edge beside its line.
fn polish_near_an_edge() -> Scenario {
    let overrides = [("run.duration_s", "0.4")];
    from_file(
        "tests/hidden_effects/scenarios/polish_edge.toml",
        &overrides,
    )
}

fn from_file(file: &str, overrides: &[(&str, &str)]) -> Scenario {
    let file = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../..")
        .join(file);
    let text = std::fs::read_to_string(&file).expect("in the repository");
    let overrides: Vec<_> = (overrides.iter())
        .map(|(key, value)| ((*key).to_owned(), (*value).to_owned()))
        .collect();
    Scenario::from_str(&file, &text, &overrides).unwrap_or_else(|e| panic!("{e}"))
}

fn stage(kind: EffectKind) -> Scenario {
    match kind.family() {
        Family::Cutting => chamfer(2, 0.3),
        Family::Milling => milling(),
        // Two edges push the tool to no side, and the foot would not slide.
        Family::Foot => chamfer(1, 0.3),
        Family::Wheel => polish(),
        Family::Joint if kind == EffectKind::JointRotor => load(
            "irb6600_175_255",
            &format!("{ARM_POSTURE}\ndrive = \"servo\""),
            "duration_s = 0.1",
            "release_n = [600.0, 600.0, -500.0]",
        ),
        Family::Joint
        | Family::Curve
        | Family::Robot
        | Family::Base
        | Family::Clock
        | Family::Sensor => load(
            "irb6600_175_255",
            ARM_POSTURE,
            "duration_s = 0.1",
            "release_n = [600.0, 600.0, -500.0]",
        ),
    }
}

/// A size that a person might find.
fn size(kind: EffectKind) -> Vec<f64> {
    use EffectKind as K;
    match kind {
        K::JointStiffness | K::CuttingCoefficient | K::FootFriction => vec![1.1],
        K::WheelStiffness | K::WheelFriction | K::WheelRemoval => vec![1.1],
        K::WheelForceOffset | K::WheelForceStiction => vec![0.4],
        K::WheelEdgeGrains => vec![0.1],
        K::JointDamping | K::SensorGain => vec![1.5],
        K::JointViscous => vec![300.0],
        K::JointCoulomb => vec![50.0],
        K::JointLoadFriction => vec![0.2],
        K::JointAsymmetricViscous => vec![300.0, 100.0],
        K::JointAsymmetricCoulomb => vec![50.0, 20.0],
        K::JointStribeck => vec![40.0, 0.01],
        K::JointBacklash => vec![1e-4],
        K::JointHysteresis => vec![100.0, 1e-4],
        K::JointCubicStiffness => vec![1e11],
        K::JointRipple => vec![2e-5, -1e-5, 80.0],
        K::JointCounterbalance => vec![800.0, -300.0],
        K::JointOffset => vec![60.0],
        K::JointZero => vec![0.01],
        K::LinkMass => vec![1.2],
        K::LinkCenter => vec![0.03, -0.02, 0.05],
        K::LinkLength => vec![0.01, -0.02, 0.015],
        K::JointRotor => vec![0.4],
        K::ClockRate => vec![1.01],
        K::JointPositionCurve => vec![-3.0, 3.0, 60.0, -40.0, 80.0],
        K::JointFrictionByPosition => vec![-3.0, 3.0, 30.0, 50.0, 20.0],
        K::JointFrictionBySpeed => vec![0.0, 0.1, 30.0, 20.0, 60.0],
        K::Payload => vec![12.0, 0.0, 0.05, 0.1],
        K::BaseCompliance => vec![1e-7],
        K::BaseTilt => vec![0.01],
        K::CuttingEdgeForce => vec![4e3, 5e3, 6e3],
        K::CuttingRunout => vec![5e-6, 3e-6],
        K::CuttingHoleOffset => vec![2e-5, -1e-5],
        K::CuttingWornTooth => vec![1e-5],
        K::CuttingWear => vec![0.05],
        K::CuttingDepthOffset => vec![3e-5],
        K::SpindleSpeed => vec![0.98],
        K::MillingProcessDamping => vec![2e5],
        K::ToolMode => vec![5e-8, 600.0, 0.02],
        K::FootFrictionFalling => vec![0.4, 1e-3],
        K::FootPressureLoss => vec![0.3],
        K::FootSealStiction => vec![97.0],
        K::WheelEccentricity => vec![1e-5, -2e-5],
        K::SensorDelay | K::ClockDelay => vec![0.0031],
        K::SensorOffset => vec![0.002],
        K::SensorDrift => vec![0.01, 0.05],
        K::SensorLowPass => vec![0.004],
    }
}

/// Channels whose values are not the same bits, by name.
fn differences(one: &Recording, other: &Recording) -> Vec<String> {
    assert_eq!(one.header.channels.len(), other.header.channels.len());
    assert_eq!(one.time_s, other.time_s);
    let columns = one.columns.iter().zip(&other.columns);
    (one.header.channels.iter().zip(columns))
        .filter(|(_, (a, b))| a.iter().zip(*b).any(|(a, b)| a.to_bits() != b.to_bits()))
        .map(|(channel, _)| channel.name.clone())
        .collect()
}

fn all_stages() -> Vec<(EffectKind, Scenario)> {
    // What plays no part in a plant has no run: `replay/`.
    (EffectKind::ALL
        .iter()
        .filter(|kind| kind.acts_in(Model::Driven)))
    .flat_map(|kind| stages(*kind).into_iter().map(|scenario| (*kind, scenario)))
    .collect()
}

#[test]
fn a_neutral_effect_changes_no_bit() {
    for (kind, scenario) in all_stages() {
        let kind = &kind;
        // What only shapes may have any value.
        let mut effect = Effect::neutral(*kind, target(*kind));
        for (info, value) in kind.parameters().iter().zip(&mut effect.values) {
            if !info.is_size {
                *value = 0.5 * (info.neutral + info.max.min(info.neutral + 1.0));
            }
        }
        let nominal = run(&scenario, &[]);
        let with = run(&scenario, &[effect]);
        let differing = differences(&nominal, &with);
        assert!(differing.is_empty(), "{}: {differing:?}", kind.name());
        let bits = |r: &Recording| -> Vec<u64> {
            r.scalars
                .iter()
                .map(|scalar| scalar.value.to_bits())
                .collect()
        };
        assert_eq!(bits(&nominal), bits(&with), "{}", kind.name());
    }
}

#[test]
fn every_effect_shows_and_only_where_it_acts() {
    for (kind, scenario) in all_stages() {
        let kind = &kind;
        let nominal = run(&scenario, &[]);
        let effect = Effect {
            values: size(*kind),
            ..Effect::neutral(*kind, target(*kind))
        };
        let with = run(&scenario, &[effect]);
        for (channel, column) in with.header.channels.iter().zip(&with.columns) {
            assert!(
                column.iter().all(|v| v.is_finite()),
                "{}: {}",
                kind.name(),
                channel.name
            );
        }
        // A tilting base has channels of its own, a stiffer transmission another step; both show.
        if with.header.channels.len() != nominal.header.channels.len()
            || with.time_s != nominal.time_s
        {
            continue;
        }
        let differing = differences(&nominal, &with);
        assert!(!differing.is_empty(), "{}", kind.name());
        if kind.family() == Family::Clock {
            let told: Vec<&String> = (differing.iter())
                .filter(|name| name.ends_with(".command"))
                .collect();
            assert!(told.is_empty(), "{told:?}");
            let moving = nominal.columns.iter().zip(&nominal.header.channels);
            let moving = moving.filter(|(column, _)| column.iter().any(|v| *v != column[0]));
            for (_, spec) in moving.filter(|(_, spec)| !spec.name.ends_with(".command")) {
                assert!(differing.contains(&spec.name), "{}", spec.name);
            }
        }
        if kind.family() == Family::Sensor {
            assert_eq!(differing, ["tool.velocity_y"], "{}", kind.name());
        }
    }
}

/// A text with the entries is the same run as the effects in memory.
#[test]
fn an_extended_text_is_the_same_run() {
    let scenario = stage(EffectKind::JointCoulomb);
    let effects: Vec<Effect> = [
        EffectKind::JointCoulomb,
        EffectKind::JointRipple,
        EffectKind::Payload,
    ]
    .map(|kind| Effect {
        values: size(kind),
        ..Effect::neutral(kind, target(kind))
    })
    .into();
    let in_memory = run(&scenario, &effects);
    let again = support::scenario(&in_memory.header.scenario_text);
    assert_eq!(again.effects, effects);
    assert!(differences(&in_memory, &run(&again, &[])).is_empty());
}
