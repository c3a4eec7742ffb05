//! The arm's postures along planned and taught segments.

use nalgebra::{Isometry3, Translation3, Unit, UnitQuaternion, Vector3};
use truecut_arm::Robot;

use super::error::SurfacePathError;
use super::taught::TaughtPoints;
use crate::program::{Motion, PathPoint, ProgramError, TravelOptions, shortest_travel};

/// Part of a program.
#[derive(Debug, Clone)]
pub enum Segment {
    /// Poses of the tool, world.
    Planned(Vec<Isometry3<f64>>),
    /// Postures as they were taught; the arm moves freely to the first.
    Taught(TaughtPoints),
}

/// Copies of a path for a part of `count`-fold symmetry, turned about a turntable's axis: the k-th
/// by k/count of a turn.
#[must_use]
pub fn copies(
    poses: &[Isometry3<f64>],
    centre_m: &Vector3<f64>,
    axis: &Unit<Vector3<f64>>,
    count: usize,
) -> Vec<Vec<Isometry3<f64>>> {
    let turned = |k: usize| {
        let angle = std::f64::consts::TAU * k as f64 / count as f64;
        let turn = UnitQuaternion::from_axis_angle(axis, angle);
        let about = Translation3::from(*centre_m)
            * Isometry3::from_parts(Translation3::identity(), turn)
            * Translation3::from(-centre_m);
        poses.iter().map(|pose| about * pose).collect()
    };
    (0..count).map(turned).collect()
}

/// Postures along segments, `[segment][point]`, rad or m: each planned one by [`shortest_travel`]
/// from where the one before ends, the first from `start`.
///
/// # Errors
/// At the first point that is out of reach or limits, too near a singularity, or to which a joint
/// would have to jump.
pub fn solve(
    robot: &Robot,
    segments: &[Segment],
    start: &[f64],
    options: &TravelOptions,
) -> Result<Vec<Vec<Vec<f64>>>, SurfacePathError> {
    let mut solved = Vec::with_capacity(segments.len());
    let mut before = start.to_vec();
    for (number, segment) in segments.iter().enumerate() {
        let postures = match segment {
            Segment::Planned(poses) => {
                planned(robot, poses, &before, options).map_err(|source| {
                    SurfacePathError::Travel {
                        segment: number + 1,
                        source,
                    }
                })?
            }
            Segment::Taught(points) => points.postures.clone(),
        };
        if let Some(last) = postures.last() {
            before.clone_from(last);
        }
        solved.push(postures);
    }
    Ok(solved)
}

/// How fast the tool runs says nothing of where the joints stand.
const ANY_SPEED: Motion = Motion::Linear { speed_m_per_s: 1.0 };

fn planned(
    robot: &Robot,
    poses: &[Isometry3<f64>],
    start: &[f64],
    options: &TravelOptions,
) -> Result<Vec<Vec<f64>>, ProgramError> {
    let points: Vec<PathPoint> = (poses.iter())
        .map(|pose| PathPoint {
            base_from_tool: *pose,
            motion: ANY_SPEED,
            turntable_rad: None,
        })
        .collect();
    let flange_from_tool = &robot.frames.flange_from_tool;
    let world = Isometry3::identity();
    shortest_travel(
        robot,
        flange_from_tool,
        &world,
        &points,
        Some(start),
        options,
    )
}
