//! The motion of a polishing wheel along its raster.

use super::{KNOT_INTERVAL_S, PlannedMotion, Target};
use crate::error::SimError;
use truecut_arm::Robot;
use truecut_core::wheel::precession::PrecessionWheel;
use truecut_plan::motion::follow::FollowError;
use truecut_plan::motion::polish::{RasterError, RasterTask, RectangularFace};
use truecut_plan::precession::{PrecessionPlan, PrecessionPlanError};
use truecut_scenario::PolishSpec;

const PATH: &str = "process.polish.path";
const FEED: &str = "process.polish.path.feed_mm_per_s";
const FACE: &str = "process.polish.face";
const PRECESSION: &str = "process.polish.precession";

/// How far the undeformed wheel reaches into the face along the path, m: as asked for, or what the
/// force takes on a face without edges.
pub(crate) fn indentation_m(spec: &PolishSpec) -> Result<f64, SimError> {
    let force_n = match (spec.indentation_m, spec.control.force_n()) {
        (Some(indentation_m), _) => return Ok(indentation_m),
        (None, force_n) => force_n.unwrap_or(0.0),
    };
    let wheel = &spec.wheel;
    let found = wheel.indentation_m(force_n);
    if found < 0.5 * wheel.radius_m {
        return Ok(found);
    }
    Err(SimError::scenario(
        "process.polish.control.force_n",
        format!(
            "{force_n} N press the wheel in by {:.2} mm, but it must be less than half its radius of {} mm: the contact law holds for \
             patches that are small beside the wheel",
            found * 1e3,
            wheel.radius_m * 1e3
        ),
    ))
}

/// The wheel as the precession rules see it.
fn precession_wheel(spec: &PolishSpec, depth_m: f64) -> Result<PrecessionWheel, SimError> {
    let radius_m = spec.wheel.radius_m;
    PrecessionWheel::new(radius_m, depth_m, spec.tilt_rad, spec.spin_rad_s)
        .map_err(|error| SimError::scenario("process.polish", error.to_string()))
}

/// A patch that is wider than the face has no middle from which edges could be told.
fn check_patch(wheel: &PrecessionWheel, face: &RectangularFace) -> Result<(), SimError> {
    let patch_m = 2.0 * wheel.patch_radius_m();
    let sides = [("length_mm", face.length_m), ("width_mm", face.width_m)];
    match sides.into_iter().find(|(_, side_m)| *side_m < patch_m) {
        None => Ok(()),
        Some((key, side_m)) => Err(SimError::scenario(
            format!("{FACE}.{key}"),
            format!(
                "the face is {} mm wide there, but must be at least as wide as the patch of {:.3} mm, the circle that it cuts from the \
                 undeformed wheel",
                side_m * 1e3,
                patch_m * 1e3
            ),
        )),
    }
}

/// The motion of a wheel along its raster; `posture` chooses the branch at the start.
pub(crate) fn solve(
    spec: &PolishSpec,
    robot: &Robot,
    posture: &[f64],
) -> Result<PlannedMotion, SimError> {
    let wheel = precession_wheel(spec, indentation_m(spec)?)?;
    check_patch(&wheel, &spec.face)?;
    let task = RasterTask {
        wheel: &wheel,
        face: spec.face,
        raster: spec.path,
        precession: spec.precession,
        interval_s: KNOT_INTERVAL_S,
    };
    let found = task.solve(robot, posture).map_err(refused)?;
    Ok(PlannedMotion {
        knots: found.knots,
        duration_s: found.duration_s,
        note: found.plan.as_ref().map(note),
        target: Target::Face,
    })
}

fn note(plan: &PrecessionPlan) -> String {
    let feed = if plan.reductions.is_empty() {
        "at its feed all along".to_owned()
    } else {
        let lost_s = plan.duration_s() - plan.asked_s;
        format!("{lost_s:.2} s more than at its feed")
    };
    format!(
        "precession: the angle keeps its rule with {:.1} degrees rms off the steady turn; the path takes {:.2} s, {feed}",
        plan.deviation_rms_rad().to_degrees(),
        plan.duration_s(),
    )
}

fn refused(error: RasterError) -> SimError {
    let key = match &error {
        RasterError::Face(_) => FACE,
        RasterError::Precession(PrecessionPlanError::Arm(arm)) => {
            // The plan's points are not those of the command: its place is not told.
            let message = format!("the arm cannot lead the wheel along the raster: {arm}");
            return SimError::scenario(PATH, message);
        }
        RasterError::Precession(PrecessionPlanError::JointTooFast { .. })
        | RasterError::Follow(FollowError::TooFast { .. }) => FEED,
        RasterError::Precession(_) => PRECESSION,
        RasterError::Follow(_) => PATH,
        RasterError::Arm(_) => {
            let RasterError::Arm(arm) = error else {
                unreachable!()
            };
            return arm.into();
        }
    };
    SimError::scenario(key, error.to_string())
}
