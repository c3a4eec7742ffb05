//! What is planned: a wheel on a face, and how fast and how finely.

use nalgebra::Vector2;
use truecut_core::wheel::precession::{Boundary, EdgeRule, PrecessionWheel};

/// What moves over which face, and how.
#[derive(Debug, Clone, Copy)]
pub struct PrecessionTask<'a> {
    pub wheel: &'a PrecessionWheel,
    pub boundary: &'a Boundary,
    pub rule: EdgeRule,
    /// Vertices of the path of the patch's middle, straight legs between them, in the face's plane.
    pub path_m: &'a [Vector2<f64>],
    pub feed_m_per_s: f64,
    /// Rate ω2 of the steady turn; negative clockwise, 0 holds the angle.
    pub turn_rad_s: f64,
    /// Angle of the steady turn at the start.
    pub start_rad: f64,
}

/// How fast angle and feed may change.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PrecessionLimits {
    /// Largest rate of the precession angle.
    pub rate_rad_s: f64,
    /// Largest acceleration of the precession angle.
    pub acceleration_rad_s2: f64,
    /// Largest acceleration along the path where the feed is lowered.
    pub feed_acceleration_m_s2: f64,
}

impl PrecessionLimits {
    /// Length T of the moving mean: 2 ω̂/α̂.
    pub(super) fn window_s(&self) -> f64 {
        2.0 * self.rate_rad_s / self.acceleration_rad_s2
    }
}

/// How finely is planned.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PrecessionOptions {
    /// Longest interval of the path.
    pub interval_m: f64,
    /// Angles of the grid, in a turn.
    pub angles: usize,
    /// The feed is not lowered below this share of what is asked.
    pub least_feed_share: f64,
}

impl Default for PrecessionOptions {
    /// 0.1 mm, an eighth of a degree, a hundredth.
    fn default() -> Self {
        Self {
            interval_m: 0.1e-3,
            angles: 2880,
            least_feed_share: 0.01,
        }
    }
}
