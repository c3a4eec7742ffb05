//! Robot programs: a path as moves of the robot, written as a Motoman job ([`jbi`]) or an ABB module ([`rapid`]) and read
//! back.
//!
//! A [`Program`] belongs to no maker. Each [`Move`] holds the tool's pose in the base frame and the posture that reaches it;
//! from the posture a dialect derives what it prints to tell the arm's branches apart, and from what is printed the posture
//! is found again ([`jbi::Rconf`], [`rapid::Confdata`]).
//!
//! ```
//! use nalgebra::{Isometry3, Translation3, UnitQuaternion};
//! use truecut_arm::Robot;
//! use truecut_plan::program::{Motion, PathPoint, Program, Tool, TravelOptions, jbi};
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! # let urdf = concat!(env!("CARGO_MANIFEST_DIR"), "/../../assets/robots/irb6600_175_255/robot.urdf");
//! let robot = Robot::load(urdf.as_ref(), None, None)?;
//! let down = UnitQuaternion::from_euler_angles(std::f64::consts::PI, 0.0, 0.0);
//! let points: Vec<PathPoint> = (0..5)
//!     .map(|i| PathPoint {
//!         base_from_tool: Isometry3::from_parts(Translation3::new(1.5, 0.02 * f64::from(i), 0.8), down),
//!         motion: Motion::Linear { speed_m_per_s: 0.02 },
//!         turntable_rad: None,
//!     })
//!     .collect();
//! let tool = Tool::of(&robot, "wheel", 1);
//! let program = Program::along(&robot, "DEMO", tool, Isometry3::identity(), &points, &TravelOptions::default())?;
//! let date = jbi::JobDate::new(2026, 1, 31, 12, 0)?;
//! let options = jbi::JbiOptions::new(date);
//! let jobs = jbi::write(&program, &robot, &options)?;
//! let job = jbi::JbiJob::parse(&jobs[0].text, "DEMO.JBI".as_ref())?;
//! let read = job.program(&robot, &program.tool, &program.world_from_base, &options)?;
//! assert_eq!(read.moves.len(), 5);
//! # Ok(())
//! # }
//! ```

mod error;
mod flags;
mod inspect;
pub mod jbi;
mod number;
pub mod rapid;
mod replay;
mod travel;

use nalgebra::{Isometry3, Vector3};
use truecut_arm::{FrameId, Robot};

pub use error::{ProgramError, ProgramErrorKind};
pub use inspect::{Finding, FindingKind};
pub use replay::{Replay, ReplayOptions, ReplayRow};
pub use travel::{TravelOptions, shortest_travel};

/// Pose and posture of a move belong together if the posture puts the tool within this of the pose, m and rad.
const SAME_POSE: f64 = 1e-6;

/// The tool as a controller knows it.
#[derive(Debug, Clone, PartialEq)]
pub struct Tool {
    pub name: String,
    /// Number in the controller's table of tools.
    pub number: u8,
    pub flange_from_tool: Isometry3<f64>,
    pub mass_kg: f64,
    /// Centre of mass in the flange frame, m.
    pub centre_m: Vector3<f64>,
}

impl Tool {
    /// The robot's own tool frame, with a mass of 1 kg at the tool point.
    #[must_use]
    pub fn of(robot: &Robot, name: &str, number: u8) -> Self {
        let flange_from_tool = robot.frames.flange_from_tool;
        Self {
            name: name.to_owned(),
            number,
            flange_from_tool,
            mass_kg: 1.0,
            centre_m: flange_from_tool.translation.vector,
        }
    }
}

/// How the arm gets to a point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Motion {
    /// All joints start and arrive together.
    Joint {
        /// Share of the top speed, above 0 to 1.
        share: f64,
    },
    /// The tool point runs along a straight line.
    Linear { speed_m_per_s: f64 },
}

/// Where the tool shall be, the arm's branch not chosen yet.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PathPoint {
    pub base_from_tool: Isometry3<f64>,
    /// How to get here from the point before.
    pub motion: Motion,
    /// Angle of the workpiece's turntable, if there is one.
    pub turntable_rad: Option<f64>,
}

/// One move of a program.
#[derive(Debug, Clone, PartialEq)]
pub struct Move {
    /// Which point of the path this is; rises from move to move.
    pub path_point: usize,
    pub base_from_tool: Isometry3<f64>,
    pub motion: Motion,
    pub turntable_rad: Option<f64>,
    /// Joint coordinates that put the tool there, whole turns included, rad or m.
    pub posture: Vec<f64>,
}

/// A sequence of moves of one tool in one base frame.
#[derive(Debug, Clone, PartialEq)]
pub struct Program {
    pub name: String,
    pub comment: String,
    pub tool: Tool,
    /// Frame in which the moves' poses are given.
    pub world_from_base: Isometry3<f64>,
    pub moves: Vec<Move>,
}

impl Program {
    /// A program through `points`, on the arm's branches by [`shortest_travel`]. Path points count from 0.
    ///
    /// # Errors
    /// As [`shortest_travel`].
    pub fn along(
        robot: &Robot,
        name: &str,
        tool: Tool,
        world_from_base: Isometry3<f64>,
        points: &[PathPoint],
        options: &TravelOptions,
    ) -> Result<Self, ProgramError> {
        let postures = shortest_travel(
            robot,
            &tool.flange_from_tool,
            &world_from_base,
            points,
            None,
            options,
        )?;
        let moves = points.iter().zip(postures).enumerate();
        Ok(Self {
            name: name.to_owned(),
            comment: String::new(),
            tool,
            world_from_base,
            moves: moves
                .map(|(path_point, (point, posture))| Move {
                    path_point,
                    base_from_tool: point.base_from_tool,
                    motion: point.motion,
                    turntable_rad: point.turntable_rad,
                    posture,
                })
                .collect(),
        })
    }

    /// Pose of the flange that a move asks for, in the world.
    pub(crate) fn world_from_flange(&self, base_from_tool: &Isometry3<f64>) -> Isometry3<f64> {
        self.world_from_base * base_from_tool * self.tool.flange_from_tool.inverse()
    }

    /// What a writer relies on: finite values, postures that reach their poses, speeds above zero, points that rise, and a
    /// turntable in all moves or in none.
    pub(crate) fn check(&self, robot: &Robot) -> Result<(), ProgramError> {
        let mut before: Option<&Move> = None;
        for step in &self.moves {
            self.check_move(step, robot)?;
            if let Some(before) = before {
                if step.path_point <= before.path_point {
                    return Err(ProgramErrorKind::value(
                        "path point",
                        step.path_point,
                        "above that of the move before",
                    )
                    .into());
                }
                if step.turntable_rad.is_some() != before.turntable_rad.is_some() {
                    return Err(ProgramErrorKind::TurntableInSome {
                        path_point: step.path_point,
                    }
                    .into());
                }
            }
            before = Some(step);
        }
        Ok(())
    }

    fn check_move(&self, step: &Move, robot: &Robot) -> Result<(), ProgramError> {
        let path_point = step.path_point;
        let (speed, top, what) = match step.motion {
            Motion::Joint { share } => (share, 1.0, "share of the top speed"),
            Motion::Linear { speed_m_per_s } => (speed_m_per_s, f64::MAX, "speed in m/s"),
        };
        if !(speed > 0.0 && speed <= top) {
            let rule = "above zero and finite; a share at most 1";
            return Err(ProgramErrorKind::at_point(path_point, what, speed, rule).into());
        }
        if let Some(angle) = step.turntable_rad.filter(|angle| !angle.is_finite()) {
            return Err(
                ProgramErrorKind::at_point(path_point, "turntable angle", angle, "finite").into(),
            );
        }
        if step.posture.len() != robot.dof() {
            return Err(ProgramErrorKind::JointCount {
                what: format!("the posture of path point {path_point}"),
                found: step.posture.len(),
                wanted: robot.dof(),
            }
            .into());
        }
        let flange = robot.world_from_frame(&step.posture, FrameId::Flange);
        let wanted = self.world_from_flange(&step.base_from_tool);
        let apart_m = (flange.translation.vector - wanted.translation.vector).norm();
        let apart_rad = flange.rotation.angle_to(&wanted.rotation);
        if !(apart_m <= SAME_POSE && apart_rad <= SAME_POSE) {
            return Err(ProgramErrorKind::PostureMissesPose {
                path_point,
                apart_mm: apart_m * 1e3,
                apart_deg: apart_rad.to_degrees(),
            }
            .into());
        }
        Ok(())
    }
}
