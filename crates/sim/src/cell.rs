//! The cell: one scenario, ready to run, and the step loop.

use crate::build::Prepared;
use crate::channels;
use crate::command::JointCommand;
use crate::contact::ContactSolver;
use crate::error::SimError;
use crate::guard::{Guard, Watch};
use crate::loads::{Attachment, Loads};
use crate::plant::{Command, Plant, RapierPlant, WorldWrench};
use crate::process::{FrameMotion, Process, ToolState};
use crate::scene::Stage;
use crate::torque_use::{TorqueUse, servo_note};
use nalgebra::{Matrix3, Vector3, Vector6};
use truecut_arm::JointKind;
use truecut_recording::{Header, Measured, Outcome, Recorder, Scalar, Scene, Unit};
use truecut_scenario::Scenario;

/// Steps between two calls of the progress function.
const STEPS_PER_REPORT: usize = 500;

/// Largest recording, bytes.
const LARGEST_RECORDING_BYTES: f64 = 2e9;

/// One scenario, ready to run.
pub struct Cell {
    header: Header,
    plant: Box<dyn Plant>,
    process: Box<dyn Process>,
    contacts: ContactSolver,
    command: JointCommand,
    guard: Guard,
    stage: Stage,
    axes: Matrix3<f64>,
    tool_start_m: Vector3<f64>,
    foot_start_m: Vector3<f64>,
    first_command: Vec<f64>,
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
        let cell = Self::assemble(scenario, prepared, Box::new(plant));
        cell.check_memory(scenario)?;
        Ok(cell)
    }

    fn assemble(scenario: &Scenario, prepared: Prepared, plant: Box<dyn Plant>) -> Self {
        let (stage, scene) = Stage::new(
            &prepared.robot,
            &prepared.start,
            prepared.world_from_process,
            scenario.run.deflection_scale,
            prepared.workpiece,
            prepared.process.as_ref(),
        );
        let mut header = header(scenario, &prepared, scene);
        header.channels.extend(channels::specs(&prepared.robot));
        header.channels.extend(prepared.process.channels());
        let position = |attachment| {
            let frame: truecut_arm::FrameId = attachment;
            let pose = prepared.robot.world_from_frame(&prepared.start, frame);
            pose.translation.vector
        };
        let steps = (prepared.duration_s / prepared.dt_s - 1e-9).ceil() as usize;
        let friction = if prepared.kind == crate::plant::DriveKind::Force {
            vec![0.0; prepared.robot.dof()]
        } else {
            (prepared.robot.chain.joints.iter())
                .map(|j| j.transmission.dry_friction)
                .collect()
        };
        let interval = scenario.run.record_interval_s.unwrap_or(0.0);
        let steps_per_row = ((interval / prepared.dt_s).round() as usize).max(1);
        let recorded = steps_per_row as f64 * prepared.dt_s;
        if interval > 0.0 && (recorded / interval - 1.0).abs() > 1e-6 {
            header.notes.push(format!(
                "a row every {:.6} ms: the {} ms asked for are no whole number of steps",
                recorded * 1e3,
                interval * 1e3
            ));
        }
        Self {
            tool_start_m: position(Attachment::Tool.into()),
            foot_start_m: position(Attachment::Foot.into()),
            first_command: prepared.first_command(),
            contacts: ContactSolver::new(friction),
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
            stage,
            header,
            plant,
        }
    }

    /// Channels, scene and notes: what a [`Recorder`] is opened with.
    pub fn header(&self) -> Header {
        self.header.clone()
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
        let (rows, channels) = (
            self.steps / self.steps_per_row + 1,
            self.header.channels.len(),
        );
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
    pub fn run(
        mut self,
        recorder: &mut Recorder,
        progress: &dyn Fn(f64),
    ) -> Result<RunEnd, SimError> {
        recorder.reserve(self.steps / self.steps_per_row + 1);
        let mut outcome = Outcome::Completed;
        let mut row = Vec::with_capacity(self.header.channels.len());
        for step in 0..=self.steps {
            let time_s = step as f64 * self.plant.time_step_s();
            if let Some(diverged) = self.step(time_s) {
                outcome = diverged;
                break;
            }
            if step % self.steps_per_row == 0 {
                self.record(time_s, &mut row);
                recorder.push_row(time_s, &row)?;
            }
            if recorder.frame_is_due(time_s) {
                recorder.push_frame(self.frame(time_s));
            }
            self.plant.drift();
            if step % STEPS_PER_REPORT == 0 {
                progress(step as f64 / self.steps as f64);
            }
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

    /// One step at `time_s`, up to the moment when it could be recorded. `Some` if it diverged.
    fn step(&mut self, time_s: f64) -> Option<Outcome> {
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
        let diverged = self.watch(time_s, &wrenches);
        if diverged.is_none() {
            let dt_s = self.plant.time_step_s();
            self.process
                .commit(&state, &loads, &self.contacts.outcomes, dt_s);
        }
        diverged
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

    fn record(&mut self, time_s: f64, row: &mut Vec<f64>) {
        row.clear();
        let state = self.tool_state(time_s);
        let position = self.plant.frame(Attachment::Tool).world_from_frame;
        let energy = self.plant.energy_j();
        channels::record(
            row,
            &state,
            &position.translation.vector,
            self.plant.joints(),
            energy,
        );
        self.process.record(row);
    }

    fn frame(&self, time_s: f64) -> truecut_recording::Frame {
        let joints = self.plant.joints();
        let shift: Vec<f64> = (joints.command.iter().zip(&self.first_command))
            .map(|(now, first)| now - first)
            .collect();
        self.stage
            .frame(time_s, self.plant.as_ref(), self.process.as_ref(), &shift)
    }
}

fn header(scenario: &Scenario, prepared: &Prepared, scene: Scene) -> Header {
    let mut notes = prepared.notes.clone();
    notes.extend(servo_note(prepared));
    notes.push(format!(
        "time step {:.6} ms, leapfrog, no numerical damping",
        prepared.dt_s * 1e3
    ));
    Header {
        scenario_name: scenario.name.clone(),
        scenario_text: scenario.effective_text(),
        channels: Vec::new(),
        scene,
        notes,
    }
}

fn joint_limits(prepared: &Prepared) -> Vec<(String, f64, f64, &'static str)> {
    (prepared.robot.chain.joints.iter())
        .map(|joint| {
            let unit = match joint.kind {
                JointKind::Revolute => "rad",
                JointKind::Prismatic => "m",
            };
            let (lower, upper) = joint
                .limits
                .map_or((f64::NEG_INFINITY, f64::INFINITY), |l| (l.lower, l.upper));
            (joint.name.clone(), lower, upper, unit)
        })
        .collect()
}

fn plant_scalars(prepared: &Prepared) -> Vec<Scalar> {
    let mut scalars = vec![Scalar::new(
        "run.time_step",
        Unit::Second,
        prepared.dt_s,
        "Time step of the run",
    )];
    if let Ok(modes) = prepared.robot.modes(&prepared.start, None) {
        for (i, f) in modes.frequency_hz.iter().enumerate() {
            scalars.push(Scalar::new(
                format!("plant.mode{}_frequency", i + 1),
                Unit::Hertz,
                *f,
                "Natural frequency of the free arm at the start",
            ));
        }
    }
    scalars
}
