//! Which measured channel drives what: names, units, gaps, limits.

use crate::error::SimError;
use truecut_arm::{JointKind, Robot};
use truecut_recording::{Measured, MeasuredChannel, Unit, nearest, significant};
use truecut_scenario::Scenario;

/// What a measured channel may be of a joint.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum JointQuantity {
    /// Link coordinate.
    Coordinate,
    /// Commanded coordinate.
    Command,
    /// Torque or force of the drive.
    Drive,
}

impl JointQuantity {
    /// The second part of the channel's name.
    pub(crate) fn name(self, kind: JointKind) -> &'static str {
        match (self, kind) {
            (Self::Coordinate, JointKind::Revolute) => "angle",
            (Self::Coordinate, JointKind::Prismatic) => "position",
            (Self::Command, _) => "command",
            (Self::Drive, JointKind::Revolute) => "drive_torque",
            (Self::Drive, JointKind::Prismatic) => "drive_force",
        }
    }

    fn unit(self, kind: JointKind) -> Unit {
        match (self, kind) {
            (Self::Coordinate | Self::Command, JointKind::Revolute) => Unit::Radian,
            (Self::Coordinate | Self::Command, JointKind::Prismatic) => Unit::Metre,
            (Self::Drive, JointKind::Revolute) => Unit::NewtonMetre,
            (Self::Drive, JointKind::Prismatic) => Unit::Newton,
        }
    }
}

/// Name of a joint's channel; `joint` counts from 0.
pub(crate) fn joint_channel(robot: &Robot, joint: usize, quantity: JointQuantity) -> String {
    let kind = robot.chain.joints[joint].kind;
    format!("joint{}.{}", joint + 1, quantity.name(kind))
}

/// Measured data of a scenario, with the places of its faults.
#[derive(Clone, Copy)]
pub(crate) struct Source<'a> {
    pub scenario: &'a Scenario,
    pub measured: &'a Measured,
}

impl<'a> Source<'a> {
    /// An error about a measured channel, at its table in the scenario.
    pub(crate) fn error(&self, channel: &str, message: impl Into<String>) -> SimError {
        let mapped = self.scenario.data.as_ref().and_then(|data| {
            let mut channels = data.mapping.channels.iter();
            channels.position(|one| one.channel == channel)
        });
        let key = mapped.map_or_else(
            || "data".to_owned(),
            |index| format!("data.channel.{index}.channel"),
        );
        SimError::scenario(key, message)
    }

    /// The channel of a joint, if it was measured, in the unit that the joint has.
    ///
    /// # Errors
    /// Another unit.
    pub(crate) fn joint(
        &self,
        robot: &Robot,
        joint: usize,
        quantity: JointQuantity,
    ) -> Result<Option<&'a MeasuredChannel>, SimError> {
        let name = joint_channel(robot, joint, quantity);
        let Ok(channel) = self.measured.channel(&name) else {
            return Ok(None);
        };
        let kind = robot.chain.joints[joint].kind;
        self.expect_unit(channel, quantity.unit(kind))?;
        Ok(Some(channel))
    }

    /// Refuses a channel in a unit of another dimension.
    pub(crate) fn expect_unit(
        &self,
        channel: &MeasuredChannel,
        unit: Unit,
    ) -> Result<(), SimError> {
        if channel.spec.unit == unit {
            return Ok(());
        }
        let accepted: Vec<&str> = unit.accepted_symbols().collect();
        let message = format!(
            "channel {} is given in {}, but its unit must be one of {}",
            channel.spec.name,
            channel.spec.unit,
            accepted.join(", ")
        );
        Err(self.error(&channel.spec.name, message))
    }

    /// The values of an input, which must be there at every time.
    pub(crate) fn complete(&self, channel: &'a MeasuredChannel) -> Result<&'a [f64], SimError> {
        let Some(gap) = channel.first_gap() else {
            return Ok(&channel.values);
        };
        let at = |index: usize| self.measured.time_s.get(index).copied().unwrap_or(f64::NAN);
        let message = format!(
            "channel {} drives the model, but has no measurement from {:.3} s to {:.3} s ({} samples): \
             an input must be complete; raise data.max_gap_s or use a part of the file",
            channel.spec.name,
            at(gap.start),
            at(gap.end - 1),
            gap.len()
        );
        Err(self.error(&channel.spec.name, message))
    }

    /// Refuses inputs that nothing takes.
    pub(crate) fn refuse_others(&self, taken: &[String]) -> Result<(), SimError> {
        for channel in self.measured.inputs() {
            let name = &channel.spec.name;
            if taken.contains(name) {
                continue;
            }
            let meant = nearest(name, taken.iter().map(String::as_str))
                .map_or_else(String::new, |near| format!("; did you mean \"{near}\"?"));
            let message = format!(
                "channel \"{name}\" has role \"input\", but this replay takes only {}{meant}",
                taken.join(", ")
            );
            return Err(self.error(name, message));
        }
        Ok(())
    }

    /// Refuses coordinates beyond the joint's limits, which are mostly coordinates in another unit,
    /// and such as move far faster than it can, which are mostly times in another unit.
    pub(crate) fn within_limits(
        &self,
        robot: &Robot,
        joint: usize,
        channel: &MeasuredChannel,
    ) -> Result<(), SimError> {
        self.within(robot, joint, channel, 0.0)
    }

    /// [`Source::within_limits`] of a motion that an arm has made: its file may give a limit short
    /// of the machine's own, but not by a tenth of the range.
    pub(crate) fn made_within_limits(
        &self,
        robot: &Robot,
        joint: usize,
        channel: &MeasuredChannel,
    ) -> Result<(), SimError> {
        self.within(robot, joint, channel, MOST_BEYOND)
    }

    fn within(
        &self,
        robot: &Robot,
        joint: usize,
        channel: &MeasuredChannel,
        part_beyond: f64,
    ) -> Result<(), SimError> {
        let joint = &robot.chain.joints[joint];
        let Some(limits) = joint.limits else {
            return Ok(());
        };
        let beyond = part_beyond * (limits.upper - limits.lower);
        let outside =
            |value: &&f64| **value < limits.lower - beyond || **value > limits.upper + beyond;
        let Some(value) = channel.values.iter().find(outside) else {
            let speed = fast(&channel.values) / self.measured.interval_s();
            let may_be = MOST_OVER_SPEED * limits.velocity;
            if limits.velocity <= 0.0 || speed <= may_be {
                return Ok(());
            }
            let unit = channel.spec.unit;
            let message = format!(
                "channel {} moves by {} {unit}/s, but joint `{}` by {} {unit}/s at most: is `data.time_unit` right, \
                 and the column's unit?",
                channel.spec.name,
                significant(speed, 4),
                joint.name,
                significant(limits.velocity, 4)
            );
            return Err(self.error(&channel.spec.name, message));
        };
        let unit = channel.spec.unit;
        let message = format!(
            "channel {} reaches {value:.4} {unit}, but joint `{}` ends at {:.4} and {:.4} {unit}: is the \
             column's unit right?",
            channel.spec.name, joint.name, limits.lower, limits.upper
        );
        Err(self.error(&channel.spec.name, message))
    }
}

/// Part of its range by which a joint may have moved beyond the limits in its file.
const MOST_BEYOND: f64 = 0.1;
/// A command faster than so many times the joint's limit is no command of that joint.
const MOST_OVER_SPEED: f64 = 20.0;
/// Part of the steps between samples that may be larger: spikes, a jump.
const JUMPS: f64 = 0.01;

/// A large step between samples, without the few largest.
fn fast(values: &[f64]) -> f64 {
    let mut steps: Vec<f64> = values
        .windows(2)
        .map(|pair| (pair[1] - pair[0]).abs())
        .collect();
    if steps.is_empty() {
        return 0.0;
    }
    let rank = ((1.0 - JUMPS) * (steps.len() - 1) as f64) as usize;
    *steps.select_nth_unstable_by(rank, f64::total_cmp).1
}
