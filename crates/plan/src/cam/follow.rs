//! A path from CAM before an arm: poses, postures, and a program without a maker.

use std::path::Path;

use nalgebra::{Isometry3, Rotation3, Translation3, UnitQuaternion, Vector3};
use truecut_arm::Robot;

use super::{Attitude, CamPath, CamPoint};
use crate::program::{
    Motion, Move, PathPoint, Program, ProgramError, SpindleSwitch, TravelOptions, Zone,
    shortest_travel,
};

/// Turns about the tool's axis that are tried where none is given.
const SPINS: usize = 24;
/// Points at which they are compared.
const SAMPLES: usize = 40;

/// How a path stands before an arm.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WorkSetup {
    pub world_from_work: Isometry3<f64>,
    /// Turn about the tool's axis against the work frame's x, rad; `None` chooses the one of least
    /// travel.
    pub spin_rad: Option<f64>,
    /// Speed in rapid traverse, on a line.
    pub rapid_m_per_s: f64,
    /// Speed of the move to the first point, share of the top speed.
    pub joint_share: f64,
    /// Within what points are passed; `None` leaves it to the dialect.
    pub zone_m: Option<f64>,
}

/// A program through a path; `head` gives all but the moves.
///
/// # Errors
/// With the line of the file that the first point comes from which the arm cannot reach.
pub fn follow(
    robot: &Robot,
    head: Program,
    path: &CamPath,
    file: &Path,
    setup: &WorkSetup,
    options: &TravelOptions,
) -> Result<Program, ProgramError> {
    let spin_rad = setup
        .spin_rad
        .unwrap_or_else(|| chosen(robot, &head, path, setup, options));
    let points = points(&head, &path.points, setup, spin_rad);
    let found = postures(robot, &head, &points, options);
    let postures = found.map_err(|error| {
        let line = error
            .kind()
            .path_point()
            .map(|point| path.points[point].line);
        ProgramError::in_file(file, line, error.into_kind())
    })?;
    let each = points.iter().zip(&path.points).zip(postures);
    let moves = each
        .enumerate()
        .map(|(path_point, ((point, source), posture))| Move {
            path_point,
            base_from_tool: point.base_from_tool,
            motion: point.motion,
            zone: match (source.stops, setup.zone_m) {
                (true, _) => Zone::Stop,
                (false, Some(zone_m)) if zone_m > 0.0 => Zone::Within(zone_m),
                (false, Some(_)) => Zone::Stop,
                (false, None) => Zone::Unstated,
            },
            turntable_rad: None,
            posture,
        });
    let switch = |(before, on): &(usize, bool)| SpindleSwitch {
        before: *before,
        on: *on,
    };
    let mut notes = path.notes.clone();
    if setup.spin_rad.is_none()
        && path
            .points
            .iter()
            .any(|p| matches!(p.attitude, Attitude::Axis(_)))
    {
        let deg = spin_rad.to_degrees().round();
        notes.push(format!(
            "the tool is turned by {deg} deg about its axis: least travel of the joints"
        ));
    }
    Ok(Program {
        moves: moves.collect(),
        spindle: path.spindle.iter().map(switch).collect(),
        notes,
        ..head
    })
}

fn postures(
    robot: &Robot,
    head: &Program,
    points: &[PathPoint],
    options: &TravelOptions,
) -> Result<Vec<Vec<f64>>, ProgramError> {
    let tool = &head.tool.flange_from_tool;
    shortest_travel(robot, tool, &head.world_from_base, points, None, options)
}

/// The turn about the tool's axis by which the joints travel least, 0 if none can be followed.
fn chosen(
    robot: &Robot,
    head: &Program,
    path: &CamPath,
    setup: &WorkSetup,
    options: &TravelOptions,
) -> f64 {
    let every = path.points.len().div_ceil(SAMPLES).max(1);
    let mut few: Vec<CamPoint> = path.points.iter().step_by(every).copied().collect();
    few.extend(path.points.last());
    // Samples lie far apart.
    let options = TravelOptions {
        largest_step: f64::INFINITY,
        ..*options
    };
    let travel = |k: usize| {
        let spin_rad = std::f64::consts::TAU * k as f64 / SPINS as f64;
        let points = points(head, &few, setup, spin_rad);
        let postures = postures(robot, head, &points, &options).ok()?;
        let step = |pair: &[Vec<f64>]| {
            let each = pair[0].iter().zip(&pair[1]);
            each.map(|(a, b)| (b - a).powi(2)).sum::<f64>().sqrt()
        };
        Some((spin_rad, postures.windows(2).map(step).sum::<f64>()))
    };
    let all = (0..SPINS).filter_map(travel);
    let least = all.min_by(|a, b| a.1.total_cmp(&b.1));
    least.map_or(0.0, |(spin_rad, _)| spin_rad)
}

fn points(head: &Program, path: &[CamPoint], setup: &WorkSetup, spin_rad: f64) -> Vec<PathPoint> {
    let base_from_work = head.world_from_base.inverse() * setup.world_from_work;
    let point = |(i, one): (usize, &CamPoint)| PathPoint {
        base_from_tool: base_from_work
            * Isometry3::from_parts(
                Translation3::from(one.place_m),
                attitude(&one.attitude, spin_rad),
            ),
        motion: match (i, one.feed_m_per_s) {
            (0, _) => Motion::Joint {
                share: setup.joint_share,
            },
            (_, feed) => Motion::Linear {
                speed_m_per_s: feed.unwrap_or(setup.rapid_m_per_s),
            },
        },
        turntable_rad: None,
    };
    path.iter().enumerate().map(point).collect()
}

/// The tool's attitude in the work frame: for an upright axis its z points down and its x lies at
/// the spin against the work frame's x; other axes tilt that by the shortest way.
fn attitude(attitude: &Attitude, spin_rad: f64) -> UnitQuaternion<f64> {
    match attitude {
        Attitude::Whole(turn) => *turn,
        Attitude::Axis(axis) => {
            let upright = Rotation3::from_axis_angle(&Vector3::z_axis(), spin_rad)
                * Rotation3::from_axis_angle(&Vector3::x_axis(), std::f64::consts::PI);
            let tilt = Rotation3::rotation_between(&Vector3::z(), axis).unwrap_or_else(|| {
                Rotation3::from_axis_angle(&Vector3::x_axis(), std::f64::consts::PI)
            });
            UnitQuaternion::from_rotation_matrix(&(tilt * upright))
        }
    }
}
