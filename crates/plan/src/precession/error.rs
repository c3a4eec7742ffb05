//! Why there is no trajectory of the precession angle.

use nalgebra::Vector2;
use thiserror::Error;
use truecut_arm::ArmError;
use truecut_core::wheel::precession::PrecessionError;

use super::task::{PrecessionLimits, PrecessionOptions, PrecessionTask};

use crate::bounds::OutOfBounds;

/// Why there is no trajectory of the precession angle. `along_m` is the distance from the path's
/// start.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum PrecessionPlanError {
    #[error(
        "the path has {count} points; it needs two at least, all finite and no two that follow each other the same"
    )]
    Path { count: usize },
    #[error(transparent)]
    OutOfBounds(#[from] OutOfBounds),
    #[error("{:.2} mm from the path's start {source}", along_m * 1e3)]
    Place {
        along_m: f64,
        source: PrecessionError,
    },
    #[error(
        "{:.2} mm from the path's start angles are left at every point, but none for a stretch of {:.4} mm as a whole", along_m * 1e3, stretch_m * 1e3
    )]
    Abrupt { along_m: f64, stretch_m: f64 },
    #[error(
        "{:.2} mm from the path's start the angle cannot follow: even at {:.3} mm/s, the least feed allowed, edges ask for more than the rate and acceleration that limits and joints leave it", along_m * 1e3, least_m_per_s * 1e3
    )]
    TooNarrow { along_m: f64, least_m_per_s: f64 },
    #[error(
        "{:.2} mm from the path's start joint \"{joint}\" is too fast even at {:.3} mm/s, the least feed allowed", along_m * 1e3, least_m_per_s * 1e3
    )]
    JointTooFast {
        along_m: f64,
        joint: String,
        least_m_per_s: f64,
    },
    #[error(transparent)]
    Arm(#[from] ArmError),
}

/// The ranges of a task's numbers.
pub(super) fn check(
    task: &PrecessionTask<'_>,
    limits: &PrecessionLimits,
    options: &PrecessionOptions,
) -> Result<(), PrecessionPlanError> {
    let finite = |p: &Vector2<f64>| p.iter().all(|c| c.is_finite());
    let moves = task.path_m.windows(2).all(|w| w[0] != w[1]);
    if task.path_m.len() < 2 || !task.path_m.iter().all(finite) || !moves {
        let count = task.path_m.len();
        return Err(PrecessionPlanError::Path { count });
    }
    let positive = |value: f64| value > 0.0 && value.is_finite();
    let angles = options.angles as f64;
    let share = options.least_feed_share;
    let above_zero = |quantity, value| (quantity, value, positive(value), "finite and above 0");
    let any = |quantity, value: f64| (quantity, value, value.is_finite(), "finite");
    let rules = [
        above_zero("the feed (m/s)", task.feed_m_per_s),
        any("the rate of the steady turn (rad/s)", task.turn_rad_s),
        any("the angle at the start (rad)", task.start_rad),
        above_zero("the largest rate of the angle (rad/s)", limits.rate_rad_s),
        above_zero(
            "the largest acceleration of the angle (rad/s2)",
            limits.acceleration_rad_s2,
        ),
        above_zero(
            "the largest acceleration of the feed (m/s2)",
            limits.feed_acceleration_m_s2,
        ),
        above_zero("the longest interval (m)", options.interval_m),
        (
            "the number of angles",
            angles,
            (16.0..=16384.0).contains(&angles),
            "16 to 16384",
        ),
        (
            "the least share of the feed",
            share,
            share > 0.0 && share <= 1.0,
            "above 0 and at most 1",
        ),
    ];
    for (quantity, value, good, rule) in rules {
        OutOfBounds::unless(good, quantity, value, rule)?;
    }
    Ok(())
}
