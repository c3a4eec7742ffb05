//! The motion along taught postures, as a robot plays moves by joints.
//!
//! From posture to posture all joints move together, as long as the tool's way takes at the feed,
//! or the slowest joint at its share of the top speed. Corners are blended as a trajectory's are.

use nalgebra::{DVector, Vector3};
use truecut_arm::{FrameId, Robot};

use super::joints::slowest_joint_s;
use super::timing::{LeadIn, TimingLaw};
use super::trajectory::Trajectory;

/// Parts in which the tool's way from posture to posture is measured.
const PARTS: usize = 16;
/// A posture that is reached sooner is the one before, rounded.
const LEAST_MOVE_S: f64 = 1e-6;
/// Time in which the arm comes up to speed, and in which it comes to rest, s.
const RAMP: TimingLaw = TimingLaw::RestToRest(LeadIn { duration_s: 0.3 });

/// How fast taught postures are played.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TaughtSpeeds {
    /// Speed of the tool point, m/s.
    pub feed_m_per_s: f64,
    /// Largest speed of a joint, share of its top speed.
    pub joint_share: f64,
}

/// The trajectory through taught postures; those that repeat the one before, but for rounding, are
/// left out. `None` if fewer than two remain.
#[must_use]
pub fn through_taught(
    robot: &Robot,
    postures: &[Vec<f64>],
    speeds: TaughtSpeeds,
) -> Option<Trajectory<DVector<f64>>> {
    let mut knots: Vec<(f64, DVector<f64>)> = Vec::new();
    for posture in postures {
        let posture = DVector::from_vec(posture.clone());
        let at_s = match knots.last() {
            None => 0.0,
            Some((at_s, before)) => {
                let move_s = move_s(robot, before, &posture, speeds);
                if move_s < LEAST_MOVE_S {
                    continue;
                }
                at_s + move_s
            }
        };
        knots.push((at_s, posture));
    }
    (knots.len() > 1).then(|| Trajectory::new(knots, RAMP))
}

/// How long a move takes by itself.
fn move_s(robot: &Robot, from: &DVector<f64>, to: &DVector<f64>, speeds: TaughtSpeeds) -> f64 {
    let between = |k: usize| from + (to - from) * (k as f64 / PARTS as f64);
    let parts: Vec<Vec<f64>> = (0..=PARTS)
        .map(|k| between(k).as_slice().to_vec())
        .collect();
    let path_m = tool_path_mm(robot, &parts)[PARTS] * 1e-3;
    let joints_s = slowest_joint_s(robot, from.as_slice(), to.as_slice(), speeds.joint_share);
    joints_s.max(path_m / speeds.feed_m_per_s)
}

/// How far the tool point has come at each of these postures, mm.
#[must_use]
pub fn tool_path_mm(robot: &Robot, postures: &[Vec<f64>]) -> Vec<f64> {
    let (mut path_mm, mut before) = (0.0, None::<Vector3<f64>>);
    let ways = postures.iter().map(|posture| {
        let pose = robot.world_from_frame(posture, FrameId::Tool);
        let at = pose.translation.vector;
        path_mm += before.map_or(0.0, |before| (at - before).norm() * 1e3);
        before = Some(at);
        path_mm
    });
    ways.collect()
}
