//! A path from CAM before an arm: poses, postures, and a program without a maker.

use std::path::Path;

use nalgebra::{Isometry3, Rotation3, Translation3, UnitQuaternion, Vector3};
use truecut_arm::Robot;

use super::{Attitude, CamPath, CamPoint};
use crate::program::{
    Motion, Move, PathPoint, Program, ProgramError, SpindleSwitch, Start, TravelOptions, Zone,
    along_lines, along_runs,
};

/// Turns about the tool's axis that are tried where none is given.
const SPINS: usize = 24;
/// Points at which they are compared.
const SAMPLES: usize = 40;

/// How the arm goes where it is not fed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Rapid {
    /// On a line, at this speed.
    Line { speed_m_per_s: f64 },
    /// By joints: postures are chosen anew after each such move.
    Joints,
}

/// How a path stands before an arm.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WorkSetup {
    pub world_from_work: Isometry3<f64>,
    /// Turn about the tool's axis against the work frame's x, rad; `None` chooses the one whose
    /// postures cost least on the whole, by [`Start::cost`].
    pub spin_rad: Option<f64>,
    pub rapid: Rapid,
    /// Speed of moves by joints, such as that to the first point, share of the top speed.
    pub joint_share: f64,
    /// Within what points are passed; `None` leaves it to the dialect.
    pub zone_m: Option<f64>,
}

/// A program through a path, which begins in the posture nearest to `start` of those from which the
/// arm can follow it; `head` gives all but the moves.
///
/// # Errors
/// With the line of the file that the first point comes from which the arm cannot reach.
pub fn follow(
    start: Start<'_>,
    robot: &Robot,
    head: Program,
    path: &CamPath,
    file: &Path,
    setup: &WorkSetup,
    options: &TravelOptions,
) -> Result<Program, ProgramError> {
    let turned = path.leaves_turn_free();
    let task = Task {
        start,
        robot,
        head: &head,
        path,
        setup,
        options,
    };
    let spins = match setup.spin_rad {
        Some(spin_rad) => vec![spin_rad],
        None if turned => task.spins(),
        None => vec![0.0],
    };
    let (spin_rad, points, found) = task.first_of(&spins);
    let postures = found.map_err(|error| {
        let line = error
            .kind()
            .path_point()
            .map(|point| path.points[point].line);
        ProgramError::in_file(file, line, error.into_kind())
    })?;
    // A controller that blends the last point, too, ends the program before it is there.
    let last = path.points.len().saturating_sub(1);
    let each = points.iter().zip(&path.points).zip(postures);
    let moves = each
        .enumerate()
        .map(|(path_point, ((point, source), posture))| Move {
            path_point,
            base_from_tool: point.base_from_tool,
            motion: point.motion,
            zone: match (source.stops || path_point == last, setup.zone_m) {
                (true, _) => Zone::Stop,
                (false, Some(zone_m)) if zone_m > 0.0 => Zone::Within(zone_m),
                (false, Some(_)) => Zone::Stop,
                (false, None) => Zone::Unstated,
            },
            turntable_rad: None,
            posture,
        });
    let switch = |(before, on)| SpindleSwitch { before, on };
    let mut notes = path.notes.clone();
    if setup.spin_rad.is_none() && turned {
        let deg = spin_rad.to_degrees().round();
        let near = match start {
            Start::AtRest => "the middle of their ranges",
            Start::Near(_) => "the posture given",
        };
        notes.push(format!(
            "the tool is turned by {deg} deg about its axis: the joints stay nearest to {near}"
        ));
    }
    Ok(Program {
        moves: moves.collect(),
        spindle: path.switches().map(switch).collect(),
        notes,
        ..head
    })
}

/// What is needed to find postures at one turn of the tool.
struct Task<'a> {
    start: Start<'a>,
    robot: &'a Robot,
    head: &'a Program,
    path: &'a CamPath,
    setup: &'a WorkSetup,
    options: &'a TravelOptions,
}

impl Task<'_> {
    /// Postures at the first of these turns at which the path can be followed; else the fault of
    /// the first.
    fn first_of(&self, spins: &[f64]) -> (f64, Vec<PathPoint>, Postures) {
        let mut refused: Option<(f64, Vec<PathPoint>, ProgramError)> = None;
        for &spin_rad in spins {
            // Where one turn failed, another may be at an end as soon.
            if let Some(point) = refused
                .as_ref()
                .and_then(|(.., error)| error.kind().path_point())
            {
                let here = &self.path.points[point..=point];
                let here = points(self.head, here, self.setup, spin_rad);
                if self.postures(&here).is_err() {
                    continue;
                }
            }
            let all = points(self.head, &self.path.points, self.setup, spin_rad);
            match self.postures(&all) {
                Ok(found) => return (spin_rad, all, Ok(found)),
                Err(error) => {
                    refused.get_or_insert((spin_rad, all, error));
                }
            }
        }
        match refused {
            Some((spin_rad, all, error)) => (spin_rad, all, Err(error)),
            None => (0.0, Vec::new(), Ok(Vec::new())),
        }
    }

    fn postures(&self, points: &[PathPoint]) -> Postures {
        let frames = [&self.head.tool.flange_from_tool, &self.head.world_from_base];
        let along = match self.setup.rapid {
            Rapid::Line { .. } => along_lines,
            Rapid::Joints => along_runs,
        };
        along(self.robot, frames, points, self.start, self.options)
    }

    /// Turns about the tool's axis by the mean cost of the postures at some points of the path,
    /// least first; those at which these points cannot be reached go last.
    fn spins(&self) -> Vec<f64> {
        let every = self.path.points.len().div_ceil(SAMPLES).max(1);
        let mut few: Vec<CamPoint> = self.path.points.iter().step_by(every).copied().collect();
        few.extend(self.path.points.last());
        let cost = |spin_rad: f64| {
            // Samples lie far apart: between them the arm moves as it likes.
            let mut points = points(self.head, &few, self.setup, spin_rad);
            points.iter_mut().for_each(|point| point.motion = FREE);
            let found = self.postures(&points).ok()?;
            let each = found.iter().map(|q| self.start.cost(self.robot, q));
            Some(each.sum::<f64>() / found.len() as f64)
        };
        let spin_rad = |k: usize| std::f64::consts::TAU * k as f64 / SPINS as f64;
        let rated = (0..SPINS).map(|k| (cost(spin_rad(k)).unwrap_or(f64::INFINITY), spin_rad(k)));
        let mut rated: Vec<(f64, f64)> = rated.collect();
        rated.sort_by(|a, b| a.0.total_cmp(&b.0));
        rated.into_iter().map(|(_, spin_rad)| spin_rad).collect()
    }
}

type Postures = Result<Vec<Vec<f64>>, ProgramError>;

/// A move that may turn joints as far as limits let it.
const FREE: Motion = Motion::Joint { share: 1.0 };

fn points(head: &Program, path: &[CamPoint], setup: &WorkSetup, spin_rad: f64) -> Vec<PathPoint> {
    let base_from_work = head.world_from_base.inverse() * setup.world_from_work;
    let point = |(i, one): (usize, &CamPoint)| PathPoint {
        base_from_tool: base_from_work
            * Isometry3::from_parts(
                Translation3::from(one.place_m),
                attitude(&one.attitude, spin_rad),
            ),
        motion: match (i, one.feed_m_per_s, setup.rapid) {
            (0, ..) | (_, None, Rapid::Joints) => Motion::Joint {
                share: setup.joint_share,
            },
            (_, Some(speed_m_per_s), _) | (_, None, Rapid::Line { speed_m_per_s }) => {
                Motion::Linear { speed_m_per_s }
            }
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
