//! The files that a path job names.

use std::path::Path;

use truecut_arm::{Masses, Robot};
use truecut_plan::surface::{Mesh, MeshUse, PatchFile, SurfaceError};
use truecut_plan::surface_path::{SurfacePathError, TaughtPoints};
use truecut_scenario::PathJob;

use crate::failure::Failure;

/// Everything that is read before planning.
pub struct Inputs {
    pub robot: Robot,
    pub patch: PatchFile,
    /// The patch as a triangle mesh.
    pub patch_mesh: Mesh,
    pub body: Option<Mesh>,
    /// In the order of the job.
    pub taught: Vec<TaughtPoints>,
}

impl Inputs {
    pub fn load(job: &PathJob) -> Result<Inputs, Failure> {
        let robot = robot(job)?;
        let help = |what: &str| format!("it is {what} of {}", job.path().display());
        let spec = &job.surface;
        let surface = |error: SurfaceError, key: &str, what: &str| match error.line() {
            Some(_) => Failure::in_file(
                error.path(),
                error.line(),
                error.message(),
                Some(help(what)),
            ),
            None => job.problem(key, error.to_string()).into(),
        };
        let patch = spec.face.load().map_err(|error| {
            let key = spec.face.key_of(error.kind());
            surface(error, key, "the face")
        })?;
        let patch_mesh = Mesh::of_patch(patch.surface.as_ref())
            .map_err(|fault| job.problem(spec.face.key_of(&fault), fault.to_string()))?;
        let body = (spec.body.as_ref())
            .map(|body| Mesh::load(&body.file, body.unit_m, MeshUse::Body))
            .transpose()
            .map_err(|error| surface(error, "surface.body", "the body"))?;
        if let Some(body) = &body {
            super::body::check(job, &patch, body)?;
        }
        let taught = job.taught.iter().enumerate().map(|(index, one)| {
            TaughtPoints::load(&one.file, &robot).map_err(|error| match error {
                SurfacePathError::Taught {
                    file,
                    line,
                    message,
                } if line > 0 => {
                    let place = Some(Path::new(&file));
                    Failure::in_file(place, Some(line), message, Some(help("a taught file")))
                }
                other => {
                    let key = format!("taught.{index}.file");
                    job.problem(&key, other.to_string()).into()
                }
            })
        });
        let taught = taught.collect::<Result<_, Failure>>()?;
        Ok(Inputs {
            robot,
            patch,
            patch_mesh,
            body,
            taught,
        })
    }
}

fn robot(job: &PathJob) -> Result<Robot, Failure> {
    let arm = &job.robot;
    let robot = Robot::read(&arm.urdf, &arm.reading(Masses::NotNeeded));
    let robot = robot.map_err(|error| match error.line() {
        Some(_) => Failure::arm(&error),
        None => job.problem(&arm.key_of(&error), error.to_string()).into(),
    })?;
    let robot = with_slides(job, robot)?;
    check_joints(job, &robot)?;
    Ok(robot)
}

/// Slides stand where the start posture has them: a robot program moves rotary joints only.
fn with_slides(job: &PathJob, robot: Robot) -> Result<Robot, Failure> {
    let places_m = &job.robot.posture_m;
    let count = robot.slides().count();
    if places_m.len() == count {
        if count == 0 {
            return Ok(robot);
        }
        let held = robot.with_slides_at(places_m);
        return held.map_err(|error| job.problem("robot.posture_mm", error.message()).into());
    }
    let message = match robot.slides().next() {
        None => format!(
            "`robot.posture_mm` has {} values, but the arm has no slides",
            places_m.len()
        ),
        Some(first) => format!(
            "`robot.posture_mm` has {} values, but the arm has {count} slides, joint `{}` the first: a robot \
             program moves rotary joints alone, and slides stand where this says",
            places_m.len(),
            robot.chain.joints[first].name
        ),
    };
    let key = match places_m.is_empty() {
        true => "robot.urdf",
        false => "robot.posture_mm",
    };
    Err(job.problem(key, message).into())
}

/// The start posture must have a value for each rotary joint.
fn check_joints(job: &PathJob, robot: &Robot) -> Result<(), Failure> {
    let arm = &job.robot;
    if arm.posture_rad.len() != robot.dof() {
        let message = format!(
            "`robot.posture_deg` has {} values, but the arm has {} joints",
            arm.posture_rad.len(),
            robot.dof()
        );
        return Err(job.problem("robot.posture_deg", message).into());
    }
    robot
        .check_posture(&arm.posture_rad)
        .map_err(|error| job.problem("robot.posture_deg", error.message()))?;
    Ok(())
}
