//! Commands and forces in, motion out: the measured inputs of a forward run.

use super::beginning::{Beginning, beginning};
use super::inputs::{JointQuantity, Source, joint_channel};
use crate::command::{JointCommand, Samples};
use crate::error::SimError;
use crate::process::{ForceSamples, Replay};
use truecut_arm::{JointKind, Robot};
use truecut_recording::{Measured, Role, Unit};
use truecut_scenario::{DriveKind, ReplayMode, ReplaySpec, RobotSpec, Scenario};

/// Names of the measured tool forces, in process axes.
const TOOL_FORCES: [&str; 3] = ["tool.force_x", "tool.force_y", "tool.force_z"];

/// Data begin within this of the posture that a scenario gives, degrees or mm.
const POSTURE_ROUNDING: f64 = 1.0;

/// Measured inputs, checked against the robot.
pub(crate) struct ForwardInputs {
    /// Name of the data.
    source: String,
    interval_s: f64,
    duration_s: f64,
    /// Measured commands `[joint][sample]`.
    commands: Vec<Option<Vec<f64>>>,
    /// Measured drive forces `[joint][sample]`.
    drive_forces: Vec<Option<Vec<f64>>>,
    tool_forces: [Option<Vec<f64>>; 3],
    /// Where each joint was measured to begin.
    measured_start: Vec<Option<Beginning>>,
    /// Whether the scenario says where each joint is.
    written: Vec<bool>,
    /// Whether joints are on springs, and whether the controller makes up for their sag.
    driven: bool,
    against_sag: bool,
}

impl ForwardInputs {
    /// The inputs of a scenario's replay.
    ///
    /// # Errors
    /// A mode without plant; no data; an input that does not fit the drive, is incomplete, in a
    /// wrong unit or beyond the joint's limits; a run that is longer than its data.
    pub fn of(
        replay: &ReplaySpec,
        scenario: &Scenario,
        measured: Option<&Measured>,
        robot: &Robot,
        kind: DriveKind,
    ) -> Result<ForwardInputs, SimError> {
        if replay.mode != ReplayMode::Forward {
            let message = "has no plant to run; only mode \"forward\" has one";
            return Err(SimError::scenario("process.replay.mode", message));
        }
        let Some(measured) = measured else {
            let message =
                "a replay needs its measured data: name the file in data.file, or when it is run";
            return Err(SimError::scenario("process.replay", message));
        };
        let source = Source { scenario, measured };
        let quantity = match kind {
            DriveKind::Position | DriveKind::Servo => JointQuantity::Command,
            DriveKind::Force => JointQuantity::Drive,
        };
        let joints = 0..robot.dof();
        let mut taken: Vec<String> = (joints.clone())
            .map(|joint| joint_channel(robot, joint, quantity))
            .collect();
        taken.extend(TOOL_FORCES.map(str::to_owned));
        source.refuse_others(&taken)?;
        if measured.inputs().next().is_none() {
            let message = format!(
                "no column has role \"input\"; this replay takes {}",
                taken.join(", ")
            );
            return Err(SimError::scenario("data.channel", message));
        }
        let series = (joints.clone())
            .map(|joint| input(&source, robot, joint, quantity))
            .collect::<Result<Vec<_>, SimError>>()?;
        let none = vec![None; robot.dof()];
        let (commands, drive_forces) = match quantity {
            JointQuantity::Command => (series, none),
            JointQuantity::Coordinate | JointQuantity::Drive => (none, series),
        };
        let scaled = |series: Option<Vec<f64>>| {
            series.map(|values| about_first(values, replay.amplitude_factor))
        };
        Ok(ForwardInputs {
            source: measured.source.clone(),
            interval_s: measured.interval_s() / replay.speed_factor,
            duration_s: duration_s(scenario, measured, replay.speed_factor)?,
            commands: commands.into_iter().map(scaled).collect(),
            drive_forces: drive_forces.into_iter().map(scaled).collect(),
            tool_forces: tool_forces(&source)?.map(scaled),
            measured_start: joints
                .map(|joint| measured_start(&source, robot, joint))
                .collect::<Result<_, _>>()?,
            written: (robot.chain.joints.iter())
                .map(|joint| match joint.kind {
                    JointKind::Revolute => !scenario.robot.posture_rad.is_empty(),
                    JointKind::Prismatic => !scenario.robot.posture_m.is_empty(),
                })
                .collect(),
            driven: kind != DriveKind::Force,
            against_sag: scenario.robot.hold_against_sag,
        })
    }

    /// How long the run takes, s.
    pub fn duration_s(&self) -> f64 {
        self.duration_s
    }

    /// The posture of the start: the first commands; of a joint that nothing commands, what the
    /// scenario says; where it says nothing, where it was measured to begin.
    pub fn posture(&self, given: &[f64]) -> Vec<f64> {
        (given.iter().enumerate())
            .map(|(joint, given)| match self.written[joint] {
                true => self.first_command(joint).unwrap_or(*given),
                false => self.begun(joint).unwrap_or(*given),
            })
            .collect()
    }

    fn first_command(&self, joint: usize) -> Option<f64> {
        self.commands[joint].as_ref().map(|samples| samples[0])
    }

    /// Where commands and measurements begin.
    fn begun(&self, joint: usize) -> Option<f64> {
        self.first_command(joint)
            .or(self.measured_start[joint].map(|start| start.at))
    }

    /// Joints that begin where they were measured, with the spread of that.
    pub fn found(&self) -> Vec<(usize, f64)> {
        let found = |joint: usize| {
            let start = self.measured_start[joint]?;
            let is_found = self.commands[joint].is_none() && !self.written[joint];
            is_found.then_some((joint, start.spread))
        };
        (0..self.commands.len()).filter_map(found).collect()
    }

    /// Joints on springs that nothing commands, of which is known where they are: the motors stand
    /// where they hold them there. (What is measured is the link, which sags from its motor.)
    pub fn held(&self) -> Vec<usize> {
        let known = |joint: &usize| match self.written[*joint] {
            true => self.against_sag,
            false => self.measured_start[*joint].is_some(),
        };
        (0..self.commands.len())
            .filter(|joint| self.driven && self.commands[*joint].is_none() && known(joint))
            .collect()
    }

    /// Refuses data that begin in another posture than the scenario gives: one of them is not what
    /// the other is about.
    ///
    /// # Errors
    /// A joint that begins further from `given` than a posture is rounded.
    pub fn check_posture(
        &self,
        spec: &RobotSpec,
        robot: &Robot,
        given: &[f64],
    ) -> Result<(), SimError> {
        for (index, joint) in robot.chain.joints.iter().enumerate() {
            let (key, written, unit, per_si) = match joint.kind {
                JointKind::Revolute => ("posture_deg", &spec.posture_rad, "°", 1f64.to_degrees()),
                JointKind::Prismatic => ("posture_mm", &spec.posture_m, " mm", 1e3),
            };
            let begun = self.begun(index).unwrap_or(given[index]);
            let (begun, given) = (begun * per_si, given[index] * per_si);
            if written.is_empty() || (begun - given).abs() <= POSTURE_ROUNDING {
                continue;
            }
            let message = format!(
                "{}: joint {} `{}` begins at {begun:.4}{unit}, but `robot.{key}` has {given:.4}{unit}: they must agree \
                 within {POSTURE_ROUNDING}{unit}; check the unit of the column, or write the posture of the data (or none)",
                self.source,
                index + 1,
                joint.name,
            );
            return Err(SimError::scenario(format!("robot.{key}"), message));
        }
        Ok(())
    }

    /// What the controller and the drives do; joints without a measured command stay at `posture`.
    pub fn command(&self, posture: &[f64]) -> JointCommand {
        let length = self
            .commands
            .iter()
            .flatten()
            .map(Vec::len)
            .next()
            .unwrap_or(1);
        let at = |joint: usize, k: usize| match &self.commands[joint] {
            Some(samples) => samples[k],
            None => posture[joint],
        };
        let sample = |k| (0..posture.len()).map(|joint| at(joint, k)).collect();
        let forces = (self.drive_forces.iter()).map(|values| self.series(values));
        JointCommand::Replay(Samples::new(
            self.interval_s,
            (0..length).map(sample).collect(),
            forces.collect(),
        ))
    }

    /// The forces on the tool.
    pub fn process(&self) -> Replay {
        Replay::new(
            self.tool_forces
                .each_ref()
                .map(|values| self.series(values)),
        )
    }

    fn series(&self, values: &Option<Vec<f64>>) -> Option<ForceSamples> {
        values.clone().map(|values| ForceSamples {
            interval_s: self.interval_s,
            values,
        })
    }
}

/// Values with their distance from the first one times `factor`.
fn about_first(mut values: Vec<f64>, factor: f64) -> Vec<f64> {
    // The nominal run must not differ by a rounding.
    if factor != 1.0
        && let Some(first) = values.first().copied()
    {
        for value in &mut values {
            *value = first + factor * (*value - first);
        }
    }
    values
}

fn duration_s(scenario: &Scenario, measured: &Measured, speed: f64) -> Result<f64, SimError> {
    let (asked, available) = (scenario.run.duration_s, measured.duration_s() / speed);
    if asked.is_finite() && asked > available * (1.0 + 1e-9) {
        let message = format!("is {asked} s, but the data takes {available:.4} s");
        return Err(SimError::scenario("run.duration_s", message));
    }
    Ok(asked.min(available))
}

fn input(
    source: &Source<'_>,
    robot: &Robot,
    joint: usize,
    quantity: JointQuantity,
) -> Result<Option<Vec<f64>>, SimError> {
    let channel = source.joint(robot, joint, quantity)?;
    let Some(channel) = channel.filter(|channel| channel.role == Role::Input) else {
        return Ok(None);
    };
    if quantity == JointQuantity::Command {
        source.within_limits(robot, joint, channel)?;
    }
    Ok(Some(source.complete(channel)?.to_vec()))
}

fn tool_forces(source: &Source<'_>) -> Result<[Option<Vec<f64>>; 3], SimError> {
    let mut forces = [None, None, None];
    for (slot, name) in forces.iter_mut().zip(TOOL_FORCES) {
        let found = source
            .measured
            .inputs()
            .find(|channel| channel.spec.name == name);
        if let Some(channel) = found {
            source.expect_unit(channel, Unit::Newton)?;
            *slot = Some(source.complete(channel)?.to_vec());
        }
    }
    Ok(forces)
}

fn measured_start(
    source: &Source<'_>,
    robot: &Robot,
    joint: usize,
) -> Result<Option<Beginning>, SimError> {
    let Some(channel) = source.joint(robot, joint, JointQuantity::Coordinate)? else {
        return Ok(None);
    };
    source.within_limits(robot, joint, channel)?;
    Ok(beginning(&channel.values, &channel.valid))
}
