//! Why a plan cannot be made.

use nalgebra::Vector3;
use thiserror::Error;
use truecut_arm::ArmError;

use crate::assessment::{Assessment, Stability};
use crate::criterion::Criterion;

/// Why a plan cannot be made. `along_m` is the distance from the path's start.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum PlanError {
    #[error("the path has {count} points; it needs two at least, all finite and no two the same")]
    PathPoints { count: usize },
    #[error(
        "the feed of leg {leg} of the path stands at {angle_deg:.2} deg to the tool axis; a milling path runs across it, at 90 deg"
    )]
    FeedAlongTool { leg: usize, angle_deg: f64 },
    #[error(
        "the arm is not one with an ortho-parallel basis and a spherical wrist, for which postures are planned"
    )]
    NotOrthoParallel,
    #[error(
        "the path leaves the arm's reach {along}, at {point}: no redundancy angle brings the tool there",
        along = along(*along_m), point = point(point_m)
    )]
    OutOfReach { along_m: f64, point_m: Vector3<f64> },
    #[error(
        "the path leaves the joint limits {along}, at {point}: the posture that misses them least, at a redundancy angle of {angle_deg:.1} deg, breaks those of joint \"{joint}\" by {excess_deg:.2} deg",
        along = along(*along_m), point = point(point_m)
    )]
    OutsideLimits {
        along_m: f64,
        point_m: Vector3<f64>,
        angle_deg: f64,
        joint: String,
        excess_deg: f64,
    },
    #[error(
        "the path runs through a {kind} singularity {along}, at {point}: the posture furthest from it, at a redundancy angle of {angle_deg:.1} deg, is {distance} away; at least {least} are asked",
        along = along(*along_m), point = point(point_m)
    )]
    Singular {
        kind: &'static str,
        along_m: f64,
        point_m: Vector3<f64>,
        angle_deg: f64,
        distance: String,
        least: String,
    },
    #[error(
        "the arm would have to jump to another branch {along}, at {point}: no posture reaches both sides",
        along = along(*along_m), point = point(point_m)
    )]
    Broken { along_m: f64, point_m: Vector3<f64> },
    #[error(
        "no redundancy angle is stable by {criterion} {along}, at {point}: {}",
        least_bad(*criterion, *angle_deg, assessment, *needed),
        along = along(*along_m), point = point(point_m)
    )]
    NoStableAngle {
        criterion: Criterion,
        along_m: f64,
        point_m: Vector3<f64>,
        /// The angle that misses stability least.
        angle_deg: f64,
        assessment: Assessment,
        /// What the assessed value would have to be: an anisotropy, or a depth in m.
        needed: f64,
    },
    #[error(
        "stable angles do not hang together by {criterion}: {along}, at {point}, none that is stable can be reached from those before"
        , along = along(*along_m), point = point(point_m)
    )]
    Parted {
        criterion: Criterion,
        along_m: f64,
        point_m: Vector3<f64>,
    },
    #[error(
        "the plan asks {speed_deg_s:.1} deg/s of joint \"{joint}\" {along}, at {point}, at the cut's feed; it turns no faster than {limit_deg_s:.1} deg/s",
        along = along(*along_m), point = point(point_m)
    )]
    TooFast {
        along_m: f64,
        point_m: Vector3<f64>,
        joint: String,
        speed_deg_s: f64,
        limit_deg_s: f64,
    },
    #[error(transparent)]
    Arm(#[from] ArmError),
}

fn along(along_m: f64) -> String {
    format!("{:.1} mm from its start", along_m * 1e3)
}

fn point(p: &Vector3<f64>) -> String {
    format!("({:.4}, {:.4}, {:.4}) m", p.x, p.y, p.z)
}

fn least_bad(criterion: Criterion, angle_deg: f64, found: &Assessment, needed: f64) -> String {
    let short = 100.0 * (1.0 - found.value / needed);
    match (criterion, found.decay) {
        (_, Some(decay)) if found.stability() == Stability::Marginal && found.margin >= 0.0 => {
            format!(
                "the least bad, {angle_deg:.1} deg, does not chatter, but vibration dies away at {:.3} 1/s where {:.3} 1/s are asked",
                -decay.growth_per_s, decay.least_per_s
            )
        }
        (Criterion::Anisotropy, _) => format!(
            "the least bad, {angle_deg:.1} deg, has r = {:.3} where {needed} is asked, {short:.1} % short",
            found.value
        ),
        _ => format!(
            "the least bad, {angle_deg:.1} deg, is stable to {:.4} mm where {:.4} mm are asked, {short:.1} % short",
            found.value * 1e3,
            needed * 1e3
        ),
    }
}
