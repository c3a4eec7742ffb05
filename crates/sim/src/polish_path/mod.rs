//! The way of a polishing wheel: raster, precession, postures, and the command that leads the arm along it.

mod raster;
pub(crate) mod timing;

use crate::error::SimError;
use crate::led_path::{KNOT_INTERVAL_S, LedPath, Over, check_speeds};
use crate::tool_path::{Along, check_singularities, leaves};
use nalgebra::{Isometry3, Matrix3, Point3, Rotation3, UnitQuaternion, Vector2, Vector3};
use timing::{Course, Station};
use truecut_arm::{BranchOptions, FrameId, IkSolver, PathOptions, Robot, tool_pose};
use truecut_core::wheel::pneumatic::PneumaticWheel;
use truecut_core::wheel::precession::{Boundary, ChordExtent, EdgeRule, PatchLaw, PrecessionWheel};
use truecut_plan::precession::{
    ArmOnFace, PrecessionLimits, PrecessionOptions, PrecessionPlanError, PrecessionTask,
};
use truecut_scenario::{ControlSpec, EdgeRuleSpec, FaceSpec, PneumaticSpec, PolishSpec};

const PATH: &str = "process.polish.path";
const FEED: &str = "process.polish.path.feed_mm_per_s";
const FACE: &str = "process.polish.face";
const PRECESSION: &str = "process.polish.precession";

/// Largest acceleration along the path where a plan lowers the feed, m/s².
const FEED_ACCELERATION_M_S2: f64 = 0.5;

/// The face's frame in the world: x along its length, z its outward normal.
pub(crate) fn world_from_face(face: &FaceSpec) -> Isometry3<f64> {
    let (x, z) = (Vector3::from(face.x_axis), Vector3::from(face.normal));
    let axes = Rotation3::from_matrix_unchecked(Matrix3::from_columns(&[x, z.cross(&x), z]));
    Isometry3::from_parts(
        Vector3::from(face.origin_m).into(),
        UnitQuaternion::from_rotation_matrix(&axes),
    )
}

/// The wheel of a scenario.
pub(crate) fn pneumatic(spec: &PneumaticSpec) -> PneumaticWheel {
    PneumaticWheel {
        radius_m: spec.radius_m,
        pressure_pa: spec.pressure_pa,
        shell_thickness_m: spec.shell_thickness_m,
        youngs_modulus_pa: spec.youngs_modulus_pa,
        poisson: spec.poisson,
        damping_pa_s_per_m: spec.damping_pa_s_per_m,
    }
}

/// How far the undeformed wheel reaches into the face along the path, m: as asked for, or what the force takes on a face
/// without edges.
pub(crate) fn penetration_m(spec: &PolishSpec) -> Result<f64, SimError> {
    let force_n = match spec.control {
        ControlSpec::Position { penetration_m } => return Ok(penetration_m),
        ControlSpec::ConstantForce { force_n, .. } | ControlSpec::Compliant { force_n, .. } => {
            force_n
        }
    };
    let wheel = pneumatic(&spec.wheel);
    let found = wheel.penetration_m(force_n);
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

/// The way of a wheel along its raster; `posture` chooses the branch at the start.
pub(crate) fn solve(
    spec: &PolishSpec,
    robot: &Robot,
    posture: &[f64],
) -> Result<LedPath, SimError> {
    let wheel = precession_wheel(spec, penetration_m(spec)?)?;
    check_patch(&wheel, &spec.face)?;
    let vertices = raster::vertices(&spec.face, &spec.path);
    let solver = robot.ik_solver(&BranchOptions::default());
    let (course, note) = match limits(spec) {
        None => (steady(spec, &vertices), None),
        Some((rule, limits)) => planned(
            spec,
            &wheel,
            &vertices,
            (robot, &solver),
            posture,
            (rule, &limits),
        )?,
    };
    let stations = course.sampled(KNOT_INTERVAL_S);
    let poses = poses(spec, &wheel, &stations)?;
    let at_mm = |k: usize| stations[k].along_m * 1e3;
    let along = Along {
        key: PATH,
        at_mm: &at_mm,
    };
    let followed = solver.follow(&poses, FrameId::Tool, posture, &PathOptions::default());
    let postures = followed.map_err(|error| leaves(error.kind(), &along).1)?;
    check_singularities(&solver, &postures, &along)?;
    let feed = Along { key: FEED, ..along };
    let advice = "lower the feed or the rate of the precession";
    check_speeds(robot, &postures, &feed, "the path", advice)?;
    Ok(LedPath {
        postures,
        duration_s: course.duration_s(),
        note,
        over: Over::Face,
    })
}

/// Rule and limits of a plan; none for a steady turn.
fn limits(spec: &PolishSpec) -> Option<(EdgeRule, PrecessionLimits)> {
    let (rule, rate_rad_s, acceleration_rad_s2) = match spec.precession.rule {
        EdgeRuleSpec::None => return None,
        EdgeRuleSpec::Cosine {
            epsilon,
            rate_rad_s,
            acceleration_rad_s2,
        } => (EdgeRule::Paper { epsilon }, rate_rad_s, acceleration_rad_s2),
        EdgeRuleSpec::Exact {
            rate_rad_s,
            acceleration_rad_s2,
        } => {
            let rule = EdgeRule::Exact(ChordExtent::Clipped);
            (rule, rate_rad_s, acceleration_rad_s2)
        }
    };
    let limits = PrecessionLimits {
        rate_rad_s,
        acceleration_rad_s2,
        feed_acceleration_m_s2: FEED_ACCELERATION_M_S2,
    };
    Some((rule, limits))
}

/// The angle turns by the clock, the feed is that asked for.
fn steady(spec: &PolishSpec, vertices: &[Vector2<f64>]) -> Course {
    let (mut along_m, mut stations) = (0.0, Vec::with_capacity(vertices.len()));
    for (k, point_m) in vertices.iter().enumerate() {
        along_m += (point_m - vertices[k.saturating_sub(1)]).norm();
        let time_s = along_m / spec.path.feed_m_per_s;
        stations.push(Station {
            time_s,
            along_m,
            point_m: *point_m,
            angle_rad: spec.precession.start_rad + spec.precession.turn_rad_s * time_s,
        });
    }
    Course::new(stations)
}

/// The angle keeps a rule at edges; feed and angle are lowered to what the rule and the joints allow.
fn planned(
    spec: &PolishSpec,
    wheel: &PrecessionWheel,
    vertices: &[Vector2<f64>],
    (robot, solver): (&Robot, &IkSolver<'_>),
    posture: &[f64],
    (rule, limits): (EdgeRule, &PrecessionLimits),
) -> Result<(Course, Option<String>), SimError> {
    let boundary = Boundary::rectangle(spec.face.length_m, spec.face.width_m)
        .map_err(|error| SimError::scenario(FACE, error.to_string()))?;
    let task = PrecessionTask {
        wheel,
        boundary: &boundary,
        rule,
        path_m: vertices,
        feed_m_per_s: spec.path.feed_m_per_s,
        turn_rad_s: spec.precession.turn_rad_s,
        start_rad: spec.precession.start_rad,
    };
    let arm = ArmOnFace {
        robot,
        solver,
        world_from_face: world_from_face(&spec.face),
        zero_direction: Vector3::from(spec.face.x_axis),
        start: posture,
    };
    let found = task.plan_for_arm(&arm, limits, &PrecessionOptions::default());
    let plan = found.map_err(plan_error)?.plan;
    let lost_s = plan.duration_s() - plan.asked_s;
    let note = format!(
        "precession: the angle keeps its rule with {:.1} degrees rms off the steady turn; the path takes {:.2} s, {} its feed \
         for {lost_s:.2} s",
        plan.deviation_rms_rad().to_degrees(),
        plan.duration_s(),
        if plan.reductions.is_empty() {
            "keeps"
        } else {
            "gives up"
        }
    );
    let stations = plan.points.iter().map(|point| Station {
        time_s: point.time_s,
        along_m: point.along_m,
        point_m: point.point_m,
        angle_rad: point.angle_rad,
    });
    Ok((Course::new(stations.collect()), Some(note)))
}

fn plan_error(error: PrecessionPlanError) -> SimError {
    let key = match &error {
        PrecessionPlanError::Arm(_) => PATH.to_owned(),
        PrecessionPlanError::JointTooFast { .. } => FEED.to_owned(),
        _ => PRECESSION.to_owned(),
    };
    if let PrecessionPlanError::Arm(arm) = &error {
        // The plan's points are not those of the command: its place is not told.
        return SimError::scenario(
            key,
            format!("the arm cannot lead the wheel along the raster: {arm}"),
        );
    }
    SimError::scenario(key, error.to_string())
}

/// Poses of the tool: the wheel's centre above the point, the tool's z axis along the spin axis, towards the face.
fn poses(
    spec: &PolishSpec,
    wheel: &PrecessionWheel,
    stations: &[Station],
) -> Result<Vec<Isometry3<f64>>, SimError> {
    let world_from_face = world_from_face(&spec.face);
    let zero_direction = Vector3::from(spec.face.x_axis);
    let pose = |station: &Station| {
        let (x, y) = (station.point_m.x, station.point_m.y);
        let centre = world_from_face * Point3::new(x, y, wheel.centre_height_m());
        let towards_face = -(world_from_face * wheel.axis(station.angle_rad));
        let axis = nalgebra::Unit::new_normalize(towards_face);
        Ok(tool_pose(&centre.coords, &axis, &zero_direction, 0.0)?)
    };
    stations.iter().map(pose).collect()
}
