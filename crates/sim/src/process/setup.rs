//! From the process of a scenario to what runs. Each process has a `setup` in its folder; here is
//! what it is given, and what it gives.

use super::Process;
use crate::command::{JointCommand, StraightCommand};
use crate::effect::Effects;
use crate::error::SimError;
use crate::motion::PlannedMotion;
use crate::motion::path_file::StartNear;
use crate::motion::solve::solved;
use crate::posture;
use crate::replay::forward::ForwardInputs;
use crate::robots::Robots;
use crate::scene::{DrawWorkpiece, Tooling};
use nalgebra::{Isometry3, Matrix3, UnitQuaternion, Vector3};
use std::sync::Arc;
use truecut_arm::{FrameId, Load, Robot};
use truecut_plan::motion::straight::SolvedPath;
use truecut_plan::surface::Mesh;
use truecut_recording::{Measured, Shape};
use truecut_scenario::{DriveKind, PostureFrom, ProcessSpec, Scenario};

/// What a process is set up from.
pub struct SetupContext<'a> {
    pub(crate) scenario: &'a Scenario,
    /// The nominal robot: effects on it show in the run only.
    pub(crate) robot: &'a Robot,
    pub(crate) robots: &'a Robots,
    pub(crate) kind: DriveKind,
    pub(crate) effects: &'a Effects,
    pub(crate) measured: Option<&'a Measured>,
}

impl<'a> SetupContext<'a> {
    /// The scenario.
    #[must_use]
    pub fn scenario(&self) -> &'a Scenario {
        self.scenario
    }

    /// The robot without effects.
    #[must_use]
    pub fn robot(&self) -> &'a Robot {
        self.robot
    }

    /// Joint coordinates from which the arm starts, in chain order, rad and m.
    ///
    /// # Errors
    /// Too many or too few values, or one outside the limits of its joint.
    pub fn posture(&self) -> Result<Vec<f64>, SimError> {
        let given = || posture::posture(&self.scenario.robot, self.robot);
        match self.scenario.process.facts().posture {
            PostureFrom::Scenario => given(),
            PostureFrom::Job(file) => given().map_err(|error| posture::of_job(error, &file)),
            PostureFrom::Taught => Ok(vec![0.0; self.robot.dof()]),
            PostureFrom::Path => Ok(self.start_near()?.posture),
        }
    }

    /// Where the arm of a path may start: near to the scenario's posture, if it gives one.
    pub(crate) fn start_near(&self) -> Result<StartNear, SimError> {
        StartNear::of(&self.scenario.robot, self.robot)
    }

    /// Compliance of the driven arm at the foot, process axes, m/N.
    pub(crate) fn compliance(&self, posture: &[f64]) -> Result<Matrix3<f64>, SimError> {
        Ok(self.robot.process_compliance(posture, FrameId::Foot)?)
    }

    /// The motion of the arm, solved unless it is known. `is_same` says of another process whether
    /// it asks for the same one.
    pub(crate) fn planned(
        &self,
        posture: &[f64],
        is_same: impl Fn(&ProcessSpec) -> bool,
        solve: impl FnOnce() -> Result<PlannedMotion, SimError>,
    ) -> Result<Arc<PlannedMotion>, SimError> {
        solved(self.scenario, self.robots, posture, is_same, solve)
    }

    /// Where a planned motion sets out, and how long its run takes.
    pub(crate) fn departure(&self, path: &PlannedMotion) -> Departure {
        let posture = path.knots[0].clone();
        Departure {
            world_from_process: self.robot.world_from_process(&posture),
            posture,
            duration_s: path.duration_s.min(self.scenario.run.duration_s),
        }
    }
}

/// The first posture of a planned motion, without load.
pub(crate) struct Departure {
    pub posture: Vec<f64>,
    pub world_from_process: Isometry3<f64>,
    /// Length of the run, s.
    pub duration_s: f64,
}

impl Departure {
    /// World axes to process axes.
    pub fn process_from_world(&self) -> UnitQuaternion<f64> {
        self.world_from_process.rotation.inverse()
    }
}

/// A part, at every place where a copy of it stands in the world.
pub(crate) type StandingPart = Vec<(Arc<Mesh>, Isometry3<f64>)>;

/// Reads the part that a process works on, when clearances are asked for.
pub(crate) type ReadPart = Box<dyn Fn() -> Result<StandingPart, SimError> + Send + Sync>;

/// A process that is ready to run, and how the arm moves with it.
pub struct ProcessSetup {
    pub(crate) process: Box<dyn Process>,
    pub(crate) workpiece: DrawWorkpiece,
    pub(crate) tooling: Tooling,
    pub(crate) part: ReadPart,
    /// Outward normal of a plane workpiece, world axes; without it against the tool's z axis.
    pub(crate) surface_normal: Option<Vector3<f64>>,
    /// Posture without load in which the arm starts.
    pub(crate) posture: Vec<f64>,
    pub(crate) motion: Motion,
}

/// What moves the arm.
pub(crate) enum Motion {
    /// The feed of the process along its y axis; without one the arm holds its posture.
    Feed,
    /// A straight path, at this speed, m/s.
    Straight(SolvedPath, f64),
    /// A motion that was solved as a whole.
    Planned(Arc<PlannedMotion>),
    /// Measured commands.
    Replay(ForwardInputs),
}

impl ProcessSetup {
    /// Whether the arm follows a path that was solved as a whole.
    pub(crate) fn follows_path(&self) -> bool {
        matches!(self.motion, Motion::Planned(_))
    }

    /// A process on an arm that starts in `posture` and holds it, or feeds the tool along the
    /// process's y axis if [`Process::feed_along_y_m_per_s`] says so.
    #[must_use]
    pub fn new(process: impl Process + 'static, posture: Vec<f64>) -> Self {
        Self {
            process: Box::new(process),
            workpiece: Box::new(Vec::new),
            tooling: Tooling::default(),
            part: Box::new(|| Ok(Vec::new())),
            surface_normal: None,
            posture,
            motion: Motion::Feed,
        }
    }

    /// The same with a workpiece to be drawn.
    pub(crate) fn on(self, workpiece: impl Fn() -> Vec<Shape> + Send + Sync + 'static) -> Self {
        Self {
            workpiece: Box::new(workpiece),
            ..self
        }
    }

    /// The same with a tool to be drawn, and a pressure foot; without, spindle and holder are.
    #[must_use]
    pub fn holding(self, tooling: Tooling) -> Self {
        Self { tooling, ..self }
    }

    /// The same with a part that stands in the world and may be met.
    pub(crate) fn working_on(
        self,
        part: impl Fn() -> Result<StandingPart, SimError> + Send + Sync + 'static,
    ) -> Self {
        Self {
            part: Box::new(part),
            ..self
        }
    }

    /// The same along a path.
    pub(crate) fn led_by(self, motion: Motion) -> Self {
        Self { motion, ..self }
    }

    /// Length of the run, s, where the scenario asks for `asked_s`.
    pub(crate) fn duration_s(&self, asked_s: f64) -> f64 {
        match &self.motion {
            Motion::Feed | Motion::Straight(..) => asked_s,
            Motion::Planned(path) => path.duration_s.min(asked_s),
            Motion::Replay(inputs) => inputs.duration_s(),
        }
    }

    /// A note on a planned path that the run, asked to take `asked_s`, does not finish.
    pub(crate) fn unfinished(&self, asked_s: f64) -> Option<String> {
        match &self.motion {
            Motion::Planned(path) => cut_short(asked_s, path.duration_s),
            _ => None,
        }
    }

    /// What there is to say of the path.
    pub(crate) fn note(&self) -> Option<String> {
        match &self.motion {
            Motion::Planned(path) => path.note.clone(),
            _ => None,
        }
    }

    /// Joints that nothing commands: their motors hold them in the posture.
    pub(crate) fn held(&self) -> Vec<usize> {
        match &self.motion {
            Motion::Replay(inputs) => inputs.held(),
            _ => Vec::new(),
        }
    }

    /// What the controller asks of the nominal robot, with the sag that it makes up for.
    pub(crate) fn command(
        &self,
        robot: &Robot,
        world_from_process: &Isometry3<f64>,
        duration_s: f64,
        sag: Option<&Load>,
    ) -> Result<JointCommand, SimError> {
        let posture = &self.posture;
        Ok(match &self.motion {
            Motion::Feed => {
                let speed = self.process.feed_along_y_m_per_s();
                if speed == 0.0 {
                    JointCommand::Hold(match sag {
                        Some(load) => robot.holding_command(posture, load)?,
                        None => posture.clone(),
                    })
                } else {
                    JointCommand::Along(StraightCommand::solve(
                        robot,
                        posture,
                        world_from_process,
                        speed,
                        duration_s,
                        sag,
                    )?)
                }
            }
            Motion::Straight(path, speed_m_per_s) => JointCommand::Along(StraightCommand::of(
                robot,
                path.clone(),
                *speed_m_per_s,
                sag,
            )?),
            Motion::Planned(path) => JointCommand::Replay(path.command(robot, sag)?),
            Motion::Replay(inputs) => inputs.command(posture),
        })
    }
}

/// Refuses a process that presses with an arm whose joints are free.
pub(crate) fn check_drive(process: &ProcessSpec, kind: DriveKind) -> Result<(), SimError> {
    match process.facts().needs_drive {
        Some(what) if kind == DriveKind::Force => Err(SimError::scenario(
            "robot.drive",
            format!(
                "drive = \"force\" leaves the joints free, but process.{what} presses against them"
            ),
        )),
        _ => Ok(()),
    }
}

/// How the note ends on a run that ends before its process does.
const UNFINISHED: &str = "what is reported is of an unfinished process";

/// Whether a note of a run says that it ended before its process did.
pub fn tells_unfinished(note: &str) -> bool {
    note.ends_with(UNFINISHED)
}

/// A note on a run of `duration_s` whose process takes `natural_s` by itself, if it ends before.
pub(crate) fn cut_short(duration_s: f64, natural_s: f64) -> Option<String> {
    (duration_s < natural_s * (1.0 - 1e-9)).then(|| {
        format!(
            "run.duration_s is {duration_s:.4} s, the process takes {natural_s:.4} s by itself: {UNFINISHED}"
        )
    })
}
