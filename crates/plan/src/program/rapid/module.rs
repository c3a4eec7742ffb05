//! A module as its file says it, and the program that it makes a robot run.

use std::path::PathBuf;

use nalgebra::Isometry3;
use truecut_arm::{Robot, ToolLoad};

use super::{Confdata, NO_LOAD_KG, RapidOptions};
use crate::program::flags::Flags;
use crate::program::reading::{Goal, Step, follow};
use crate::program::{Motion, Program, ProgramError, SpindleSwitch, Tool, Zone};

/// Where a move goes.
#[derive(Debug, Clone, PartialEq)]
pub enum RapidGoal {
    /// Pose in the work object, and the configuration unless its supervision is switched off.
    Target {
        base_from_tool: Isometry3<f64>,
        confdata: Option<Confdata>,
    },
    /// Joints, deg.
    Joints([f64; 6]),
}

/// A move, its data looked up.
#[derive(Debug, Clone, PartialEq)]
pub struct RapidMove {
    pub line: usize,
    /// Name of the target, if it has one.
    pub target: String,
    pub goal: RapidGoal,
    /// Point on the way of a circle.
    pub via: Option<Isometry3<f64>>,
    pub linear: bool,
    /// Of the tool point.
    pub speed_m_per_s: f64,
    pub zone: Zone,
    /// External axis a, deg; `None` if unused.
    pub turntable_deg: Option<f64>,
}

/// A module run through from `main`, or from its first procedure.
#[derive(Debug, Clone, PartialEq)]
pub struct RapidModule {
    pub path: PathBuf,
    pub name: String,
    pub tool_name: String,
    pub flange_from_tool: Isometry3<f64>,
    pub tool_load: Option<ToolLoad>,
    /// The work object of the first move.
    pub world_from_base: Isometry3<f64>,
    pub moves: Vec<RapidMove>,
    /// Digital outputs set: before which move, name, value.
    pub outputs: Vec<(usize, String, bool)>,
    /// What was left aside, with lines.
    pub notes: Vec<String>,
}

impl RapidModule {
    /// The program that the module makes a robot run. Targets named `p` and a number are the path
    /// points of that number; if one is not, moves are counted.
    ///
    /// # Errors
    /// With the move's line, if no posture reaches its pose in its configuration.
    pub fn program(&self, robot: &Robot, options: &RapidOptions) -> Result<Program, ProgramError> {
        let spindle = self.outputs.iter();
        let spindle = spindle.filter(|(_, name, _)| Some(name) == options.spindle_signal.as_ref());
        let others = self.outputs.len() - spindle.clone().count();
        let mut notes = self.notes.clone();
        if others > 0 {
            notes.push(format!(
                "{others} digital outputs are set that are not the spindle's; they are left aside"
            ));
        }
        let turned = |step: &&RapidMove| step.turntable_deg.is_some_and(|deg| deg != 0.0);
        if let Some(step) = self.moves.iter().find(turned) {
            notes.push(format!(
                "line {}: eax_a is read as a turntable in degrees; a track in mm is not read",
                step.line
            ));
        }
        let head = Program {
            name: self.name.clone(),
            comment: String::new(),
            tool: Tool {
                name: self.tool_name.clone(),
                number: 0,
                flange_from_tool: self.flange_from_tool,
                load: self.tool_load.filter(|load| load.mass_kg > NO_LOAD_KG),
            },
            world_from_base: self.world_from_base,
            moves: Vec::with_capacity(self.moves.len()),
            spindle: spindle
                .map(|(before, _, on)| SpindleSwitch {
                    before: *before,
                    on: *on,
                })
                .collect(),
            notes,
        };
        let steps = self.moves.iter().map(|step| Step {
            line: step.line,
            path_point: step.target.strip_prefix('p').and_then(|n| n.parse().ok()),
            goal: match &step.goal {
                RapidGoal::Joints(deg) => {
                    Goal::Joints(deg.iter().map(|joint| joint.to_radians()).collect())
                }
                RapidGoal::Target {
                    base_from_tool,
                    confdata,
                } => {
                    let flags = confdata.map(|conf| Box::new(conf) as Box<dyn Flags>);
                    Goal::Pose(*base_from_tool, flags)
                }
            },
            via: step.via,
            with_tangent: false,
            motion: if step.linear {
                Motion::Linear {
                    speed_m_per_s: step.speed_m_per_s,
                }
            } else {
                // A speed above that of all joints at full speed is full speed.
                let share = (step.speed_m_per_s / options.joint_top_m_per_s).min(1.0);
                Motion::Joint { share }
            },
            zone: step.zone,
            turntable_rad: step.turntable_deg.map(f64::to_radians),
        });
        follow(head, steps.collect(), robot, &self.path)
    }
}
