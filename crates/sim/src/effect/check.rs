//! Whether an effect applies to a scenario.

use crate::error::SimError;
use crate::plant::DriveKind;
use truecut_arm::{JointKind, Robot};
use truecut_scenario::effect::{Effect, EffectKind, Family, Target};
use truecut_scenario::{FootSpec, FrictionSpec, ProcessSpec, Scenario};

/// Checks `scenario.effects[index]`.
pub(super) fn applies(
    scenario: &Scenario,
    index: usize,
    robot: &Robot,
    drive: DriveKind,
) -> Result<(), SimError> {
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
        if drive == DriveKind::Force && in_transmission(effect.kind) {
            let message = format!(
                "{effect} acts in the transmission, but drive = \"force\" leaves the joints without one"
            );
            return refuse("kind", message);
        }
    }
    if effect.kind == EffectKind::SensorDelay && effect.values[0] < 0.0 {
        let message = format!(
            "the delay is {} s, but a run knows no future: it must be at least 0",
            effect.values[0]
        );
        return refuse("delay_s", message);
    }
    match misfit(effect, &scenario.process) {
        Some(message) => refuse("kind", message),
        None => Ok(()),
    }
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

fn in_transmission(kind: EffectKind) -> bool {
    matches!(
        kind,
        EffectKind::JointStiffness
            | EffectKind::JointDamping
            | EffectKind::JointBacklash
            | EffectKind::JointHysteresis
            | EffectKind::JointCubicStiffness
            | EffectKind::JointRipple
            | EffectKind::JointLoadFriction
    )
}

fn foot_of(process: &ProcessSpec) -> Option<&FootSpec> {
    match process {
        ProcessSpec::Chamfer(spec) => spec.foot.as_ref(),
        ProcessSpec::Load(spec) => spec.foot.as_ref(),
        ProcessSpec::Wheel(_)
        | ProcessSpec::Milling(_)
        | ProcessSpec::Polish(_)
        | ProcessSpec::Belt(_)
        | ProcessSpec::Brush(_)
        | ProcessSpec::Replay(_) => None,
    }
}

/// Why the effect has nothing to act on in the process.
fn misfit(effect: &Effect, process: &ProcessSpec) -> Option<String> {
    let name = match process {
        ProcessSpec::Chamfer(_) => "process.chamfer",
        ProcessSpec::Load(_) => "process.load",
        ProcessSpec::Wheel(_) => "process.wheel",
        ProcessSpec::Milling(_) => "process.milling",
        ProcessSpec::Polish(_) => "process.polish",
        ProcessSpec::Belt(_) => "process.belt",
        ProcessSpec::Brush(_) => "process.brush",
        ProcessSpec::Replay(_) => "process.replay",
    };
    match effect.kind.family() {
        Family::Cutting if !matches!(process, ProcessSpec::Chamfer(_)) => Some(format!(
            "{effect} does not apply to {name}: it acts on a chamfering edge"
        )),
        Family::Wheel => wheel_misfit(effect, process)
            .map(|why| format!("{effect} does not apply to {name}: {why}")),
        Family::Foot => {
            let Some(foot) = foot_of(process) else {
                return Some(format!(
                    "{effect} does not apply to {name} without a pressure foot"
                ));
            };
            friction_misfit(effect, &foot.friction)
                .map(|why| format!("{effect} does not apply: {why}"))
        }
        _ => None,
    }
}

fn wheel_misfit(effect: &Effect, process: &ProcessSpec) -> Option<&'static str> {
    let of_control = matches!(
        effect.kind,
        EffectKind::WheelForceOffset | EffectKind::WheelForceStiction
    );
    let uncontrolled = match process {
        ProcessSpec::Polish(spec) => spec.control.force_n().is_none(),
        ProcessSpec::Belt(spec) => spec.control.force_n().is_none(),
        _ => false,
    };
    match process {
        ProcessSpec::Wheel(_) | ProcessSpec::Brush(_) if of_control => {
            Some("it acts on a force control, which process.polish and process.belt can have")
        }
        _ if of_control && uncontrolled => {
            Some("it acts on a force control, but law = \"position\" has none")
        }
        ProcessSpec::Wheel(_)
        | ProcessSpec::Polish(_)
        | ProcessSpec::Belt(_)
        | ProcessSpec::Brush(_) => None,
        _ => Some(
            "it acts on the wheel of process.wheel, process.polish, process.belt or process.brush",
        ),
    }
}

fn friction_misfit(effect: &Effect, law: &FrictionSpec) -> Option<&'static str> {
    match (effect.kind, law) {
        (EffectKind::FootFriction | EffectKind::FootFrictionFalling, FrictionSpec::None) => {
            Some("the foot has no friction (law = \"none\")")
        }
        (EffectKind::FootFrictionFalling, FrictionSpec::EquivalentViscous { .. }) => {
            Some("the equivalent viscous law has no speed; use \"coulomb\" or \"stribeck\"")
        }
        _ => None,
    }
}
