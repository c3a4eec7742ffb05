//! Joint paths at given redundancy angles: followed, assessed, checked for speed.

use rayon::prelude::*;

use crate::criterion::Criterion;
use crate::error::PlanError;
use crate::motion::joints::{JointSpeed, joint_speeds};
use crate::plan::{Plan, PlanPoint, Segment};
use crate::planner::Planner;
use crate::reach::{Candidate, Family, are_joined, largest_motion_rad};

impl Planner<'_> {
    /// Candidates at the path's start of the family of a sheet, those nearest to the posture asked
    /// for first: both wrists and all whole turns cut alike.
    pub(crate) fn starts(&self, sheet: usize, angle_rad: f64) -> Result<Vec<Candidate>, PlanError> {
        let first = self.reach.columns[0].cells.iter().flatten();
        let family: Option<Family> = first
            .filter(|c| c.sheet == sheet)
            .map(|c| c.branch.into())
            .next();
        let mut starts = self.surveyor.candidates(0.0, angle_rad)?;
        starts.retain(|c| Some(c.branch.into()) == family);
        let distance = |c: &Candidate| -> f64 {
            let apart = c.posture.iter().zip(self.options.near);
            apart.map(|(a, b)| (a - b).powi(2)).sum()
        };
        starts.sort_by(|a, b| distance(a).total_cmp(&distance(b)));
        Ok(starts)
    }

    /// Candidates at all stations, each without a jump from the one before.
    pub(crate) fn follow(
        &self,
        start: &Candidate,
        angle: &(dyn Fn(f64) -> f64 + Sync),
    ) -> Result<Vec<Candidate>, PlanError> {
        let mut found = vec![start.clone()];
        for column in &self.reach.columns[1..] {
            let along_m = column.along_m;
            let before = &found[found.len() - 1];
            let candidates = self.surveyor.candidates(along_m, angle(along_m))?;
            let joined = candidates.into_iter().filter(|c| are_joined(c, before));
            let motion = |c: &Candidate| largest_motion_rad(&c.posture, &before.posture);
            let next = joined.min_by(|a, b| motion(a).total_cmp(&motion(b)));
            found.push(next.ok_or_else(|| self.broken(along_m))?);
        }
        Ok(found)
    }

    /// Candidates at all stations with what the criterion says of them; at a corner of the path,
    /// the worse of its two legs.
    pub(crate) fn assessed(
        &self,
        criterion: Criterion,
        candidates: &[Candidate],
        angle: &(dyn Fn(f64) -> f64 + Sync),
        segments: Vec<Segment>,
    ) -> Result<Plan, PlanError> {
        let stations = self.reach.columns.par_iter().zip(candidates);
        let points = stations.map(|(column, candidate)| {
            let (along_m, posture) = (column.along_m, &candidate.posture);
            let mut assessment = self.assess(criterion, posture, &self.frame(along_m))?;
            let before = self.path.leg(along_m - 1e-9);
            if before != self.path.leg(along_m) {
                let frame = self.path.world_from_milling(before);
                let other = self.assess(criterion, posture, &frame)?;
                if other.reserve() < assessment.reserve() {
                    assessment = other;
                }
            }
            Ok(PlanPoint {
                along_m,
                point_m: self.path.point_m(along_m),
                angle_rad: angle(along_m),
                posture: posture.clone(),
                assessment,
            })
        });
        Ok(Plan {
            criterion,
            segments,
            points: points.collect::<Result<_, PlanError>>()?,
            family: candidates[0].branch.into(),
        })
    }

    /// Refuses a plan that turns a joint faster than it can at the cut's feed.
    pub(crate) fn check_speed(&self, plan: &Plan) -> Result<(), PlanError> {
        let feed_m_per_s = self.cut.feed_m_per_s();
        for pair in plan.points.windows(2) {
            let seconds = (pair[1].along_m - pair[0].along_m) / feed_m_per_s;
            let mut speeds = joint_speeds(self.robot, &pair[0].posture, &pair[1].posture, seconds);
            if let Some(fast) = speeds.find(JointSpeed::is_too_fast) {
                return Err(PlanError::TooFast {
                    along_m: pair[0].along_m,
                    point_m: pair[0].point_m,
                    joint: self.robot.chain.joints[fast.joint].name.clone(),
                    speed_deg_s: fast.speed.to_degrees(),
                    limit_deg_s: fast.limit.to_degrees(),
                });
            }
        }
        Ok(())
    }
}
