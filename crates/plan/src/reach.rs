//! Where the arm can stand: postures over path position and redundancy angle.

use std::f64::consts::TAU;

use rayon::prelude::*;
use truecut_arm::{ArmBranch, Elbow, FrameId, IkSolver, OpwGeometry, Robot, Shoulder};

use crate::error::PlanError;
use crate::motion::branch::BranchWish;
use crate::sheets::Sheets;
use crate::singularity::SingularityLimits;
use crate::tool_path::ToolPath;

/// One joint may not move further than this (rad) between neighbours of the grid that count as
/// joined. Whole turns and other branches are further away; near the singularity distance asked
/// for, one step of the angle stays below.
const JOINED_RAD: f64 = 1.2;

/// Width to which the place where a path leaves its reach is narrowed, m.
const PLACE_M: f64 = 1e-4;

/// Shoulder and elbow of a branch. Both wrists of a family have the same stiffness and modes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Family {
    pub shoulder: Shoulder,
    pub elbow: Elbow,
}

impl From<ArmBranch> for Family {
    fn from(branch: ArmBranch) -> Self {
        Self {
            shoulder: branch.shoulder,
            elbow: branch.elbow,
        }
    }
}

/// A posture that the arm can take.
#[derive(Debug, Clone, PartialEq)]
pub struct Candidate {
    pub posture: Vec<f64>,
    pub branch: ArmBranch,
    /// Candidates of one sheet are joined by neighbours without a jump.
    pub sheet: usize,
}

/// All angles at one place of the path.
#[derive(Debug, Clone, PartialEq)]
pub struct Column {
    pub along_m: f64,
    /// Candidates for each angle of [`Reach::angles_rad`].
    pub cells: Vec<Vec<Candidate>>,
}

/// All candidates on a grid of places and angles.
#[derive(Debug, Clone, PartialEq)]
pub struct Reach {
    /// Evenly over a turn, from 0.
    pub angles_rad: Vec<f64>,
    pub columns: Vec<Column>,
}

/// What the survey looks with.
pub(crate) struct Surveyor<'a> {
    pub robot: &'a Robot,
    pub solver: IkSolver<'a>,
    pub geometry: OpwGeometry,
    pub path: &'a ToolPath,
    pub limits: SingularityLimits,
    pub wish: BranchWish,
}

impl Surveyor<'_> {
    /// Candidates at a place and an angle, sheets not known yet.
    pub fn candidates(&self, along_m: f64, angle_rad: f64) -> Result<Vec<Candidate>, PlanError> {
        let pose = self.path.pose(along_m, angle_rad)?;
        let postures = self.solver.within_limits(&pose, FrameId::Tool);
        let candidates = postures.into_iter().filter_map(|posture| {
            let branch = self.geometry.branch(&posture);
            let wanted = self.wish.allows(branch);
            let clear = self
                .limits
                .allow(&self.geometry.singularity_distance(&posture));
            (wanted && clear).then_some(Candidate {
                posture,
                branch,
                sheet: 0,
            })
        });
        Ok(candidates.collect())
    }

    fn column(&self, along_m: f64, angles_rad: &[f64]) -> Result<Column, PlanError> {
        let cells = angles_rad
            .iter()
            .map(|angle| self.candidates(along_m, *angle));
        let cells = cells.collect::<Result<_, PlanError>>()?;
        Ok(Column { along_m, cells })
    }

    /// The grid, or why some place of the path has no candidate.
    pub fn survey(&self, along_m: &[f64], angle_count: usize) -> Result<Reach, PlanError> {
        let angles_rad: Vec<f64> = (0..angle_count)
            .map(|i| TAU * i as f64 / angle_count as f64)
            .collect();
        let columns = along_m.par_iter().map(|at| self.column(*at, &angles_rad));
        let mut columns = columns.collect::<Result<Vec<Column>, PlanError>>()?;
        let is_empty = |column: &Column| column.cells.iter().all(Vec::is_empty);
        if let Some(bad) = columns.iter().position(is_empty) {
            let good_m = (bad > 0).then(|| columns[bad - 1].along_m);
            return Err(self.left(good_m, columns[bad].along_m, &angles_rad));
        }
        join(&mut columns);
        let reach = Reach {
            angles_rad,
            columns,
        };
        match reach.furthest_unbroken() {
            last if last + 1 == reach.columns.len() => Ok(reach),
            last => {
                let along_m = reach.columns[last + 1].along_m;
                Err(PlanError::Broken {
                    along_m,
                    point_m: self.path.point_m(along_m),
                })
            }
        }
    }

    /// Why there is no candidate at `bad_m`, at the place behind `good_m` where that begins.
    fn left(&self, good_m: Option<f64>, bad_m: f64, angles_rad: &[f64]) -> PlanError {
        let mut bad_m = bad_m;
        if let Some(mut good_m) = good_m {
            while bad_m - good_m > PLACE_M {
                let middle = 0.5 * (good_m + bad_m);
                let empty = match self.column(middle, angles_rad) {
                    Ok(column) => column.cells.iter().all(Vec::is_empty),
                    Err(error) => return error,
                };
                *(if empty { &mut bad_m } else { &mut good_m }) = middle;
            }
        }
        self.explain(bad_m, angles_rad)
            .unwrap_or_else(|error| error)
    }

    /// What keeps the arm from a place: a singularity if limits allow it, else limits, else reach.
    fn explain(&self, along_m: f64, angles_rad: &[f64]) -> Result<PlanError, PlanError> {
        let point_m = self.path.point_m(along_m);
        let mut clearest: Option<(f64, PlanError)> = None;
        let mut least: Option<(f64, PlanError)> = None;
        for angle in angles_rad {
            let pose = self.path.pose(along_m, *angle)?;
            let wanted = |q: &Vec<f64>| self.wish.allows(self.geometry.branch(q));
            for q in self
                .solver
                .within_limits(&pose, FrameId::Tool)
                .iter()
                .filter(|q| wanted(q))
            {
                let (share, error) = self.singular(q, along_m, *angle);
                if clearest.as_ref().is_none_or(|(best, _)| share > *best) {
                    clearest = Some((share, error));
                }
            }
            for q in self
                .solver
                .branches(&pose, FrameId::Tool)
                .iter()
                .filter(|q| wanted(q))
            {
                if let Some((joint, excess)) = self.excess(q)
                    && least.as_ref().is_none_or(|(best, _)| excess < *best)
                {
                    let error = PlanError::OutsideLimits {
                        along_m,
                        point_m,
                        angle_deg: angle.to_degrees(),
                        joint,
                        excess_deg: excess.to_degrees(),
                    };
                    least = Some((excess, error));
                }
            }
        }
        let found = clearest.or(least).map(|(_, error)| error);
        Ok(found.unwrap_or(PlanError::OutOfReach { along_m, point_m }))
    }

    /// The singularity that a posture is nearest to, and its share of the distance asked for.
    fn singular(&self, q: &[f64], along_m: f64, angle_rad: f64) -> (f64, PlanError) {
        let near = (self.limits).nearest(&self.geometry.singularity_distance(q));
        let error = PlanError::Singular {
            kind: near.kind,
            along_m,
            point_m: self.path.point_m(along_m),
            angle_deg: angle_rad.to_degrees(),
            distance: near.distance,
            least: near.least,
        };
        (near.share, error)
    }

    /// The joint that breaks its limits most, and by how much.
    fn excess(&self, q: &[f64]) -> Option<(String, f64)> {
        let joints = self.robot.chain.joints.iter().zip(q);
        let beyond = joints.filter_map(|(joint, value)| {
            let limits = joint.limits?;
            let by = (value - limits.upper).max(limits.lower - value);
            (by > 0.0).then_some((joint, by))
        });
        let worst = beyond.max_by(|a, b| a.1.total_cmp(&b.1));
        worst.map(|(joint, by)| (joint.name.clone(), by))
    }
}

/// Whether the arm gets from one posture to the other without a jump.
pub(crate) fn are_joined(a: &Candidate, b: &Candidate) -> bool {
    a.branch == b.branch && largest_motion_rad(&a.posture, &b.posture) <= JOINED_RAD
}

/// Largest motion of a joint between two postures.
pub(crate) fn largest_motion_rad(a: &[f64], b: &[f64]) -> f64 {
    let moved = a.iter().zip(b).map(|(a, b)| (a - b).abs());
    moved.fold(0.0, f64::max)
}

/// Gives every candidate its sheet.
fn join(columns: &mut [Column]) {
    let mut starts: Vec<Vec<usize>> = Vec::new();
    let mut count = 0;
    for column in columns.iter() {
        let begin = |cell: &Vec<Candidate>| {
            count += cell.len();
            count - cell.len()
        };
        starts.push(column.cells.iter().map(begin).collect());
    }
    let mut sheets = Sheets::new(count);
    let mut link = |a: (&Vec<Candidate>, usize), b: (&Vec<Candidate>, usize)| {
        for (i, one) in a.0.iter().enumerate() {
            for (j, other) in b.0.iter().enumerate() {
                if are_joined(one, other) {
                    sheets.join(a.1 + i, b.1 + j);
                }
            }
        }
    };
    for (c, column) in columns.iter().enumerate() {
        let cells = &column.cells;
        for (i, cell) in cells.iter().enumerate() {
            let next = (i + 1) % cells.len();
            link((cell, starts[c][i]), (&cells[next], starts[c][next]));
            if let Some(after) = columns.get(c + 1) {
                link((cell, starts[c][i]), (&after.cells[i], starts[c + 1][i]));
            }
        }
    }
    let numbers = sheets.numbers();
    let candidates = columns.iter_mut().flat_map(|c| &mut c.cells).flatten();
    for (candidate, sheet) in candidates.zip(numbers) {
        candidate.sheet = sheet;
    }
}

impl Reach {
    /// The last column that some sheet reaches which begins in the first.
    fn furthest_unbroken(&self) -> usize {
        let sheets = |column: &Column| -> Vec<usize> {
            let all = column.cells.iter().flatten().map(|c| c.sheet);
            let mut all: Vec<usize> = all.collect();
            all.sort_unstable();
            all.dedup();
            all
        };
        let first = sheets(&self.columns[0]);
        let reached = |column: &Column| sheets(column).iter().any(|s| first.contains(s));
        let unbroken = self.columns.iter().take_while(|column| reached(column));
        unbroken.count() - 1
    }

    /// Index of the column nearest to a place.
    pub fn nearest_column(&self, along_m: f64) -> usize {
        let after = self.columns.partition_point(|c| c.along_m < along_m);
        let before = after.saturating_sub(1);
        match self.columns.get(after) {
            Some(c) if c.along_m - along_m < along_m - self.columns[before].along_m => after,
            _ => before,
        }
    }
}
