//! A straight path of the tool: its poses, and the postures along it on one branch, within reach
//! and limits, clear of singularities.

use nalgebra::{Isometry3, Translation3, Unit, Vector3};
use truecut_arm::{ArmError, BranchOptions, Elbow, FrameId, Robot, Shoulder, Wrist, tool_pose};

use super::branch::{BranchWish, from_posture_to_posture, on_a_branch, on_the_branch_of};
use super::follow::{FollowError, check_singularities};
use super::interpolation::lagrange;
use super::timing::smooth_between;

/// Knots of a path lie at most this far apart, m. Cubic interpolation between them errs by less
/// than 1e-9 m on the posture changes of a machining path.
const KNOT_SPACING_M: f64 = 2e-3;

/// A straight line of the tool point in the world, which is the frame of the robot's base.
#[derive(Debug, Clone, PartialEq)]
pub struct StraightPath {
    /// Where the line begins and how the tool stands; `None`: at the robot's posture, whose
    /// attitude is kept.
    pub start: Option<PathStart>,
    /// Unit vector along the line.
    pub direction: [f64; 3],
    /// Length of the line.
    pub length_m: f64,
}

/// A path that is given in the world. Of the postures that reach its first pose the one nearest to
/// the robot's posture is taken, among those of the branch asked for.
#[derive(Debug, Clone, PartialEq)]
pub struct PathStart {
    /// First tool point.
    pub point_m: [f64; 3],
    /// Unit vector of the tool's z axis, from the spindle into the workpiece.
    pub tool_axis: [f64; 3],
    /// Direction of the tool's x axis at redundancy angle 0, made square to the tool axis.
    pub zero_direction: [f64; 3],
    /// Redundancy angle along the path: one knot at least, in rising order.
    pub turn: Vec<TurnKnot>,
    /// Side of the shoulder; `None`: either.
    pub shoulder: Option<Shoulder>,
    /// Side of the elbow; `None`: either.
    pub elbow: Option<Elbow>,
    /// Sense of the wrist; `None`: either.
    pub wrist: Option<Wrist>,
}

/// Redundancy angle at a distance from the start of the path.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TurnKnot {
    /// Distance from the start of the path.
    pub at_m: f64,
    /// Redundancy angle.
    pub redundancy_rad: f64,
}

impl PathStart {
    /// Pose of the tool at a distance from the start of the path, along `direction`.
    fn pose(&self, direction: &Vector3<f64>, at_m: f64) -> Result<Isometry3<f64>, ArmError> {
        let point = Vector3::from(self.point_m) + direction * at_m;
        let axis = Unit::new_normalize(Vector3::from(self.tool_axis));
        let zero = Vector3::from(self.zero_direction);
        tool_pose(&point, &axis, &zero, self.redundancy_rad(at_m))
    }

    /// The branch that the path asks for.
    #[must_use]
    pub fn wish(&self) -> BranchWish {
        BranchWish {
            shoulder: self.shoulder,
            elbow: self.elbow,
            wrist: self.wrist,
        }
    }

    /// The first word for a branch that is given.
    fn word(&self) -> Option<&'static str> {
        let given = [
            ("shoulder", self.shoulder.is_some()),
            ("elbow", self.elbow.is_some()),
            ("wrist", self.wrist.is_some()),
        ];
        given
            .into_iter()
            .find_map(|(word, given)| given.then_some(word))
    }

    /// Redundancy angle at a distance from the start of the path: it comes to rest at each knot and
    /// goes from one to the next as 3u² − 2u³, so that joint speeds have no jumps.
    pub fn redundancy_rad(&self, at_m: f64) -> f64 {
        let after = self.turn.partition_point(|knot| knot.at_m <= at_m);
        let knot = |index: usize| self.turn[index.min(self.turn.len() - 1)];
        if after == 0 || after == self.turn.len() {
            return knot(after.saturating_sub(1)).redundancy_rad;
        }
        let (a, b) = (knot(after - 1), knot(after));
        let u = (at_m - a.at_m) / (b.at_m - a.at_m);
        smooth_between(a.redundancy_rad, b.redundancy_rad, u)
    }
}

/// Postures at even distances along a path, the first at its start, the last at its end.
#[derive(Debug, Clone, PartialEq)]
pub struct SolvedPath {
    pub spacing_m: f64,
    pub knots: Vec<Vec<f64>>,
}

impl SolvedPath {
    /// The posture at a distance from the path's start, m, by Lagrange's cubic through four knots.
    #[must_use]
    pub fn posture(&self, at_m: f64) -> Vec<f64> {
        let x = at_m / self.spacing_m;
        let k = (x.floor() as usize).clamp(1, self.knots.len() - 3);
        let joints = 0..self.knots[0].len();
        let value = |joint: usize| {
            let knots = [0, 1, 2, 3].map(|i| self.knots[k + i - 1][joint]);
            lagrange(knots, x - k as f64)[0]
        };
        joints.map(value).collect()
    }
}

/// Why an arm cannot follow a straight path.
#[derive(Debug, thiserror::Error)]
pub enum StraightPathError {
    /// Out of reach, off limits or singular on the way.
    #[error(transparent)]
    Follow(#[from] FollowError),
    /// The tool's axis and its direction at angle 0 make no pose.
    #[error(transparent)]
    Arm(#[from] ArmError),
    /// A word for a branch (its name) where the arm has none.
    #[error("{robot} is no arm of six joints with a spherical wrist")]
    NoBranches { word: &'static str, robot: String },
}

impl StraightPath {
    /// Solves the postures. `posture` is where the robot stands (a path without a start), or what
    /// the first posture is to be near.
    ///
    /// # Errors
    /// Where the path cannot be followed; words for a branch of an arm without branches.
    pub fn solve(&self, robot: &Robot, posture: &[f64]) -> Result<SolvedPath, StraightPathError> {
        let intervals = (self.length_m / KNOT_SPACING_M).ceil().max(3.0);
        let spacing_m = self.length_m / intervals;
        let poses = self.poses(robot, posture, spacing_m, intervals as usize + 1)?;
        let at_mm = |k: usize| spacing_m * k as f64 * 1e3;
        let solver = robot.ik_solver(&BranchOptions::default());
        let knots = match &self.start {
            start if solver.geometry().is_none() => {
                if let Some(word) = start.as_ref().and_then(PathStart::word) {
                    let robot = robot.name.clone();
                    return Err(StraightPathError::NoBranches { word, robot });
                }
                from_posture_to_posture(&solver, posture, &poses, &at_mm)
            }
            None => on_the_branch_of(posture, &solver, &poses, &at_mm),
            Some(start) => on_a_branch(start.wish(), posture, &solver, &poses, &at_mm),
        }?;
        check_singularities(&solver, &knots, &at_mm)?;
        Ok(SolvedPath { spacing_m, knots })
    }

    /// Poses of the tool at the knots, world.
    fn poses(
        &self,
        robot: &Robot,
        posture: &[f64],
        spacing_m: f64,
        count: usize,
    ) -> Result<Vec<Isometry3<f64>>, ArmError> {
        let direction = Vector3::from(self.direction);
        let here = robot.world_from_frame(posture, FrameId::Tool);
        let pose = |k: usize| {
            let at_m = spacing_m * k as f64;
            match &self.start {
                None => Ok(Translation3::from(direction * at_m) * here),
                Some(start) => start.pose(&direction, at_m),
            }
        };
        (0..count).map(pose).collect()
    }
}
