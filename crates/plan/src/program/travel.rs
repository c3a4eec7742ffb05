//! Which branch the arm takes along a path: the one of shortest travel.

use std::cmp::Ordering;

use nalgebra::Isometry3;
use rayon::prelude::*;
use truecut_arm::{BranchOptions, FrameId, IkSolver, Robot};

use super::error::{ProgramError, ProgramErrorKind};
use super::moves::{Motion, Move, PathPoint, Program, Tool, Zone};
use super::spare::led_along;
use super::start::Start;
use crate::singularity::SingularityLimits;

/// When a posture or a step of the arm counts as possible.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TravelOptions {
    /// Largest motion of one joint (rad or m) along a linear move. A joint move may turn joints as
    /// far as limits let it.
    pub largest_step: f64,
    /// How far postures keep from singularities.
    pub singularity: SingularityLimits,
}

impl Default for TravelOptions {
    /// Half a radian, and the distances from singularities that milling keeps.
    fn default() -> Self {
        Self {
            largest_step: 0.5,
            singularity: SingularityLimits::default(),
        }
    }
}

impl Program {
    /// A program through `points`, on the arm's branches by [`shortest_travel`]. Path points count
    /// from 0.
    ///
    /// # Errors
    /// As [`shortest_travel`].
    pub fn along(
        robot: &Robot,
        name: &str,
        tool: Tool,
        world_from_base: Isometry3<f64>,
        points: &[PathPoint],
        options: &TravelOptions,
    ) -> Result<Self, ProgramError> {
        let postures = shortest_travel(
            robot,
            &tool.flange_from_tool,
            &world_from_base,
            points,
            None,
            options,
        )?;
        let moves = points.iter().zip(postures).enumerate();
        Ok(Self {
            name: name.to_owned(),
            comment: String::new(),
            tool,
            world_from_base,
            moves: moves
                .map(|(path_point, (point, posture))| Move {
                    path_point,
                    base_from_tool: point.base_from_tool,
                    motion: point.motion,
                    zone: Zone::default(),
                    turntable_rad: point.turntable_rad,
                    posture,
                })
                .collect(),
            spindle: Vec::new(),
            notes: Vec::new(),
        })
    }
}

/// Cheapest route to a posture: the rank of its start, what it costs, and the posture before.
#[derive(Clone, Copy)]
pub(super) struct Route {
    /// Goes before the cost: of two routes the one whose start ranks first is cheaper.
    rank: usize,
    cost: f64,
    from: usize,
}

impl Route {
    pub(super) const UNREACHED: Route = Route {
        rank: usize::MAX,
        cost: f64::INFINITY,
        from: usize::MAX,
    };

    pub(super) fn beginning(rank: usize, cost: f64) -> Self {
        Route {
            rank,
            cost,
            from: usize::MAX,
        }
    }

    fn cmp(&self, other: &Route) -> Ordering {
        let by_cost = || self.cost.total_cmp(&other.cost);
        self.rank.cmp(&other.rank).then_with(by_cost)
    }
}

/// Postures along a path, over all branches of the inverse kinematics and all whole turns within
/// limits. Without a posture before the first (`start`) the path begins in the posture of least
/// [cost](Start::cost) from which all points are reached, [`Start::AtRest`]. From there, the sum of
/// the distances from point to point (root of the sum of squared joint motions) is least, the way
/// from `start` included. Found by dynamic programming, so no other choice is shorter. An arm with
/// joints to spare has a continuum of postures at each point: it is led along the lines by steps of
/// least length, from the start nearest to what is asked for.
///
/// # Errors
/// At the first point that is out of reach, within no limits, singular in all postures, or to which
/// a joint would have to jump: with the point and the joint.
pub fn shortest_travel(
    robot: &Robot,
    flange_from_tool: &Isometry3<f64>,
    world_from_base: &Isometry3<f64>,
    points: &[PathPoint],
    start: Option<&[f64]>,
    options: &TravelOptions,
) -> Result<Vec<Vec<f64>>, ProgramError> {
    let solver = robot.ik_solver(&BranchOptions::default());
    let frames = [flange_from_tool, world_from_base];
    if robot.has_joints_to_spare() {
        let start = start.map_or(Start::AtRest, Start::Near);
        return led_along(&solver, frames, points, start, options);
    }
    let columns = survey(robot, &solver, frames, points, options)?;
    let Some(first) = columns.first() else {
        return Ok(Vec::new());
    };
    let begun: Vec<Route> = match start {
        Some(start) => {
            let from_start = first.iter().map(|q| distance(start, q).0);
            from_start.map(|cost| Route::beginning(0, cost)).collect()
        }
        None => {
            let ranks = Start::AtRest.ranks(robot, first).into_iter();
            ranks.map(|rank| Route::beginning(rank, 0.0)).collect()
        }
    };
    chain(robot, points, &columns, begun, options)
}

/// The flange in the world where the tool stands at a pose in the base frame.
pub(super) fn flange_at(
    [flange_from_tool, world_from_base]: [&Isometry3<f64>; 2],
    base_from_tool: &Isometry3<f64>,
) -> Isometry3<f64> {
    world_from_base * base_from_tool * flange_from_tool.inverse()
}

/// Postures at each point that keep limits and distances.
pub(super) fn survey(
    robot: &Robot,
    solver: &IkSolver,
    frames: [&Isometry3<f64>; 2],
    points: &[PathPoint],
    options: &TravelOptions,
) -> Result<Vec<Vec<Vec<f64>>>, ProgramErrorKind> {
    let survey = |(path_point, point): (usize, &PathPoint)| {
        let world_from_flange = flange_at(frames, &point.base_from_tool);
        let limits = &options.singularity;
        candidates(robot, solver, path_point, &world_from_flange, limits)
    };
    let columns = points.par_iter().enumerate().map(survey);
    // Collected in order, so that the first fault of the path is reported, whichever thread finds
    // one first.
    let columns: Vec<Result<Vec<Vec<f64>>, ProgramErrorKind>> = columns.collect();
    columns.into_iter().collect()
}

/// The cheapest chain through the postures at the points, from routes to those of the first.
pub(super) fn chain(
    robot: &Robot,
    points: &[PathPoint],
    columns: &[Vec<Vec<f64>>],
    begun: Vec<Route>,
    options: &TravelOptions,
) -> Result<Vec<Vec<f64>>, ProgramError> {
    let mut routes: Vec<Vec<Route>> = vec![begun];
    for (i, point) in points.iter().enumerate().skip(1) {
        let largest = match point.motion {
            Motion::Joint { .. } => f64::INFINITY,
            Motion::Linear { .. } => options.largest_step,
        };
        let (before, here) = (&columns[i - 1], &columns[i]);
        let reached = here
            .iter()
            .map(|q| cheapest(before, &routes[i - 1], q, largest));
        let reached: Vec<Route> = reached.collect();
        if reached.iter().all(|route| route.cost.is_infinite()) {
            let poses = [&points[i - 1], point].map(|one| one.base_from_tool.rotation);
            let turn_rad = poses[0].angle_to(&poses[1]);
            let step = [before, here];
            return Err(jump(robot, i, step, &routes[i - 1], largest, turn_rad).into());
        }
        routes.push(reached);
    }
    Ok(walk_back(columns, &routes))
}

/// The chain of least travel through columns of rated postures, the ratings added to it.
pub(super) fn rated_chain(columns: &[Vec<(f64, Vec<f64>)>]) -> Vec<Vec<f64>> {
    let postures = |column: &Vec<(f64, Vec<f64>)>| column.iter().map(|(_, q)| q.clone()).collect();
    let bare: Vec<Vec<Vec<f64>>> = columns.iter().map(postures).collect();
    let mut routes: Vec<Vec<Route>> = Vec::with_capacity(columns.len());
    for (i, column) in columns.iter().enumerate() {
        let reached = column.iter().map(|(rating, q)| {
            let route = match routes.last() {
                Some(before) => cheapest(&bare[i - 1], before, q, f64::INFINITY),
                None => Route::beginning(0, 0.0),
            };
            Route {
                cost: route.cost + rating,
                ..route
            }
        });
        let reached = reached.collect();
        routes.push(reached);
    }
    walk_back(&bare, &routes)
}

/// Postures at a point that keep limits and distances.
pub(super) fn candidates(
    robot: &Robot,
    solver: &IkSolver,
    path_point: usize,
    world_from_flange: &Isometry3<f64>,
    limits: &SingularityLimits,
) -> Result<Vec<Vec<f64>>, ProgramErrorKind> {
    let all = solver.within_limits(world_from_flange, FrameId::Flange);
    if all.is_empty() {
        let branches = solver.branches(world_from_flange, FrameId::Flange);
        return Err(outside(robot, path_point, world_from_flange, &branches));
    }
    let Some(geometry) = solver.geometry() else {
        return Ok(all);
    };
    let clear = |q: &&Vec<f64>| limits.allow(&geometry.singularity_distance(q));
    let kept: Vec<Vec<f64>> = all.iter().filter(clear).cloned().collect();
    if kept.is_empty() {
        let shares = all
            .iter()
            .map(|q| limits.nearest(&geometry.singularity_distance(q)));
        let furthest = shares.max_by(|a, b| a.share.total_cmp(&b.share));
        return Err(furthest.map_or(
            ProgramErrorKind::out_of_reach(path_point, world_from_flange),
            |near| ProgramErrorKind::Singular {
                path_point,
                kind: near.kind,
                joint: robot.chain.joints[near.joint].name.clone(),
                distance: near.distance,
                least: near.least,
            },
        ));
    }
    Ok(kept)
}

/// Why no posture is within limits.
pub(super) fn outside(
    robot: &Robot,
    path_point: usize,
    world_from_flange: &Isometry3<f64>,
    branches: &[Vec<f64>],
) -> ProgramErrorKind {
    let worst = |q: &Vec<f64>| {
        let joints = robot.chain.joints.iter().zip(q);
        let excess = joints.filter_map(|(joint, q)| {
            let l = joint.limits?;
            let turns = [-1.0, 0.0, 1.0].map(|turn| q + turn * std::f64::consts::TAU);
            let by = turns.map(|q| (q - l.upper).max(l.lower - q).max(0.0));
            Some((joint, by.into_iter().fold(f64::INFINITY, f64::min)))
        });
        excess.max_by(|a, b| a.1.total_cmp(&b.1))
    };
    let least = branches.iter().filter_map(worst);
    match least.min_by(|a, b| a.1.total_cmp(&b.1)) {
        None => ProgramErrorKind::out_of_reach(path_point, world_from_flange),
        Some((joint, by)) => ProgramErrorKind::OutsideLimits {
            path_point,
            joint: joint.name.clone(),
            excess_deg: by.to_degrees(),
        },
    }
}

/// Root of the sum of squared joint motions, and the widest of them.
pub(super) fn distance(from: &[f64], to: &[f64]) -> (f64, f64) {
    let mut squares = 0.0;
    let mut widest: f64 = 0.0;
    for (a, b) in from.iter().zip(to) {
        let step = (a - b).abs();
        widest = widest.max(step);
        squares += step * step;
    }
    (squares.sqrt(), widest)
}

fn cheapest(before: &[Vec<f64>], routes: &[Route], to: &[f64], largest: f64) -> Route {
    let mut best = Route::UNREACHED;
    for (from, (q, route)) in before.iter().zip(routes).enumerate() {
        // No route from here is cheaper than the route to here.
        if route.cmp(&best).is_ge() {
            continue;
        }
        let (length, widest) = distance(q, to);
        let longer = Route {
            rank: route.rank,
            cost: route.cost + length,
            from,
        };
        if widest <= largest && longer.cmp(&best).is_lt() {
            best = longer;
        }
    }
    best
}

fn jump(
    robot: &Robot,
    path_point: usize,
    [before, here]: [&Vec<Vec<f64>>; 2],
    routes: &[Route],
    largest: f64,
    turn_rad: f64,
) -> ProgramErrorKind {
    let mut least = (f64::INFINITY, 0);
    let reached = before
        .iter()
        .zip(routes)
        .filter(|(_, w)| w.cost.is_finite());
    for (from, _) in reached {
        for to in here {
            let steps = from.iter().zip(to).map(|(a, b)| (a - b).abs());
            let widest = steps.enumerate().max_by(|a, b| a.1.total_cmp(&b.1));
            if let Some((joint, step)) = widest.filter(|(_, step)| *step < least.0) {
                least = (step, joint);
            }
        }
    }
    ProgramErrorKind::Jump {
        path_point,
        joint: robot.chain.joints[least.1].name.clone(),
        jump_deg: least.0.to_degrees(),
        largest_deg: largest.to_degrees(),
        turn_deg: turn_rad.to_degrees(),
    }
}

fn walk_back(columns: &[Vec<Vec<f64>>], routes: &[Vec<Route>]) -> Vec<Vec<f64>> {
    let last = routes.last().map(Vec::as_slice).unwrap_or_default();
    let cheapest = last.iter().enumerate().min_by(|a, b| a.1.cmp(b.1));
    let mut at = cheapest.map_or(0, |(k, _)| k);
    let mut path = Vec::with_capacity(columns.len());
    for (column, routes) in columns.iter().zip(routes).rev() {
        path.push(column[at].clone());
        at = routes[at].from;
    }
    path.reverse();
    path
}
