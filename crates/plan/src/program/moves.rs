//! Programs as moves of the robot, of no maker.

use nalgebra::Isometry3;
use truecut_arm::{FrameId, Robot, ToolLoad};

use super::error::{FASTEST_M_PER_S, ProgramError, ProgramErrorKind};

/// Pose and posture of a move belong together if the posture puts the tool within this of the pose,
/// m and rad.
const SAME_POSE: f64 = 1e-6;

/// A line that leads no further than this, m and rad, is none: to rounding.
const NO_WAY: f64 = 1e-9;

/// The tool as a controller knows it.
#[derive(Debug, Clone, PartialEq)]
pub struct Tool {
    pub name: String,
    /// Number in the controller's table of tools.
    pub number: u8,
    pub flange_from_tool: Isometry3<f64>,
    /// `None` if it is not known: each dialect has a way to say that.
    pub load: Option<ToolLoad>,
}

impl Tool {
    /// The robot's own tool frame and load.
    #[must_use]
    pub fn of(robot: &Robot, name: &str, number: u8) -> Self {
        Self {
            name: name.to_owned(),
            number,
            flange_from_tool: robot.frames.flange_from_tool,
            load: robot.tool_load,
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

/// How a point is passed.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Zone {
    /// The tool stops there.
    Stop,
    /// The tool leaves its way to the point within this distance of it, m.
    Within(f64),
    /// Passed as the dialect passes points of which nothing more is said.
    #[default]
    Unstated,
}

/// The spindle switched on or off.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct SpindleSwitch {
    /// Index of the move before which it is switched; the number of moves for the end.
    pub before: usize,
    pub on: bool,
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
    pub zone: Zone,
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
    /// In the order of the moves.
    pub spindle: Vec<SpindleSwitch>,
    /// What was read and left aside, with its line.
    pub notes: Vec<String>,
}

impl Move {
    /// Whether this is a line to where the move before has led already.
    fn stands_still(&self, before: &Move) -> bool {
        let [from, to] = [before, self].map(|step| &step.base_from_tool);
        let apart_m = (to.translation.vector - from.translation.vector).norm();
        let apart_rad = from.rotation.angle_to(&to.rotation);
        let joints = self.posture.iter().zip(&before.posture);
        matches!(self.motion, Motion::Linear { .. })
            && self.turntable_rad == before.turntable_rad
            && apart_m <= NO_WAY
            && apart_rad <= NO_WAY
            && joints.into_iter().all(|(a, b)| (a - b).abs() <= NO_WAY)
    }
}

impl Program {
    /// The program without lines that lead nowhere, as files from CAM have them that say a point
    /// twice: a controller that blends would stop at one. Where such a line stops, the move before
    /// does.
    pub(super) fn without_standing_lines(&self) -> Program {
        let mut moves: Vec<Move> = Vec::with_capacity(self.moves.len());
        // Of each move, how many are kept before it.
        let mut kept = Vec::with_capacity(self.moves.len());
        for step in &self.moves {
            kept.push(moves.len());
            match moves.last_mut().filter(|before| step.stands_still(before)) {
                Some(before) if step.zone == Zone::Stop => before.zone = Zone::Stop,
                Some(_) => {}
                None => moves.push(step.clone()),
            }
        }
        let spindle = self.spindle.iter().map(|switch| SpindleSwitch {
            before: kept.get(switch.before).copied().unwrap_or(moves.len()),
            on: switch.on,
        });
        Program {
            spindle: spindle.collect(),
            moves,
            ..self.clone()
        }
    }

    /// Switches of the spindle before a move.
    pub(crate) fn switches(&self, before: usize) -> impl Iterator<Item = bool> + '_ {
        let here = move |one: &&SpindleSwitch| one.before == before;
        self.spindle.iter().filter(here).map(|one| one.on)
    }

    /// Pose of the flange that a move asks for, in the world.
    pub(crate) fn world_from_flange(&self, base_from_tool: &Isometry3<f64>) -> Isometry3<f64> {
        self.world_from_base * base_from_tool * self.tool.flange_from_tool.inverse()
    }

    /// What a writer relies on: finite values, postures that reach their poses, speeds above zero,
    /// points that rise, and a turntable in all moves or in none.
    pub fn check(&self, robot: &Robot) -> Result<(), ProgramError> {
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
            Motion::Linear { speed_m_per_s } => (speed_m_per_s, FASTEST_M_PER_S, "speed in m/s"),
        };
        if !(speed > 0.0 && speed <= top) {
            let rule = format!("above zero and finite, at most {top}: no arm is faster");
            return Err(ProgramErrorKind::at_point(path_point, what, speed, &rule).into());
        }
        if let Zone::Within(zone_m) = step.zone
            && !(zone_m > 0.0 && zone_m.is_finite())
        {
            let rule = "above zero and finite";
            return Err(ProgramErrorKind::at_point(path_point, "zone in m", zone_m, rule).into());
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
