//! The motion of a belt's contact wheel over the face of its path job.

use super::path_file::{self, LedAlong, StartNear};
use super::{BeltLines, KNOT_INTERVAL_S, PlannedMotion, Target};
use crate::error::SimError;
use crate::process::{NoPasses, Passes};
use std::sync::Arc;
use truecut_arm::{FrameId, Robot};
use truecut_plan::motion::lines::{CopyAt, LinesError, LinesTask};
use truecut_plan::path_file::PathFile;
use truecut_scenario::{BeltJob, BeltSpec, LONGEST_S};

const PATH: &str = "process.belt.path.file";

/// The motion of a belt's wheel; `posture` is where the arm comes from.
pub(crate) fn solve(
    spec: &BeltSpec,
    robot: &Robot,
    posture: &[f64],
) -> Result<PlannedMotion, SimError> {
    match &spec.path {
        None => along_lines(spec, robot, posture),
        Some(path) => along_file(spec, path, robot, posture),
    }
}

/// Along a path from a file, over the job's face.
fn along_file(
    spec: &BeltSpec,
    path: &PathFile,
    robot: &Robot,
    posture: &[f64],
) -> Result<PlannedMotion, SimError> {
    let start = StartNear {
        posture: posture.to_vec(),
        is_given: true,
    };
    let led = path_file::lead(path, PATH, robot, &start)?;
    let job = &spec.job;
    let patch = job.surface.face.load();
    let patch = Arc::new(patch.map_err(|error| refused(job, &error.into()))?);
    let world_from_patch = job.surface.world_from_patch;
    let patch_from_world = world_from_patch.inverse();
    let place = |q: &Vec<f64>| patch_from_world * robot.world_from_frame(q, FrameId::Tool);
    let places: Vec<_> = led.knots.iter().map(place).collect();
    let rubber_m = spec.wheel.rubber_m;
    let found = Passes::of_places(
        &places,
        KNOT_INTERVAL_S,
        patch.clone(),
        &job.wheel,
        rubber_m,
    );
    let (passes, deepest_m) = found.map_err(|why| no_passes(spec, path, &led, why))?;
    let note = format!(
        "belt: {}, {:.2} s, pressed in by up to {:.3} mm",
        led.told,
        led.duration_s,
        deepest_m * 1e3
    );
    let copies = vec![CopyAt {
        from_s: 0.0,
        world_from_patch,
    }];
    Ok(PlannedMotion {
        knots: led.knots,
        duration_s: led.duration_s,
        note: Some(note),
        target: Target::Lines(BeltLines {
            patch,
            passes,
            copies,
        }),
    })
}

/// Why the way of a file finishes nothing.
fn no_passes(spec: &BeltSpec, path: &PathFile, led: &LedAlong, why: NoPasses) -> SimError {
    let file = path.file.display();
    let radius_mm = spec.job.wheel.radius_m * 1e3;
    let message = match why {
        NoPasses::TooDeep(knot, depth_m) => {
            let at_s = knot as f64 * KNOT_INTERVAL_S;
            let points = led.way.iter().flat_map(|way| &way.points);
            let next = points.into_iter().find(|point| point.reached_s >= at_s);
            let line = next.and_then(|point| point.line);
            let line = line.map_or_else(String::new, |line| format!(":{line}"));
            format!(
                "{file}{line}: the wheel is led {:.3} mm into the face, but the rubber on its hub is {:.3} mm thick",
                depth_m * 1e3,
                spec.wheel.rubber_m * 1e3
            )
        }
        NoPasses::Above(least_m) => {
            let stays = match least_m {
                Some(least_m) => format!("it stays {:.3} mm above it or more", least_m * 1e3),
                None => "no point of the face lies under it".to_owned(),
            };
            format!(
                "{file}: the way never brings the wheel onto the face: {stays}; its centre is what follows the \
                 path, unless tool_xyz_mm, such as [0, 0, {radius_mm:.3}], says another place"
            )
        }
    };
    SimError::scenario(PATH, message)
}

/// The motion of a belt's wheel along the lines of its job; `posture` is where the arm comes from.
fn along_lines(spec: &BeltSpec, robot: &Robot, posture: &[f64]) -> Result<PlannedMotion, SimError> {
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
    let passes = Passes::of_lines(
        &found.lines,
        &found.patch,
        &job.wheel,
        job.path.feed_m_per_s,
    );
    let passes =
        passes.ok_or_else(|| SimError::scenario("process.belt.job", "the job has no lines"))?;
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
            passes,
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
