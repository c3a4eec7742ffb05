//! A program run through between its points: what the arm does on the way.

use std::sync::atomic::{AtomicUsize, Ordering};

use nalgebra::Isometry3;
use rayon::prelude::*;
use truecut_arm::{BranchOptions, FrameId, IkSolver, PathOptions, Robot};

use super::inspect::{Finding, FindingKind, ON_THE_SPOT_M, too_near};
use super::moves::{Motion, Move, Program};
use crate::motion::joints::{joint_speeds, slowest_joint_s};
use crate::reach::largest_motion_rad;
use crate::singularity::SingularityLimits;

/// Most places that a run through is asked to look at: some 200 bytes are kept of each.
pub const MOST_PLACES: usize = 4_000_000;

/// Moves from one word on progress to the next.
const TOLD_EVERY: usize = 256;

/// How a program is run through.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ReplayOptions {
    /// Longest way between two places looked at on a line, m.
    pub step_m: f64,
    /// Largest turn between them, rad.
    pub step_rad: f64,
    pub singularity: SingularityLimits,
}

impl ReplayOptions {
    /// Places at which a line is looked at, its end with them.
    pub(super) fn places(&self, from: &Isometry3<f64>, to: &Isometry3<f64>) -> usize {
        let path_m = (to.translation.vector - from.translation.vector).norm();
        let turn_rad = from.rotation.angle_to(&to.rotation);
        let count = (path_m / self.step_m).max(turn_rad / self.step_rad);
        count.ceil().max(1.0) as usize
    }

    /// Places at which a move by joints is looked at, its end with them.
    fn turns(&self, from: &[f64], to: &[f64]) -> usize {
        (largest_motion_rad(from, to) / self.step_rad)
            .ceil()
            .max(1.0) as usize
    }
}

impl Default for ReplayOptions {
    /// 1 mm, 1°.
    fn default() -> Self {
        Self {
            step_m: 1e-3,
            step_rad: 1_f64.to_radians(),
            singularity: SingularityLimits::default(),
        }
    }
}

/// The arm at one instant.
#[derive(Debug, Clone, PartialEq)]
pub struct ReplayRow {
    pub time_s: f64,
    /// Path point of the move under way.
    pub path_point: usize,
    pub world_from_tool: Isometry3<f64>,
    pub posture: Vec<f64>,
}

/// A program run through.
#[derive(Debug, Clone, PartialEq)]
pub struct Replay {
    pub rows: Vec<ReplayRow>,
    /// What the arm cannot do, or only badly, each kind once a move and joint.
    pub findings: Vec<Finding>,
    /// Largest speed of a joint over its limit, with the joint and the path point, on lines.
    pub fastest: Option<(f64, usize, usize)>,
}

impl Replay {
    /// What the arm cannot do.
    pub fn grave(&self) -> impl Iterator<Item = &Finding> {
        let findings = self.findings.iter();
        findings.filter(|finding| finding.kind.is_grave())
    }
}

impl Program {
    /// How many places a run through looks at.
    #[must_use]
    pub fn places(&self, options: &ReplayOptions) -> usize {
        let pairs = self.moves.windows(2);
        let each = pairs.map(|pair| match pair[1].motion {
            Motion::Joint { .. } => options.turns(&pair[0].posture, &pair[1].posture),
            Motion::Linear { .. } => {
                let [from, to] = [0, 1].map(|k| &pair[k].base_from_tool);
                options.places(from, to)
            }
        });
        each.fold(1, usize::saturating_add)
    }

    /// Runs through a program: along lines the tool point at the programmed speed, its attitude
    /// turning evenly, the joints found again between path points from the posture before; on moves
    /// by joints all joints together, the slowest at its share of its top speed. Accelerations and
    /// zones are left out.
    #[must_use]
    pub fn replay(&self, robot: &Robot, options: &ReplayOptions) -> Replay {
        self.replay_telling(robot, options, &|_| ())
    }

    /// As [`Program::replay`]; tells now and then which part of it is done, 0 to 1.
    #[must_use]
    pub fn replay_telling(
        &self,
        robot: &Robot,
        options: &ReplayOptions,
        tell: &(dyn Fn(f64) + Sync),
    ) -> Replay {
        let (done, all) = (AtomicUsize::new(0), self.moves.len() as f64);
        // Moves are independent of each other: each begins and ends with a posture of the program.
        let pairs = self.moves.par_windows(2);
        let solver = robot.ik_solver(&BranchOptions::default());
        let legs: Vec<Leg> = pairs
            .map(|pair| {
                let before = done.fetch_add(1, Ordering::Relaxed);
                if before.is_multiple_of(TOLD_EVERY) {
                    tell(before as f64 / all);
                }
                self.leg(robot, &solver, [&pair[0], &pair[1]], options)
            })
            .collect();
        let mut replay = Replay {
            rows: Vec::new(),
            findings: self.inspect(robot, &options.singularity),
            fastest: None,
        };
        // Speeds are judged on the way; between path points alone they would be means.
        let slow = |finding: &Finding| !matches!(finding.kind, FindingKind::TooFast { .. });
        replay.findings.retain(slow);
        if let Some(first) = self.moves.first() {
            let flange = robot.world_from_frame(&first.posture, FrameId::Flange);
            replay.rows.push(ReplayRow {
                time_s: 0.0,
                path_point: first.path_point,
                world_from_tool: flange * self.tool.flange_from_tool,
                posture: first.posture.clone(),
            });
        }
        let mut start_s = 0.0;
        for leg in legs {
            let end_s = leg.rows.last().map_or(0.0, |row| row.time_s);
            replay
                .rows
                .extend(leg.rows.into_iter().map(|row| ReplayRow {
                    time_s: row.time_s + start_s,
                    ..row
                }));
            start_s += end_s;
            replay.findings.extend(leg.findings);
            if leg
                .fastest
                .is_some_and(|(share, ..)| replay.fastest.is_none_or(|f| share > f.0))
            {
                replay.fastest = leg.fastest;
            }
        }
        replay.findings.sort_by_key(|finding| finding.path_point);
        replay
    }

    fn leg(
        &self,
        robot: &Robot,
        solver: &IkSolver<'_>,
        [before, step]: [&Move; 2],
        options: &ReplayOptions,
    ) -> Leg {
        match step.motion {
            Motion::Joint { share } => self.by_joints(robot, before, step, share, options),
            Motion::Linear { speed_m_per_s } => {
                self.on_line(solver, [before, step], speed_m_per_s, options)
            }
        }
    }

    fn by_joints(
        &self,
        robot: &Robot,
        before: &Move,
        step: &Move,
        share: f64,
        options: &ReplayOptions,
    ) -> Leg {
        let time_s = slowest_joint_s(robot, &before.posture, &step.posture, share);
        let count = options.turns(&before.posture, &step.posture);
        let mut leg = Leg::default();
        for k in 1..=count {
            let t = k as f64 / count as f64;
            let between = before.posture.iter().zip(&step.posture);
            let posture: Vec<f64> = between.map(|(a, b)| a + t * (b - a)).collect();
            let flange = robot.world_from_frame(&posture, FrameId::Flange);
            leg.rows.push(ReplayRow {
                time_s: t * time_s,
                path_point: step.path_point,
                world_from_tool: flange * self.tool.flange_from_tool,
                posture,
            });
        }
        leg
    }

    fn on_line(
        &self,
        solver: &IkSolver<'_>,
        [before, step]: [&Move; 2],
        speed_m_per_s: f64,
        options: &ReplayOptions,
    ) -> Leg {
        let robot = solver.robot();
        let (from, to) = (&before.base_from_tool, &step.base_from_tool);
        let path_m = (to.translation.vector - from.translation.vector).norm();
        let count = options.places(from, to);
        let mut leg = Leg::default();
        let mut last = before.posture.clone();
        for k in 1..=count {
            let t = k as f64 / count as f64;
            // Half a turn has no shortest way; its end is looked at then.
            let pose = from.try_lerp_slerp(to, t, 1e-9).unwrap_or(*to);
            let flange = self.world_from_flange(&pose);
            let Some(posture) = next_posture(solver, &flange, &last) else {
                leg.find(robot, step, 0, FindingKind::LeavesReach { share: t });
                return leg;
            };
            let time_s = path_m / speed_m_per_s;
            // A turn on the spot takes the time that the joints need.
            if path_m > ON_THE_SPOT_M {
                leg.speeds(robot, step, &last, &posture, time_s / count as f64);
            }
            if let Some(geometry) = solver.geometry().filter(|_| k < count)
                && let Some((joint, kind)) = too_near(geometry, &posture, &options.singularity)
            {
                leg.find(robot, step, joint, kind);
            }
            leg.rows.push(ReplayRow {
                time_s: t * time_s,
                path_point: step.path_point,
                world_from_tool: self.world_from_base * pose,
                posture: posture.clone(),
            });
            last = posture;
        }
        let apart = last.iter().zip(&step.posture).map(|(a, b)| (a - b).abs());
        let widest = apart.enumerate().max_by(|a, b| a.1.total_cmp(&b.1));
        if let Some((joint, by_rad)) = widest.filter(|(_, by)| *by > SAME_POSTURE_RAD) {
            leg.find(robot, step, joint, FindingKind::OtherPosture { by_rad });
        }
        leg
    }
}

/// The posture at the next place of a line: the nearest of all, or, of an arm with joints to spare,
/// the one that the posture before leads to.
fn next_posture(
    solver: &IkSolver<'_>,
    world_from_flange: &Isometry3<f64>,
    before: &[f64],
) -> Option<Vec<f64>> {
    if solver.robot().has_joints_to_spare() {
        let next = std::slice::from_ref(world_from_flange);
        let led = solver.follow(next, FrameId::Flange, before, &PathOptions::default());
        return led.ok()?.pop();
    }
    let apart = |q: &Vec<f64>| largest_motion_rad(q, before);
    let found = solver.within_limits(world_from_flange, FrameId::Flange);
    let found = found.into_iter();
    found.min_by(|a, b| apart(a).total_cmp(&apart(b)))
}

/// A line arrives in the posture of its end if all joints do to this, rad: what the inverse
/// kinematics of a rounded pose leave near, not at, a singularity.
const SAME_POSTURE_RAD: f64 = 1e-3;

/// One move run through.
#[derive(Default)]
struct Leg {
    rows: Vec<ReplayRow>,
    findings: Vec<Finding>,
    fastest: Option<(f64, usize, usize)>,
}

impl Leg {
    /// Each kind once for a joint: the first place.
    fn find(&mut self, robot: &Robot, step: &Move, joint: usize, kind: FindingKind) {
        let joint = robot.chain.joints[joint].name.clone();
        let same = |other: &Finding| {
            other.joint == joint
                && std::mem::discriminant(&other.kind) == std::mem::discriminant(&kind)
        };
        if !self.findings.iter().any(same) {
            self.findings.push(Finding {
                path_point: step.path_point,
                joint,
                kind,
            });
        }
    }

    fn speeds(&mut self, robot: &Robot, step: &Move, from: &[f64], to: &[f64], time_s: f64) {
        for one in joint_speeds(robot, from, to, time_s) {
            let share = one.share();
            if self.fastest.is_none_or(|(most, ..)| share > most) {
                self.fastest = Some((share, one.joint, step.path_point));
            }
            if one.is_too_fast() {
                self.find(robot, step, one.joint, FindingKind::of_speed(&one));
            }
        }
    }
}
