//! Motions that are solved as a whole before the run.

pub(crate) mod belt;
pub(crate) mod brush;
pub(crate) mod edges;
pub(crate) mod path_file;
pub(crate) mod polish;
pub(crate) mod solve;
pub(crate) mod straight;
pub(crate) mod surface_polish;

use crate::command::Samples;
use crate::error::SimError;
use crate::process::{Passes, Station};
use nalgebra::{Isometry3, Vector3};
use std::sync::Arc;
use truecut_arm::{Load, Robot};
use truecut_plan::motion::lines::CopyAt;
use truecut_plan::path_file::Way;
use truecut_plan::surface::{Mesh, PatchFile};

/// Time between knots of the command, s.
pub(crate) const KNOT_INTERVAL_S: f64 = 5e-3;

/// A motion of the arm.
#[derive(Debug)]
pub(crate) struct PlannedMotion {
    /// Postures every [`KNOT_INTERVAL_S`], from the start on.
    pub knots: Vec<Vec<f64>>,
    pub duration_s: f64,
    /// What there is to tell of it, for people.
    pub note: Option<String>,
    pub target: Target,
}

/// What a motion was solved over, for the process that goes along it.
#[derive(Debug)]
pub(crate) enum Target {
    /// A face that the scenario gives whole.
    Face,
    /// The lines of a path job.
    Lines(BeltLines),
    /// A workpiece and its edges.
    Edges(BrushWork),
    /// A freeform face that is polished.
    Polished(PolishedFace),
    /// Nothing but the path as it is written.
    Way(Way),
    /// Nothing: the tool is free.
    Nothing,
}

/// What a belt follows, and where.
#[derive(Debug)]
pub(crate) struct BeltLines {
    pub patch: Arc<PatchFile>,
    /// Where the wheel touches it.
    pub passes: Passes,
    /// The copies, in the order in which they are finished.
    pub copies: Vec<CopyAt>,
}

/// What a wheel polishes.
#[derive(Debug)]
pub(crate) struct PolishedFace {
    pub patch: Arc<PatchFile>,
    /// The part that it is of, as far as that is known.
    pub body: Arc<Mesh>,
    /// Outward normal where the first line begins, in the patch's frame.
    pub first_normal: Vector3<f64>,
}

/// What a brush works on.
#[derive(Debug)]
pub(crate) struct BrushWork {
    pub mesh: Arc<Mesh>,
    pub world_from_mesh: Isometry3<f64>,
    /// Places on the edges, in the mesh's frame, edge after edge.
    pub stations: Vec<Station>,
}

impl PlannedMotion {
    /// The command that leads a nominal arm along, with the sag that it makes up for.
    pub(crate) fn command(&self, robot: &Robot, sag: Option<&Load>) -> Result<Samples, SimError> {
        let postures = match sag {
            Some(load) => robot.holding_commands(&self.knots, load)?,
            None => self.knots.clone(),
        };
        let forces = vec![None; robot.dof()];
        Ok(Samples::new(KNOT_INTERVAL_S, postures, forces))
    }
}
