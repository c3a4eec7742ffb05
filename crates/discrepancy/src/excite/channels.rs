//! Channels of a planned motion: what moves, and what will be measured.

use truecut_recording::{ChannelSpec, MeasuredChannel, Role, Unit, measured::ChannelMapping};
use truecut_scenario::{DriveKind, ProcessSpec, ReplayMode, Scenario};
use truecut_sim::SimError;

/// The mode of a scenario that replays motions of joints.
pub(super) fn mode(scenario: &Scenario) -> Result<ReplayMode, SimError> {
    let ProcessSpec::Replay(replay) = &scenario.process else {
        let key = format!("process.{}", scenario.process.name());
        let message = format!(
            "`{key}` must be [process.replay], with mode \"inverse\" or \"forward\": a motion of the joints is planned"
        );
        return Err(SimError::scenario(key, message));
    };
    match replay.mode {
        ReplayMode::Observe => Err(SimError::scenario(
            "process.replay.mode",
            "`process.replay.mode` is \"observe\", in which nothing moves: a motion is planned for \"inverse\" and \"forward\"",
        )),
        ReplayMode::Forward if scenario.robot.drive == DriveKind::Force => Err(SimError::scenario(
            "robot.drive",
            "`robot.drive` is \"force\", in which forces are given and no motion: a motion is planned for drives that follow one",
        )),
        mode => Ok(mode),
    }
}

/// What moves: all joints where their motion is measured, those commanded where it is commanded.
pub(super) fn inputs(
    mapped: &[ChannelMapping],
    rotary: &[bool],
    is_inverse: bool,
) -> Vec<(usize, ChannelSpec)> {
    let spec = |joint: usize| {
        let (measured, unit) = match rotary[joint] {
            true => ("angle", Unit::Radian),
            false => ("position", Unit::Metre),
        };
        let quantity = if is_inverse { measured } else { "command" };
        let name = format!("joint{}.{quantity}", joint + 1);
        ChannelSpec::new(name, unit, "Planned motion")
    };
    let drives = |spec: &ChannelSpec| {
        let mut mapped = mapped.iter().filter(|one| one.role == Role::Input);
        is_inverse || mapped.any(|one| one.channel == spec.name)
    };
    (0..rotary.len())
        .map(|joint| (joint, spec(joint)))
        .filter(|(_, spec)| drives(spec))
        .collect()
}

/// An output of which nothing is measured yet.
pub(super) fn output(mapping: &ChannelMapping) -> MeasuredChannel {
    MeasuredChannel {
        spec: ChannelSpec::new(
            mapping.channel.clone(),
            mapping.unit.unit,
            "Measured output",
        ),
        role: Role::Output,
        values: Vec::new(),
        valid: Vec::new(),
        noise: mapping.noise,
        white_kept: 1.0,
    }
}
