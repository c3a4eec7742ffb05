//! `truecut robot`: a robot as read from its files.

use truecut_arm::{JointKind, Robot, report::fk_table};

use crate::args::RobotArguments;
use crate::exit_status::ExitStatus;
use crate::failure::Failure;
use crate::text;

/// Prints the report, as text or JSON, or a table of flange poses.
pub fn describe(arguments: &RobotArguments) -> Result<ExitStatus, Failure> {
    let robot = Robot::load(&arguments.urdf, None, arguments.tip.as_deref())
        .map_err(|error| Failure::arm(&error))?;
    if let Some(file) = &arguments.fk {
        let text = std::fs::read_to_string(file).map_err(|error| Failure::at(file, error))?;
        let table = fk_table(&robot, &text).map_err(|error| Failure::at(file, error))?;
        return crate::print(&table);
    }
    let posture = match &arguments.posture_deg {
        Some(written) => posture(&robot, written)?,
        None => robot.default_posture(),
    };
    let report = robot
        .report(&posture)
        .map_err(|error| Failure::arm(&error))?;
    if arguments.json {
        return crate::print(&text::json(&report)?);
    }
    crate::print(&report.to_text())
}

/// Degrees to radians for rotary joints, millimetres to metres for prismatic ones.
fn posture(robot: &Robot, written: &[f64]) -> Result<Vec<f64>, Failure> {
    let joints = &robot.chain.joints;
    if written.len() != joints.len() {
        return Err(Failure::message(format!(
            "--posture-deg has {} values, but the chain has {} joints",
            written.len(),
            joints.len()
        )));
    }
    let si = |(joint, value): (&truecut_arm::Joint, &f64)| match joint.kind {
        JointKind::Revolute => value.to_radians(),
        JointKind::Prismatic => value / 1e3,
    };
    Ok(joints.iter().zip(written).map(si).collect())
}
