//! From the path milling table and its solved path to the process that runs.

use super::nominal::NominalPath;
use super::spindle::SpindleCourse;
use super::written::Written;
use super::{PathMilling, PathMillingSetup};
use crate::error::SimError;
use crate::motion::{KNOT_INTERVAL_S, PlannedMotion, Target, path_file};
use crate::process::setup::Motion;
use crate::process::{ProcessSetup, SetupContext};
use crate::scene::{Tooling, shapes};
use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};
use std::f64::consts::{PI, TAU};
use std::sync::Arc;
use truecut_arm::{FrameId, Load, Robot};
use truecut_core::cutting::milling::layered::way::{Leg, WayFault, follow};
use truecut_core::cutting::milling::swivel;
use truecut_core::cutting::milling::swivel::field::{DistanceField, nodes};
use truecut_core::cutting::milling::swivel::way::SwivelLeg;
use truecut_plan::path_file::{Way, WayPoint};
use truecut_scenario::{PathMillingSpec, ProcessSpec};

pub(super) const FILE: &str = "process.path_milling.path.file";
/// A tool whose axis leans further from the work frame's z, rad, is not upright.
const LEAN_RAD: f64 = 1e-4;
/// Largest feed per tooth as a part of the cutter's diameter: chips are far thinner than it.
const LARGEST_FEED: f64 = 0.1;
/// Most nodes of a grid in space: stock, target and what is cut of them have each one.
const MOST_NODES: f64 = 24e6;
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
    let from = context.departure(motion);
    let work_from_world = way.world_from_work.inverse();
    let leans = leans(way);
    let knots = &motion.knots;
    let nominal = NominalPath::new(robot, knots, KNOT_INTERVAL_S, &work_from_world, leans);
    let written = match leans {
        false => upright(spec, way, robot, &nominal)?,
        true => swivel(spec, way, robot)?,
    };
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
        written,
        said: way.spindle.clone(),
        spindle: course,
        lines: way.points.iter().map(|point| point.line).collect(),
        reached_s: way.points.iter().map(|point| point.reached_s).collect(),
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

/// Whether the tool leans anywhere on a path.
fn leans(way: &Way) -> bool {
    way.points.iter().any(|point| {
        let axis = point.work_from_tool.rotation * -Vector3::z();
        axis.angle(&Vector3::z()) > LEAN_RAD
    })
}

/// The path of an upright tool and what it means for the stock.
fn upright(
    spec: &PathMillingSpec,
    way: &Way,
    robot: &Robot,
    nominal: &NominalPath,
) -> Result<Written, SimError> {
    let place = |pose: &Isometry3<f64>| pose.translation.vector;
    let each = pieces(way, robot).into_iter();
    let legs: Vec<Leg> = each
        .map(|(from, to, point)| Leg {
            from_m: place(&from),
            to_m: place(&to),
            rapid: way.points[point].rapid,
            point,
        })
        .collect();
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
    let meant = followed.map_err(|fault| at_fault(spec, way, &fault))?;
    let sinks = match ends_cut {
        true => None,
        false => nominal.sinks_into(&meant, &profile),
    };
    if let Some(sinking) = sinks {
        let near = (way.points.iter()).min_by(|a, b| {
            let off = |one: &WayPoint| (place(&one.work_from_tool) - sinking).norm();
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
    Ok(Written::Upright {
        legs,
        meant: Box::new(meant),
    })
}

/// The path of a tool that leans and what it means for the stock.
fn swivel(spec: &PathMillingSpec, way: &Way, robot: &Robot) -> Result<Written, SimError> {
    let stock = &spec.stock;
    let nodes = nodes(&stock.block, stock.grid_m);
    let count = nodes.iter().map(|count| *count as f64).product::<f64>();
    if count > MOST_NODES {
        let message = format!(
            "the tool leans, so that the stock is kept on a grid in space: {:.4} mm makes {count:.2e} nodes of it, but \
             there may be {MOST_NODES:.1e} at most; give a larger spacing, or less stock",
            stock.grid_m * 1e3
        );
        let key = "process.path_milling.stock.grid_mm";
        return Err(SimError::scenario(key, message));
    }
    let upwards =
        |pose: Isometry3<f64>| pose * UnitQuaternion::from_axis_angle(&Vector3::x_axis(), PI);
    let legs: Vec<SwivelLeg> = (pieces(way, robot).into_iter())
        .map(|(from, to, point)| SwivelLeg {
            from: upwards(from),
            to: upwards(to),
            rapid: way.points[point].rapid,
            point,
        })
        .collect();
    let field = DistanceField::of(
        stock.block,
        &stock.holes,
        stock.solid.as_deref(),
        stock.grid_m,
    );
    let meant = swivel::way::follow(&legs, field, &spec.cutter.profile())
        .map_err(|fault| at_fault(spec, way, &fault))?;
    Ok(Written::Swivel {
        legs,
        meant: Box::new(meant),
    })
}

/// What a cutter cannot do, at the point where.
fn at_fault(spec: &PathMillingSpec, way: &Way, fault: &WayFault) -> SimError {
    let point = fault.point().and_then(|point| way.points.get(point));
    at_point(spec, point, &fault.to_string())
}

/// The path as straight pieces between two poses of the tool, with the point that each leads to.
fn pieces(way: &Way, robot: &Robot) -> Vec<(Isometry3<f64>, Isometry3<f64>, usize)> {
    let work_from_world = way.world_from_work.inverse();
    let mut pieces = Vec::new();
    for (index, pair) in way.points.windows(2).enumerate() {
        if pair[1].speed_m_per_s.is_some() {
            pieces.push((pair[0].work_from_tool, pair[1].work_from_tool, index + 1));
            continue;
        }
        let at = |k: usize| {
            let share = k as f64 / PIECES as f64;
            let ends = pair[0].posture.iter().zip(&pair[1].posture);
            let q: Vec<f64> = ends.map(|(a, b)| a + share * (b - a)).collect();
            work_from_world * robot.world_from_frame(&q, FrameId::Tool)
        };
        pieces.extend((0..PIECES).map(|k| (at(k), at(k + 1), index + 1)));
    }
    pieces
}
