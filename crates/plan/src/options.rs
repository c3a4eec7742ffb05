//! How a plan of postures is looked for.

use crate::assessment::LEAST_DECAY;
use crate::motion::branch::BranchWish;
use crate::singularity::SingularityLimits;

/// How a plan is looked for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlannerOptions {
    /// Step of the redundancy angle; a stable interval narrower than it may be missed.
    pub angle_step_rad: f64,
    /// Longest segment to begin with, m.
    pub segment_m: f64,
    /// How often a segment may be halved.
    pub halvings: u32,
    /// Largest shift of an end of the stable interval from one segment to the next.
    pub end_shift_rad: f64,
    /// Least decay by regeneration at the cut's depth, as a part of that of the arm's slowest
    /// decaying mode; from 0 to less than 1. See [`LEAST_DECAY`].
    pub least_decay: f64,
    pub singularity: SingularityLimits,
    /// Branches that are allowed.
    pub branch: BranchWish,
    /// Of equal joint paths (wrists, whole turns) the one that starts nearest to this posture is
    /// taken.
    pub near: [f64; 6],
}

impl Default for PlannerOptions {
    fn default() -> Self {
        Self {
            angle_step_rad: 4_f64.to_radians(),
            segment_m: 0.05,
            halvings: 3,
            end_shift_rad: 10_f64.to_radians(),
            least_decay: LEAST_DECAY,
            singularity: SingularityLimits::default(),
            branch: BranchWish::default(),
            near: [0.0; 6],
        }
    }
}
