//! How a path becomes a robot program.

use nalgebra::Isometry3;
use truecut_arm::Robot;

use super::dialect::{Dialect, Settings};
use super::error::OptionFault;
use super::moves::Program;

/// How a path becomes a robot program: `[program]` of a path job.
#[derive(Debug, Clone)]
pub struct ProgramSetup {
    /// Name of the program, and of its file.
    pub name: String,
    /// A remark in its head.
    pub comment: String,
    /// The language.
    pub dialect: &'static dyn Dialect,
    /// What the dialect needs beside the program.
    pub settings: Settings,
    /// Speed of moves by joints, share of the top speed.
    pub joint_share: f64,
    /// Largest motion of one joint from point to point on a line, rad.
    pub largest_step_rad: f64,
    /// Where the controller's base frame stands in the world.
    pub world_from_base: Isometry3<f64>,
}

impl ProgramSetup {
    /// The program without moves.
    ///
    /// # Errors
    /// If the dialect cannot take its options.
    pub fn head(&self, robot: &Robot) -> Result<Program, OptionFault> {
        Ok(Program {
            name: self.name.clone(),
            comment: self.comment.clone(),
            tool: self.dialect.tool(robot, &self.settings.options)?,
            world_from_base: self.world_from_base,
            moves: Vec::new(),
            spindle: Vec::new(),
            notes: Vec::new(),
        })
    }
}
