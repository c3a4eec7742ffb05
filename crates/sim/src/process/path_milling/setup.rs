//! From the path milling table and its solved path to the process that runs.

use super::nominal::NominalPath;
use super::spindle::SpindleCourse;
use super::{PathMilling, PathMillingSetup};
use crate::error::SimError;
use crate::motion::{KNOT_INTERVAL_S, PlannedMotion, Target, path_file};
use crate::process::setup::Motion;
use crate::process::{ProcessSetup, SetupContext};
use crate::scene::{Tooling, shapes};
use nalgebra::{Isometry3, Translation3, Vector3};
use std::f64::consts::TAU;
use std::sync::Arc;
use truecut_arm::{FrameId, Load, Robot};
use truecut_core::cutting::milling::layered::way::{Leg, follow};
use truecut_plan::path_file::{Way, WayPoint};
use truecut_scenario::{PathMillingSpec, ProcessSpec};

pub(super) const FILE: &str = "process.path_milling.path.file";
/// Farthest that the tool's axis may lean from the work frame's z, rad.
const LEAN_RAD: f64 = 1e-4;
/// Largest feed per tooth as a part of the cutter's diameter: chips are far thinner than it.
const LARGEST_FEED: f64 = 0.1;
/// Ways by joints are looked at in so many pieces.
const PIECES: usize = 40;

/// The process of a scenario along its path, and its workpiece.
pub(crate) fn setup(
    spec: &PathMillingSpec,
    context: &SetupContext<'_>,
) -> Result<ProcessSetup, SimError> {
    let motion = motion(spec, context)?;
    let from = context.departure(&motion);
    let setup = parameters(spec, context, &motion)?;
    let radius_m = spec.cutter.radius_m;
    let block = spec.stock.block;
    let middle_m = 0.5 * (block.least_m + block.most_m);
    let process_from_work = from.world_from_process.inverse() * setup.world_from_work;
    let process_from_block = process_from_work * Translation3::from(middle_m);
    let solid = spec.stock.solid.clone();
    let half_m = 0.5 * (block.most_m - block.least_m);
    let length_m = (block.most_m - block.least_m).z.max(2.0 * radius_m) + 2.0 * radius_m;
    let tooling = match spec.cutter.is_flat() {
        true => Tooling::end_mill(radius_m, length_m),
        false => Tooling::round_mill(&spec.cutter.profile(), length_m),
    };
    Ok(ProcessSetup::new(PathMilling::new(setup), from.posture)
        .holding(tooling)
        .on(move || match &solid {
            Some(solid) => vec![shapes::solid(&process_from_work, solid)],
            None => vec![shapes::stock(&process_from_block, &half_m)],
        })
        .led_by(Motion::Planned(motion)))
}

/// All that a pass is made of, along a motion.
pub(super) fn parameters(
    spec: &PathMillingSpec,
    context: &SetupContext<'_>,
    motion: &PlannedMotion,
) -> Result<PathMillingSetup, SimError> {
    let robot = context.robot;
    spec.cutter
        .check()
        .map_err(|error| SimError::scenario("process.path_milling.cutter", error.to_string()))?;
    let Target::Way(way) = &motion.target else {
        return Err(SimError::scenario(FILE, "the path is not solved"));
    };
    let course = spindle(spec, way);
    check_feed(spec, way, &course)?;
    let legs = legs(spec, way, robot)?;
    let profile = spec.cutter.profile();
    let ends_cut = spec.cutter.centre_cutting;
    let followed = follow(
        &legs,
        spec.stock.block,
        &spec.stock.holes,
        spec.stock.solid.as_deref(),
        &profile,
        spec.stock.grid_m,
        ends_cut,
    );
    let meant = followed.map_err(|fault| {
        let point = fault.point().and_then(|point| way.points.get(point));
        at_point(spec, point, &fault.to_string())
    })?;
    let from = context.departure(motion);
    let work_from_world = way.world_from_work.inverse();
    let nominal = NominalPath::new(robot, &motion.knots, KNOT_INTERVAL_S, &work_from_world);
    let sinks = match ends_cut {
        true => None,
        false => nominal.sinks_into(&meant, &profile),
    };
    if let Some(sinking) = sinks {
        let near = (way.points.iter()).min_by(|a, b| {
            let off = |one: &WayPoint| (one.work_from_tool.translation.vector - sinking).norm();
            off(a).total_cmp(&off(b))
        });
        let message = format!(
            "where corners are blended the depth changes in the stock, at ({:.2}, {:.2}, {:.2}) mm, but the ends of \
             the teeth do not cut here: stop at the point before (G61), or turn further away from the stock",
            sinking.x * 1e3,
            sinking.y * 1e3,
            sinking.z * 1e3
        );
        return Err(at_point(spec, near, &message));
    }
    let tool_axes = robot.tool_axes(&from.posture);
    let modes = robot.cutting_modes(&from.posture, &spec.attached)?;
    let rates = modes.iter().map(|mode| mode.natural_frequency_rad_s / TAU);
    let linearised = robot.linearised(&from.posture, FrameId::Tool, &Load::none())?;
    let turned: Vec<_> = (spec.attached.tool.iter())
        .map(|mode| mode.turned(&tool_axes))
        .collect();
    let process_from_work = from.process_from_world() * way.world_from_work.rotation;
    Ok(PathMillingSetup {
        nominal,
        legs,
        said: way.spindle.clone(),
        spindle: course,
        lines: way.points.iter().map(|point| point.line).collect(),
        reached_s: way.points.iter().map(|point| point.reached_s).collect(),
        meant,
        world_from_work: way.world_from_work,
        process_from_work: process_from_work.to_rotation_matrix(),
        work_from_tool: work_from_world.rotation.to_rotation_matrix().matrix() * tool_axes,
        mode_share: linearised.largest_share(&turned),
        fastest_mode_hz: rates.fold(0.0, f64::max),
        spec: spec.clone(),
    })
}

/// The motion along the path.
pub(super) fn motion(
    spec: &PathMillingSpec,
    context: &SetupContext<'_>,
) -> Result<Arc<PlannedMotion>, SimError> {
    let start = context.start_near()?;
    let is_same = |other: &ProcessSpec| match other {
        ProcessSpec::PathMilling(other) => other.path == spec.path,
        _ => false,
    };
    let solve = || path_file::solve(&spec.path, FILE, context.robot, &start);
    context.planned(&start.key(), is_same, solve)
}

/// The spindle's rotation on the path.
fn spindle(spec: &PathMillingSpec, way: &Way) -> SpindleCourse {
    let speeds = spec.spindle.speeds_rad_s().into_iter();
    let timed = speeds.enumerate().map(|(k, (from, rad_s))| {
        let come = way.points.get(from).filter(|_| k > 0);
        (come.map_or(0.0, |point| point.reached_s), rad_s)
    });
    SpindleCourse::new(spec.start_angle_rad, timed)
}

/// A fault at a point of the path, with its line.
fn at_point(spec: &PathMillingSpec, point: Option<&WayPoint>, message: &str) -> SimError {
    let file = spec.path.file.display();
    let place = match point.and_then(|point| point.line) {
        Some(line) => format!("{file}:{line}"),
        None => file.to_string(),
    };
    SimError::scenario(FILE, format!("{place}: {message}"))
}

/// Refuses chips that are not thin beside the cutter.
fn check_feed(spec: &PathMillingSpec, way: &Way, course: &SpindleCourse) -> Result<(), SimError> {
    let diameter_m = 2.0 * spec.cutter.radius_m;
    let mut from_s = 0.0;
    for point in &way.points {
        let begun_s = std::mem::replace(&mut from_s, point.reached_s);
        if point.rapid {
            continue;
        }
        let period_s = spec.tooth_period_at_s(course.rad_s(begun_s));
        let chip_m = point.speed_m_per_s.unwrap_or(0.0) * period_s;
        if chip_m > LARGEST_FEED * diameter_m {
            let message = format!(
                "the feed gives a feed per tooth of {:.4} mm, but must give at most {:.4} mm, a tenth of the \
                 diameter: chips are far thinner than the cutter",
                chip_m * 1e3,
                LARGEST_FEED * diameter_m * 1e3
            );
            return Err(at_point(spec, Some(point), &message));
        }
    }
    Ok(())
}

/// The path as straight pieces of an upright tool.
fn legs(spec: &PathMillingSpec, way: &Way, robot: &Robot) -> Result<Vec<Leg>, SimError> {
    let place = |pose: &Isometry3<f64>| pose.translation.vector;
    for point in &way.points {
        let axis = point.work_from_tool.rotation * -Vector3::z();
        let lean_rad = axis.angle(&Vector3::z());
        if lean_rad > LEAN_RAD {
            let message = format!(
                "the tool leans by {:.4} degrees, but must stand along the work frame's z axis: its axis is \
                 fixed here",
                lean_rad.to_degrees()
            );
            return Err(at_point(spec, Some(point), &message));
        }
    }
    let work_from_world = way.world_from_work.inverse();
    let mut legs = Vec::new();
    for (index, pair) in way.points.windows(2).enumerate() {
        let leg = |from_m: Vector3<f64>, to_m: Vector3<f64>| Leg {
            from_m,
            to_m,
            rapid: pair[1].rapid,
            point: index + 1,
        };
        if pair[1].speed_m_per_s.is_some() {
            legs.push(leg(
                place(&pair[0].work_from_tool),
                place(&pair[1].work_from_tool),
            ));
            continue;
        }
        let at = |k: usize| {
            let share = k as f64 / PIECES as f64;
            let ends = pair[0].posture.iter().zip(&pair[1].posture);
            let q: Vec<f64> = ends.map(|(a, b)| a + share * (b - a)).collect();
            place(&(work_from_world * robot.world_from_frame(&q, FrameId::Tool)))
        };
        legs.extend((0..PIECES).map(|k| leg(at(k), at(k + 1))));
    }
    Ok(legs)
}
