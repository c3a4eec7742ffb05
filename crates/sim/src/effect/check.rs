//! Whether an effect applies to a scenario.

use super::robot::rotor_with;
use crate::error::SimError;
use truecut_arm::{JointKind, Robot};
use truecut_core::friction::{FootFriction, FrictionLaw};
use truecut_scenario::effect::{
    BaseEffect, ClockEffect, Effect, EffectKind, FootEffect, JointEffect, Model, SensorEffect,
    Target, Typed, WheelEffect,
};
use truecut_scenario::{DriveKind, Parts, ProcessSpec, ReplayMode, Scenario, WheelHold};

/// Checks `scenario.effects[index]`.
pub(super) fn applies(scenario: &Scenario, index: usize, robot: &Robot) -> Result<(), SimError> {
    let effect = &scenario.effects[index];
    let refuse = |key: &str, message: String| {
        Err(SimError::scenario(format!("effect.{index}.{key}"), message))
    };
    if let Target::Joint(joint) = effect.target {
        if joint >= robot.dof() {
            return refuse("joint", no_such_joint(robot, joint));
        }
        if let Some(message) = wrong_keys(scenario, index, robot, joint) {
            return refuse("kind", message);
        }
    }
    if effect.kind.is_curve() && effect.values[0] >= effect.values[1] {
        let (from, to) = (effect.values[0], effect.values[1]);
        let message = format!(
            "the curve ends at {to}, but must end beyond its first knot at {from}: nothing lies between"
        );
        let rotary = robot_is_rotary(robot, effect);
        let info = &effect.kind.parameters()[1];
        return refuse(if rotary { info.rotary_key } else { info.key }, message);
    }
    if let Some(
        Typed::Sensor(_, SensorEffect::Delay { delay_s })
        | Typed::Clock(ClockEffect::Delay { delay_s }),
    ) = effect.typed()
        && delay_s < 0.0
    {
        let message =
            format!("the delay is {delay_s} s, but a run knows no future: it must be at least 0");
        return refuse("delay_s", message);
    }
    if let Some(Typed::Joint(joint, JointEffect::Rotor { inertia })) = effect.typed()
        && let Err(message) = rotor_with(&robot.chain.joints[joint], inertia)
    {
        let info = &effect.kind.parameters()[0];
        let rotary = robot_is_rotary(robot, effect);
        return refuse(if rotary { info.rotary_key } else { info.key }, message);
    }
    match misfit(scenario, effect) {
        Some(message) => refuse("kind", message),
        None => Ok(()),
    }
}

fn robot_is_rotary(robot: &Robot, effect: &Effect) -> bool {
    match effect.target {
        Target::Joint(joint) => robot.chain.joints[joint].kind == JointKind::Revolute,
        Target::Whole | Target::Axis(_) | Target::Channel(_) => false,
    }
}

/// Why the effect, at any size, has nothing to act on in the model that the scenario is about;
/// `None` if it has. What this refuses, neither a run takes nor a search proposes.
pub fn misfit(scenario: &Scenario, effect: &Effect) -> Option<String> {
    let model = model(scenario);
    if !effect.kind.acts_in(model) {
        return Some(no_part(effect, model));
    }
    let (name, parts) = (scenario.process.name(), scenario.process.facts().parts);
    let why = match effect.typed()? {
        Typed::Joint(_, JointEffect::Rotor { .. }) => {
            (model == Model::Driven && scenario.robot.drive != DriveKind::Servo).then_some(
                "a drive that follows its command exactly turns no rotor; drive = \"servo\" does",
            )
        }
        Typed::Joint(..)
        | Typed::Curve(..)
        | Typed::Robot(_)
        | Typed::Base(_, BaseEffect::Compliance { .. }) => None,
        Typed::Base(axis, BaseEffect::Tilt { .. }) => tilt_misfit(scenario, axis),
        Typed::Clock(_) | Typed::Sensor(..) => None,
        Typed::Cutting(_) if model == Model::Steady => {
            return (!turns(&scenario.process)).then(|| no_part(effect, model));
        }
        Typed::Cutting(_) => cutting_misfit(&parts),
        Typed::Milling(_) => (!matches!(scenario.process, ProcessSpec::Milling(_)))
            .then_some("it acts on the end mill of process.milling"),
        Typed::Foot(foot) => return foot_misfit(effect, foot, name, &parts),
        Typed::Wheel(wheel) => wheel_misfit(wheel, &parts),
    };
    why.map(|why| format!("{effect} does not apply to process.{name}: {why}"))
}

/// The model that predicts what the scenario is about.
fn model(scenario: &Scenario) -> Model {
    if let ProcessSpec::Replay(replay) = &scenario.process {
        match replay.mode {
            ReplayMode::Inverse { .. } => return Model::Inverse,
            ReplayMode::Observe => return Model::Steady,
            ReplayMode::Forward => {}
        }
    }
    match scenario.robot.drive {
        DriveKind::Position | DriveKind::Servo => Model::Driven,
        DriveKind::Force => Model::Free,
    }
}

/// That effects of the kind do nothing in the model.
fn no_part(effect: &Effect, model: Model) -> String {
    let name = effect.kind.name();
    match model {
        Model::Driven => format!("\"{name}\" plays no part in a plant"),
        Model::Free => format!(
            "{effect} acts in the transmission, but drive = \"force\" leaves the joints without one"
        ),
        Model::Inverse => {
            let known: Vec<&str> = (EffectKind::ALL.iter())
                .filter(|kind| kind.acts_in(model))
                .map(|kind| kind.name())
                .collect();
            let known = known.join(", ");
            format!("\"{name}\" plays no part in inverse dynamics; {known} do")
        }
        Model::Steady => format!(
            "\"{name}\" plays no part where nothing is simulated; sensor_drift does, and with \
             spindle_rpm and depth_mm in [process.replay] cutting_runout"
        ),
    }
}

fn turns(process: &ProcessSpec) -> bool {
    matches!(process, ProcessSpec::Replay(replay) if replay.turning.is_some())
}

fn no_such_joint(robot: &Robot, joint: usize) -> String {
    format!(
        "joint {} does not exist: the chain of {} has {}, counted from 1",
        joint + 1,
        robot.name,
        robot.dof()
    )
}

fn wrong_keys(scenario: &Scenario, index: usize, robot: &Robot, joint: usize) -> Option<String> {
    let is_rotary = robot.chain.joints[joint].kind == JointKind::Revolute;
    if scenario.effect_is_rotary(index)? == is_rotary {
        return None;
    }
    let effect = &scenario.effects[index];
    let info = (effect.kind.parameters().iter()).find(|info| info.key != info.rotary_key)?;
    let (wrong, right, kind) = if is_rotary {
        (info.key, info.rotary_key, "rotary")
    } else {
        (info.rotary_key, info.key, "prismatic")
    };
    Some(format!(
        "joint {} `{}` is {kind}: {} takes `{right}` there, not `{wrong}`",
        joint + 1,
        robot.chain.joints[joint].name,
        effect.kind.name()
    ))
}

/// World axis along which gravity points.
const VERTICAL: usize = 2;

fn tilt_misfit(scenario: &Scenario, axis: usize) -> Option<&'static str> {
    if !scenario.robot.gravity {
        return Some("without gravity (robot.gravity = false) no direction is level");
    }
    (axis == VERTICAL).then_some(
        "gravity points along z, about which a turned base stands as level as before; x and y tilt it",
    )
}

fn cutting_misfit(parts: &Parts) -> Option<&'static str> {
    parts
        .edges
        .is_none()
        .then_some("it acts on a chamfering edge")
}

fn wheel_misfit(effect: WheelEffect, parts: &Parts) -> Option<&'static str> {
    let Some(wheel) = parts.wheel else {
        return Some(
            "it acts on the wheel of process.wheel, process.polish, process.belt or process.brush",
        );
    };
    match effect {
        WheelEffect::EdgeGrains { .. } => (!wheel.over_edges).then_some(
            "it acts on edges that the wheel runs over, which process.polish has where the \
                 inset of its path is less than the wheel's reach",
        ),
        WheelEffect::ForceOffset { .. } | WheelEffect::ForceStiction { .. } => match wheel.hold {
            WheelHold::Force(_) => None,
            WheelHold::Position => {
                Some("it acts on a force control, but law = \"position\" has none")
            }
            WheelHold::Path => {
                Some("it acts on a force control, which process.polish and process.belt can have")
            }
        },
        WheelEffect::Stiffness { .. }
        | WheelEffect::Eccentricity { .. }
        | WheelEffect::Friction { .. }
        | WheelEffect::Removal { .. } => None,
    }
}

fn foot_misfit(effect: &Effect, foot: FootEffect, name: &str, parts: &Parts) -> Option<String> {
    let Some(spec) = &parts.foot else {
        return Some(format!(
            "{effect} does not apply to process.{name} without a pressure foot"
        ));
    };
    let why = match (foot, &spec.friction) {
        (
            FootEffect::Friction { .. } | FootEffect::FrictionFalling { .. },
            FootFriction::Law(FrictionLaw::None),
        ) => "the foot has no friction (law = \"none\")",
        (FootEffect::FrictionFalling { .. }, FootFriction::Equivalent(_)) => {
            "the equivalent viscous law has no speed; use \"coulomb\" or \"stribeck\""
        }
        (
            FootEffect::Friction { .. }
            | FootEffect::FrictionFalling { .. }
            | FootEffect::PressureLoss { .. }
            | FootEffect::SealStiction { .. },
            _,
        ) => return None,
    };
    Some(format!("{effect} does not apply: {why}"))
}
