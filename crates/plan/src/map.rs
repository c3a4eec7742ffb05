//! Stiffness and stability over joints 2 and 3, for a tool axis that keeps its direction in the
//! world.
//!
//! Joint 1 turns the whole picture about the vertical, and the wrist holds the tool axis; what is
//! left of a posture's influence on the stiffness at the tool is mostly joints 2 and 3 (a patent of
//! 2022 draws its map of r over them).

use nalgebra::{Isometry3, Matrix3, Translation3, Unit, Vector3};
use rayon::prelude::*;
use truecut_arm::{BranchOptions, FrameId, IkSolver, OpwGeometry, Robot, tool_pose};

use crate::assess::assess;
use crate::assessment::LEAST_DECAY;
use crate::criterion::{Criterion, Cut};
use crate::error::PlanError;
use crate::singularity::SingularityLimits;
use crate::tool_path::ToolPath;

/// The three directions of the tool axis for which maps are drawn, world frame: down, along x,
/// along y.
#[must_use]
pub fn axis_directions() -> [Unit<Vector3<f64>>; 3] {
    [-Vector3::z_axis(), Vector3::x_axis(), Vector3::y_axis()]
}

/// What is held while joints 2 and 3 vary.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MapRequest {
    /// Coordinate of joint 1, rad.
    pub joint_1_rad: f64,
    pub tool_axis: Unit<Vector3<f64>>,
    /// The tool's x axis at redundancy angle 0, world; it must not lie along the tool axis.
    pub zero_direction: Vector3<f64>,
    pub redundancy_angle_rad: f64,
    /// Direction of the feed across the tool axis, world.
    pub feed: Vector3<f64>,
    pub singularity: SingularityLimits,
}

/// One posture of a map.
#[derive(Debug, Clone, PartialEq)]
pub struct MapCell {
    pub posture: Vec<f64>,
    /// r = (k_max − k_min)/k_max in the cutting plane, by the physical definition.
    pub anisotropy: f64,
    /// Limit of mode coupling with all modes, m; infinite if no depth is unstable.
    pub limit_depth_m: f64,
}

/// Values over joints 2 and 3.
#[derive(Debug, Clone, PartialEq)]
pub struct JointMap {
    pub request: MapRequest,
    pub joint_2_rad: Vec<f64>,
    pub joint_3_rad: Vec<f64>,
    /// By joint 2, then joint 3; none where the wrist cannot hold the tool axis within its limits,
    /// or near a singularity.
    pub cells: Vec<Vec<Option<MapCell>>>,
}

/// The map over the joints' ranges in steps of about `step_rad`.
///
/// # Errors
/// If the arm is not ortho-parallel, or the zero direction or the feed lies along the tool axis.
pub fn joint_map(
    robot: &Robot,
    cut: &Cut,
    request: &MapRequest,
    step_rad: f64,
) -> Result<JointMap, PlanError> {
    let cells = MapCells::new(robot, cut, request)?;
    let [joint_2_rad, joint_3_rad] = [1, 2].map(|joint| range(robot, joint, step_rad));
    let row = |q2: &f64| joint_3_rad.iter().map(|q3| cells.cell(*q2, *q3)).collect();
    let cells: Result<_, PlanError> = joint_2_rad.par_iter().map(row).collect();
    Ok(JointMap {
        request: *request,
        cells: cells?,
        joint_2_rad,
        joint_3_rad,
    })
}

/// Cells of a map, one by one.
pub struct MapCells<'a> {
    wrist: Wrist<'a>,
    cut: &'a Cut,
    world_from_milling: Matrix3<f64>,
}

impl<'a> MapCells<'a> {
    /// # Errors
    /// As [`joint_map`].
    pub fn new(robot: &'a Robot, cut: &'a Cut, request: &MapRequest) -> Result<Self, PlanError> {
        let solver = robot.ik_solver(&BranchOptions::default());
        let geometry = *solver.geometry().ok_or(PlanError::NotOrthoParallel)?;
        // The path serves for its axes and their checks only.
        let feed = request.feed.normalize();
        let path = ToolPath::new(
            &[Vector3::zeros(), feed],
            request.tool_axis,
            request.zero_direction,
        )?;
        Ok(Self {
            wrist: Wrist::new(robot, solver, geometry, request)?,
            cut,
            world_from_milling: path.world_from_milling(0),
        })
    }

    /// The cell at two joint coordinates, rad; none where the tool axis cannot be held.
    ///
    /// # Errors
    /// If the arm has no compliance or modes.
    pub fn cell(&self, q2: f64, q3: f64) -> Result<Option<MapCell>, PlanError> {
        let Some(posture) = self.wrist.posture(q2, q3) else {
            return Ok(None);
        };
        let value = |criterion| {
            let (robot, frame) = (self.wrist.robot, &self.world_from_milling);
            let found = assess(criterion, robot, &posture, frame, self.cut, LEAST_DECAY);
            found.map(|assessment| assessment.value)
        };
        Ok(Some(MapCell {
            anisotropy: value(Criterion::Anisotropy)?,
            limit_depth_m: value(Criterion::ModeCoupling)?,
            posture,
        }))
    }
}

/// Values from the lower to the upper limit of a joint, by a hair within so that rounding does not
/// break them; a full turn where it has none.
fn range(robot: &Robot, joint: usize, step_rad: f64) -> Vec<f64> {
    use std::f64::consts::PI;
    let limits = robot.chain.joints[joint].limits;
    let (low, high) = limits.map_or((-PI, PI), |l| (l.lower.max(-PI), l.upper.min(PI)));
    let (low, high) = (low + 1e-6, high - 1e-6);
    let count = ((high - low) / step_rad).round().max(1.0) as usize;
    let at = |i: usize| low + (high - low) * i as f64 / count as f64;
    (0..=count).map(at).collect()
}

/// Turns the wrist so that the tool keeps its orientation.
struct Wrist<'a> {
    robot: &'a Robot,
    solver: IkSolver<'a>,
    geometry: OpwGeometry,
    request: MapRequest,
    /// Orientation of the tool, at the origin.
    world_from_tool: Isometry3<f64>,
    /// Wrist centre in the last link and in the tool.
    last_from_centre_m: Vector3<f64>,
    tool_from_centre_m: Vector3<f64>,
}

impl<'a> Wrist<'a> {
    fn new(
        robot: &'a Robot,
        solver: IkSolver<'a>,
        geometry: OpwGeometry,
        request: &MapRequest,
    ) -> Result<Self, PlanError> {
        let world_from_tool = tool_pose(
            &Vector3::zeros(),
            &request.tool_axis,
            &request.zero_direction,
            request.redundancy_angle_rad,
        )?;
        let last_from_wrist = geometry.wrist_from_last_link.inverse();
        let last_from_centre_m = last_from_wrist.translation.vector;
        let zero = [0.0; 6];
        let tool = robot.world_from_frame(&zero, FrameId::Tool);
        let last = robot.world_from_links(&zero)[5];
        let centre = (tool.inverse() * last) * nalgebra::Point3::from(last_from_centre_m);
        Ok(Self {
            robot,
            solver,
            geometry,
            request: *request,
            world_from_tool,
            last_from_centre_m,
            tool_from_centre_m: centre.coords,
        })
    }

    /// The posture within limits that holds the tool axis with joints 2 and 3 as given; of two
    /// wrists the one that is less turned. None if there is none, or it is too near to a
    /// singularity.
    fn posture(&self, q2: f64, q3: f64) -> Option<Vec<f64>> {
        let q1 = self.request.joint_1_rad;
        let links = self.robot.world_from_links(&[q1, q2, q3, 0.0, 0.0, 0.0]);
        let centre = links[5] * nalgebra::Point3::from(self.last_from_centre_m);
        let rotation = self.world_from_tool.rotation;
        let tip = centre.coords - rotation * self.tool_from_centre_m;
        let pose = Isometry3::from_parts(Translation3::from(tip), rotation);
        let asked = [q1, q2, q3];
        let is_asked = |q: &Vec<f64>| q.iter().zip(asked).all(|(a, b)| (a - b).abs() < 1e-6);
        let limits = &self.request.singularity;
        let is_clear = |q: &Vec<f64>| limits.allow(&self.geometry.singularity_distance(q));
        let postures = self.solver.within_limits(&pose, FrameId::Tool).into_iter();
        let postures = postures.filter(|q| is_asked(q) && is_clear(q));
        let turned = |q: &Vec<f64>| q[3..].iter().map(|a| a * a).sum::<f64>();
        postures.min_by(|a, b| turned(a).total_cmp(&turned(b)))
    }
}
