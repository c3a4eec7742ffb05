//! The cell: one scenario, ready to run, and the step loop.

use crate::build::{Prepared, joint_limits, plant_scalars};
use crate::channels;
use crate::command::JointCommand;
use crate::contact::ContactSolver;
use crate::error::SimError;
use crate::guard::{Guard, Watch};
use crate::loads::{Attachment, Loads};
use crate::measurement::Sensor;
use crate::plant::{Command, Plant, RapierPlant, ReducedPlant, WorldWrench};
use crate::process::{FrameMotion, Process, ToolState};
use crate::robots::Robots;
use crate::scene::{Setting, Stage};
use crate::step_size::Scheme;
use crate::torque_use::{TorqueUse, servo_note};
use nalgebra::{Matrix3, Vector3, Vector6};
use truecut_arm::JointKind;
use truecut_recording::{ChannelSpec, Header, Measured, Outcome, Recorder, Scalar, UnknownName};
use truecut_scenario::Scenario;
use truecut_scenario::effect::Target;

/// Steps between two calls of the progress function.
const STEPS_PER_REPORT: usize = 500;

/// Largest recording, bytes.
const LARGEST_RECORDING_BYTES: f64 = 2e9;

/// One scenario, ready to run.
pub struct Cell {
    scenario: Scenario,
    channels: Vec<ChannelSpec>,
    notes: Vec<String>,
    plant: Box<dyn Plant>,
    process: Box<dyn Process>,
    contacts: ContactSolver,
    command: JointCommand,
    guard: Guard,
    setting: Setting,
    axes: Matrix3<f64>,
    tool_start_m: Vector3<f64>,
    foot_start_m: Vector3<f64>,
    first_command: Vec<f64>,
    base_joints: usize,
    /// Whether each joint of the arm is rotary.
    rotary: Vec<bool>,
    /// Columns that are not recorded as they are.
    sensors: Vec<(usize, Sensor)>,
    steps: usize,
    steps_per_row: usize,
    torque_use: TorqueUse,
    scalars: Vec<Scalar>,
}

/// What a run ended with; give it to [`Recorder::finish`].
pub struct RunEnd {
    pub scalars: Vec<Scalar>,
    pub profiles: Vec<truecut_recording::Profile>,
    pub outcome: Outcome,
}

impl Cell {
    /// Loads the robot, finds the posture at touch-down, chooses the step and builds the world.
    ///
    /// # Errors
    /// Whatever is wrong with the robot's files, or with a value of the scenario for this robot.
    pub fn build(scenario: &Scenario) -> Result<Self, SimError> {
        Self::build_with_data(scenario, None)
    }

    /// As [`Cell::build`], with the measured data that a replay is driven by. Other processes make no use of it.
    ///
    /// # Errors
    /// As [`Cell::build`]; a replay without data, or with data that does not fit.
    pub fn build_with_data(
        scenario: &Scenario,
        measured: Option<&Measured>,
    ) -> Result<Self, SimError> {
        let prepared = Prepared::new(scenario, measured)?;
        let plant = RapierPlant::new(
            &prepared.robot,
            &prepared.start,
            &prepared.first_command(),
            prepared.drive(),
            prepared.gravity_m_s2,
            prepared.dt_s,
        );
        let note = format!(
            "time step {:.6} ms, leapfrog, no numerical damping",
            prepared.dt_s * 1e3
        );
        let cell = Self::assemble(scenario, prepared, Box::new(plant), note)?;
        cell.check_memory(scenario)?;
        Ok(cell)
    }

    /// As [`Cell::build`], with the arm linearised about its start ([`ReducedPlant`]): many times as fast,
    /// with steps up to 1 ms.
    ///
    /// # Errors
    /// As [`Cell::build`].
    pub fn build_reduced(scenario: &Scenario) -> Result<Self, SimError> {
        Self::build_reduced_from(&Robots::new(), scenario)
    }

    /// As [`Cell::build_reduced`], with robots that may have been read before.
    ///
    /// # Errors
    /// As [`Cell::build`].
    pub fn build_reduced_from(robots: &Robots, scenario: &Scenario) -> Result<Self, SimError> {
        Self::build_reduced_with_data(robots, scenario, None)
    }

    /// As [`Cell::build_reduced_from`], with the measured data that a replay is driven by.
    ///
    /// # Errors
    /// As [`Cell::build_with_data`].
    pub fn build_reduced_with_data(
        robots: &Robots,
        scenario: &Scenario,
        measured: Option<&Measured>,
    ) -> Result<Self, SimError> {
        let prepared = Prepared::for_scheme(scenario, measured, robots, Scheme::Exact)?;
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
        })?;
        let note = plant.note();
        let cell = Self::assemble(scenario, prepared, Box::new(plant), note)?;
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
            guard: Guard::new(joint_limits(&prepared)),
            axes: *prepared
                .world_from_process
                .rotation
                .to_rotation_matrix()
                .matrix(),
            steps_per_row,
            steps,
            torque_use: TorqueUse::new(&prepared),
            scalars: plant_scalars(&prepared),
            process: prepared.process,
            command: prepared.command,
            base_joints: prepared.base_joints,
            sensors,
            setting: Setting {
                robot: prepared.robot,
                start: prepared.start,
                world_from_process: prepared.world_from_process,
                workpiece: prepared.workpiece,
                deflection_scale: scenario.run.deflection_scale,
            },
            plant,
        })
    }

    /// Channels, scene and notes: what a [`Recorder`] is opened with.
    pub fn header(&self) -> Header {
        Header {
            scenario_name: self.scenario.name.clone(),
            // With all its effects, also those that were added in memory.
            scenario_text: (self.scenario).extended_text(&self.scenario.effects, &self.rotary),
            channels: self.channels.clone(),
            scene: self.setting.stage(self.process.as_ref()).1,
            notes: self.notes.clone(),
        }
    }

    /// The channels alone, in the order of the rows.
    pub fn channels(&self) -> &[ChannelSpec] {
        &self.channels
    }

    /// The column of a channel.
    ///
    /// # Errors
    /// A channel that is not there; the nearest one is named.
    pub fn channel_index(&self, name: &str) -> Result<usize, SimError> {
        (self.channels.iter().position(|spec| spec.name == name)).ok_or_else(|| {
            let known = self.channels.iter().map(|spec| spec.name.as_str());
            SimError::scenario("data", UnknownName::new("channel", name, known).to_string())
        })
    }

    /// Rows that a run to the end has.
    pub fn rows(&self) -> usize {
        self.steps / self.steps_per_row + 1
    }

    /// Time step, s.
    pub fn time_step_s(&self) -> f64 {
        self.plant.time_step_s()
    }

    /// Time between two rows of the recording, s.
    pub fn row_interval_s(&self) -> f64 {
        self.steps_per_row as f64 * self.time_step_s()
    }

    /// A recording is held in memory as a whole.
    fn check_memory(&self, scenario: &Scenario) -> Result<(), SimError> {
        let (rows, channels) = (self.steps / self.steps_per_row + 1, self.channels.len());
        let bytes = rows as f64 * channels as f64 * 8.0;
        if bytes <= LARGEST_RECORDING_BYTES {
            return Ok(());
        }
        let keys = [
            "run.record_interval_ms",
            "run.time_step_ms",
            "run.duration_s",
        ];
        let key = keys.into_iter().find(|key| scenario.gives(key));
        Err(SimError::scenario(
            key.unwrap_or("process"),
            format!(
                "the recording would have {rows} rows of {channels} channels, {:.1} GB, but must be at most \
                 {:.0} GB: it is held in memory; raise run.record_interval_ms (a row is now written every \
                 {:.4} ms)",
                bytes / 1e9,
                LARGEST_RECORDING_BYTES / 1e9,
                self.row_interval_s() * 1e3
            ),
        ))
    }

    /// Runs to the end, or until the run diverges. Rows go to the recorder as they come; `progress` is told
    /// the part done, from 0 to 1.
    ///
    /// # Errors
    /// Only what cannot be written; a diverged run is an outcome.
    pub fn run(self, recorder: &mut Recorder, progress: &dyn Fn(f64)) -> Result<RunEnd, SimError> {
        recorder.reserve(self.rows());
        let mut stage = None;
        self.each_step(|cell, step, time_s, row| {
            if let Some(row) = row {
                recorder.push_row(time_s, row)?;
            }
            if recorder.frame_is_due(time_s) {
                let stage =
                    stage.get_or_insert_with(|| cell.setting.stage(cell.process.as_ref()).0);
                recorder.push_frame(cell.frame(stage, time_s));
            }
            if step % STEPS_PER_REPORT == 0 {
                progress(step as f64 / cell.steps as f64);
            }
            Ok(())
        })
    }

    /// As [`Cell::run`], without a recorder: each row (values in the order of [`Cell::channels`]) is given
    /// to `row` together with its time, and nothing else is kept.
    pub fn run_rows(self, mut row: impl FnMut(f64, &[f64])) -> RunEnd {
        let end = self.each_step(|_, _, time_s, values| {
            if let Some(values) = values {
                row(time_s, values);
            }
            Ok::<(), std::convert::Infallible>(())
        });
        match end {
            Ok(end) => end,
            Err(never) => match never {},
        }
    }

    /// The loop: `visit` sees every step before the plant moves on, with its row if one is due.
    fn each_step<E>(
        mut self,
        mut visit: impl FnMut(&Self, usize, f64, Option<&[f64]>) -> Result<(), E>,
    ) -> Result<RunEnd, E> {
        let mut outcome = Outcome::Completed;
        let mut row = Vec::with_capacity(self.channels.len());
        for step in 0..=self.steps {
            let time_s = step as f64 * self.plant.time_step_s();
            let state = match self.step(time_s) {
                Ok(state) => state,
                Err(diverged) => {
                    outcome = diverged;
                    break;
                }
            };
            let due = step % self.steps_per_row == 0;
            if due {
                self.record(&state, &mut row);
            }
            visit(&self, step, time_s, due.then_some(row.as_slice()))?;
            self.plant.drift();
        }
        let findings = self.process.finish();
        self.scalars.extend(self.torque_use.scalar());
        self.scalars.extend(findings.scalars);
        Ok(RunEnd {
            scalars: self.scalars,
            profiles: findings.profiles,
            outcome,
        })
    }

    /// One step at `time_s`, up to the moment when it could be recorded: the state then, or how it diverged.
    fn step(&mut self, time_s: f64) -> Result<ToolState, Outcome> {
        let n = self.plant.dof();
        let mut position = [0.0; truecut_arm::MAX_JOINTS];
        let mut velocity = [0.0; truecut_arm::MAX_JOINTS];
        self.command
            .at(time_s, &mut position[..n], &mut velocity[..n]);
        let mut force = [0.0; truecut_arm::MAX_JOINTS];
        self.command.force_at(time_s, &mut force[..n]);
        let command = Command {
            position: &position[..n],
            velocity: &velocity[..n],
            force: &force[..n],
        };
        let loads = self.process.evaluate(&self.tool_state(time_s));
        let wrenches = self.to_world(&loads);
        self.plant.begin(command, &wrenches);
        self.contacts
            .solve(self.plant.as_mut(), &loads.contacts, &self.axes);
        self.plant
            .finish(&self.contacts.wrenches, &self.contacts.joint_torques);
        self.torque_use.watch(time_s, self.plant.as_ref());
        let state = self.tool_state(time_s);
        if let Some(diverged) = self.watch(time_s, &wrenches) {
            return Err(diverged);
        }
        let dt_s = self.plant.time_step_s();
        self.process
            .commit(&state, &loads, &self.contacts.outcomes, dt_s);
        Ok(state)
    }

    fn to_world(&self, loads: &Loads) -> arrayvec::ArrayVec<WorldWrench, 4> {
        loads
            .wrenches
            .iter()
            .map(|w| {
                let mut wrench = Vector6::zeros();
                wrench
                    .fixed_rows_mut::<3>(0)
                    .copy_from(&(self.axes * w.force_n));
                wrench
                    .fixed_rows_mut::<3>(3)
                    .copy_from(&(self.axes * w.moment_n_m));
                (w.frame, wrench)
            })
            .collect()
    }

    fn motion(&self, attachment: Attachment, start_m: &Vector3<f64>) -> FrameMotion {
        let frame = self.plant.frame(attachment);
        let joints = self.plant.joints();
        let velocity: Vector3<f64> = frame
            .jacobian
            .fixed_rows::<3>(0)
            .column_iter()
            .zip(&joints.velocity)
            .map(|(column, v)| column * *v)
            .sum();
        FrameMotion {
            displacement_m: self
                .axes
                .tr_mul(&(frame.world_from_frame.translation.vector - start_m)),
            velocity_m_per_s: self.axes.tr_mul(&velocity),
        }
    }

    fn tool_state(&self, time_s: f64) -> ToolState {
        ToolState {
            time_s,
            tool: self.motion(Attachment::Tool, &self.tool_start_m),
            foot: self.motion(Attachment::Foot, &self.foot_start_m),
        }
    }

    fn watch(&mut self, time_s: f64, wrenches: &[WorldWrench]) -> Option<Outcome> {
        let mut power_w = self.plant.drive_power_w() - self.plant.dissipation_w();
        let joints = self.plant.joints();
        for (attachment, wrench) in wrenches.iter().chain(&self.contacts.wrenches) {
            let jacobian = &self.plant.frame(*attachment).jacobian;
            let columns = jacobian.column_iter().zip(&joints.velocity);
            power_w += columns
                .map(|(column, v)| column.dot(wrench) * v)
                .sum::<f64>();
        }
        for (torque, v) in self.contacts.joint_torques.iter().zip(&joints.velocity) {
            power_w += torque * v;
        }
        let (kinetic, potential) = self.plant.energy_j();
        let joints = self.plant.joints();
        self.guard.check(&Watch {
            time_s,
            dt_s: self.plant.time_step_s(),
            positions: &joints.position,
            velocities: &joints.velocity,
            energy_j: kinetic + potential,
            power_w,
        })
    }

    fn record(&mut self, state: &ToolState, row: &mut Vec<f64>) {
        row.clear();
        let position = self.plant.frame(Attachment::Tool).world_from_frame;
        let energy = self.plant.energy_j();
        channels::record(
            row,
            state,
            &position.translation.vector,
            self.plant.joints(),
            self.base_joints,
            energy,
        );
        self.process.record(row);
        for (column, sensor) in &mut self.sensors {
            row[*column] = sensor.measure(state.time_s, row[*column]);
        }
    }

    fn frame(&self, stage: &Stage, time_s: f64) -> truecut_recording::Frame {
        let joints = self.plant.joints();
        let shift: Vec<f64> = (joints.command.iter().zip(&self.first_command))
            .map(|(now, first)| now - first)
            .collect();
        stage.frame(time_s, self.plant.as_ref(), self.process.as_ref(), &shift)
    }
}

/// The column of every channel with a sensor of its own.
fn sensors(
    scenario: &Scenario,
    prepared: &Prepared,
    channels: &[ChannelSpec],
) -> Result<Vec<(usize, Sensor)>, SimError> {
    let mut sensors = Vec::new();
    // Neutral ones too must name a channel.
    for (index, effect) in scenario.effects.iter().enumerate() {
        let Target::Channel(channel) = &effect.target else {
            continue;
        };
        let column = (channels.iter().position(|spec| spec.name == *channel)).ok_or_else(|| {
            let known = channels.iter().map(|spec| spec.name.as_str());
            let error = UnknownName::new("channel", channel, known);
            SimError::scenario(format!("effect.{index}.channel"), error.to_string())
        })?;
        let model = prepared.sensors.iter().find(|(name, _)| name == channel);
        if let Some((_, model)) = model
            && sensors.iter().all(|(known, _)| *known != column)
        {
            sensors.push((column, Sensor::new(*model)));
        }
    }
    Ok(sensors)
}
