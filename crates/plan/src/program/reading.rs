//! From what a file says of its moves to a program: what the readers of all dialects share.

use std::collections::BTreeMap;
use std::path::Path;

use nalgebra::{Isometry3, Unit, UnitQuaternion};
use rayon::prelude::*;
use truecut_arm::{BranchOptions, FrameId, IkOptions, IkSolver, Robot};

use super::error::{MOST_POINTS, ProgramError, ProgramErrorKind, SLOWEST};
use super::flags::{Flags, Resolver};
use super::moves::{Motion, Move, Program, Zone};
use super::spare::line_end;
use super::start::Start;
use super::travel::{outside, rated_chain};
use crate::arc::Arc;

/// How far chords of a circle lie off it, m.
pub(super) const CHORD_M: f64 = 5e-6;
/// Largest turn of the tool along a chord, rad.
const CHORD_RAD: f64 = 0.1;

/// Where a move goes.
pub(super) enum Goal {
    /// The tool's pose in the program's base frame, with what the file says of the branch. Without
    /// it the posture is the one nearest to that before.
    Pose(Isometry3<f64>, Option<Box<dyn Flags>>),
    /// A pose, in the posture nearest to this one.
    Near(Isometry3<f64>, Vec<f64>),
    Joints(Vec<f64>),
}

/// A move as a file says it.
pub(super) struct Step {
    pub line: usize,
    pub path_point: Option<usize>,
    pub goal: Goal,
    /// A point that a circle goes through on its way.
    pub via: Option<Isometry3<f64>>,
    /// Whether the tool turns on a circle as its tangent does, whatever the attitude of the end.
    pub with_tangent: bool,
    pub motion: Motion,
    pub zone: Zone,
    pub turntable_rad: Option<f64>,
}

/// What was read and left aside, each kind once.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Notes(BTreeMap<String, (usize, usize)>);

impl Notes {
    pub fn add(&mut self, line: usize, text: impl Into<String>) {
        self.0.entry(text.into()).or_insert((line, 0)).1 += 1;
    }

    /// In the order of their first lines.
    pub fn texts(&self) -> Vec<String> {
        let mut all: Vec<_> = self.0.iter().collect();
        all.sort_by_key(|(_, (line, _))| *line);
        let text = |(text, (line, count)): (&String, &(usize, usize))| match count {
            1 => format!("line {line}: {text}"),
            _ => format!("line {line}: {text}; {} more like it", count - 1),
        };
        all.into_iter().map(text).collect()
    }
}

type Column = Vec<(f64, Vec<f64>)>;

/// Refuses a move that would never end.
fn unless_too_slow(motion: Motion) -> Result<(), ProgramErrorKind> {
    let (speed, what) = match motion {
        Motion::Joint { share } => (share, "the share of the top speed"),
        Motion::Linear { speed_m_per_s } => (speed_m_per_s, "the speed in m/s"),
    };
    let rule = format!("at least {SLOWEST:e}: the move would not end");
    ProgramErrorKind::unless(speed >= SLOWEST, what, format!("{speed:e}"), rule)
}

/// Adds the moves to a program: circles as chords, postures by what the file says of the branch,
/// else nearest to that before. Switches of the spindle count steps, and are moved to the moves
/// that come of them.
///
/// # Errors
/// With the step's line, if no posture reaches it.
pub(super) fn follow(
    mut head: Program,
    steps: Vec<Step>,
    robot: &Robot,
    path: &Path,
) -> Result<Program, ProgramError> {
    if let Some(step) = steps.get(MOST_POINTS) {
        ProgramErrorKind::unless_too_many(steps.len())
            .map_err(|kind| ProgramError::in_file(path, step.line, kind))?;
    }
    for step in &steps {
        unless_too_slow(step.motion)
            .map_err(|kind| ProgramError::in_file(path, step.line, kind))?;
    }
    let (steps, firsts) = chords(&head, steps, robot, path)?;
    for switch in &mut head.spindle {
        switch.before = firsts.get(switch.before).copied().unwrap_or(steps.len());
    }
    let points = path_points(&steps);
    let resolver = match steps.iter().find(|step| step.flags().is_some()) {
        Some(step) => Some(
            Resolver::new(robot).map_err(|kind| ProgramError::in_file(path, step.line, kind))?,
        ),
        None => None,
    };
    let flagged = |(step, point): (&Step, &usize)| match (&step.goal, &resolver) {
        (Goal::Pose(pose, Some(flags)), Some(resolver)) => {
            let found = resolver.postures(*point, &head.world_from_flange(pose), flags.as_ref());
            found.map_err(|kind| ProgramError::in_file(path, step.line, kind))
        }
        (Goal::Joints(joints), _) => Ok(vec![(0.0, joints.clone())]),
        (Goal::Pose(..) | Goal::Near(..), _) => Ok(Column::new()),
    };
    // Collected in order, so that the first fault of the file is reported.
    let columns: Vec<Result<Column, ProgramError>> =
        steps.par_iter().zip(&points).map(flagged).collect();
    let mut columns: Vec<Column> = columns.into_iter().collect::<Result<_, _>>()?;
    let solver = robot.ik_solver(&BranchOptions::default());
    for i in 0..columns.len() {
        let given = match &steps[i].goal {
            Goal::Near(pose, near) => Some((pose, Some(vec![(0.0, near.clone())]))),
            Goal::Pose(pose, _) => Some((pose, None)),
            Goal::Joints(_) => None,
        };
        if let (true, Some((pose, near))) = (columns[i].is_empty(), given) {
            let before = i.checked_sub(1).map(|k| columns[k].as_slice());
            let led = before.filter(|_| near.is_none()).and_then(|before| {
                let from = steps[i - 1].pose(&head, robot);
                led_on_a_line(&head, &solver, steps[i].motion, [&from, pose], before)
            });
            let near = near.as_deref().or(before).unwrap_or_default();
            let flange = head.world_from_flange(pose);
            let found = led.map_or_else(|| unflagged(robot, &solver, &flange, near, points[i]), Ok);
            columns[i] = found.map_err(|kind| ProgramError::in_file(path, steps[i].line, kind))?;
        }
    }
    let postures = rated_chain(&columns);
    for ((step, posture), path_point) in steps.into_iter().zip(postures).zip(points) {
        head.moves.push(Move {
            path_point,
            base_from_tool: step.pose(&head, robot),
            motion: step.motion,
            zone: step.zone,
            turntable_rad: step.turntable_rad,
            posture,
        });
    }
    Ok(head)
}

impl Step {
    fn flags(&self) -> Option<&dyn Flags> {
        match &self.goal {
            Goal::Pose(_, Some(flags)) => Some(flags.as_ref()),
            _ => None,
        }
    }

    fn pose(&self, head: &Program, robot: &Robot) -> Isometry3<f64> {
        match &self.goal {
            Goal::Pose(pose, _) | Goal::Near(pose, _) => *pose,
            Goal::Joints(joints) => {
                let flange = robot.world_from_frame(joints, FrameId::Flange);
                head.world_from_base.inverse() * flange * head.tool.flange_from_tool
            }
        }
    }
}

/// Steps with circles taken apart, and the index of the first of each step.
fn chords(
    head: &Program,
    steps: Vec<Step>,
    robot: &Robot,
    path: &Path,
) -> Result<(Vec<Step>, Vec<usize>), ProgramError> {
    let mut all: Vec<Step> = Vec::with_capacity(steps.len());
    let mut firsts = Vec::with_capacity(steps.len());
    for mut step in steps {
        let at = |kind| ProgramError::in_file(path, step.line, kind);
        if let Goal::Joints(joints) | Goal::Near(_, joints) = &step.goal
            && joints.len() != robot.dof()
        {
            return Err(at(ProgramErrorKind::JointCount {
                what: "the move's target".to_owned(),
                found: joints.len(),
                wanted: robot.dof(),
            }));
        }
        firsts.push(all.len());
        if let Some(via) = step.via.take() {
            let before = all.last().ok_or_else(|| {
                at(ProgramErrorKind::unexpected(
                    "a circle",
                    "a move to its start",
                ))
            })?;
            let (from, to) = (before.pose(head, robot), step.pose(head, robot));
            let places = [&from, &via, &to].map(|pose| pose.translation.vector);
            for place in &places {
                ProgramErrorKind::unless_too_far(place).map_err(at)?;
            }
            let arc = Arc::through(places).ok_or_else(|| {
                at(ProgramErrorKind::value(
                    "the circle",
                    "a line",
                    "three points of a circle",
                ))
            })?;
            let turned = |share: f64| {
                let axis = Unit::new_normalize(arc.spoke.cross(&arc.quarter));
                UnitQuaternion::from_axis_angle(&axis, share * arc.turn_rad) * from.rotation
            };
            if step.with_tangent {
                step.goal = Goal::Pose(Isometry3::from_parts(to.translation, turned(1.0)), None);
            }
            let turn_rad = match step.with_tangent {
                true => arc.turn_rad,
                false => from.rotation.angle_to(&to.rotation),
            };
            let count = arc
                .chords(CHORD_M)
                .max((turn_rad / CHORD_RAD).ceil() as usize);
            ProgramErrorKind::unless_too_large(arc.radius_m()).map_err(at)?;
            let total = all.len().saturating_add(count);
            ProgramErrorKind::unless_too_many(total).map_err(at)?;
            for k in 1..count {
                let share = k as f64 / count as f64;
                let turn = match step.with_tangent {
                    true => Some(turned(share)),
                    false => from.rotation.try_slerp(&to.rotation, share, 1e-9),
                };
                let place = arc.at(share).into();
                let pose = Isometry3::from_parts(place, turn.unwrap_or(to.rotation));
                all.push(Step {
                    goal: Goal::Pose(pose, None),
                    path_point: None,
                    zone: Zone::default(),
                    via: None,
                    ..step
                });
            }
        }
        all.push(step);
    }
    Ok((all, firsts))
}

/// The points that the file numbers; counted if it does not number all, or not upwards.
fn path_points(steps: &[Step]) -> Vec<usize> {
    let named: Option<Vec<usize>> = steps.iter().map(|step| step.path_point).collect();
    let rising = |points: &Vec<usize>| points.windows(2).all(|pair| pair[0] < pair[1]);
    named
        .filter(rising)
        .unwrap_or_else(|| (0..steps.len()).collect())
}

/// The posture nearest to the one before; all if there is not one posture before.
fn unflagged(
    robot: &Robot,
    solver: &IkSolver,
    world_from_flange: &Isometry3<f64>,
    before: &[(f64, Vec<f64>)],
    path_point: usize,
) -> Result<Column, ProgramErrorKind> {
    if let [(_, before)] = before {
        return Ok(vec![(
            0.0,
            nearest(robot, solver, world_from_flange, before, path_point)?,
        )]);
    }
    if robot.has_joints_to_spare() {
        // Samples of a continuum would lead on to others: one stands for all.
        let rest = Start::AtRest.posture(robot);
        let starts = solver.starts_near(world_from_flange, FrameId::Flange, &rest);
        if let Some(start) = starts.into_iter().next() {
            return Ok(vec![(0.0, start)]);
        }
    }
    let all = solver.within_limits(world_from_flange, FrameId::Flange);
    if all.is_empty() {
        let branches = solver.branches(world_from_flange, FrameId::Flange);
        return Err(outside(robot, path_point, world_from_flange, &branches));
    }
    Ok(all.into_iter().map(|q| (0.0, q)).collect())
}

/// Where a line leads an arm with joints to spare from its one posture before; `None` of other
/// moves and arms.
fn led_on_a_line(
    head: &Program,
    solver: &IkSolver,
    motion: Motion,
    ends: [&Isometry3<f64>; 2],
    before: &[(f64, Vec<f64>)],
) -> Option<Column> {
    let ([(_, before)], Motion::Linear { .. }) = (before, motion) else {
        return None;
    };
    let frames = [&head.tool.flange_from_tool, &head.world_from_base];
    let led = solver.robot().has_joints_to_spare();
    let end = led.then(|| line_end(solver, frames, ends, before).ok());
    end.flatten().map(|q| vec![(0.0, q)])
}

/// The posture within limits nearest to another one.
pub(super) fn nearest(
    robot: &Robot,
    solver: &IkSolver,
    world_from_flange: &Isometry3<f64>,
    before: &[f64],
    path_point: usize,
) -> Result<Vec<f64>, ProgramErrorKind> {
    let flange = FrameId::Flange;
    if solver.geometry().is_none() {
        let options = IkOptions::default();
        let near = robot.inverse_kinematics(world_from_flange, flange, before, &options);
        if let Ok(near) = near {
            return Ok(near);
        }
    }
    let distance = |q: &Vec<f64>| {
        let each = q.iter().zip(before);
        each.map(|(a, b)| (a - b).powi(2)).sum::<f64>()
    };
    let all = solver.within_limits(world_from_flange, flange);
    let least = all
        .into_iter()
        .min_by(|a, b| distance(a).total_cmp(&distance(b)));
    least.ok_or_else(|| {
        let branches = solver.branches(world_from_flange, flange);
        outside(robot, path_point, world_from_flange, &branches)
    })
}
