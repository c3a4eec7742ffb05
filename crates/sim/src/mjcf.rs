//! The cell's plant as a MuJoCo model.

use crate::build::Prepared;
use crate::error::SimError;
use crate::plant::DriveKind;
use truecut_arm::{MjcfDrive, MjcfOptions};
use truecut_scenario::Scenario;
use truecut_scenario::effect::{Effect, EffectKind, Family};

/// MJCF of the scenario's arm at the posture of touch-down, driven as the scenario says. The process is not
/// part of it: it is applied from outside, as it is here.
///
/// # Errors
/// What [`crate::Cell::build`] would refuse about the robot; a servo drive, which MJCF joints cannot hold.
pub fn export_mjcf(scenario: &Scenario) -> Result<String, SimError> {
    // Laws of joints and process are ours; the MJCF holds what is built into the robot.
    let built_in = |effect: &Effect| {
        matches!(
            effect.kind,
            EffectKind::JointStiffness | EffectKind::JointDamping
        ) || effect.kind.family() != Family::Joint
    };
    if let Some(index) = (scenario.effects.iter()).position(|e| !e.is_neutral() && !built_in(e)) {
        return Err(SimError::scenario(
            format!("effect.{index}.kind"),
            format!(
                "{} cannot be exported: MJCF joints know no such law",
                scenario.effects[index]
            ),
        ));
    }
    let prepared = Prepared::new(scenario, None)?;
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
