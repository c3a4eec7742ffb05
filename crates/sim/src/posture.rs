//! Postures that a scenario gives, and the limits of the joints.

use crate::command::JointCommand;
use crate::error::SimError;
use std::path::Path;
use truecut_arm::{JointKind, Robot};
use truecut_scenario::RobotSpec;

/// Joint coordinates in chain order from the lists of rotary and prismatic ones.
pub(crate) fn posture(spec: &RobotSpec, robot: &Robot) -> Result<Vec<f64>, SimError> {
    let mut rotary = spec.posture_rad.iter();
    let mut prismatic = spec.posture_m.iter();
    let joints = &robot.chain.joints;
    for (key, kind, given) in [
        (
            "robot.posture_deg",
            JointKind::Revolute,
            spec.posture_rad.len(),
        ),
        (
            "robot.posture_mm",
            JointKind::Prismatic,
            spec.posture_m.len(),
        ),
    ] {
        let needed = joints.iter().filter(|j| j.kind == kind).count();
        if given != 0 && given != needed {
            let what = match kind {
                JointKind::Revolute => "rotary",
                JointKind::Prismatic => "prismatic",
            };
            return Err(SimError::scenario(
                key,
                format!("`{key}` has {given} values, but the chain has {needed} {what} joints"),
            ));
        }
    }
    let posture: Vec<f64> = joints
        .iter()
        .map(|joint| match joint.kind {
            JointKind::Revolute => rotary.next().copied().unwrap_or(0.0),
            JointKind::Prismatic => prismatic.next().copied().unwrap_or(0.0),
        })
        .collect();
    check_posture(robot, &posture, "posture outside the limits")?;
    Ok(posture)
}

/// A fault of a posture that a path job gives stands in the job.
pub(crate) fn of_job(error: SimError, job: &Path) -> SimError {
    match error {
        SimError::Scenario { message, .. } => SimError::scenario(
            "process.belt.job",
            format!("`process.belt.job`: {}: {message}", job.display()),
        ),
        other => other,
    }
}

fn check_posture(robot: &Robot, posture: &[f64], what: &str) -> Result<(), SimError> {
    for (i, (joint, q)) in robot.chain.joints.iter().zip(posture).enumerate() {
        let Some(limits) = joint.limits else { continue };
        if *q < limits.lower || *q > limits.upper {
            let (key, factor, unit) = match joint.kind {
                JointKind::Revolute => ("robot.posture_deg", 180.0 / std::f64::consts::PI, "deg"),
                JointKind::Prismatic => ("robot.posture_mm", 1e3, "mm"),
            };
            return Err(SimError::scenario(
                key,
                format!(
                    "{what}: joint {} `{}` at {:.3} {unit}, limits {:.3} to {:.3} {unit}",
                    i + 1,
                    joint.name,
                    q * factor,
                    limits.lower * factor,
                    limits.upper * factor
                ),
            ));
        }
    }
    Ok(())
}

/// Refuses a command that leaves the limits anywhere.
pub(crate) fn check_limits(robot: &Robot, command: &JointCommand) -> Result<(), SimError> {
    (command.postures().iter())
        .try_for_each(|posture| check_posture(robot, posture, "the command leaves the limits"))
}

/// Name, lower and upper limit and unit of every joint.
pub(crate) fn joint_limits(robot: &Robot) -> Vec<(String, f64, f64, &'static str)> {
    (robot.chain.joints.iter())
        .map(|joint| {
            let unit = match joint.kind {
                JointKind::Revolute => "rad",
                JointKind::Prismatic => "m",
            };
            let (lower, upper) = joint
                .limits
                .map_or((f64::NEG_INFINITY, f64::INFINITY), |l| (l.lower, l.upper));
            (joint.name.clone(), lower, upper, unit)
        })
        .collect()
}
