//! The motion of a polishing wheel along its raster.

use super::{KNOT_INTERVAL_S, PlannedMotion, Target};
use crate::error::SimError;
use nalgebra::{Isometry3, Matrix3, Rotation3, UnitQuaternion, Vector3};
use truecut_arm::Robot;
use truecut_core::wheel::precession::{PatchLaw, PrecessionWheel};
use truecut_plan::motion::follow::FollowError;
use truecut_plan::motion::polish::{RasterError, RasterTask};
use truecut_plan::motion::raster::Raster;
use truecut_plan::precession::{PrecessionPlan, PrecessionPlanError};
use truecut_scenario::{FaceSpec, PolishSpec};

const PATH: &str = "process.polish.path";
const FEED: &str = "process.polish.path.feed_mm_per_s";
const FACE: &str = "process.polish.face";
const PRECESSION: &str = "process.polish.precession";

/// The face's frame in the world: x along its length, z its outward normal.
pub(crate) fn world_from_face(face: &FaceSpec) -> Isometry3<f64> {
    let (x, z) = (Vector3::from(face.x_axis), Vector3::from(face.normal));
    let axes = Rotation3::from_matrix_unchecked(Matrix3::from_columns(&[x, z.cross(&x), z]));
    Isometry3::from_parts(
        Vector3::from(face.origin_m).into(),
        UnitQuaternion::from_rotation_matrix(&axes),
    )
}

/// How far the undeformed wheel reaches into the face along the path, m: as asked for, or what the force takes on a face
/// without edges.
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
    let (radius_m, law) = (spec.wheel.radius_m, PatchLaw::Geometric);
    PrecessionWheel::new(radius_m, depth_m, spec.tilt_rad, spec.spin_rad_s, law)
        .map_err(|error| SimError::scenario("process.polish", error.to_string()))
}

/// A patch that is wider than the face has no middle from which edges could be told.
fn check_patch(wheel: &PrecessionWheel, face: &FaceSpec) -> Result<(), SimError> {
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
        world_from_face: world_from_face(&spec.face),
        zero_direction: Vector3::from(spec.face.x_axis),
        face_m: [spec.face.length_m, spec.face.width_m],
        raster: Raster {
            lines: spec.path.lines,
            inset_m: spec.path.inset_m,
            corner_radius_m: spec.path.corner_radius_m,
            feed_m_per_s: spec.path.feed_m_per_s,
        },
        start_rad: spec.precession.start_rad,
        turn_rad_s: spec.precession.turn_rad_s,
        rule: spec.precession.at_edges,
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
    let lost_s = plan.duration_s() - plan.asked_s;
    format!(
        "precession: the angle keeps its rule with {:.1} degrees rms off the steady turn; the path takes {:.2} s, {} its feed \
         for {lost_s:.2} s",
        plan.deviation_rms_rad().to_degrees(),
        plan.duration_s(),
        if plan.reductions.is_empty() {
            "keeps"
        } else {
            "gives up"
        }
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
