//! The motion of a polishing wheel over a freeform face, along lines that are laid on it.

use super::edges::{LaidTool, LaidWay};
use super::path_file::{self, StartNear};
use super::{PlannedMotion, PolishedFace, Target};
use crate::error::SimError;
use nalgebra::Isometry3;
use std::path::Path;
use std::sync::Arc;
use truecut_arm::Robot;
use truecut_core::wheel::precession::PrecessionWheel;
use truecut_plan::cam::{CamPath, CamPoint, Rapid, WorkSetup};
use truecut_plan::clearance::Solid;
use truecut_plan::path_file::LaidPath;
use truecut_plan::polish_path::{PolishPath, PolishPathError};
use truecut_plan::surface::{Mesh, MeshUse, PatchFile, SurfaceError};
use truecut_plan::surface_path::FaceSource;
use truecut_scenario::SurfacePolishSpec;

const TABLE: &str = "process.surface_polish";
const PATH: &str = "process.surface_polish.path";

/// What helps where an arm cannot go along a line.
const OTHERWISE: &str = "place the part elsewhere, lay lines another way (`surface.mesh.u_along`), or \
                         tilt the wheel less";

/// From line to line the wheel is looked at in steps of this part of its radius: between two of
/// them less than a hundredth of it is missed.
const LOOKED_AT: f64 = 0.25;

/// The wheel may lie deeper in the part than at its contact by this: triangles stand for a curved
/// face, and places of a path are rounded, m.
const GOUGE_M: f64 = 0.01e-3;

/// The motion of the wheel.
pub(crate) fn solve(
    spec: &SurfacePolishSpec,
    robot: &Robot,
    start: &StartNear,
) -> Result<PlannedMotion, SimError> {
    let (face, laid) = face(spec)?;
    let path = LaidPath {
        path: &laid.path,
        file: file(spec),
        setup: work_setup(spec),
        joint_share: spec.joint_share,
    };
    let key = |_: usize| PATH.to_owned();
    let led = path_file::lead_along(&path, "line", (&key, OTHERWISE), robot, start)?;
    let note = format!(
        "surface_polish: {}, {:.2} s, {} pieces of lines; straight lines from point to point leave the face by up to {:.1} µm; relative radii \
         of wheel and face in the ratio {:.2} at most",
        led.told,
        led.duration_s,
        laid.contacts_m.len(),
        laid.chord_m * 1e6,
        laid.unalike
    );
    Ok(PlannedMotion {
        knots: led.knots,
        duration_s: led.duration_s,
        note: Some(note),
        target: Target::Polished(face),
    })
}

/// The way over the face, for a robot program.
pub(super) fn way(
    spec: &SurfacePolishSpec,
    robot: &Robot,
    start: StartNear,
) -> Result<LaidWay, SimError> {
    let motion = solve(spec, robot, &start)?;
    let (face, laid) = face(spec)?;
    Ok(LaidWay {
        path: laid.path,
        setup: work_setup(spec),
        slides_m: robot.slides().map(|at| start.posture[at]).collect(),
        near: start.is_given.then_some(start.posture),
        part: face.body,
        world_from_part: spec.surface.world_from_patch,
        tool: LaidTool {
            name: "wheel",
            solid: Solid::Ball {
                radius_m: spec.wheel.radius_m,
            },
            tool_from_solid: Isometry3::identity(),
        },
        line_word: "line",
        note: motion.note,
    })
}

/// The file that the face is in.
fn file(spec: &SurfacePolishSpec) -> &Path {
    match &spec.surface.face {
        FaceSource::Patch(file) => file,
        FaceSource::Mesh(face) => &face.mesh.file,
    }
}

fn work_setup(spec: &SurfacePolishSpec) -> WorkSetup {
    WorkSetup {
        world_from_work: spec.surface.world_from_patch,
        spin_rad: None,
        rapid: Rapid::Line {
            speed_m_per_s: spec.rapid_m_per_s,
        },
        joint_share: spec.joint_share,
        zone_m: None,
    }
}

/// Reads or fits the face, and lays lines on it that leave the rest of the part alone.
fn face(spec: &SurfacePolishSpec) -> Result<(PolishedFace, PolishPath), SimError> {
    let wheel = (spec.laying.radius_m, spec.laying.indentation_m);
    // A tilt or a spin that is none is told in the words of the precession.
    PrecessionWheel::new(wheel.0, wheel.1, spec.laying.tilt_rad, spec.spin_rad_s)
        .map_err(|error| SimError::scenario(TABLE, error.to_string()))?;
    let source = &spec.surface.face;
    let patch = source.load().map_err(|error| {
        let key = format!("{TABLE}.{}", source.key_of(error.kind()));
        SimError::scenario(key, error.to_string())
    })?;
    let (body, is_body) = body(spec, &patch)?;
    let laid = (spec.laying.path(&patch)).map_err(|error| {
        let key = match &error {
            PolishPathError::NoRoom { .. } => format!("{PATH}.inset_mm"),
            PolishPathError::TooManyLines { .. } => format!("{PATH}.line_spacing_mm"),
            PolishPathError::TooMany { .. } => format!("{PATH}.step_mm"),
            PolishPathError::Surface(fault) => format!("{TABLE}.{}", source.key_of(fault)),
            _ => format!("{TABLE}.wheel.radius_mm"),
        };
        SimError::scenario(key, format!("{}: {error}", file(spec).display()))
    })?;
    if is_body {
        let fit_m = patch.fit.as_ref().map_or(0.0, |fit| fit.deviation_m);
        check_gouge(spec, &body, &laid.path, fit_m)?;
    }
    let points = &laid.path.points;
    let face = PolishedFace {
        patch: Arc::new(patch),
        body: Arc::new(body),
        // The wheel is let down along it.
        first_normal: (points[0].place_m - points[1].place_m).normalize(),
    };
    Ok((face, laid))
}

/// The part as a mesh, and whether that is a body: the one that is given, else the mesh that the
/// face is of, else the face alone.
fn body(spec: &SurfacePolishSpec, patch: &PatchFile) -> Result<(Mesh, bool), SimError> {
    let load = |file: &Path, unit_m: f64, key: &str| {
        let mesh = Mesh::load(file, unit_m, MeshUse::Body);
        mesh.map_err(|error| SimError::scenario(format!("{TABLE}.{key}"), error.to_string()))
    };
    match (&spec.surface.body, &spec.surface.face) {
        (Some(body), _) => Ok((load(&body.file, body.unit_m, "surface.body")?, true)),
        (None, FaceSource::Mesh(face)) => {
            let mesh = &face.mesh;
            Ok((load(&mesh.file, mesh.unit_m, "surface.mesh.file")?, true))
        }
        (None, FaceSource::Patch(_)) => {
            let mesh = Mesh::of_patch(patch.surface.as_ref()).map_err(SurfaceError::from);
            let mesh = mesh.map_err(|error| {
                SimError::scenario(format!("{TABLE}.surface.patch"), error.to_string())
            })?;
            Ok((mesh, false))
        }
    }
}

/// Refuses a way on which the wheel would press on more of the part than where it touches, or would
/// not be clear of it from line to line.
fn check_gouge(
    spec: &SurfacePolishSpec,
    body: &Mesh,
    path: &CamPath,
    fit_m: f64,
) -> Result<(), SimError> {
    let laying = &spec.laying;
    let least_m = laying.radius_m - laying.indentation_m - fit_m - GOUGE_M;
    for (at, point) in path.points.iter().enumerate() {
        if point.feed_m_per_s.is_none() && at > 0 {
            check_lifted(spec, body, [&path.points[at - 1], point])?;
        }
        let nearest = body.nearest(&point.place_m);
        if nearest.distance_m >= least_m {
            continue;
        }
        let deep_mm = (laying.radius_m - nearest.distance_m) * 1e3;
        let [x, y, z] = (nearest.point_m * 1e3).into();
        let message = format!(
            "{}: line {}: the wheel lies {deep_mm:.3} mm deep in the part at ({x:.3}, {y:.3}, {z:.3}) mm, beside its contact, where it is \
             pressed in by {:.3} mm: it must touch the face alone; give a smaller wheel or a larger inset_mm",
            file(spec).display(),
            point.line,
            laying.indentation_m * 1e3
        );
        return Err(SimError::scenario(
            format!("{TABLE}.wheel.radius_mm"),
            message,
        ));
    }
    Ok(())
}

/// Refuses a way from one line to the next on which the lifted wheel meets the part.
fn check_lifted(
    spec: &SurfacePolishSpec,
    body: &Mesh,
    [from, to]: [&CamPoint; 2],
) -> Result<(), SimError> {
    let way_m = to.place_m - from.place_m;
    let count = (way_m.norm() / (LOOKED_AT * spec.laying.radius_m))
        .ceil()
        .max(1.0);
    for k in 0..=count as usize {
        let nearest = body.nearest(&(from.place_m + way_m * (k as f64 / count)));
        if nearest.distance_m >= spec.laying.radius_m {
            continue;
        }
        let [x, y, z] = (nearest.point_m * 1e3).into();
        let message = format!(
            "{}: between lines {} and {} the wheel, lifted by {} mm, meets the part at ({x:.3}, {y:.3}, {z:.3}) mm: lift it further",
            file(spec).display(),
            from.line,
            to.line,
            spec.laying.lift_m * 1e3
        );
        return Err(SimError::scenario(format!("{PATH}.lift_mm"), message));
    }
    Ok(())
}
