//! A way that a scenario lays on its part, along edges or over a face, for a run and for a robot
//! program.

use super::brush;
use super::path_file::StartNear;
use super::surface_polish;
use crate::error::SimError;
use nalgebra::{Isometry3, Vector3};
use std::sync::Arc;
use truecut_arm::Robot;
use truecut_plan::cam::{CamPath, Rapid, WorkSetup};
use truecut_plan::clearance::Solid;
use truecut_plan::edge_path::EdgePathError;
use truecut_plan::surface::{EdgeChain, Mesh};
use truecut_scenario::{AlongEdges, BrushSpec, BrushWay, ProcessSpec, Scenario};

/// The way along picked edges.
pub(super) fn laid(along: &AlongEdges, chains: &[EdgeChain]) -> Result<CamPath, SimError> {
    along.laying.path(chains).map_err(|(edge, error)| {
        let key = match error {
            EdgePathError::NoSide { .. } => "process.brush.along.tilt_towards".to_owned(),
            EdgePathError::ShorterThanLead { .. } => "process.brush.along.lead_mm".to_owned(),
            EdgePathError::TooMany { .. } => "process.brush.along.step_mm".to_owned(),
        };
        SimError::scenario(key, format!("edge {}: {error}", edge + 1))
    })
}

/// A way that a scenario lays on its part, before its arm.
#[derive(Debug)]
pub struct LaidWay {
    /// In the part's frame; the line of a point is the number of its edge, or of its piece of a
    /// line over a face, from 1.
    pub path: CamPath,
    /// What such a one is called.
    pub line_word: &'static str,
    /// How it stands.
    pub setup: WorkSetup,
    /// The posture that it shall begin near to, where the scenario gives one, of all joints.
    pub near: Option<Vec<f64>>,
    /// Where slides stand, in chain order, m.
    pub slides_m: Vec<f64>,
    /// The part.
    pub part: Arc<Mesh>,
    pub world_from_part: Isometry3<f64>,
    /// What works on it.
    pub tool: LaidTool,
    /// What there is to tell of the arm led along it.
    pub note: Option<String>,
}

/// The tool of a way at its size.
#[derive(Debug)]
pub struct LaidTool {
    pub name: &'static str,
    pub solid: Solid,
    pub tool_from_solid: Isometry3<f64>,
}

/// The way that a scenario lays on its part, for a robot program; `None` where it lays none. The
/// arm is led along it as in a run, so that what a run refuses is refused here.
///
/// # Errors
/// At the key of the scenario that caused it.
pub fn laid_way(scenario: &Scenario, robot: &Robot) -> Result<Option<LaidWay>, SimError> {
    let start = StartNear::of(&scenario.robot, robot)?;
    let spec = match &scenario.process {
        ProcessSpec::Brush(spec) => spec,
        ProcessSpec::SurfacePolish(spec) => {
            return surface_polish::way(spec, robot, start).map(Some);
        }
        _ => return Ok(None),
    };
    let BrushWay::Along(along) = &spec.way else {
        return Ok(None);
    };
    let motion = brush::solve(spec, robot, &start)?;
    let (work, chains) = brush::work(spec)?;
    Ok(Some(LaidWay {
        path: laid(along, &chains)?,
        setup: work_setup(spec, along),
        slides_m: robot.slides().map(|at| start.posture[at]).collect(),
        near: start.is_given.then_some(start.posture),
        part: work.mesh,
        world_from_part: spec.world_from_mesh,
        tool: LaidTool {
            name: "brush",
            solid: Solid::Cylinder {
                radius_m: spec.brush.radius_m,
                length_m: spec.brush.width_m,
            },
            // A cylinder's axis is its z, the brush's is the tool's y.
            tool_from_solid: Isometry3::rotation(Vector3::x() * std::f64::consts::FRAC_PI_2),
        },
        line_word: "edge",
        note: motion.note,
    }))
}

/// How a way along edges stands before the arm.
pub(super) fn work_setup(spec: &BrushSpec, along: &AlongEdges) -> WorkSetup {
    WorkSetup {
        world_from_work: spec.world_from_mesh,
        spin_rad: None,
        rapid: Rapid::Joints,
        joint_share: along.joint_share,
        zone_m: None,
    }
}
