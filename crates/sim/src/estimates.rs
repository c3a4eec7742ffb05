//! Which estimates of the arm a run rests on.

use crate::error::SimError;
use crate::robots::Robots;
use truecut_arm::{Robot, TransmissionValue};
use truecut_scenario::{DriveKind, ProcessSpec, ReplayMode, RobotSpec, Scenario};

/// A sentence on the masses and on the values of transmissions that act in runs of a scenario, or
/// in its inverse dynamics, and are estimates by the sources in `robot.toml`; `None` if none is.
///
/// # Errors
/// Whatever is wrong with the robot's files.
pub fn estimates(scenario: &Scenario, robots: &Robots) -> Result<Option<String>, SimError> {
    if !scenario.process.facts().needs_robot {
        return Ok(None);
    }
    let robot = robots.robot(&scenario.robot)?;
    Ok(match replay_mode(scenario) {
        // Springs and dampers pass on what moves the links, whatever they are.
        Some(ReplayMode::Inverse { .. }) => {
            use TransmissionValue::{DryFriction, RotorInertia};
            robot.estimates(&[DryFriction, RotorInertia])
        }
        Some(ReplayMode::Observe) => None,
        Some(ReplayMode::Forward) | None => acting(&scenario.robot, &robot),
    })
}

fn replay_mode(scenario: &Scenario) -> Option<ReplayMode> {
    match &scenario.process {
        ProcessSpec::Replay(replay) => Some(replay.mode),
        _ => None,
    }
}

/// The same of a robot that has been read.
pub(crate) fn acting(spec: &RobotSpec, robot: &Robot) -> Option<String> {
    use TransmissionValue::{Damping, DriveLimit, DryFriction, RotorInertia, Servo, Stiffness};
    let values: &[TransmissionValue] = match spec.drive {
        // A motor that follows its command exactly needs no rotor; its limit is watched.
        DriveKind::Position => &[Stiffness, Damping, DryFriction, DriveLimit],
        DriveKind::Servo => &[Stiffness, Damping, DryFriction, RotorInertia, Servo],
        DriveKind::Force => &[],
    };
    let is_given = |value: &TransmissionValue| {
        // Ratios that the scenario gives stand in place of the joints' damping.
        *value == Damping && !spec.damping_ratios.is_empty()
    };
    let acts = values.iter().filter(|value| !is_given(value)).copied();
    robot.estimates(&acts.collect::<Vec<_>>())
}
