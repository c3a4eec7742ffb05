//! The arm's postures along planned and taught segments.

use nalgebra::{Isometry3, Translation3, Unit, UnitQuaternion, Vector3};
use truecut_arm::{BranchOptions, FrameId, IkSolver, Robot};

use super::error::SurfacePathError;
use super::taught::TaughtPoints;
use crate::reach::SingularityLimits;

/// Part of a program.
#[derive(Debug, Clone)]
pub enum Segment {
    /// Poses of the tool, world.
    Planned(Vec<Isometry3<f64>>),
    /// Postures as they were taught; the arm moves freely to the first.
    Taught(TaughtPoints),
}

/// When a joint path counts as good.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SolveOptions {
    pub singularities: SingularityLimits,
    /// Largest motion of a joint from one pose to the next within a planned segment, rad or m.
    pub largest_step: f64,
}

impl Default for SolveOptions {
    fn default() -> Self {
        Self {
            singularities: SingularityLimits::default(),
            largest_step: 0.2,
        }
    }
}

/// Postures of every segment.
#[derive(Debug, Clone, PartialEq)]
pub struct Solved {
    /// `[segment][point]`, rad or m.
    pub segments: Vec<Vec<Vec<f64>>>,
    /// Greatest motion of one joint from the end of each segment to the start of the next.
    pub between: Vec<f64>,
}

/// Copies of a path for a part of `count`-fold symmetry, turned about a turntable's axis: the k-th by k/count of a turn.
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

/// Postures along segments, each the one of shortest travel from the posture before, from `start`.
///
/// # Errors
/// At the first point that is out of reach or limits, too near a singularity, or to which a joint would have to jump.
pub fn solve(
    robot: &Robot,
    segments: &[Segment],
    start: &[f64],
    options: &SolveOptions,
) -> Result<Solved, SurfacePathError> {
    let solver = robot.ik_solver(&BranchOptions::default());
    let mut solved = Solved {
        segments: Vec::new(),
        between: Vec::new(),
    };
    let mut before = start.to_vec();
    for (number, segment) in segments.iter().enumerate() {
        let postures = match segment {
            Segment::Planned(poses) => {
                planned(robot, &solver, poses, &before, options, number + 1)?
            }
            Segment::Taught(points) => points.postures.clone(),
        };
        if let Some(first) = postures.first().filter(|_| number > 0) {
            solved.between.push(largest(&before, first).1);
        }
        if let Some(last) = postures.last() {
            before.clone_from(last);
        }
        solved.segments.push(postures);
    }
    Ok(solved)
}

fn planned(
    robot: &Robot,
    solver: &IkSolver<'_>,
    poses: &[Isometry3<f64>],
    start: &[f64],
    options: &SolveOptions,
    segment: usize,
) -> Result<Vec<Vec<f64>>, SurfacePathError> {
    let mut postures: Vec<Vec<f64>> = Vec::with_capacity(poses.len());
    for (index, pose) in poses.iter().enumerate() {
        let before = postures.last().map_or(start, Vec::as_slice);
        let next = solver.nearest(pose, FrameId::Tool, before);
        let next = next.map_err(|source| SurfacePathError::NotReached {
            segment,
            index: index + 1,
            source,
        })?;
        check_singularity(solver, &next, &options.singularities, segment, index + 1)?;
        let (joint, jump) = largest(before, &next);
        if index > 0 && jump > options.largest_step {
            return Err(SurfacePathError::Jump {
                segment,
                index: index + 1,
                joint: robot.chain.joints[joint].name.clone(),
                jump_deg: jump.to_degrees(),
                limit_deg: options.largest_step.to_degrees(),
            });
        }
        postures.push(next);
    }
    Ok(postures)
}

fn check_singularity(
    solver: &IkSolver<'_>,
    posture: &[f64],
    limits: &SingularityLimits,
    segment: usize,
    index: usize,
) -> Result<(), SurfacePathError> {
    let Some(geometry) = solver.geometry() else {
        return Ok(());
    };
    let distance = geometry.singularity_distance(posture);
    let degrees = |rad: f64| format!("{:.2} deg", rad.to_degrees());
    let millimetres = |m: f64| format!("{:.1} mm", m * 1e3);
    let near = |kind, distance, least| SurfacePathError::Singular {
        segment,
        index,
        kind,
        distance,
        least,
    };
    if distance.wrist_rad < limits.wrist_rad {
        return Err(near(
            "wrist",
            degrees(distance.wrist_rad),
            degrees(limits.wrist_rad),
        ));
    }
    if distance.elbow_rad < limits.elbow_rad {
        return Err(near(
            "elbow",
            degrees(distance.elbow_rad),
            degrees(limits.elbow_rad),
        ));
    }
    if distance.shoulder_m < limits.shoulder_m {
        return Err(near(
            "shoulder",
            millimetres(distance.shoulder_m),
            millimetres(limits.shoulder_m),
        ));
    }
    Ok(())
}

/// The joint that moves most between two postures, and how far.
fn largest(a: &[f64], b: &[f64]) -> (usize, f64) {
    let moves = a.iter().zip(b).map(|(a, b)| (a - b).abs()).enumerate();
    moves.max_by(|a, b| a.1.total_cmp(&b.1)).unwrap_or((0, 0.0))
}
