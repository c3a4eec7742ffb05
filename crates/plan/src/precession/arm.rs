//! The arm that leads the wheel: postures along the plan, and the feed at which its joints keep up.

use nalgebra::{DMatrix, DVector, Isometry3, Point3, Unit, Vector2, Vector3};
use truecut_arm::{ArmError, FrameId, IkSolver, PathOptions, Robot, tool_pose};
use truecut_core::wheel::precession::PrecessionWheel;

use super::feed::FeedPace;
use super::{
    PrecessionLimits, PrecessionOptions, PrecessionPlan, PrecessionPlanError, PrecessionPoint,
    PrecessionTask,
};
use crate::motion::joints::{JointSpeed, joint_speeds};

/// A joint that is too fast is brought to this share of its limit, so that rounding does not ask
/// for another pass.
const AIM: f64 = 0.999;

/// Share of a joint's limit that the feed may take before it is lowered; the rest is left to the
/// angle.
const MOST_BY_FEED: f64 = 0.5;

/// An arm before a face. The tool frame's origin is the wheel's centre, its z axis the spin axis
/// towards the face.
#[derive(Debug, Clone, Copy)]
pub struct ArmOnFace<'a> {
    pub robot: &'a Robot,
    pub solver: &'a IkSolver<'a>,
    /// The face's frame in the world: z its outward normal.
    pub world_from_face: Isometry3<f64>,
    /// Where the tool's x axis points, as far as the spin axis lets it; world.
    pub zero_direction: Vector3<f64>,
    /// Posture that chooses the branch at the start.
    pub start: &'a [f64],
}

/// A plan with the postures that carry it out.
#[derive(Debug, Clone, PartialEq)]
pub struct ArmPlan {
    pub plan: PrecessionPlan,
    /// One for each point of the plan.
    pub postures: Vec<Vec<f64>>,
}

impl ArmOnFace<'_> {
    /// Pose of the tool that carries the wheel over a point of the face, the spin axis leaning
    /// towards an angle.
    pub(crate) fn pose(
        &self,
        wheel: &PrecessionWheel,
        point_m: &Vector2<f64>,
        angle_rad: f64,
    ) -> Result<Isometry3<f64>, ArmError> {
        let centre = Point3::new(point_m.x, point_m.y, wheel.centre_height_m());
        let towards_face = -(self.world_from_face * wheel.axis(angle_rad));
        let axis = Unit::new_normalize(towards_face);
        let centre = self.world_from_face * centre;
        tool_pose(&centre.coords, &axis, &self.zero_direction, 0.0)
    }

    /// Speeds of the joints in the interval after point `k`.
    fn speeds<'p>(
        &'p self,
        plan: &PrecessionPlan,
        postures: &'p [Vec<f64>],
        k: usize,
    ) -> impl Iterator<Item = JointSpeed> + 'p {
        let taken_s = plan.points[k + 1].time_s - plan.points[k].time_s;
        joint_speeds(self.robot, &postures[k], &postures[k + 1], taken_s)
    }

    /// Slows angle or feed wherever a joint is too fast; whether it had to.
    fn hold_back(
        &self,
        plan: &PrecessionPlan,
        postures: &[Vec<f64>],
        pace: &mut FeedPace,
        window_s: f64,
    ) -> Result<bool, PrecessionPlanError> {
        let times: Vec<f64> = plan.points.iter().map(|p| p.time_s).collect();
        let mut held = false;
        for k in 0..plan.points.len() - 1 {
            let speeds = self.speeds(plan, postures, k);
            let fastest = speeds.max_by(|a, b| a.share().total_cmp(&b.share()));
            let Some(fastest) = fastest.filter(|fastest| fastest.share() > 1.0) else {
                continue;
            };
            let share = fastest.share();
            held = true;
            let too_fast = |least_m_per_s| PrecessionPlanError::JointTooFast {
                along_m: plan.points[k].along_m,
                joint: self.robot.chain.joints[fastest.joint].name.clone(),
                least_m_per_s,
            };
            let by_feed = self.share_by_feed(plan, &postures[k], k, &fastest);
            if by_feed > MOST_BY_FEED {
                let share = AIM * MOST_BY_FEED / by_feed;
                pace.slow_to(k, share).map_err(too_fast)?;
            }
            // What the angle adds, and what is left for it.
            let by_angle = (share - by_feed).max(share - MOST_BY_FEED);
            let left = AIM * (1.0 - by_feed).max(1.0 - MOST_BY_FEED);
            let turned_rad = plan.points[k + 1].angle_rad - plan.points[k].angle_rad;
            let rate_rad_s = turned_rad.abs() / (times[k + 1] - times[k]);
            let half_s = 0.5 * window_s;
            let (from_s, to_s) = (times[k] - half_s, times[k + 1] + half_s);
            pace.hold_rate(
                rate_rad_s * (left / by_angle).min(1.0),
                from_s,
                to_s,
                &times,
            );
        }
        Ok(held)
    }

    /// Speed over its limit that the feed alone asks of a joint, the spin axis kept: J q̇ = (feed,
    /// 0). Infinite where the arm is singular.
    fn share_by_feed(&self, plan: &PrecessionPlan, q: &[f64], k: usize, of: &JointSpeed) -> f64 {
        let (from, to) = (&plan.points[k], &plan.points[k + 1]);
        let moved = (to.point_m - from.point_m) / (to.time_s - from.time_s);
        let feed = self.world_from_face * Vector3::new(moved.x, moved.y, 0.0);
        let jacobian = self.robot.jacobian(q, FrameId::Tool);
        let square = DMatrix::from_fn(6, jacobian.ncols(), |r, c| jacobian[(r, c)]);
        let twist = DVector::from_column_slice(&[feed.x, feed.y, feed.z, 0.0, 0.0, 0.0]);
        let speeds = square.lu().solve(&twist);
        speeds.map_or(f64::INFINITY, |speeds| speeds[of.joint].abs() / of.limit)
    }
}

impl PrecessionTask<'_> {
    /// The angle along the path and the postures, every joint within its speed limit.
    ///
    /// # Errors
    /// As [`Self::plan`]; if the path leaves the arm's reach or limits or makes it jump; or if a
    /// joint stays too fast.
    pub fn plan_for_arm(
        &self,
        arm: &ArmOnFace<'_>,
        limits: &PrecessionLimits,
        options: &PrecessionOptions,
    ) -> Result<ArmPlan, PrecessionPlanError> {
        let (intervals, mut pace) = self.prepared(limits, options)?;
        loop {
            let plan = self.planned(&intervals, &mut pace, limits, options)?;
            let pose = |p: &PrecessionPoint| arm.pose(self.wheel, &p.point_m, p.angle_rad);
            let poses: Vec<_> = plan.points.iter().map(pose).collect::<Result<_, _>>()?;
            let steps = PathOptions::default();
            let postures = (arm.solver).follow(&poses, FrameId::Tool, arm.start, &steps)?;
            if arm.hold_back(&plan, &postures, &mut pace, limits.window_s())? {
                pace.settle();
                continue;
            }
            return Ok(ArmPlan { plan, postures });
        }
    }
}
