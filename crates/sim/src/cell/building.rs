//! How a cell is built: from a scenario, with either plant.

use super::Cell;
use super::deflection::PathDeflection;
use crate::build::{Prepared, plant_scalars};
use crate::channels;
use crate::contact::ContactSolver;
use crate::engine::{Engine, StepsPerPeriod};
use crate::error::SimError;
use crate::guard::Guard;
use crate::loads::Attachment;
use crate::plant::{Plant, RapierPlant, ReducedPlant};
use crate::posture::joint_limits;
use crate::robots::Robots;
use crate::run::Extent;
use crate::scene::Setting;
use crate::spring_use::SpringUse;
use crate::torque_use::{TorqueUse, servo_note, unchecked_note};
use std::sync::Arc;
use truecut_arm::JointKind;
use truecut_core::sensor::{ChannelModel, Sensor};
use truecut_recording::{ChannelSpec, Measured, Role, UnknownName, significant};
use truecut_scenario::effect::Target;
use truecut_scenario::{FaultRule, Scenario};

/// Largest recording, bytes.
const LARGEST_RECORDING_BYTES: f64 = 2e9;

impl Cell {
    /// Loads the robot, finds the posture at touch-down, chooses the step and builds the world.
    /// `measured` drives a replay.
    ///
    /// # Errors
    /// Whatever is wrong with the robot's files, or with a value of the scenario for this robot; a
    /// replay without data, or with data that does not fit.
    pub(crate) fn build(
        scenario: &Scenario,
        measured: Option<&Measured>,
        robots: &Robots,
        engine: Engine,
    ) -> Result<Self, SimError> {
        let prepared = Prepared::new(scenario, measured, robots, engine)?;
        let hasty_clock = measured
            .filter(|_| scenario.process.facts().replays)
            .and_then(|measured| hasty_clock(measured, prepared.dt_s));
        let (plant, note) = match engine {
            Engine::Rapier => rapier(&prepared),
            Engine::Reduced {
                steps_per_period, ..
            } => reduced(&prepared, steps_per_period)?,
        };
        let mut cell = Self::assemble(scenario, prepared, plant, note)?;
        cell.notes.extend(hasty_clock.clone());
        cell.hasty_clock = hasty_clock;
        cell.check_memory(scenario)?;
        Ok(cell)
    }

    fn assemble(
        scenario: &Scenario,
        prepared: Prepared,
        plant: Box<dyn Plant>,
        step_note: String,
    ) -> Result<Self, SimError> {
        let mut channels = channels::specs(&prepared.robot, prepared.base_joints);
        let deflection = prepared.is_path.then(|| {
            PathDeflection::new(
                prepared.robot.clone(),
                prepared.start.clone(),
                prepared.first_command(),
                prepared.surface_normal,
            )
        });
        channels.extend(deflection.iter().flat_map(|_| PathDeflection::specs()));
        channels.extend(prepared.process.channels());
        let position = |attachment| {
            let frame: truecut_arm::FrameId = attachment;
            let pose = prepared.robot.world_from_frame(&prepared.start, frame);
            pose.translation.vector
        };
        let steps = (prepared.duration_s / prepared.dt_s - 1e-9).ceil() as usize;
        let interval = scenario.run.record_interval_s.unwrap_or(0.0);
        let steps_per_row = ((interval / prepared.dt_s).round() as usize).max(1);
        let recorded = steps_per_row as f64 * prepared.dt_s;
        let mut notes = prepared.notes.clone();
        notes.extend(servo_note(&prepared));
        notes.extend(unchecked_note(&prepared));
        // An arm without modes tells why where they are needed.
        let modes = prepared.robot.modes(&prepared.start, None);
        notes.extend(modes.ok().and_then(|modes| modes.overdamped_note()));
        notes.push(step_note);
        if interval > 0.0 && (recorded / interval - 1.0).abs() > 1e-6 {
            notes.push(format!(
                "a row every {:.6} ms: the {} ms asked for are no whole number of steps",
                recorded * 1e3,
                interval * 1e3
            ));
        }
        let sensors = sensors(scenario, &prepared, &channels)?;
        Ok(Self {
            scenario: scenario.clone(),
            rotary: (prepared.robot.chain.joints[prepared.base_joints..].iter())
                .map(|joint| joint.kind == JointKind::Revolute)
                .collect(),
            channels,
            notes,
            tool_start_m: position(Attachment::Tool.into()),
            foot_start_m: position(Attachment::Foot.into()),
            first_command: prepared.first_command(),
            contacts: ContactSolver::new(prepared.friction.clone()),
            guard: Guard::new(joint_limits(&prepared.robot)),
            axes: *prepared
                .world_from_process
                .rotation
                .to_rotation_matrix()
                .matrix(),
            steps_per_row,
            steps_per_balance: steps_per_row,
            steps,
            energy_j: (0.0, 0.0),
            torque_use: TorqueUse::new(&prepared),
            spring_use: SpringUse::new(&prepared),
            hasty_clock: None,
            placeholders: (prepared.robot.chain.placeholders.clone())
                .filter(|_| scenario.run.placeholders == FaultRule::Fail),
            deflection,
            asked: None,
            scalars: plant_scalars(&prepared),
            process: prepared.process,
            command: prepared.command,
            base_joints: prepared.base_joints,
            sensors,
            setting: Arc::new(Setting {
                robot: prepared.robot,
                start: prepared.start,
                world_from_process: prepared.world_from_process,
                workpiece: prepared.workpiece,
                tooling: prepared.tooling,
                part: prepared.part,
                deflection_scale: scenario.run.deflection_scale,
            }),
            plant,
        })
    }

    /// What the run comes to if it reaches its end.
    pub fn extent(&self) -> Extent {
        Extent {
            steps: self.steps,
            rows: self.steps / self.steps_per_row + 1,
            channels: self.channels.len(),
            kept: self.channels.len(),
        }
    }

    /// A recording of hours at full rate is a slip more often than it is wanted.
    fn check_memory(&self, scenario: &Scenario) -> Result<(), SimError> {
        let extent = self.extent();
        let (rows, channels) = (extent.rows, extent.channels);
        let bytes = extent.bytes() as f64;
        if bytes <= LARGEST_RECORDING_BYTES {
            return Ok(());
        }
        let keys = [
            "run.record_interval_ms",
            "run.time_step_ms",
            "run.duration_s",
        ];
        let key = keys.into_iter().find(|key| scenario.gives(key));
        let unit = if scenario.process.facts().replays {
            ", or, if the data's times are milliseconds, say so, data.time_unit = \"ms\" (now seconds are read)"
        } else {
            ""
        };
        Err(SimError::scenario(
            key.unwrap_or("process"),
            format!(
                "the recording would have {rows} rows of {channels} channels, {:.1} GB, but must be at most \
                 {:.0} GB; raise run.record_interval_ms (a row is now written every \
                 {:.4} ms){unit}",
                bytes / 1e9,
                LARGEST_RECORDING_BYTES / 1e9,
                self.row_interval_s() * 1e3
            ),
        ))
    }
}

/// The arm as a multibody, and a note on its step.
fn rapier(prepared: &Prepared) -> (Box<dyn Plant>, String) {
    let plant = RapierPlant::new(
        &prepared.robot,
        &prepared.start,
        &prepared.first_command(),
        prepared.drive(),
        prepared.gravity_m_s2,
        prepared.dt_s,
    )
    .moving(&prepared.start_velocity());
    let note = format!(
        "time step {:.6} ms, leapfrog, no numerical damping",
        prepared.dt_s * 1e3
    );
    (Box::new(plant), note)
}

/// The arm linearised about its start, and a note on its step.
fn reduced(
    prepared: &Prepared,
    steps_per_period: StepsPerPeriod,
) -> Result<(Box<dyn Plant>, String), SimError> {
    let plant = ReducedPlant::new(
        prepared.robot.clone(),
        &prepared.start,
        &prepared.first_command(),
        (prepared.kind, prepared.drive()),
        prepared.gravity_m_s2,
        prepared.dt_s,
        prepared.command.moves(),
    )
    .ok_or_else(|| {
        SimError::scenario(
            "robot.urdf",
            "the mass matrix of the arm at its start is singular",
        )
    })?
    .moving(&prepared.start_velocity())
    .swinging(prepared.process.is_given());
    let note = plant.note(steps_per_period);
    Ok((Box::new(plant), note))
}

/// The column of every channel that is not recorded as it is.
fn sensors(
    scenario: &Scenario,
    prepared: &Prepared,
    channels: &[ChannelSpec],
) -> Result<Vec<(usize, Sensor)>, SimError> {
    // Neutral ones too must name a channel.
    for (index, effect) in scenario.effects.iter().enumerate() {
        let Target::Channel(channel) = &effect.target else {
            continue;
        };
        if channels.iter().all(|spec| spec.name != *channel) {
            let known = channels.iter().map(|spec| spec.name.as_str());
            let error = UnknownName::new("channel", channel, known);
            let key = format!("effect.{index}.channel");
            return Err(SimError::scenario(key, error.to_string()));
        }
    }
    let models = channels.iter().map(|spec| match is_input(scenario, spec) {
        true => prepared.sensors.own(&spec.name),
        false => prepared.sensors.of(&spec.name),
    });
    let changed = models.enumerate();
    Ok(changed
        .filter(|(_, model)| *model != ChannelModel::default())
        .map(|(column, model)| (column, Sensor::new(model)))
        .collect())
}

/// Whether a channel drives the run: it is what its column of the data says, whenever that comes.
fn is_input(scenario: &Scenario, spec: &ChannelSpec) -> bool {
    let mapped = scenario.data.iter().flat_map(|data| &data.mapping.channels);
    let mut inputs = mapped.filter(|one| one.role == Role::Input);
    inputs.any(|input| input.channel == spec.name)
}

/// That inputs change faster than the plant steps, as times do that are read in too small a unit.
fn hasty_clock(measured: &Measured, time_step_s: f64) -> Option<String> {
    let interval_s = measured.interval_s();
    // Differences of times are rounded: an interval of one step is none that is too short.
    (interval_s < time_step_s * (1.0 - 1e-6)).then(|| {
        format!(
            "the data have a sample every {} s, {} of them to a time step of {} s: is the unit of their times \
             right (data.time_unit; seconds without it), or their rate (data.rate_hz)?",
            significant(interval_s, 3),
            significant(time_step_s / interval_s, 3),
            significant(time_step_s, 3)
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Times as a file has them that begins somewhere: whole steps, rounded to its decimals.
    #[test]
    fn a_sample_to_a_step_is_no_hasty_clock() {
        for (begins, step_s) in [(1.0, 1e-3), (7.3, 2e-3), (1234.5, 1e-3), (0.1, 5e-4)] {
            for rows in [2, 11, 1000] {
                let stamps = (0..rows).map(|row| begins + f64::from(row) * step_s);
                let time_s = stamps.map(|stamp| (stamp * 1e4).round() / 1e4 - begins);
                let mut measured = Measured {
                    time_s: time_s.collect(),
                    ..Measured::default()
                };
                let told = hasty_clock(&measured, step_s);
                assert_eq!(told, None, "{begins} s, {step_s} s, {rows} rows");
                measured
                    .time_s
                    .iter_mut()
                    .for_each(|time_s| *time_s *= 1e-3);
                assert!(hasty_clock(&measured, step_s).is_some());
            }
        }
    }
}
