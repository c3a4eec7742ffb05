//! Channels of the plant: joints, tool, energy.

use crate::plant::JointState;
use crate::process::ToolState;
use nalgebra::Vector3;
use truecut_arm::{Joint, JointKind, Robot};
use truecut_recording::{ChannelSpec, Unit};

const KINETIC: &str = "energy.kinetic";
const POTENTIAL: &str = "energy.potential";

/// Whether a channel of that name is an energy of the arm.
pub(crate) fn is_energy(name: &str) -> bool {
    [KINETIC, POTENTIAL].contains(&name)
}

/// Channels of the robot, in the order of [`record`]. The first `base_joints` are tilts of the
/// base; the joints of the arm are counted from 1 behind them.
pub(crate) fn specs(robot: &Robot, base_joints: usize) -> Vec<ChannelSpec> {
    let mut specs = Vec::new();
    let mut vector = |quantity: &str, unit, text: &str, axes: [&str; 3]| {
        specs.extend(["x", "y", "z"].iter().zip(axes).map(|(axis, called)| {
            let text = format!("{text} {called}");
            ChannelSpec::new(format!("tool.{quantity}_{axis}"), unit, text)
        }));
    };
    let displaced = "Displacement of the tool since touch-down, process";
    let axes = ["X (tool axis)", "Y (horizontal)", "Z"];
    vector("displacement", Unit::Metre, displaced, axes);
    let speed = "Velocity of the tool, process";
    vector("velocity", Unit::MetrePerSecond, speed, ["X", "Y", "Z"]);
    let place = "Position of the tool, world";
    vector("position", Unit::Metre, place, ["x", "y", "z"]);
    let (base, arm) = robot.chain.joints.split_at(base_joints);
    for joint in base {
        let largest = joint.axis.iamax();
        specs.extend(base_specs(["x", "y", "z"][largest]));
    }
    for (i, joint) in arm.iter().enumerate() {
        specs.extend(joint_specs(i + 1, joint));
    }
    specs.push(ChannelSpec::new(
        KINETIC,
        Unit::Joule,
        "Kinetic energy of the arm",
    ));
    specs.push(ChannelSpec::new(
        POTENTIAL,
        Unit::Joule,
        "Energy in gravity and transmissions",
    ));
    specs
}

fn base_specs(axis: &str) -> [ChannelSpec; 3] {
    let spec = |quantity: &str, unit, text: &str| {
        ChannelSpec::new(
            format!("base.{quantity}_{axis}"),
            unit,
            format!("{text}, world {axis}"),
        )
    };
    [
        spec("tilt", Unit::Radian, "Tilt of the base"),
        spec(
            "tilt_rate",
            Unit::RadianPerSecond,
            "Rate of the tilt of the base",
        ),
        spec(
            "moment",
            Unit::NewtonMetre,
            "Moment of the ground on the base",
        ),
    ]
}

/// Channel of a joint's link coordinate; `number` counts from 1.
pub(crate) fn position_name(number: usize, kind: JointKind) -> String {
    match kind {
        JointKind::Revolute => format!("joint{number}.angle"),
        JointKind::Prismatic => format!("joint{number}.position"),
    }
}

fn joint_specs(number: usize, joint: &Joint) -> [ChannelSpec; 5] {
    let (name, kind) = (&joint.name, joint.kind);
    let (position, velocity, effort, torque) = match kind {
        JointKind::Revolute => (
            Unit::Radian,
            Unit::RadianPerSecond,
            Unit::NewtonMetre,
            "transmission_torque",
        ),
        JointKind::Prismatic => (
            Unit::Metre,
            Unit::MetrePerSecond,
            Unit::Newton,
            "transmission_force",
        ),
    };
    let spec = |quantity: &str, unit, text: &str| {
        ChannelSpec::new(
            format!("joint{number}.{quantity}"),
            unit,
            format!("{text}, joint `{name}`"),
        )
    };
    let coordinate = ChannelSpec::new(
        position_name(number, kind),
        position,
        format!("Link coordinate, joint `{name}`"),
    );
    [
        coordinate,
        spec("velocity", velocity, "Link velocity"),
        spec("command", position, "Commanded coordinate"),
        spec(torque, effort, "What the transmission exerts on the link"),
        drive_spec(number, joint),
    ]
}

/// Channel of what a joint's drive exerts; `number` counts from 1.
pub(crate) fn drive_spec(number: usize, joint: &Joint) -> ChannelSpec {
    let (quantity, unit) = match joint.kind {
        JointKind::Revolute => ("drive_torque", Unit::NewtonMetre),
        JointKind::Prismatic => ("drive_force", Unit::Newton),
    };
    ChannelSpec::new(
        format!("joint{number}.{quantity}"),
        unit,
        format!("What the drive exerts, joint `{}`", joint.name),
    )
}

/// Appends the robot's values of one instant.
pub(crate) fn record(
    row: &mut Vec<f64>,
    state: &ToolState,
    tool_position_m: &Vector3<f64>,
    joints: &JointState,
    base_joints: usize,
    energy_j: (f64, f64),
) {
    row.extend(state.tool.displacement_m.iter());
    row.extend(state.tool.velocity_m_per_s.iter());
    row.extend(tool_position_m.iter());
    for i in 0..joints.position.len() {
        row.extend([joints.position[i], joints.velocity[i]]);
        row.extend((i >= base_joints).then_some(joints.command[i]));
        row.push(joints.transmission[i]);
        row.extend((i >= base_joints).then_some(joints.drive[i]));
    }
    row.extend([energy_j.0, energy_j.1]);
}
