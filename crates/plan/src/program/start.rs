//! The first posture of a path: which of an arm's branches and whole turns it begins in.

use nalgebra::Isometry3;
use rayon::prelude::*;
use truecut_arm::{BranchOptions, FrameId, IkSolver, Joint, JointKind, Robot};

use super::error::ProgramError;
use super::moves::{Motion, PathPoint};
use super::replay::ReplayOptions;
use super::spare::led_along;
use super::travel::{Route, TravelOptions, chain, distance, flange_at, survey};

/// Costs that differ by less are one: postures that mirror each other, to rounding.
const SAME_COST: f64 = 1e-9;
/// Postures that agree to this in every joint are one, rad.
const SAME_POSTURE_RAD: f64 = 1e-6;
/// How far joints stay within their limits on runs of lines, where they can.
const WITHIN_LIMITS_RAD: f64 = 0.5 * std::f64::consts::PI / 180.0;
/// A joint turns by less between two places of a line: another branch of the wrist or of the
/// shoulder lies half a turn away.
pub(super) const OTHER_BRANCH_RAD: f64 = std::f64::consts::FRAC_PI_2;

/// What the first posture of a path shall lie near to.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Start<'a> {
    /// The middle of the joints' ranges.
    AtRest,
    /// This posture, rad or m.
    Near(&'a [f64]),
}

impl Start<'_> {
    /// What is least of the posture chosen: the sum over the joints of the squared distance from
    /// what it shall lie near to, each as a share of half the joint's range.
    #[must_use]
    pub fn cost(&self, robot: &Robot, posture: &[f64]) -> f64 {
        let joints = robot.chain.joints.iter().zip(posture);
        let each = joints.enumerate().map(|(i, (joint, q))| {
            let (middle, half) = middle_and_half(joint);
            let near = match self {
                Start::AtRest => middle,
                Start::Near(posture) => posture.get(i).copied().unwrap_or(middle),
            };
            ((q - near) / half).powi(2)
        });
        each.sum()
    }

    /// What a posture shall lie near to.
    pub(super) fn posture(&self, robot: &Robot) -> Vec<f64> {
        let middles = || robot.chain.joints.iter().map(|one| middle_and_half(one).0);
        match self {
            Start::AtRest => middles().collect(),
            Start::Near(posture) => posture.to_vec(),
        }
    }

    /// Costs by their order; those that are equal to rounding have the same place in it.
    pub(super) fn ranks(&self, robot: &Robot, postures: &[Vec<f64>]) -> Vec<usize> {
        let costs: Vec<f64> = postures.iter().map(|q| self.cost(robot, q)).collect();
        let mut order: Vec<usize> = (0..costs.len()).collect();
        order.sort_by(|a, b| costs[*a].total_cmp(&costs[*b]));
        let mut ranks = vec![0; costs.len()];
        for pair in order.windows(2) {
            let same = costs[pair[1]] - costs[pair[0]] < SAME_COST;
            ranks[pair[1]] = ranks[pair[0]] + usize::from(!same);
        }
        ranks
    }
}

/// Middle of a joint's range and half its width. Without both limits: zero (a limit that excludes
/// it) and half a turn, or a metre.
fn middle_and_half(joint: &Joint) -> (f64, f64) {
    let (low, high) = joint
        .limits
        .map_or((f64::NEG_INFINITY, f64::INFINITY), |l| (l.lower, l.upper));
    let (middle, half) = (0.5 * (low + high), 0.5 * (high - low));
    if half.is_finite() && half > 0.0 {
        return (middle, half);
    }
    let half = match joint.kind {
        JointKind::Revolute => std::f64::consts::PI,
        JointKind::Prismatic => 1.0,
    };
    (0.0_f64.max(low).min(high), half)
}

/// Postures along points of which all but the first are reached on lines: from the start of least
/// [cost](Start::cost) from which the arm keeps its limits all along the lines, whole turns
/// included. If there is none: from the one that gets furthest, so that running through the program
/// tells what stops it. Of an arm of six joints without a closed form, and of a path that has moves
/// by joints, the points alone are looked at; one with joints to spare is led along the lines from
/// starts that lie as near as they can to what is asked for. `frames` are the tool in the flange
/// and the base in the world.
///
/// # Errors
/// As [`shortest_travel`](super::shortest_travel).
pub fn along_lines(
    robot: &Robot,
    frames: [&Isometry3<f64>; 2],
    points: &[PathPoint],
    start: Start<'_>,
    options: &TravelOptions,
) -> Result<Vec<Vec<f64>>, ProgramError> {
    let solver = robot.ik_solver(&BranchOptions::default());
    if robot.has_joints_to_spare() {
        return led_along(&solver, frames, points, start, options);
    }
    let columns = survey(robot, &solver, frames, points, options)?;
    let Some(first) = columns.first() else {
        return Ok(Vec::new());
    };
    let ranks = start.ranks(robot, first);
    let begin = |allowed: &dyn Fn(usize) -> bool| {
        let begun = ranks.iter().enumerate().map(|(i, rank)| match allowed(i) {
            true => Route::beginning(*rank, 0.0),
            false => Route::UNREACHED,
        });
        chain(robot, points, &columns, begun.collect(), options)
    };
    if solver.geometry().is_none() || !points.iter().skip(1).all(is_line) {
        return begin(&|_| true);
    }
    let run = LineRun {
        robot,
        solver: &solver,
        frames,
        points,
        columns: &columns,
        margin_rad: 0.0,
    };
    match run.best(&ranks) {
        Ok(postures) => Ok(postures),
        Err(reached) => {
            let furthest = reached.iter().max().copied().unwrap_or(0);
            begin(&|at| reached[at] == furthest).or_else(|_| begin(&|_| true))
        }
    }
}

/// As [`along_lines`], along runs of lines to which the arm goes by joints: each run begins in the
/// posture of least cost from the end of the one before, if there is one from which all joints stay
/// half a degree within their limits, which an arm that gives way needs. Where a run cannot be
/// followed from any, and of an arm of six joints without a closed form, the points alone are
/// looked at.
///
/// # Errors
/// As [`shortest_travel`](super::shortest_travel).
pub fn along_runs(
    robot: &Robot,
    frames: [&Isometry3<f64>; 2],
    points: &[PathPoint],
    start: Start<'_>,
    options: &TravelOptions,
) -> Result<Vec<Vec<f64>>, ProgramError> {
    let solver = robot.ik_solver(&BranchOptions::default());
    if robot.has_joints_to_spare() {
        return led_along(&solver, frames, points, start, options);
    }
    let columns = survey(robot, &solver, frames, points, options)?;
    let Some(first) = columns.first() else {
        return Ok(Vec::new());
    };
    let mut found: Vec<Vec<f64>> = Vec::with_capacity(points.len());
    while found.len() < points.len() && solver.geometry().is_some() {
        let from = found.len();
        let lines = points[from + 1..].iter().take_while(|point| is_line(point));
        let range = from..=from + lines.count();
        let start = found.last().map_or(start, |posture| Start::Near(posture));
        let ranks = start.ranks(robot, &columns[from]);
        let run = LineRun {
            robot,
            solver: &solver,
            frames,
            points: &points[range.clone()],
            columns: &columns[range],
            margin_rad: WITHIN_LIMITS_RAD,
        };
        let to_the_limits = || {
            LineRun {
                margin_rad: 0.0,
                ..run
            }
            .best(&ranks)
        };
        let Ok(postures) = run.best(&ranks).or_else(|_| to_the_limits()) else {
            break;
        };
        found.extend(postures);
    }
    if found.len() == points.len() {
        return Ok(found);
    }
    let ranks = start.ranks(robot, first).into_iter();
    let begun = ranks.map(|rank| Route::beginning(rank, 0.0)).collect();
    chain(robot, points, &columns, begun, options)
}

pub(super) fn is_line(point: &PathPoint) -> bool {
    matches!(point.motion, Motion::Linear { .. })
}

/// Points of which all but the first are reached on lines, and the postures at each.
#[derive(Clone, Copy)]
struct LineRun<'a> {
    robot: &'a Robot,
    solver: &'a IkSolver<'a>,
    frames: [&'a Isometry3<f64>; 2],
    points: &'a [PathPoint],
    columns: &'a [Vec<Vec<f64>>],
    /// How far joints keep from their limits.
    margin_rad: f64,
}

impl LineRun<'_> {
    /// Postures from the start of least rank, and of those of least travel, from which the lines
    /// can be followed to the end; else how many points each start gets to.
    fn best(&self, ranks: &[usize]) -> Result<Vec<Vec<f64>>, Vec<usize>> {
        let (points, columns) = (self.points, self.columns);
        let leg = |i: usize| {
            let line = Line {
                robot: self.robot,
                solver: self.solver,
                ends: [&columns[i - 1], &columns[i]],
                slack_rad: SAME_POSTURE_RAD - self.margin_rad,
            };
            let pair = [&points[i - 1], &points[i]];
            line.successors(pair, self.frames)
        };
        let legs: Vec<Vec<Option<usize>>> = (1..points.len()).into_par_iter().map(leg).collect();
        let length = |way: &[usize]| {
            let at = |point: usize| &columns[point][way[point]];
            let steps = (1..way.len()).map(|point| distance(at(point - 1), at(point)).0);
            steps.sum::<f64>()
        };
        let mut order: Vec<usize> = (0..ranks.len()).collect();
        order.sort_by_key(|at| ranks[*at]);
        let mut best: Option<(usize, f64, Vec<usize>)> = None;
        let mut reached = vec![0; ranks.len()];
        for at in order {
            if best.as_ref().is_some_and(|(rank, ..)| *rank < ranks[at]) {
                break;
            }
            let way = way(at, &legs);
            reached[at] = way.len();
            let travel = length(&way);
            let is_whole = way.len() == points.len();
            if is_whole && best.as_ref().is_none_or(|(_, least, _)| travel < *least) {
                best = Some((ranks[at], travel, way));
            }
        }
        let (.., way) = best.ok_or(reached)?;
        let postures = way.iter().zip(columns);
        Ok(postures.map(|(at, column)| column[*at].clone()).collect())
    }
}

/// Where a start leads, point by point, as far as it can be followed.
fn way(start: usize, legs: &[Vec<Option<usize>>]) -> Vec<usize> {
    let mut way = vec![start];
    let mut at = start;
    for leg in legs {
        let Some(next) = leg[at] else { break };
        way.push(next);
        at = next;
    }
    way
}

/// A line between two points and the postures at its ends.
struct Line<'a> {
    robot: &'a Robot,
    solver: &'a IkSolver<'a>,
    ends: [&'a Vec<Vec<f64>>; 2],
    /// By how much joints may be beyond their limits; below zero within.
    slack_rad: f64,
}

/// A branch followed along a line: where it began, where it is, and between what its joints stood.
struct Follower {
    begun: Vec<f64>,
    now: Vec<f64>,
    low: Vec<f64>,
    high: Vec<f64>,
}

impl Line<'_> {
    /// For each posture at the start of the line, the one at its end to which it leads within
    /// limits.
    fn successors(
        &self,
        [from, to]: [&PathPoint; 2],
        frames: [&Isometry3<f64>; 2],
    ) -> Vec<Option<usize>> {
        // Postures that are whole turns apart move alike.
        let mut followers: Vec<Option<Follower>> = Vec::new();
        let mut of: Vec<usize> = Vec::with_capacity(self.ends[0].len());
        for q in self.ends[0] {
            let alike = |known: &Option<Follower>| {
                known
                    .as_ref()
                    .is_some_and(|known| widest(&turns_off(&known.begun, q)) < SAME_POSTURE_RAD)
            };
            let known = followers.iter().position(alike);
            of.push(known.unwrap_or(followers.len()));
            if known.is_none() {
                followers.push(Some(Follower::at(q)));
            }
        }
        // As when the program is run through.
        let count = ReplayOptions::default().places(&from.base_from_tool, &to.base_from_tool);
        for k in 1..=count {
            let t = k as f64 / count as f64;
            let between = (k < count).then(|| {
                from.base_from_tool
                    .try_lerp_slerp(&to.base_from_tool, t, 1e-9)
            });
            // The end, too, by all branches: of those that are allowed there the nearest may be
            // another.
            let pose = between.flatten().unwrap_or(to.base_from_tool);
            let here = (self.solver).branches(&flange_at(frames, &pose), FrameId::Flange);
            for follower in &mut followers {
                *follower = follower.take().and_then(|one| one.led_to(&here));
            }
        }
        let ends = self.ends[0].iter().zip(of);
        let end = |(q, of): (&Vec<f64>, usize)| self.end(q, followers[of].as_ref()?);
        ends.map(end).collect()
    }

    /// Where a posture arrives that moves as a follower did.
    fn end(&self, q: &[f64], follower: &Follower) -> Option<usize> {
        let turned = |i: usize| q[i] - follower.begun[i];
        let within = |(i, joint): (usize, &Joint)| {
            joint.limits.is_none_or(|l| {
                follower.low[i] + turned(i) >= l.lower - self.slack_rad
                    && follower.high[i] + turned(i) <= l.upper + self.slack_rad
            })
        };
        if !self.robot.chain.joints.iter().enumerate().all(within) {
            return None;
        }
        let same = |end: &Vec<f64>| {
            let each = end.iter().zip(&follower.now).enumerate();
            let mut apart = each.map(|(i, (end, now))| (end - now - turned(i)).abs());
            apart.all(|apart| apart < SAME_POSTURE_RAD)
        };
        self.ends[1].iter().position(same)
    }
}

impl Follower {
    fn at(q: &[f64]) -> Self {
        let q = || q.to_vec();
        Self {
            begun: q(),
            now: q(),
            low: q(),
            high: q(),
        }
    }

    /// One place further: in the posture nearest by; `None` if that is on another branch.
    fn led_to(mut self, here: &[Vec<f64>]) -> Option<Self> {
        let steps = here.iter().map(|q| turns_off(&self.now, q));
        let step = steps.min_by(|a, b| widest(a).total_cmp(&widest(b)))?;
        if widest(&step) >= OTHER_BRANCH_RAD {
            return None;
        }
        for (i, by) in step.into_iter().enumerate() {
            self.now[i] += by;
            self.low[i] = self.low[i].min(self.now[i]);
            self.high[i] = self.high[i].max(self.now[i]);
        }
        Some(self)
    }
}

/// The way from a posture to another without whole turns, joint by joint; arms with a closed form
/// have rotary joints only.
fn turns_off(from: &[f64], to: &[f64]) -> Vec<f64> {
    let turn = std::f64::consts::TAU;
    let each = from.iter().zip(to).map(|(a, b)| b - a);
    each.map(|by| by - turn * (by / turn).round()).collect()
}

fn widest(step: &[f64]) -> f64 {
    step.iter().fold(0.0, |widest, by| by.abs().max(widest))
}
