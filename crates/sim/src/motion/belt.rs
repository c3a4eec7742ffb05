//! The motion of a belt's contact wheel over the face of its path job.

use super::{BeltLines, KNOT_INTERVAL_S, PlannedMotion, Target};
use crate::error::SimError;
use std::sync::Arc;
use truecut_arm::Robot;
use truecut_plan::motion::lines::{LinesError, LinesTask};
use truecut_scenario::{BeltJob, BeltSpec, LONGEST_S};

/// The motion of a belt's wheel along the lines of its job; `posture` is where the arm comes from.
pub(crate) fn solve(
    spec: &BeltSpec,
    robot: &Robot,
    posture: &[f64],
) -> Result<PlannedMotion, SimError> {
    let job = &spec.job;
    let task = LinesTask {
        surface: &job.surface,
        wheel: &job.wheel,
        path: &job.path,
        symmetry: job.symmetry.as_ref(),
        copies: spec.copies,
        joint_share: job.joint_share,
        largest_step_rad: job.largest_step_rad,
        interval_s: KNOT_INTERVAL_S,
        longest_s: LONGEST_S,
    };
    let found = task.solve(robot, posture);
    let found = found.map_err(|error| refused(job, &error))?;
    let duration_s = (found.knots.len() - 1) as f64 * KNOT_INTERVAL_S;
    let note = format!(
        "belt: {} lines on {} of the job's copies, {duration_s:.2} s",
        found.lines.lines.len(),
        found.copies.len()
    );
    Ok(PlannedMotion {
        knots: found.knots,
        duration_s,
        note: Some(note),
        target: Target::Lines(BeltLines {
            patch: Arc::new(found.patch),
            lines: found.lines,
            copies: found.copies,
        }),
    })
}

/// What is wrong with the lines is wrong with the job; where the arm fails on them is told alone.
fn refused(job: &BeltJob, error: &LinesError) -> SimError {
    let message = match error {
        LinesError::Surface(_) | LinesError::Path(_) => {
            format!("{}: {error}", job.file.display())
        }
        LinesError::Follow(_) | LinesError::NoNormal { .. } => error.to_string(),
    };
    SimError::scenario("process.belt.job", message)
}
