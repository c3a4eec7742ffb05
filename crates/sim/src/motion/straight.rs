//! The postures along a straight path of the tool: inverse kinematics on one branch, reach, limits, singularities.

use crate::error::SimError;
use nalgebra::{Isometry3, Translation3, Unit, Vector3};
use truecut_arm::{BranchOptions, FrameId, Robot, tool_pose};
use truecut_plan::motion::branch::{
    BranchWish, from_posture_to_posture, on_a_branch, on_the_branch_of,
};
use truecut_plan::motion::follow::{FollowError, check_singularities};
use truecut_scenario::{MillingPathSpec, PathStart};

const PATH: &str = "process.milling.path";
/// Knots of a path lie at most this far apart, m. Cubic interpolation between them errs by less than 1e-9 m on the
/// posture changes of a machining path.
const KNOT_SPACING_M: f64 = 2e-3;

/// Postures at even distances along a path, the first at its start, the last at its end.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct SolvedPath {
    pub spacing_m: f64,
    pub knots: Vec<Vec<f64>>,
}

impl SolvedPath {
    /// Solves the postures of a path. `posture` is where the robot stands (a path without a start), or what the first posture is
    /// to be near.
    pub(crate) fn solve(
        spec: &MillingPathSpec,
        robot: &Robot,
        posture: &[f64],
    ) -> Result<Self, SimError> {
        let intervals = (spec.length_m / KNOT_SPACING_M).ceil().max(3.0);
        let spacing_m = spec.length_m / intervals;
        let poses = poses(spec, robot, posture, spacing_m, intervals as usize + 1)?;
        let at_mm = |k: usize| spacing_m * k as f64 * 1e3;
        let refused = |error: FollowError| SimError::scenario(PATH, error.to_string());
        let solver = robot.ik_solver(&BranchOptions::default());
        let knots = match &spec.start {
            _ if solver.geometry().is_none() => {
                check_no_branch(spec, robot)?;
                from_posture_to_posture(robot, posture, &poses, &at_mm)
            }
            None => on_the_branch_of(posture, &solver, &poses, &at_mm),
            Some(start) => on_a_branch(wish(start), posture, &solver, &poses, &at_mm),
        };
        let knots = knots.map_err(refused)?;
        check_singularities(&solver, &knots, &at_mm).map_err(refused)?;
        Ok(Self { spacing_m, knots })
    }
}

/// Poses of the tool at the knots, world.
fn poses(
    spec: &MillingPathSpec,
    robot: &Robot,
    posture: &[f64],
    spacing_m: f64,
    count: usize,
) -> Result<Vec<Isometry3<f64>>, SimError> {
    let direction = Vector3::from(spec.direction);
    let here = robot.world_from_frame(posture, FrameId::Tool);
    (0..count)
        .map(|k| {
            let at_m = spacing_m * k as f64;
            let Some(start) = &spec.start else {
                return Ok(Translation3::from(direction * at_m) * here);
            };
            let point = Vector3::from(start.point_m) + direction * at_m;
            let axis = Unit::new_normalize(Vector3::from(start.tool_axis));
            let zero = Vector3::from(start.zero_direction);
            Ok(tool_pose(&point, &axis, &zero, start.redundancy_rad(at_m))?)
        })
        .collect()
}

/// The branch that a scenario asks for.
fn wish(start: &PathStart) -> BranchWish {
    BranchWish {
        shoulder: start.shoulder,
        elbow: start.elbow,
        wrist: start.wrist,
    }
}

/// Refuses words for a branch where the arm has no branches with names.
fn check_no_branch(spec: &MillingPathSpec, robot: &Robot) -> Result<(), SimError> {
    let Some(start) = &spec.start else {
        return Ok(());
    };
    let given = [
        ("shoulder", start.shoulder.is_some()),
        ("elbow", start.elbow.is_some()),
        ("wrist", start.wrist.is_some()),
    ];
    match given.into_iter().find(|(_, given)| *given) {
        None => Ok(()),
        Some((key, _)) => Err(SimError::scenario(
            format!("{PATH}.{key}"),
            format!(
                "`{PATH}.{key}` has no effect: {} is no arm of six joints with a spherical wrist",
                robot.name
            ),
        )),
    }
}
