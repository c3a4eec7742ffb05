//! The cell: one scenario, ready to run, and the step loop.

mod building;
mod deflection;
mod step;

use crate::channels;
use crate::command::JointCommand;
use crate::contact::ContactSolver;
use crate::error::SimError;
use crate::guard::Guard;
use crate::plant::Plant;
use crate::process::{Process, StandingPart, tells_unfinished};
use crate::scene::{Setting, Stage, scene};
use crate::spring_use::SpringUse;
use crate::torque_use::TorqueUse;
use deflection::PathDeflection;
use nalgebra::{Matrix3, Vector3};
use std::ops::ControlFlow;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use truecut_core::sensor::Sensor;
use truecut_plan::clearance::Tool;
use truecut_recording::{ChannelSpec, Header, Outcome, Recorder, Scalar, Scene, UnknownName};
use truecut_scenario::{FaultRule, Scenario};

/// Steps between two calls of the progress function.
const STEPS_PER_REPORT: usize = 500;
/// Rows of a run that ends early beyond its end.
const ROWS_BEYOND: usize = 3;
/// Frames of a run that show fields on the workpiece.
const FIELDS_PER_RUN: usize = 24;

/// One scenario, ready to run.
pub(crate) struct Cell {
    scenario: Scenario,
    channels: Vec<ChannelSpec>,
    notes: Vec<String>,
    plant: Box<dyn Plant>,
    process: Box<dyn Process>,
    contacts: ContactSolver,
    command: JointCommand,
    guard: Guard,
    setting: Arc<Setting>,
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
    /// Steps between two rows, before every step was to be one.
    steps_per_balance: usize,
    /// Kinetic and potential energy at the last step, J.
    energy_j: (f64, f64),
    torque_use: TorqueUse,
    spring_use: SpringUse,
    /// Why the arm's masses are not its own, where that fails the run.
    placeholders: Option<String>,
    /// That the clock of the data runs faster than the plant steps.
    hasty_clock: Option<String>,
    deflection: Option<PathDeflection>,
    scalars: Vec<Scalar>,
    /// All that is asked for, if not the whole run.
    asked: Option<Asked>,
}

/// What rows alone are asked for, beside channels that are at hand in every step.
#[derive(Clone, Copy)]
struct Asked {
    /// The energy of the arm.
    energy: bool,
    /// How far the tool is off its path.
    deflection: bool,
}

/// What a run ended with; give it to [`Recorder::finish`].
pub(crate) struct RunEnd {
    pub scalars: Vec<Scalar>,
    pub profiles: Vec<truecut_recording::Profile>,
    pub part: Option<truecut_recording::PartMesh>,
    pub outcome: Outcome,
}

impl Cell {
    /// Channels and notes: what a [`Recorder`] is opened with.
    pub fn header(&self) -> Header {
        self.header_with(Scene::default())
    }

    /// The process's tool, for clearances.
    pub(crate) fn tools(&self) -> Vec<Tool> {
        self.setting.tools()
    }

    /// The part that the process works on, for clearances.
    pub(crate) fn part(&self) -> Result<StandingPart, SimError> {
        (self.setting.part)()
    }

    /// As [`Cell::header`], with the scene, for which the robot's meshes are read.
    pub fn header_with_scene(&self) -> Header {
        let (scene, notes) = scene(&self.setting, self.process.as_ref());
        let mut header = self.header_with(scene);
        header.notes.extend(notes);
        header
    }

    fn header_with(&self, scene: Scene) -> Header {
        Header {
            scenario_name: self.scenario.name.clone(),
            // With all its effects, also those that were added in memory.
            scenario_text: (self.scenario).extended_text(&self.scenario.effects, &self.rotary),
            channels: self.channels.clone(),
            scene,
            notes: self.notes.clone(),
        }
    }

    /// The channels alone, in the order of the rows.
    pub fn channels(&self) -> &[ChannelSpec] {
        &self.channels
    }

    /// Leaves out of the run what neither forces nor these channels need; it ends without findings,
    /// and other channels of its rows are no numbers.
    pub fn keep_only(&mut self, channels: &[usize]) {
        self.process.keep_rows_only();
        let is_asked = |of: &dyn Fn(&str) -> bool| {
            let mut names = channels.iter().map(|index| &self.channels[*index].name);
            names.any(|name| of(name))
        };
        self.asked = Some(Asked {
            energy: is_asked(&channels::is_energy),
            deflection: is_asked(&PathDeflection::is_channel),
        });
    }

    /// A row at every step, whatever the scenario says.
    pub fn keep_every_step(&mut self) {
        self.steps_per_row = 1;
    }

    /// Ends the run early: [`ROWS_BEYOND`] rows after the first one that is not before `time_s`.
    pub fn end_after(&mut self, time_s: f64) {
        let rows = (time_s / self.row_interval_s()).ceil().max(0.0) as usize + ROWS_BEYOND;
        self.steps = self.steps.min(rows.saturating_mul(self.steps_per_row));
    }

    /// Puts another process in the place of this one.
    #[cfg(test)]
    pub(crate) fn replace_process(
        &mut self,
        other: impl FnOnce(Box<dyn Process>) -> Box<dyn Process>,
    ) {
        let process =
            std::mem::replace(&mut self.process, Box::new(crate::contract::process::Gone));
        self.process = other(process);
    }

    /// The scalars that a run has, by a run of one step: their names and units are those of any.
    pub(crate) fn scalars_made(mut self) -> Vec<Scalar> {
        self.steps = 0;
        self.run_rows(|_, _| ()).scalars
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

    /// Natural frequencies of the arm at its start, slowest first, Hz.
    ///
    /// # Errors
    /// A joint without a spring.
    pub(crate) fn modes_hz(&self) -> Result<Vec<f64>, SimError> {
        let modes = self.setting.robot.modes(&self.setting.start, None)?;
        Ok(modes.frequency_hz)
    }

    /// Time between two rows of the recording, s.
    pub fn row_interval_s(&self) -> f64 {
        self.steps_per_row as f64 * self.time_step_s()
    }

    /// Runs to the end, or until the run diverges, its process cannot go on, or `stop` is set. Rows
    /// go to the recorder as they come; `progress` is told the part done, from 0 to 1.
    ///
    /// # Errors
    /// Only what cannot be written; a run that ends early is an outcome.
    pub fn run(
        self,
        recorder: &mut Recorder,
        progress: &dyn Fn(f64),
        stop: Option<&AtomicBool>,
    ) -> Result<RunEnd, SimError> {
        recorder.reserve(self.rows());
        let mut stage = None;
        let shown_every = (self.steps / FIELDS_PER_RUN).max(1);
        let mut next_shown = 0;
        self.each_step(|cell, step, time_s, row| {
            if let Some(row) = row {
                recorder.push_row(time_s, row)?;
            }
            // The last frame has what the process left in the end.
            let is_last = step >= cell.steps && recorder.takes_frames();
            if is_last || recorder.frame_is_due(time_s) {
                let stage = stage
                    .get_or_insert_with(|| Stage::new(cell.setting.clone(), cell.process.as_ref()));
                let shows = is_last || step >= next_shown;
                if shows {
                    next_shown = step + shown_every;
                }
                let frame = cell.frame(stage, time_s, shows);
                match is_last {
                    true => recorder.push_last_frame(frame),
                    false => recorder.push_frame(frame),
                }
            }
            if step % STEPS_PER_REPORT == 0 {
                progress(step as f64 / cell.steps as f64);
            }
            // A stop that comes with the last step is none.
            let stopped = stop.is_some_and(|stop| stop.load(Ordering::Relaxed));
            Ok(match stopped && step < cell.steps {
                true => ControlFlow::Break(Outcome::Interrupted),
                false => ControlFlow::Continue(()),
            })
        })
    }

    /// As [`Cell::run`], without a recorder: each row (values in the order of [`Cell::channels`])
    /// is given to `row` together with its time, and nothing else is kept.
    pub fn run_rows(self, mut row: impl FnMut(f64, &[f64])) -> RunEnd {
        let end = self.each_step(|_, _, time_s, values| {
            if let Some(values) = values {
                row(time_s, values);
            }
            Ok::<_, std::convert::Infallible>(ControlFlow::Continue(()))
        });
        match end {
            Ok(end) => end,
            Err(never) => match never {},
        }
    }

    /// The loop: `visit` sees every step before the plant moves on, with its row if one is due, and
    /// may end the run.
    fn each_step<E>(
        mut self,
        mut visit: impl FnMut(&Self, usize, f64, Option<&[f64]>) -> Result<ControlFlow<Outcome>, E>,
    ) -> Result<RunEnd, E> {
        let mut outcome = Outcome::Completed;
        let mut row = Vec::with_capacity(self.channels.len());
        for step in 0..=self.steps {
            let time_s = step as f64 * self.plant.time_step_s();
            let due = step % self.steps_per_row == 0;
            let state = match self.step(step, time_s) {
                Ok(state) => state,
                Err(ended) => {
                    outcome = ended;
                    break;
                }
            };
            if due {
                self.record(&state, &mut row);
            }
            let next = visit(&self, step, time_s, due.then_some(row.as_slice()))?;
            if let ControlFlow::Break(ended) = next {
                outcome = ended;
                break;
            }
            let next_is_due = (step + 1).is_multiple_of(self.steps_per_row);
            if self.asked.is_some() && self.process.is_idle() && !next_is_due {
                self.plant.drift_unseen();
            } else {
                self.plant.drift();
            }
        }
        let findings = self.process.finish();
        if let (Outcome::Diverged { rule, .. }, Some(told)) = (&mut outcome, &self.hasty_clock) {
            *rule += &format!("; {told}");
        }
        if outcome == Outcome::Completed {
            // What is asked of the drives rests on the masses, too.
            outcome = match self.placeholders.take() {
                Some(signs) => Outcome::Placeholders { signs },
                None => self.torque_use.outcome(self.scenario.run.overload),
            };
        }
        if outcome == Outcome::Completed {
            outcome = self.spring_use.outcome();
        }
        if outcome == Outcome::Completed {
            let counts = self.scenario.run.overload == FaultRule::Fail;
            let overload = findings.overload.filter(|_| counts);
            let is_whole = !self.notes.iter().any(|note| tells_unfinished(note));
            let idle = findings.idle.filter(|_| is_whole);
            outcome = findings.beyond.or(idle).or(overload).unwrap_or_default();
        }
        self.scalars.extend(self.torque_use.scalars());
        self.scalars.extend(self.spring_use.scalar());
        self.scalars.extend(findings.scalars);
        Ok(RunEnd {
            scalars: self.scalars,
            profiles: findings.profiles,
            part: findings.part,
            outcome,
        })
    }

    fn frame(&self, stage: &Stage, time_s: f64, with_fields: bool) -> truecut_recording::Frame {
        let joints = self.plant.joints();
        let shift: Vec<f64> = (joints.command.iter().zip(&self.first_command))
            .map(|(now, first)| now - first)
            .collect();
        let (plant, process) = (self.plant.as_ref(), self.process.as_ref());
        stage.frame(time_s, plant, process, &shift, with_fields)
    }
}
