//! The posture planner.

use std::collections::BTreeMap;

use nalgebra::Matrix3;
use rayon::prelude::*;
use truecut_arm::{BranchOptions, Robot};

use crate::assess::assess;
use crate::assessment::Assessment;
use crate::chain::widest;
use crate::criterion::{Criterion, Cut};
use crate::error::PlanError;
use crate::intervals::{Interval, Standing, assessments, standing};
use crate::options::PlannerOptions;
use crate::parts::{Part, between, first_parts, halved, shifted, stations, unstable};
use crate::plan::{MarginMap, Plan, Segment};
use crate::reach::{Candidate, Column, Family, Reach, Surveyor};
use crate::tool_path::ToolPath;
use crate::tube::steadied;

/// Angles are taken that decay at least by these parts as fast as the best one at the place; the
/// next where they do not hang together along the path, and last of all whatever is stable.
const BEST_PARTS: [f64; 3] = [0.5, 0.25, 0.0];

/// Plans postures of one arm along one path in one cut.
pub struct Planner<'a> {
    pub(crate) robot: &'a Robot,
    pub(crate) path: &'a ToolPath,
    pub(crate) cut: &'a Cut,
    pub(crate) options: PlannerOptions,
    pub(crate) surveyor: Surveyor<'a>,
    pub(crate) reach: Reach,
}

impl<'a> Planner<'a> {
    /// Surveys where the arm can stand along the path; the tool is the robot's tool frame.
    ///
    /// # Errors
    /// If the arm is not ortho-parallel, or some place of the path is out of its reach.
    pub fn new(
        robot: &'a Robot,
        path: &'a ToolPath,
        cut: &'a Cut,
        options: &PlannerOptions,
    ) -> Result<Self, PlanError> {
        let solver = robot.ik_solver(&BranchOptions::default());
        let geometry = *solver.geometry().ok_or(PlanError::NotOrthoParallel)?;
        let surveyor = Surveyor {
            robot,
            solver,
            geometry,
            path,
            limits: options.singularity,
            wish: options.branch,
        };
        let count = (std::f64::consts::TAU / options.angle_step_rad).ceil() as usize;
        let reach = surveyor.survey(&stations(path, options), count.max(8))?;
        Ok(Self {
            robot,
            path,
            cut,
            options: *options,
            surveyor,
            reach,
        })
    }

    /// Where the arm can stand.
    pub fn reach(&self) -> &Reach {
        &self.reach
    }

    /// A joint path that is stable by a criterion all along, in the middle of the intervals of
    /// angles that decay at least half as fast as the best one at the place (of those that are
    /// stable, by a criterion that knows no decay).
    ///
    /// # Errors
    /// If some place has no stable angle, or stable angles do not hang together.
    pub fn plan(&self, criterion: Criterion) -> Result<Plan, PlanError> {
        let [first, others @ ..] = BEST_PARTS;
        let mut plan = self.plan_with(criterion, first);
        for part in others {
            let parted = matches!(plan, Err(PlanError::Parted { .. }));
            if parted && criterion == Criterion::Regenerative {
                plan = self.plan_with(criterion, part);
            }
        }
        plan
    }

    /// The plan by angles that decay at least by `best_part` as fast as the best.
    fn plan_with(&self, criterion: Criterion, best_part: f64) -> Result<Plan, PlanError> {
        let mut parts = first_parts(self.path, &self.options);
        let mut known: BTreeMap<usize, Standing> = BTreeMap::new();
        loop {
            self.stand(criterion, best_part, &parts, &mut known)?;
            let of = |part: &Part| known[&self.column(part)].intervals.as_slice();
            let intervals: Vec<&[Interval]> = parts.iter().map(of).collect();
            let chain = match widest(&intervals) {
                Ok(chain) => chain,
                Err(_) if parts.iter().any(|p| p.halvings > 0) => {
                    parts = halved(&parts, |_| true);
                    continue;
                }
                Err(k) => return Err(self.parted(criterion, parts[k].midpoint_m())),
            };
            let shifted = shifted(&parts, &chain, self.options.end_shift_rad);
            if shifted.iter().any(|s| *s) {
                parts = halved(&parts, |k| shifted[k]);
                continue;
            }
            let chain = steadied(&parts, &chain, self.options.end_shift_rad);
            let plan = self.along_chain(criterion, &parts, &chain)?;
            let unstable = unstable(&parts, &plan);
            if unstable.iter().any(|s| *s) {
                parts = halved(&parts, |k| unstable[k]);
                continue;
            }
            let weakest = plan.weakest();
            if weakest.assessment.is_stable() {
                self.check_speed(&plan)?;
                return Ok(plan);
            }
            let best = (weakest.angle_rad, weakest.assessment);
            return Err(self.no_stable_angle(criterion, weakest.along_m, best));
        }
    }

    /// A joint path that is given by place, stable or not, with its redundancy angle (m; rad).
    ///
    /// # Errors
    /// If the arm has no modes somewhere.
    pub fn at_postures(
        &self,
        criterion: Criterion,
        angle: &(dyn Fn(f64) -> f64 + Sync),
        posture: &dyn Fn(f64) -> Vec<f64>,
    ) -> Result<Plan, PlanError> {
        let candidate = |column: &Column| {
            let posture = posture(column.along_m);
            Candidate {
                branch: self.surveyor.geometry.branch(&posture),
                posture,
                sheet: 0,
            }
        };
        let along: Vec<Candidate> = self.reach.columns.iter().map(candidate).collect();
        self.assessed(criterion, &along, angle, Vec::new())
    }

    /// What another criterion says of the stations of a plan.
    ///
    /// # Errors
    /// If the arm has no modes somewhere.
    pub fn reassessed(
        &self,
        plan: &Plan,
        criterion: Criterion,
    ) -> Result<Vec<Assessment>, PlanError> {
        let found = plan
            .points
            .par_iter()
            .map(|point| self.assess(criterion, &point.posture, &self.frame(point.along_m)));
        found.collect()
    }

    /// What a criterion says on `count` stations, spread over the path, and every angle, for
    /// postures of one family.
    ///
    /// # Errors
    /// If the arm has no modes somewhere.
    pub fn map(
        &self,
        criterion: Criterion,
        family: Family,
        count: usize,
    ) -> Result<MarginMap, PlanError> {
        let last = self.reach.columns.len() - 1;
        let count = count.clamp(2, last + 1);
        let index = |k: usize| k * last / (count - 1);
        let columns: Vec<_> = (0..count).map(|k| &self.reach.columns[index(k)]).collect();
        let rows = columns.iter().map(|column| {
            let world_from_milling = self.frame(column.along_m);
            let assess = |c: &Candidate| self.assess(criterion, &c.posture, &world_from_milling);
            let found = assessments(column, &assess)?;
            Ok(found.iter().map(|of| of.get(&family).copied()).collect())
        });
        Ok(MarginMap {
            criterion,
            along_m: columns.iter().map(|c| c.along_m).collect(),
            angles_rad: self.reach.angles_rad.clone(),
            assessments: rows.collect::<Result<_, PlanError>>()?,
        })
    }

    pub(crate) fn frame(&self, along_m: f64) -> Matrix3<f64> {
        self.path.world_from_milling(self.path.leg(along_m))
    }

    pub(crate) fn assess(
        &self,
        criterion: Criterion,
        posture: &[f64],
        world_from_milling: &Matrix3<f64>,
    ) -> Result<Assessment, PlanError> {
        let least_decay = self.options.least_decay;
        let (robot, frame) = (self.robot, world_from_milling);
        assess(criterion, robot, posture, frame, self.cut, least_decay)
    }

    fn column(&self, part: &Part) -> usize {
        self.reach.nearest_column(part.midpoint_m())
    }

    /// Finds the intervals of all parts that are not known yet.
    fn stand(
        &self,
        criterion: Criterion,
        best_part: f64,
        parts: &[Part],
        known: &mut BTreeMap<usize, Standing>,
    ) -> Result<(), PlanError> {
        for part in parts {
            let index = self.column(part);
            if known.contains_key(&index) {
                continue;
            }
            let column = &self.reach.columns[index];
            let world_from_milling = self.frame(column.along_m);
            let assess = |c: &Candidate| self.assess(criterion, &c.posture, &world_from_milling);
            let angles_rad = &self.reach.angles_rad;
            let found = standing(&self.surveyor, column, angles_rad, best_part, &assess)?;
            known.insert(index, found);
        }
        // Of several places without a stable angle the worst is told.
        let bare = known
            .iter()
            .filter(|(_, standing)| standing.intervals.is_empty());
        let worst = bare.min_by(|a, b| {
            let reserve = |standing: &Standing| standing.best.1.reserve();
            reserve(a.1).total_cmp(&reserve(b.1))
        });
        match worst {
            Some((index, standing)) => {
                let along_m = self.reach.columns[*index].along_m;
                Err(self.no_stable_angle(criterion, along_m, standing.best))
            }
            None => Ok(()),
        }
    }

    fn no_stable_angle(
        &self,
        criterion: Criterion,
        along_m: f64,
        (angle_rad, assessment): (f64, Assessment),
    ) -> PlanError {
        PlanError::NoStableAngle {
            criterion,
            along_m,
            point_m: self.path.point_m(along_m),
            angle_deg: angle_rad.to_degrees(),
            assessment,
            needed: criterion.needed(self.cut),
        }
    }

    fn parted(&self, criterion: Criterion, along_m: f64) -> PlanError {
        PlanError::Parted {
            criterion,
            along_m,
            point_m: self.path.point_m(along_m),
        }
    }

    pub(crate) fn broken(&self, along_m: f64) -> PlanError {
        PlanError::Broken {
            along_m,
            point_m: self.path.point_m(along_m),
        }
    }

    /// The plan whose angle runs straight from mid-interval to mid-interval.
    fn along_chain(
        &self,
        criterion: Criterion,
        parts: &[Part],
        chain: &[Interval],
    ) -> Result<Plan, PlanError> {
        let segments = parts.iter().zip(chain).map(|(part, interval)| Segment {
            from_m: part.from_m,
            to_m: part.to_m,
            interval: *interval,
        });
        let segments: Vec<Segment> = segments.collect();
        let knots: Vec<(f64, f64)> = segments.iter().map(Segment::knot).collect();
        let angle = |along_m: f64| between(&knots, along_m);
        let starts = self.starts(chain[0].sheet, angle(0.0))?;
        let mut refused = None;
        for start in &starts {
            match self.follow(start, &angle) {
                Ok(found) => return self.assessed(criterion, &found, &angle, segments),
                Err(error) => refused = refused.or(Some(error)),
            }
        }
        Err(refused.unwrap_or_else(|| self.broken(0.0)))
    }
}
