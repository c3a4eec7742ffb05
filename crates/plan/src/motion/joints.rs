//! Moves by joints.

use truecut_arm::Robot;

use super::timing::{LEAST_JERK_PEAK, least_jerk};

/// Speed of a joint over a step; rad/s or m/s.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct JointSpeed {
    /// Index in the chain.
    pub joint: usize,
    pub speed: f64,
    pub limit: f64,
}

impl JointSpeed {
    /// Speed over its limit.
    #[must_use]
    pub fn share(&self) -> f64 {
        self.speed / self.limit
    }

    #[must_use]
    pub fn is_too_fast(&self) -> bool {
        self.speed > self.limit
    }
}

/// Speeds at which joints go from posture to posture in `time_s`, those without a speed limit left
/// out.
pub fn joint_speeds<'a>(
    robot: &'a Robot,
    from: &'a [f64],
    to: &'a [f64],
    time_s: f64,
) -> impl Iterator<Item = JointSpeed> + 'a {
    let each = robot.chain.joints.iter().zip(from.iter().zip(to));
    each.enumerate().filter_map(move |(joint, (one, (a, b)))| {
        Some(JointSpeed {
            joint,
            speed: (b - a).abs() / time_s,
            limit: one.limits?.velocity,
        })
        .filter(|one| one.limit.is_finite())
    })
}

/// Time that the slowest joint takes from posture to posture at a share of its top speed, s; joints
/// without a speed are not looked at.
#[must_use]
pub fn slowest_joint_s(robot: &Robot, from: &[f64], to: &[f64], share: f64) -> f64 {
    let each = robot.chain.joints.iter().zip(from.iter().zip(to));
    let times = each.filter_map(|(joint, (from, to))| {
        Some((to - from).abs() / (share * joint.limits?.velocity))
    });
    times.filter(|time| time.is_finite()).fold(0.0, f64::max)
}

/// Postures at even times on a move by joints from rest to rest, its two ends left out. All joints
/// move together, by the law of least jerk; the fastest reaches its share of its top speed, and the
/// move takes `least_s` at least.
#[must_use]
pub fn move_by_joints(
    robot: &Robot,
    [from, to]: [&[f64]; 2],
    share: f64,
    least_s: f64,
    interval_s: f64,
) -> Vec<Vec<f64>> {
    let time_s = (LEAST_JERK_PEAK * slowest_joint_s(robot, from, to, share)).max(least_s);
    let count = (time_s / interval_s).ceil() as usize;
    let knot = |k: usize| {
        let part = least_jerk(k as f64 / count as f64);
        let each = from.iter().zip(to);
        each.map(|(a, b)| a + part * (b - a)).collect()
    };
    (1..count).map(knot).collect()
}
