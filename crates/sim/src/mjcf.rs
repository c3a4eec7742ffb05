//! The cell's plant as a MuJoCo model.

use crate::build::Prepared;
use crate::effect::{Effects, JointEffects};
use crate::engine::Engine;
use crate::error::SimError;
use crate::robots::Robots;
use truecut_arm::{MjcfDrive, MjcfOptions};
use truecut_scenario::DriveKind;
use truecut_scenario::Scenario;
use truecut_scenario::effect::Effect;

/// MJCF of the scenario's arm at the posture of touch-down, driven as the scenario says. The
/// process is not part of it: it is applied from outside, as it is here.
///
/// # Errors
/// What a run would refuse about the robot; a servo drive, which MJCF joints cannot hold.
pub fn export_mjcf(scenario: &Scenario) -> Result<String, SimError> {
    // Laws of joints and process are ours; the MJCF holds what is built into the robot.
    let robots = Robots::new();
    let prepared = Prepared::new(scenario, None, &robots, Engine::Rapier)?;
    let nominal = robots.robot(&scenario.robot)?;
    let is_law = |effect: &Effect| {
        let sum = Effects::sum([effect], &nominal.chain.joints);
        !sum.joints.iter().all(JointEffects::is_built_in)
    };
    if let Some(index) = scenario.effects.iter().position(is_law) {
        return Err(SimError::scenario(
            format!("effect.{index}.kind"),
            format!(
                "{} cannot be exported: MJCF joints know no such law",
                scenario.effects[index]
            ),
        ));
    }
    if prepared.coupled_damping.is_some() {
        return Err(SimError::scenario(
            "robot.damping_ratio",
            "`robot.damping_ratio` cannot be exported: joints of MJCF have no damping between them; leave it out",
        ));
    }
    let drive = match prepared.kind {
        DriveKind::Position => MjcfDrive::Position,
        DriveKind::Force => MjcfDrive::Free,
        DriveKind::Servo => {
            return Err(SimError::scenario(
                "robot.drive",
                "a servo drive cannot be exported: its motor coordinates are not joints of the MJCF; \
                 use \"position\" or \"force\"",
            ));
        }
    };
    Ok(prepared.robot.to_mjcf(&MjcfOptions {
        posture: prepared.start.clone(),
        command: prepared.first_command(),
        gravity_m_s2: prepared.gravity_m_s2,
        drive,
        time_step_s: prepared.dt_s,
    })?)
}
