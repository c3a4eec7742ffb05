//! A robot as its scenario has it: scales, links and drives that differ from the files, rigid
//! servos.

use nalgebra::Vector3;
use truecut_arm::Robot;
use truecut_recording::UnknownName;
use truecut_scenario::{DriveKind, RobotSpec};

use crate::error::SimError;

/// Whether the scenario takes the robot as the files have it.
pub(crate) fn leaves_as_is(spec: &RobotSpec) -> bool {
    let scales = (spec.inertia_scale, spec.stiffness_scale, spec.damping_scale);
    spec.drive != DriveKind::Servo
        && scales == (1.0, 1.0, 1.0)
        && spec.damping_ratios.is_empty()
        && spec.links.is_empty()
        && spec.joints.is_empty()
}

/// The robot of the files as the scenario has it.
///
/// # Errors
/// A link or joint that the chain does not have.
pub(crate) fn adjusted(robot: &Robot, spec: &RobotSpec) -> Result<Robot, SimError> {
    let mut robot = robot.scaled(spec.inertia_scale, spec.stiffness_scale, spec.damping_scale);
    for (index, own) in spec.links.iter().enumerate() {
        let known = robot.chain.links.iter().map(|link| link.name.as_str());
        let at = find("link", index, &own.name, known)?;
        let link = &mut robot.chain.links[at];
        link.mass_kg *= own.mass_factor;
        link.inertia_about_com_kg_m2 *= own.mass_factor;
        link.com_m += Vector3::from(own.center_m);
    }
    for (index, own) in spec.joints.iter().enumerate() {
        let known = robot.chain.joints.iter().map(|joint| joint.name.as_str());
        let at = find("joint", index, &own.name, known)?;
        let transmission = &mut robot.chain.joints[at].transmission;
        transmission.rotor_inertia *= own.rotor_inertia_factor;
        transmission.stiffness = (transmission.stiffness).map(|k| k * own.stiffness_factor);
        transmission.damping *= own.damping_factor;
    }
    if spec.drive == DriveKind::Servo {
        robot.close_rigid_servos();
    }
    let (count, modes) = (spec.damping_ratios.len(), robot.dof());
    if count > 1 && count != modes {
        return Err(SimError::scenario(
            "robot.damping_ratio",
            format!(
                "`robot.damping_ratio` has {count} values, but must have one, or one for each of the arm's {modes} modes"
            ),
        ));
    }
    robot.damping_ratios.clone_from(&spec.damping_ratios);
    Ok(robot)
}

fn find<'a>(
    what: &'static str,
    index: usize,
    name: &str,
    known: impl Iterator<Item = &'a str> + Clone,
) -> Result<usize, SimError> {
    let mut names = known.clone();
    names.position(|one| one == name).ok_or_else(|| {
        let error = UnknownName::new(what, name, known);
        SimError::scenario(format!("robot.{what}.{index}.name"), error.to_string())
    })
}
