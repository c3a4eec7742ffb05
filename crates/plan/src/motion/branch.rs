//! Postures along given poses: on one branch of an arm with a closed form, or from posture to
//! posture.

use nalgebra::Isometry3;
use truecut_arm::{ArmBranch, Elbow, FrameId, IkOptions, IkSolver, PathOptions, Shoulder, Wrist};

use super::follow::{AtMm, FollowError, leaves};

/// The branch on which a path shall be followed; `None`: either.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct BranchWish {
    pub shoulder: Option<Shoulder>,
    pub elbow: Option<Elbow>,
    pub wrist: Option<Wrist>,
}

impl BranchWish {
    /// Whether a branch is one of those wished for.
    #[must_use]
    pub fn allows(&self, branch: ArmBranch) -> bool {
        self.shoulder.is_none_or(|side| side == branch.shoulder)
            && self.elbow.is_none_or(|side| side == branch.elbow)
            && self.wrist.is_none_or(|sense| sense == branch.wrist)
    }

    fn is_of(&self, solver: &IkSolver<'_>, q: &[f64]) -> bool {
        let geometry = solver.geometry();
        geometry.is_some_and(|geometry| self.allows(geometry.branch(q)))
    }
}

/// Postures along poses on the branch of `posture`.
///
/// # Errors
/// Where the path cannot be followed.
pub fn on_the_branch_of(
    posture: &[f64],
    solver: &IkSolver<'_>,
    poses: &[Isometry3<f64>],
    at_mm: &AtMm<'_>,
) -> Result<Vec<Vec<f64>>, FollowError> {
    let followed = solver.follow(poses, FrameId::Tool, posture, &PathOptions::default());
    followed.map_err(|error| leaves(error.kind(), at_mm).1)
}

/// Postures along poses over all branches asked for: from the start nearest to `posture` from which
/// the path can be followed to its end.
///
/// # Errors
/// If no posture of the branch reaches the start; else where the start that gets furthest fails.
pub fn on_a_branch(
    wish: BranchWish,
    posture: &[f64],
    solver: &IkSolver<'_>,
    poses: &[Isometry3<f64>],
    at_mm: &AtMm<'_>,
) -> Result<Vec<Vec<f64>>, FollowError> {
    let mut starts = solver.within_limits(&poses[0], FrameId::Tool);
    if starts.is_empty() {
        // Following from anywhere says why.
        return on_the_branch_of(posture, solver, poses, at_mm);
    }
    let reached = starts.len();
    starts.retain(|q| wish.is_of(solver, q));
    if starts.is_empty() {
        return Err(FollowError::NoBranch { reached });
    }
    let distance = |q: &[f64]| {
        q.iter()
            .zip(posture)
            .map(|(a, b)| (a - b).powi(2))
            .sum::<f64>()
    };
    starts.sort_by(|a, b| distance(a).total_cmp(&distance(b)));
    let mut furthest: Option<(usize, FollowError)> = None;
    for start in &starts {
        match solver.follow(poses, FrameId::Tool, start, &PathOptions::default()) {
            Ok(knots) => return Ok(knots),
            Err(error) => {
                let (index, error) = leaves(error.kind(), at_mm);
                if furthest.as_ref().is_none_or(|(best, _)| index > *best) {
                    furthest = Some((index, error));
                }
            }
        }
    }
    Err(furthest.map_or(FollowError::NoStart, |(_, error)| error))
}

/// Postures along poses of an arm without a closed form: each from the one before, the first from
/// `posture`. Where that leads beyond limits, or the path cannot be followed from there, from the
/// nearest posture within limits from which it can.
///
/// # Errors
/// If no posture reaches the start; else where the start that gets furthest fails.
pub fn from_posture_to_posture(
    solver: &IkSolver<'_>,
    posture: &[f64],
    poses: &[Isometry3<f64>],
    at_mm: &AtMm<'_>,
) -> Result<Vec<Vec<f64>>, FollowError> {
    let robot = solver.robot();
    let led = robot.inverse_kinematics(&poses[0], FrameId::Tool, posture, &IkOptions::default());
    let mut furthest: Option<(usize, FollowError)> = None;
    let mut follow = |start: &[f64]| {
        let followed = solver.follow(poses, FrameId::Tool, start, &PathOptions::default());
        let failed = match followed {
            Ok(knots) => return Some(knots),
            Err(error) => leaves(error.kind(), at_mm),
        };
        if furthest.as_ref().is_none_or(|(best, _)| failed.0 > *best) {
            furthest = Some(failed);
        }
        None
    };
    let unreached = match led {
        Ok(start) => {
            if let Some(knots) = follow(&start) {
                return Ok(knots);
            }
            None
        }
        Err(error) => Some(error),
    };
    let starts = solver.starts_near(&poses[0], FrameId::Tool, posture);
    if let Some(knots) = starts.iter().find_map(|start| follow(start)) {
        return Ok(knots);
    }
    Err(match (furthest, unreached) {
        (Some((_, error)), _) => error,
        (None, Some(error)) => FollowError::Unreachable {
            at_mm: at_mm(0),
            reason: error.to_string(),
        },
        (None, None) => FollowError::NoStart,
    })
}
