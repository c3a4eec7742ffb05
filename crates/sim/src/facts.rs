//! What a diagnosis must know of a robot to look for effects of a sensible size.

use crate::build::load_robot;
use crate::error::SimError;
use truecut_arm::JointKind;
use truecut_scenario::Scenario;

/// A joint of the chain.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct JointFacts {
    /// Rotary, or else prismatic.
    pub rotary: bool,
    /// Transmission stiffness, N m/rad or N/m; `None` if the transmission is rigid.
    pub stiffness: Option<f64>,
}

/// The robot of a scenario, in numbers; the default is none at all.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct RobotFacts {
    /// The joints, in chain order.
    pub joints: Vec<JointFacts>,
    /// Mass of all links that move, kg.
    pub moving_mass_kg: f64,
}

/// Reads the robot of a scenario.
///
/// # Errors
/// Whatever is wrong with the robot's files.
pub fn robot_facts(scenario: &Scenario) -> Result<RobotFacts, SimError> {
    let robot = load_robot(&scenario.robot)?;
    let joints = (robot.chain.joints.iter())
        .map(|joint| JointFacts {
            rotary: joint.kind == JointKind::Revolute,
            stiffness: joint.transmission.stiffness,
        })
        .collect();
    Ok(RobotFacts {
        joints,
        moving_mass_kg: robot.chain.links.iter().map(|link| link.mass_kg).sum(),
    })
}
