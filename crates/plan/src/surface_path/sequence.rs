//! From lines and taught points, for one copy or many, to a robot program.

use nalgebra::{Isometry3, Translation3, Unit, UnitQuaternion, Vector3};
use truecut_arm::{FrameId, Robot};

use super::error::SurfacePathError;
use super::solve::{Segment, copies, solve};
use crate::program::{Motion, Move, Program, TravelOptions, Zone};

/// A part of N-fold symmetry.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Symmetry {
    pub count: usize,
    /// A point of the axis, world, m.
    pub centre_m: Vector3<f64>,
    /// Copy k stands k/count of a turn from the first, right-handed about this.
    pub axis: Unit<Vector3<f64>>,
    /// Whether a turntable brings each copy to where the first one was; else the arm goes to each.
    pub turntable: bool,
}

impl Symmetry {
    /// Where the copies stand against the first one, which is the first.
    pub fn places(&self) -> impl Iterator<Item = Isometry3<f64>> {
        let centre = Translation3::from(self.centre_m);
        let (axis, count) = (self.axis, self.count);
        (0..count).map(move |k| {
            let angle = std::f64::consts::TAU * k as f64 / count as f64;
            centre * UnitQuaternion::from_axis_angle(&axis, angle) * centre.inverse()
        })
    }
}

/// A segment of one copy.
#[derive(Debug, Clone)]
pub struct Part {
    pub segment: Segment,
    /// Copy of the part, from 0.
    pub copy: usize,
    /// Which segment of the copy, from 0.
    pub index: usize,
    /// How far the turntable has turned, right-handed about its axis.
    pub turntable_rad: Option<f64>,
}

/// How fast a program runs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Speeds {
    /// Along lines, m/s.
    pub feed_m_per_s: f64,
    /// Of moves by joints, share of the top speed.
    pub joint_share: f64,
}

/// The segments of every copy in turn. A turntable turns by −k/count of a turn for copy k, which
/// brings it to where copy 0 was; an arm goes there.
///
/// # Errors
/// If the arm is to carry taught postures to another copy: postures do not turn.
pub fn parts_of(
    segments: &[Segment],
    symmetry: Option<&Symmetry>,
) -> Result<Vec<Part>, SurfacePathError> {
    let part = |(index, segment): (usize, &Segment), copy, turntable_rad| Part {
        segment: segment.clone(),
        copy,
        index,
        turntable_rad,
    };
    let numbered = || segments.iter().enumerate();
    let Some(symmetry) = symmetry else {
        return Ok(numbered().map(|one| part(one, 0, None)).collect());
    };
    if symmetry.turntable {
        let turned = |k: usize| -std::f64::consts::TAU * k as f64 / symmetry.count as f64;
        let all = (0..symmetry.count)
            .flat_map(|k| numbered().map(move |one| part(one, k, Some(turned(k)))));
        return Ok(all.collect());
    }
    let mut all = Vec::new();
    for (index, segment) in numbered() {
        let Segment::Planned(poses) = segment else {
            return Err(SurfacePathError::TaughtTurned);
        };
        let turned = copies(poses, &symmetry.centre_m, &symmetry.axis, symmetry.count);
        all.extend(turned.into_iter().enumerate().map(|(copy, poses)| Part {
            segment: Segment::Planned(poses),
            copy,
            index,
            turntable_rad: None,
        }));
    }
    all.sort_by_key(|part| (part.copy, part.index));
    Ok(all)
}

/// A program through parts: by joints to the first point of each, along lines through planned ones,
/// by joints through taught ones. Path points count from 0 through the whole program; `head` gives
/// all but the moves.
///
/// # Errors
/// As [`solve`].
pub fn program_of(
    robot: &Robot,
    head: Program,
    parts: &[Part],
    start: &[f64],
    speeds: Speeds,
    options: &TravelOptions,
) -> Result<Program, SurfacePathError> {
    let segments: Vec<Segment> = parts.iter().map(|part| part.segment.clone()).collect();
    let solved = solve(robot, &segments, start, options)?;
    let base_from_world = head.world_from_base.inverse();
    let by_joints = Motion::Joint {
        share: speeds.joint_share,
    };
    let on_line = Motion::Linear {
        speed_m_per_s: speeds.feed_m_per_s,
    };
    let mut moves = Vec::new();
    for (part, postures) in parts.iter().zip(solved) {
        for (k, posture) in postures.into_iter().enumerate() {
            let (world_from_tool, motion) = match &part.segment {
                Segment::Planned(poses) => (poses[k], if k == 0 { by_joints } else { on_line }),
                Segment::Taught(_) => (robot.world_from_frame(&posture, FrameId::Tool), by_joints),
            };
            moves.push(Move {
                path_point: moves.len(),
                base_from_tool: base_from_world * world_from_tool,
                motion,
                zone: Zone::default(),
                turntable_rad: part.turntable_rad,
                posture,
            });
        }
    }
    Ok(Program { moves, ..head })
}
