//! The posture planner.

use std::collections::BTreeMap;

use nalgebra::{Matrix3, Vector3};
use rayon::prelude::*;
use truecut_arm::{BranchOptions, Robot};

use crate::chain::widest;
use crate::criterion::{Assessment, Criterion, Cut, assess};
use crate::error::PlanError;
use crate::intervals::{Interval, Standing, assessments, standing};
use crate::parts::{Part, between, first_parts, halved, shifted, stations, unstable};
use crate::reach::{Candidate, Family, Reach, SingularityLimits, Surveyor, largest_motion_rad};
use crate::tool_path::ToolPath;

/// How a plan is looked for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlannerOptions {
    /// Step of the redundancy angle; a stable interval narrower than it may be missed.
    pub angle_step_rad: f64,
    /// Longest segment to begin with, m.
    pub segment_m: f64,
    /// How often a segment may be halved.
    pub halvings: u32,
    /// Largest shift of an end of the stable interval from one segment to the next.
    pub end_shift_rad: f64,
    pub singularity: SingularityLimits,
    /// Shoulder and elbow that are allowed; any if none is given.
    pub family: Option<Family>,
    /// Of equal joint paths (wrists, whole turns) the one that starts nearest to this posture is taken.
    pub near: [f64; 6],
}

impl Default for PlannerOptions {
    fn default() -> Self {
        Self {
            angle_step_rad: 4_f64.to_radians(),
            segment_m: 0.05,
            halvings: 3,
            end_shift_rad: 10_f64.to_radians(),
            singularity: SingularityLimits::default(),
            family: None,
            near: [0.0; 6],
        }
    }
}

/// A part of the path with one stable interval, taken at its midpoint.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Segment {
    pub from_m: f64,
    pub to_m: f64,
    pub interval: Interval,
}

impl Segment {
    pub fn midpoint_m(&self) -> f64 {
        0.5 * (self.from_m + self.to_m)
    }
}

/// The arm at one station of the path.
#[derive(Debug, Clone, PartialEq)]
pub struct PlanPoint {
    pub along_m: f64,
    pub point_m: Vector3<f64>,
    /// Redundancy angle, running on over whole turns.
    pub angle_rad: f64,
    /// Joint angles, rad.
    pub posture: Vec<f64>,
    pub assessment: Assessment,
}

/// A continuous joint path.
#[derive(Debug, Clone, PartialEq)]
pub struct Plan {
    pub criterion: Criterion,
    /// Empty for a constant angle.
    pub segments: Vec<Segment>,
    pub points: Vec<PlanPoint>,
    pub family: Family,
}

impl Plan {
    /// The point with the least margin.
    pub fn weakest(&self) -> &PlanPoint {
        let margin = |p: &&PlanPoint| p.assessment.margin;
        let weakest = self
            .points
            .iter()
            .min_by(|a, b| margin(a).total_cmp(&margin(b)));
        weakest.unwrap_or(&self.points[0])
    }

    /// Places (m) and redundancy angles (rad) between which the angle turns as 3u² − 2u³; it is constant beyond the ends.
    pub fn knots(&self) -> Vec<(f64, f64)> {
        if self.segments.is_empty() {
            return vec![(0.0, self.points[0].angle_rad)];
        }
        let knots = self.segments.iter();
        knots
            .map(|s| (s.midpoint_m(), s.interval.middle_rad()))
            .collect()
    }

    /// Largest motion of one joint from one point to the next, rad.
    pub fn largest_step_rad(&self) -> f64 {
        let steps = self.points.windows(2);
        let steps = steps.map(|w| largest_motion_rad(&w[0].posture, &w[1].posture));
        steps.fold(0.0, f64::max)
    }
}

/// What a criterion says over path and angle.
#[derive(Debug, Clone, PartialEq)]
pub struct MarginMap {
    pub criterion: Criterion,
    pub along_m: Vec<f64>,
    pub angles_rad: Vec<f64>,
    /// By place, then angle; none where the family does not reach.
    pub assessments: Vec<Vec<Option<Assessment>>>,
}

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
            family: options.family,
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

    /// A joint path that is stable by a criterion all along, in the middle of the stable intervals.
    ///
    /// # Errors
    /// If some place has no stable angle, or stable angles do not hang together.
    pub fn plan(&self, criterion: Criterion) -> Result<Plan, PlanError> {
        let mut parts = first_parts(self.path, &self.options);
        let mut known: BTreeMap<usize, Standing> = BTreeMap::new();
        loop {
            self.stand(criterion, &parts, &mut known)?;
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

    /// The joint path at a constant redundancy angle, stable or not: the one that turns the joints least.
    ///
    /// # Errors
    /// If the arm cannot follow the path at this angle.
    pub fn constant_angle(&self, criterion: Criterion, angle_rad: f64) -> Result<Plan, PlanError> {
        self.at_angles(criterion, &|_| angle_rad)
    }

    /// The joint path at redundancy angles given by place (m; rad), stable or not: the one that turns the joints least.
    ///
    /// # Errors
    /// If the arm cannot follow the path at these angles.
    pub fn at_angles(
        &self,
        criterion: Criterion,
        angle: &(dyn Fn(f64) -> f64 + Sync),
    ) -> Result<Plan, PlanError> {
        let starts = self.surveyor.candidates(0.0, angle(0.0))?;
        let mut furthest: Option<PlanError> = None;
        let mut best: Option<(f64, Vec<Candidate>)> = None;
        for start in starts {
            match self.follow(&start, angle) {
                Ok(found) => {
                    let steps = found.windows(2);
                    let steps = steps.map(|w| largest_motion_rad(&w[0].posture, &w[1].posture));
                    let travel: f64 = steps.sum();
                    if best.as_ref().is_none_or(|(least, _)| travel < *least) {
                        best = Some((travel, found));
                    }
                }
                Err(error) => {
                    let place = |e: &PlanError| e.along_m().unwrap_or(0.0);
                    if furthest.as_ref().is_none_or(|f| place(f) < place(&error)) {
                        furthest = Some(error);
                    }
                }
            }
        }
        let Some((_, found)) = best else {
            return Err(furthest.unwrap_or_else(|| self.broken(0.0)));
        };
        self.assessed(criterion, &found, angle, Vec::new())
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
        let found = plan.points.par_iter().map(|point| {
            let frame = self.frame(point.along_m);
            assess(criterion, self.robot, &point.posture, &frame, self.cut)
        });
        found.collect()
    }

    /// What a criterion says on `count` stations, spread over the path, and every angle, for postures of one family.
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
            let assess = |c: &Candidate| self.assess(criterion, c, &world_from_milling);
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
        candidate: &Candidate,
        world_from_milling: &Matrix3<f64>,
    ) -> Result<Assessment, PlanError> {
        let posture = &candidate.posture;
        assess(criterion, self.robot, posture, world_from_milling, self.cut)
    }

    fn column(&self, part: &Part) -> usize {
        self.reach.nearest_column(part.midpoint_m())
    }

    /// Finds the stable intervals of all parts that are not known yet.
    fn stand(
        &self,
        criterion: Criterion,
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
            let assess = |c: &Candidate| self.assess(criterion, c, &world_from_milling);
            let found = standing(&self.surveyor, column, &self.reach.angles_rad, &assess)?;
            known.insert(index, found);
        }
        // Of several places without a stable angle the worst is told.
        let bare = known
            .iter()
            .filter(|(_, standing)| standing.intervals.is_empty());
        let worst = bare.min_by(|a, b| a.1.best.1.margin.total_cmp(&b.1.best.1.margin));
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
        let knots = segments
            .iter()
            .map(|s| (s.midpoint_m(), s.interval.middle_rad()));
        let knots: Vec<(f64, f64)> = knots.collect();
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
