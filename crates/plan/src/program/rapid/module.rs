//! A module as its file says it, and the program that it makes a robot run.

use std::collections::BTreeMap;
use std::path::PathBuf;

use nalgebra::{Isometry3, Vector3};
use truecut_arm::Robot;

use super::{Confdata, RapidOptions};
use crate::program::flags::Resolver;
use crate::program::travel::rated_chain;
use crate::program::{Motion, Move, Program, ProgramError, Tool};

/// A position with its configuration.
#[derive(Debug, Clone, PartialEq)]
pub struct RobTarget {
    pub line: usize,
    pub base_from_tool: Isometry3<f64>,
    pub confdata: Confdata,
    /// External axis a, deg; `None` if unused.
    pub turntable_deg: Option<f64>,
}

/// A move to a target.
#[derive(Debug, Clone, PartialEq)]
pub struct RapidMove {
    pub line: usize,
    pub linear: bool,
    pub target: String,
    pub speed: String,
    pub zone: String,
}

/// A module of one tool, one work object, and one procedure.
#[derive(Debug, Clone, PartialEq)]
pub struct RapidModule {
    pub path: PathBuf,
    pub name: String,
    pub tool_name: String,
    pub flange_from_tool: Isometry3<f64>,
    pub tool_mass_kg: f64,
    pub tool_centre_m: Vector3<f64>,
    pub base_name: String,
    pub world_from_base: Isometry3<f64>,
    /// Speed of the tool point by name, m/s, with the line.
    pub speeds: BTreeMap<String, (f64, usize)>,
    pub targets: BTreeMap<String, RobTarget>,
    pub moves: Vec<RapidMove>,
}

impl RapidModule {
    /// The program that the module makes a robot run. Targets named `p` and a number are the path
    /// points of that number; if one is not, moves are counted.
    ///
    /// # Errors
    /// With the target's line, if no posture reaches its pose in its configuration.
    pub fn program(&self, robot: &Robot, options: &RapidOptions) -> Result<Program, ProgramError> {
        let mut program = Program {
            name: self.name.clone(),
            comment: String::new(),
            tool: Tool {
                name: self.tool_name.clone(),
                number: 0,
                flange_from_tool: self.flange_from_tool,
                mass_kg: self.tool_mass_kg,
                centre_m: self.tool_centre_m,
            },
            world_from_base: self.world_from_base,
            moves: Vec::with_capacity(self.moves.len()),
        };
        let resolver = Resolver::new(robot)?;
        let points = self.path_points();
        let mut columns = Vec::with_capacity(self.moves.len());
        for (i, step) in self.moves.iter().enumerate() {
            let target = &self.targets[&step.target];
            let flange = program.world_from_flange(&target.base_from_tool);
            let found = resolver.postures(points[i], &flange, &target.confdata);
            let found =
                found.map_err(|kind| ProgramError::in_file(&self.path, target.line, kind))?;
            columns.push(found);
            let (speed_m_per_s, _) = self.speeds[&step.speed];
            program.moves.push(Move {
                path_point: points[i],
                base_from_tool: target.base_from_tool,
                motion: if step.linear {
                    Motion::Linear { speed_m_per_s }
                } else {
                    let share = speed_m_per_s / options.joint_top_m_per_s;
                    Motion::Joint { share }
                },
                turntable_rad: target.turntable_deg.map(f64::to_radians),
                posture: Vec::new(),
            });
        }
        for (step, posture) in program.moves.iter_mut().zip(rated_chain(&columns)) {
            step.posture = posture;
        }
        Ok(program)
    }

    fn path_points(&self) -> Vec<usize> {
        let numbers = self
            .moves
            .iter()
            .map(|step| step.target.strip_prefix('p')?.parse().ok());
        let named: Option<Vec<usize>> = numbers.collect();
        named.unwrap_or_else(|| (0..self.moves.len()).collect())
    }
}
