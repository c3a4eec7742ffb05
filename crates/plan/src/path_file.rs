//! A path from a file, CAM's or a robot program, that leads an arm.

use std::path::{Path, PathBuf};

use nalgebra::Isometry3;
use truecut_arm::Robot;

use crate::cam::{self, CamOptions, CamPath, SpindleAtCuts, WorkSetup};
use crate::motion::led::{LedMotion, LedTask};
use crate::program::{
    Dialect, Frames, Motion, Move, Program, ProgramError, ProgramErrorKind, Settings, Start, Tool,
    TravelOptions, read_text,
};

/// Farthest that a program's tool may stand from the robot's to be the same, m and rad.
const SAME_TOOL: f64 = 1e-6;

/// A path in a file, and where it stands.
#[derive(Debug, Clone, PartialEq)]
pub struct PathFile {
    pub file: PathBuf,
    pub kind: PathFileKind,
    /// Largest speed of a joint on lines, share of its top speed.
    pub joint_share: f64,
}

/// What a file of a path is.
#[derive(Debug, Clone, PartialEq)]
pub enum PathFileKind {
    /// G-code, APT or poses.
    Cam {
        options: CamOptions,
        setup: WorkSetup,
        /// What follows the path, in the robot's tool frame.
        tool_from_tip: Isometry3<f64>,
    },
    /// A robot program, and its base frame where the file does not hold it.
    Program {
        dialect: &'static dyn Dialect,
        world_from_base: Isometry3<f64>,
    },
}

/// An arm that is led along a file.
#[derive(Debug, Clone, PartialEq)]
pub struct PathFileMotion {
    pub motion: LedMotion,
    /// Points of the path.
    pub points: usize,
    /// Lines of the file that path points come from; empty of a robot program.
    pub lines: Vec<usize>,
    /// What was left aside.
    pub notes: Vec<String>,
    /// The path as written.
    pub way: Way,
}

/// A path as it is written, point by point.
#[derive(Debug, Clone, PartialEq)]
pub struct Way {
    /// The work frame of a path from CAM, the base frame of a program.
    pub world_from_work: Isometry3<f64>,
    pub points: Vec<WayPoint>,
    /// What a path from CAM says of the spindle.
    pub spindle: Option<SpindleAtCuts>,
}

/// A point of it.
#[derive(Debug, Clone, PartialEq)]
pub struct WayPoint {
    pub work_from_tool: Isometry3<f64>,
    pub posture: Vec<f64>,
    /// Speed on the straight way there; `None`: by joints.
    pub speed_m_per_s: Option<f64>,
    /// Whether the way there is one of rapid traverse, or by joints.
    pub rapid: bool,
    /// Line of the file, of a path from CAM.
    pub line: Option<usize>,
    /// When an arm that is led along the path is there, s.
    pub reached_s: f64,
}

/// What a file holds, before an arm.
struct Read {
    program: Program,
    /// Lines that its points come from, and which points are reached in rapid traverse; empty of a
    /// robot program.
    lines: Vec<usize>,
    rapid: Vec<bool>,
    world_from_work: Isometry3<f64>,
    spindle: Option<SpindleAtCuts>,
}

impl Read {
    /// A path of CAM's, for a tool.
    fn of_cam(
        robot: &Robot,
        start: Start<'_>,
        tool: Tool,
        path: &CamPath,
        file: &Path,
        setup: &WorkSetup,
    ) -> Result<Read, ProgramError> {
        let head = Program {
            name: String::new(),
            comment: String::new(),
            tool,
            world_from_base: Isometry3::identity(),
            moves: Vec::new(),
            spindle: Vec::new(),
            notes: Vec::new(),
        };
        // Lines may be long: what lies between their ends is looked at when it is followed.
        let travel = TravelOptions {
            largest_step: std::f64::consts::PI,
            ..TravelOptions::default()
        };
        let program = cam::follow(start, robot, head, path, file, setup, &travel)?;
        let points = path.points.iter();
        Ok(Read {
            program,
            lines: points.clone().map(|one| one.line).collect(),
            rapid: points.map(|one| one.feed_m_per_s.is_none()).collect(),
            world_from_work: setup.world_from_work,
            spindle: Some(path.spindle_at_cuts()),
        })
    }

    /// An arm led along it: share of the joints' speeds on lines, time between knots, longest time.
    fn led(
        self,
        file: &Path,
        robot: &Robot,
        (joint_share, interval_s, longest_s): (f64, f64, f64),
    ) -> Result<PathFileMotion, ProgramError> {
        let task = LedTask {
            robot,
            program: &self.program,
            joint_share,
            interval_s,
            longest_s,
        };
        let motion = task.solve().map_err(|error| {
            let point = error.kind().path_point();
            let line = point.and_then(|point| self.lines.get(point).copied());
            ProgramError::in_file(file, line, error.into_kind())
        })?;
        let way = self.way(&motion.reached_s);
        let Read { program, lines, .. } = self;
        Ok(PathFileMotion {
            motion,
            points: program.moves.len(),
            lines,
            notes: program.notes,
            way,
        })
    }

    fn way(&self, reached_s: &[f64]) -> Way {
        let program = &self.program;
        let work_from_base = self.world_from_work.inverse() * program.world_from_base;
        let point = |(one, reached_s): (&Move, &f64)| {
            let speed_m_per_s = match one.motion {
                Motion::Linear { speed_m_per_s } => Some(speed_m_per_s),
                Motion::Joint { .. } => None,
            };
            let rapid = self.rapid.get(one.path_point).copied();
            WayPoint {
                work_from_tool: work_from_base * one.base_from_tool,
                posture: one.posture.clone(),
                speed_m_per_s,
                rapid: rapid.unwrap_or(false) || speed_m_per_s.is_none(),
                line: self.lines.get(one.path_point).copied(),
                reached_s: *reached_s,
            }
        };
        Way {
            world_from_work: self.world_from_work,
            points: (program.moves.iter().zip(reached_s)).map(point).collect(),
            spindle: self.spindle.clone(),
        }
    }
}

/// A path that was laid on a part, of the robot's own tool, and how it stands.
#[derive(Debug, Clone, Copy)]
pub struct LaidPath<'a> {
    pub path: &'a CamPath,
    /// The part's file, which errors name.
    pub file: &'a Path,
    pub setup: WorkSetup,
    /// Largest speed of a joint on lines, share of its top speed.
    pub joint_share: f64,
}

impl LaidPath<'_> {
    /// Leads the arm, which has rotary joints only, along it.
    ///
    /// # Errors
    /// With the line of the point that the arm cannot be led to.
    pub fn motion(
        &self,
        robot: &Robot,
        start: Start<'_>,
        interval_s: f64,
        longest_s: f64,
    ) -> Result<PathFileMotion, ProgramError> {
        let tool = Tool::of(robot, "tool", 0);
        let read = Read::of_cam(robot, start, tool, self.path, self.file, &self.setup)?;
        read.led(self.file, robot, (self.joint_share, interval_s, longest_s))
    }
}

impl PathFile {
    /// Reads the file and leads the arm, which has rotary joints only, along it.
    ///
    /// # Errors
    /// With file and line: what is not understood, or where the arm cannot be led.
    pub fn motion(
        &self,
        robot: &Robot,
        start: Start<'_>,
        interval_s: f64,
        longest_s: f64,
    ) -> Result<PathFileMotion, ProgramError> {
        let read = self.read(robot, start)?;
        let times = (self.joint_share, interval_s, longest_s);
        read.led(&self.file, robot, times)
    }

    /// The path as the file has it; `None` of a robot program.
    ///
    /// # Errors
    /// With file and line, what is not understood.
    pub fn cam(&self) -> Result<Option<CamPath>, ProgramError> {
        match &self.kind {
            PathFileKind::Cam { options, .. } => self.read_cam(options).map(Some),
            PathFileKind::Program { .. } => Ok(None),
        }
    }

    fn read_cam(&self, options: &CamOptions) -> Result<CamPath, ProgramError> {
        let file = &self.file;
        let text =
            read_text(file).map_err(|error| ProgramError::in_file(file, None, error.into()))?;
        cam::read(&text, file, options)
    }

    /// The path before an arm.
    fn read(&self, robot: &Robot, start: Start<'_>) -> Result<Read, ProgramError> {
        let file = &self.file;
        let tool = Tool::of(robot, "tool", 0);
        match &self.kind {
            PathFileKind::Cam {
                options,
                setup,
                tool_from_tip,
            } => {
                let path = self.read_cam(options)?;
                check_spin(setup, &path).map_err(|kind| ProgramError::in_file(file, None, kind))?;
                let flange_from_tool = tool.flange_from_tool * tool_from_tip;
                let tool = Tool {
                    flange_from_tool,
                    ..tool
                };
                Read::of_cam(robot, start, tool, &path, file, setup)
            }
            PathFileKind::Program {
                dialect,
                world_from_base,
            } => {
                let frames = Frames {
                    tool: tool.clone(),
                    world_from_base: *world_from_base,
                };
                let text = |path: &Path| read_text(path);
                let settings = Settings::default();
                let mut program = dialect.read(file, &text, robot, &frames, &settings)?;
                if program.moves.is_empty() {
                    let kind = ProgramErrorKind::StandsStill;
                    return Err(ProgramError::in_file(file, None, kind));
                }
                program.notes.extend(other_tool(&program.tool, &tool));
                Ok(Read {
                    world_from_work: program.world_from_base,
                    program,
                    lines: Vec::new(),
                    rapid: Vec::new(),
                    spindle: None,
                })
            }
        }
    }
}

/// Refuses a turn about the tool's axis that would change nothing.
fn check_spin(setup: &WorkSetup, path: &CamPath) -> Result<(), ProgramErrorKind> {
    let Some(spin_rad) = setup.spin_rad.filter(|_| !path.leaves_turn_free()) else {
        return Ok(());
    };
    let rule = "left out: the file gives the whole attitude of the tool at every point";
    let what = "the turn about the tool's axis in deg";
    let deg = format!("{:.3}", spin_rad.to_degrees());
    Err(ProgramErrorKind::value(what, deg, rule))
}

/// A note on a program whose tool is not the robot's.
fn other_tool(programs: &Tool, robots: &Tool) -> Option<String> {
    let (a, b) = (&programs.flange_from_tool, &robots.flange_from_tool);
    let apart_m = (a.translation.vector - b.translation.vector).norm();
    let apart_rad = a.rotation.angle_to(&b.rotation);
    (apart_m > SAME_TOOL || apart_rad > SAME_TOOL).then(|| {
        format!(
            "the program's tool `{}` stands {:.3} mm and {:.3} deg from that of the robot: the flange \
             goes as the program says",
            programs.name,
            apart_m * 1e3,
            apart_rad.to_degrees()
        )
    })
}
