//! Postures along poses, and the places at which an arm cannot be led.

use thiserror::Error;
use truecut_arm::{ArmErrorKind, IkSolver, Robot};

/// Nearest to a wrist or elbow singularity that a path may come, rad: joint speeds are some sixty
/// times as high there.
const LEAST_ANGLE_RAD: f64 = 0.017_453_292_519_943_295;
/// Nearest that the wrist may come to the first axis, m.
const LEAST_SHOULDER_M: f64 = 5e-3;
/// What is nearer to the start than is printed, mm.
const START_MM: f64 = 0.05;

/// Why an arm cannot be led along a path.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum FollowError {
    /// Inverse kinematics found nothing.
    #[error("{}: {reason}", cannot_follow(*.at_mm))]
    Unreachable { at_mm: f64, reason: String },
    /// A joint would have to jump.
    #[error(
        "{}: joint `{joint}` would have to turn by {jump_rad:.3} rad within {within_mm:.1} mm, more than \
         {limit_rad} rad: a singularity, or another branch",
        cannot_follow(*.at_mm)
    )]
    Jump {
        at_mm: f64,
        within_mm: f64,
        joint: String,
        jump_rad: f64,
        limit_rad: f64,
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
    /// `from` names what distances are counted from, `advice` what helps.
    #[error(
        "joint `{joint}` would have to move at {speed_deg_s:.2} deg/s {at_mm:.1} mm from {from}'s start, \
         but can do {limit_deg_s:.2} deg/s: {advice}"
    )]
    TooFast {
        joint: String,
        speed_deg_s: f64,
        limit_deg_s: f64,
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
            jump_rad,
            limit_rad,
        } => (
            *index,
            FollowError::Jump {
                at_mm: at_mm(*index),
                within_mm: at_mm(*index) - at_mm(index.saturating_sub(1)),
                joint: joint.clone(),
                jump_rad: *jump_rad,
                limit_rad: *limit_rad,
            },
        ),
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
    let nearest = |of: &dyn Fn(usize) -> f64| {
        let all = (0..knots.len()).map(|k| (k, of(k)));
        all.min_by(|a, b| a.1.total_cmp(&b.1))
    };
    let distance = |k: usize| geometry.singularity_distance(&knots[k]);
    let deg = |rad: f64| format!("{:.3} degrees", rad.to_degrees());
    let millimetres = |m: f64| format!("{:.3} mm", m * 1e3);
    type Distance<'a> = (
        &'static str,
        &'a dyn Fn(usize) -> f64,
        f64,
        &'a dyn Fn(f64) -> String,
    );
    let kinds: [Distance<'_>; 3] = [
        (
            "wrist singularity (axes 4 and 6 in line)",
            &|k| distance(k).wrist_rad,
            LEAST_ANGLE_RAD,
            &deg,
        ),
        (
            "elbow singularity (arm stretched or folded)",
            &|k| distance(k).elbow_rad,
            LEAST_ANGLE_RAD,
            &deg,
        ),
        (
            "shoulder singularity (wrist over the first axis)",
            &|k| distance(k).shoulder_m,
            LEAST_SHOULDER_M,
            &millimetres,
        ),
    ];
    for (kind, of, least, show) in kinds {
        if let Some((k, near)) = nearest(of)
            && near < least
        {
            return Err(FollowError::Singular {
                kind,
                at_mm: at_mm(k),
                near: show(near),
                least: show(least),
            });
        }
    }
    Ok(())
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
        for (index, joint) in robot.chain.joints.iter().enumerate() {
            let Some(limits) = joint.limits else { continue };
            let speed = (pair[1][index] - pair[0][index]).abs() / interval_s;
            if speed > limits.velocity {
                return Err(FollowError::TooFast {
                    joint: joint.name.clone(),
                    speed_deg_s: speed.to_degrees(),
                    limit_deg_s: limits.velocity.to_degrees(),
                    at_mm: at_mm(k),
                    from,
                    advice,
                });
            }
        }
    }
    Ok(())
}
