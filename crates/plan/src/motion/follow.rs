//! Postures along poses, and the places at which an arm cannot be led.

use thiserror::Error;
use truecut_arm::{ArmErrorKind, IkSolver, JointKind, Robot};

use super::joints::{JointSpeed, joint_speeds};
use crate::singularity::SingularityLimits;

/// Nearest to a singularity that a path may come: joint speeds are some sixty times as high a
/// degree from that of wrist or elbow.
const LEAST: SingularityLimits = SingularityLimits {
    wrist_rad: LEAST_ANGLE_RAD,
    elbow_rad: LEAST_ANGLE_RAD,
    shoulder_m: 5e-3,
};
/// A degree.
const LEAST_ANGLE_RAD: f64 = 0.017_453_292_519_943_295;
/// What is nearer to the start than is printed, mm.
const START_MM: f64 = 0.05;

/// Why an arm cannot be led along a path.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum FollowError {
    /// Inverse kinematics found nothing.
    #[error("{}: {reason}", cannot_follow(*.at_mm))]
    Unreachable { at_mm: f64, reason: String },
    /// A joint would have to jump, in deg or mm.
    #[error(
        "{}: joint `{joint}` would have to move by {jump:.2} {unit} within {within_mm:.1} mm, more than \
         {limit:.2} {unit}: a singularity, a joint limit or another branch",
        cannot_follow(*.at_mm)
    )]
    Jump {
        at_mm: f64,
        within_mm: f64,
        joint: String,
        jump: f64,
        limit: f64,
        unit: &'static str,
    },
    /// No posture at the start is of the branch asked for.
    #[error(
        "{reached} postures reach the start within the joint limits, but none with the shoulder, elbow \
         and wrist asked for"
    )]
    NoBranch { reached: usize },
    #[error("no posture reaches the start")]
    NoStart,
    /// More than fits into memory.
    #[error(
        "the way takes {duration_s:.4e} s, but must take at most {longest_s} s: a run fits into memory; \
         {advice}"
    )]
    TooLong {
        duration_s: f64,
        longest_s: f64,
        advice: &'static str,
    },
    /// Something else is wrong with the arm.
    #[error("{0}")]
    Arm(String),
    /// `near` and `least` with their units.
    #[error(
        "the path comes within {near} of a {kind} {at_mm:.1} mm from its start, but must stay {least} \
         away: joint speeds have no bound there"
    )]
    Singular {
        kind: &'static str,
        at_mm: f64,
        near: String,
        least: String,
    },
    /// Speeds are in `unit`, those of a slide in mm/s. `from` names what distances are counted
    /// from, `advice` what helps.
    #[error(
        "joint `{joint}` would have to move at {speed:.2} {unit} {at_mm:.1} mm from {from}'s start, \
         but can do {limit:.2} {unit}: {advice}"
    )]
    TooFast {
        joint: String,
        speed: f64,
        limit: f64,
        unit: &'static str,
        at_mm: f64,
        from: &'static str,
        advice: &'static str,
    },
}

fn cannot_follow(at_mm: f64) -> String {
    if at_mm < START_MM {
        "the tool cannot be put to the start of the path".to_owned()
    } else {
        format!("the tool cannot follow the path beyond {at_mm:.1} mm from its start")
    }
}

/// Distance of a knot from the path's start, mm.
pub type AtMm<'a> = dyn Fn(usize) -> f64 + 'a;

/// At which knot a path cannot be followed, and why.
#[must_use]
pub fn leaves(kind: &ArmErrorKind, at_mm: &AtMm<'_>) -> (usize, FollowError) {
    match kind {
        ArmErrorKind::OnPath { index, source } => (
            *index,
            FollowError::Unreachable {
                at_mm: at_mm(*index),
                reason: source.to_string(),
            },
        ),
        ArmErrorKind::PathBreaks {
            index,
            joint,
            jump,
            limit,
            unit,
        } => {
            let (scale, unit) = match *unit {
                "rad" => (1_f64.to_degrees(), "deg"),
                _ => (1e3, "mm"),
            };
            let jump = FollowError::Jump {
                at_mm: at_mm(*index),
                within_mm: at_mm(*index) - at_mm(index.saturating_sub(1)),
                joint: joint.clone(),
                jump: jump * scale,
                limit: limit * scale,
                unit,
            };
            (*index, jump)
        }
        other => (0, FollowError::Arm(other.to_string())),
    }
}

/// Refuses postures near a singularity; arms without a closed form have none that could be named.
///
/// # Errors
/// The knot that is nearest to one.
pub fn check_singularities(
    solver: &IkSolver<'_>,
    knots: &[Vec<f64>],
    at_mm: &AtMm<'_>,
) -> Result<(), FollowError> {
    let Some(geometry) = solver.geometry() else {
        return Ok(());
    };
    let distances = knots.iter().map(|q| geometry.singularity_distance(q));
    let within = distances
        .enumerate()
        .filter(|(_, distance)| !LEAST.allow(distance));
    let near = within.map(|(k, distance)| (k, LEAST.nearest(&distance)));
    let Some((k, near)) = near.min_by(|a, b| a.1.share.total_cmp(&b.1.share)) else {
        return Ok(());
    };
    Err(FollowError::Singular {
        kind: match near.kind {
            "wrist" => "wrist singularity (axes 4 and 6 in line)",
            "elbow" => "elbow singularity (arm stretched or folded)",
            _ => "shoulder singularity (wrist over the first axis)",
        },
        at_mm: at_mm(k),
        near: near.distance,
        least: near.least,
    })
}

/// Refuses a motion that takes longer than a run may. `advice` says what helps.
///
/// # Errors
/// If it does.
pub fn check_duration(
    duration_s: f64,
    longest_s: f64,
    advice: &'static str,
) -> Result<(), FollowError> {
    if duration_s <= longest_s {
        return Ok(());
    }
    Err(FollowError::TooLong {
        duration_s,
        longest_s,
        advice,
    })
}

/// Refuses a command with knots at even times on which a joint is faster than it can be. `from`
/// names what distances are counted from, `advice` what helps.
///
/// # Errors
/// The first joint of the first interval.
pub fn check_speeds(
    robot: &Robot,
    knots: &[Vec<f64>],
    interval_s: f64,
    at_mm: &AtMm<'_>,
    from: &'static str,
    advice: &'static str,
) -> Result<(), FollowError> {
    for (k, pair) in knots.windows(2).enumerate() {
        let mut speeds = joint_speeds(robot, &pair[0], &pair[1], interval_s);
        if let Some(fast) = speeds.find(JointSpeed::is_too_fast) {
            let joint = &robot.chain.joints[fast.joint];
            let (scale, unit) = match joint.kind {
                JointKind::Revolute => (1_f64.to_degrees(), "deg/s"),
                JointKind::Prismatic => (1e3, "mm/s"),
            };
            return Err(FollowError::TooFast {
                joint: joint.name.clone(),
                speed: fast.speed * scale,
                limit: fast.limit * scale,
                unit,
                at_mm: at_mm(k),
                from,
                advice,
            });
        }
    }
    Ok(())
}
