//! The motion of an arm through a program: lines at their feeds, moves by joints, stops.
//!
//! The arm starts in the posture of the first move. Lines between two stops are one trajectory from
//! rest to rest whose corners are blended, its poses exactly on a line away from its ends; moves by
//! joints go from rest to rest. A line over which a joint would be faster than its share is slower
//! than its feed, as on a controller.

use std::cell::Cell;
use std::ops::RangeInclusive;

use nalgebra::{Isometry3, Quaternion, SVector, UnitQuaternion, Vector3};
use truecut_arm::{BranchOptions, FrameId, IkSolver, PathOptions, Robot};

use super::follow::{
    FollowError, check_duration, check_singularities, check_speeds, leaves as cannot_follow,
};
use super::joints::{move_by_joints, slowest_joint_s};
use super::timing::{LeadIn, TimingLaw};
use super::trajectory::{Trajectory, WINDOW_S};
use crate::program::{Motion, Move, Program, ProgramError, ProgramErrorKind, Zone};

/// Time in which the tool comes up to its feed, and in which it comes to rest, s.
const RAMP: TimingLaw = TimingLaw::RestToRest(LeadIn { duration_s: 0.3 });
/// A move that takes less leads nowhere, s.
const LEAST_MOVE_S: f64 = 1e-9;
/// Largest turn between two knots, rad: the mean of their quaternions is that of their turns to
/// 1e-6 of it.
const LARGEST_TURN_RAD: f64 = 0.02;

/// A knot of lines with its time, s.
type TimedKnot = (f64, SVector<f64, 9>);

/// A program that leads an arm.
#[derive(Debug, Clone, Copy)]
pub struct LedTask<'a> {
    pub robot: &'a Robot,
    pub program: &'a Program,
    /// Largest speed of a joint on lines, share of its top speed.
    pub joint_share: f64,
    /// Time between knots, s.
    pub interval_s: f64,
    pub longest_s: f64,
}

/// An arm that is led through a program.
#[derive(Debug, Clone, PartialEq)]
pub struct LedMotion {
    /// Postures at even times, from rest to rest.
    pub knots: Vec<Vec<f64>>,
    /// When each of the program's moves is done, s: where corners are blended, when the tool is
    /// next to the corner by its way.
    pub reached_s: Vec<f64>,
    /// Length of the lines, m.
    pub length_m: f64,
    /// Farthest that the tool comes off its lines where corners are blended, or stays short of one
    /// at which it turns back, m, and the path point next to it.
    pub off: (f64, usize),
    /// Lines that are slower than their feed, since a joint would be too fast, and the first of
    /// their path points.
    pub slowed: Option<(usize, usize)>,
}

impl LedTask<'_> {
    /// Solves the motion.
    ///
    /// # Errors
    /// The path point that the arm cannot be led to, and why: out of reach, a singularity, a speed
    /// that a joint has not; a turntable, which stands still here; a path of one place.
    pub fn solve(&self) -> Result<LedMotion, ProgramError> {
        let moves = &self.program.moves;
        if let Some(turned) = moves.iter().find(|one| one.turntable_rad.is_some()) {
            return Err(ProgramErrorKind::TurntableMoves {
                path_point: turned.path_point,
            }
            .into());
        }
        let Some(first) = moves.first() else {
            return Err(ProgramErrorKind::StandsStill.into());
        };
        let mut led = Growing {
            task: self,
            solver: self.robot.ik_solver(&BranchOptions::default()),
            motion: LedMotion {
                knots: vec![first.posture.clone()],
                reached_s: vec![0.0],
                length_m: 0.0,
                off: (0.0, first.path_point),
                slowed: None,
            },
        };
        let mut at = 1;
        while at < moves.len() {
            match moves[at].motion {
                Motion::Joint { share } => led.by_joints(&moves[at], share),
                Motion::Linear { .. } => {
                    let last = self.last_of_lines(at);
                    led.along_lines(at - 1..=last)?;
                    at = last;
                }
            }
            let duration_s = led.duration_s();
            led.motion.reached_s.resize(at + 1, duration_s);
            led.check_duration(duration_s, at)?;
            at += 1;
        }
        if led.motion.knots.len() < 2 {
            return Err(ProgramErrorKind::StandsStill.into());
        }
        Ok(led.motion)
    }

    /// Of lines that begin with this move, the last before a stop or a move by joints.
    fn last_of_lines(&self, first: usize) -> usize {
        let moves = &self.program.moves;
        let goes_on = |at: usize| {
            moves[at].zone != Zone::Stop
                && (moves.get(at + 1))
                    .is_some_and(|next| matches!(next.motion, Motion::Linear { .. }))
        };
        let mut last = first;
        while goes_on(last) {
            last += 1;
        }
        last
    }
}

/// A place on lines: of the tool in the base frame (m), its attitude as a quaternion, the number of
/// the line that it is on, with the share of the way there, and the way from the first line (m).
#[derive(Debug, Clone, Copy, PartialEq)]
struct Place(SVector<f64, 9>);

impl Place {
    fn new(pose: &Isometry3<f64>, at_line: f64, along_m: f64) -> Self {
        let (t, q) = (pose.translation.vector, pose.rotation);
        Self(SVector::from([
            t.x, t.y, t.z, q.w, q.i, q.j, q.k, at_line, along_m,
        ]))
    }

    fn place_m(&self) -> Vector3<f64> {
        self.0.fixed_rows::<3>(0).into_owned()
    }

    fn pose(&self) -> Isometry3<f64> {
        let quaternion = Quaternion::new(self.0[3], self.0[4], self.0[5], self.0[6]);
        let attitude = UnitQuaternion::from_quaternion(quaternion);
        Isometry3::from_parts(self.place_m().into(), attitude)
    }

    fn at_line(&self) -> f64 {
        self.0[7]
    }

    fn along_m(&self) -> f64 {
        self.0[8]
    }
}

/// The motion as it grows.
struct Growing<'a> {
    task: &'a LedTask<'a>,
    solver: IkSolver<'a>,
    motion: LedMotion,
}

impl Growing<'_> {
    /// How long the motion takes so far.
    fn duration_s(&self) -> f64 {
        (self.motion.knots.len() - 1) as f64 * self.task.interval_s
    }

    fn by_joints(&mut self, to: &Move, share: f64) {
        let (robot, interval_s) = (self.task.robot, self.task.interval_s);
        let knots = &mut self.motion.knots;
        let from = knots[knots.len() - 1].clone();
        if slowest_joint_s(robot, &from, &to.posture, share) < LEAST_MOVE_S {
            return;
        }
        let between = move_by_joints(robot, [&from, &to.posture], share, interval_s, interval_s);
        knots.extend(between);
        knots.push(to.posture.clone());
    }

    fn along_lines(&mut self, range: RangeInclusive<usize>) -> Result<(), ProgramError> {
        let last = *range.end();
        let (ends, knots) = self.knots(range);
        if knots.len() < 2 {
            return Ok(());
        }
        let trajectory = Trajectory::new(knots, RAMP);
        let before_s = self.duration_s();
        self.check_duration(before_s + trajectory.duration_s(), last)?;
        let sampled = trajectory.sampled(self.task.interval_s).into_iter();
        let places: Vec<Place> = sampled.map(Place).collect();
        let postures = self.postures(&places, &ends)?;
        self.motion.knots.extend(postures.into_iter().skip(1));
        self.reach(&ends, before_s, &places);
        self.look_off(&places, &ends);
        Ok(())
    }

    /// When the moves before the last one of lines are done; the places follow at even times. What
    /// leads nowhere is done with the move before.
    fn reach(&mut self, ends: &[usize], before_s: f64, places: &[Place]) {
        let mut k = 0;
        for (line, pair) in ends.windows(2).enumerate() {
            let done_s = self.motion.reached_s[self.motion.reached_s.len() - 1];
            self.motion.reached_s.resize(pair[1], done_s);
            let at = (line + 1) as f64;
            if line + 2 == ends.len() {
                break;
            }
            while k + 2 < places.len() && places[k + 1].at_line() < at {
                k += 1;
            }
            let [from, to] = [k, k + 1].map(|k| places[k].at_line());
            let share = if to > from {
                (at - from) / (to - from)
            } else {
                0.0
            };
            let steps = k as f64 + share.clamp(0.0, 1.0);
            (self.motion.reached_s).push(before_s + steps * self.task.interval_s);
        }
    }

    /// Knots of the lines between these moves, with their times, and the moves at whose poses the
    /// lines begin and end: one that repeats the pose before is no line. The sign of a quaternion
    /// goes on from knot to knot.
    fn knots(&mut self, range: RangeInclusive<usize>) -> (Vec<usize>, Vec<TimedKnot>) {
        let moves = &self.task.program.moves;
        let (first, last) = (*range.start(), *range.end());
        let start = Place::new(&moves[first].base_from_tool, 0.0, self.motion.length_m);
        let mut ends = vec![first];
        let mut knots = vec![(0.0, start.0)];
        for to in first + 1..=last {
            let [from, next] = [to - 1, to].map(|at| &moves[at]);
            let (from_pose, to_pose) = (&from.base_from_tool, &next.base_from_tool);
            let way_m = (to_pose.translation.vector - from_pose.translation.vector).norm();
            let move_s = self.move_s(from, next, way_m);
            if move_s < LEAST_MOVE_S {
                continue;
            }
            let turn_rad = from_pose.rotation.angle_to(&to_pose.rotation);
            let parts = (turn_rad / LARGEST_TURN_RAD).ceil().max(1.0);
            let (begun_s, _) = knots[knots.len() - 1];
            for k in 1..=parts as usize {
                let t = k as f64 / parts;
                let between = from_pose.try_lerp_slerp(to_pose, t, 1e-12);
                let pose = between.filter(|_| t < 1.0).unwrap_or(*to_pose);
                let along_m = self.motion.length_m + t * way_m;
                let at_line = (ends.len() - 1) as f64 + t;
                let mut place = Place::new(&pose, at_line, along_m);
                let before = knots[knots.len() - 1].1.fixed_rows::<4>(3).into_owned();
                let mut quaternion = place.0.fixed_rows_mut::<4>(3);
                if quaternion.dot(&before) < 0.0 {
                    quaternion.neg_mut();
                }
                knots.push((begun_s + t * move_s, place.0));
            }
            self.motion.length_m += way_m;
            ends.push(to);
        }
        (ends, knots)
    }

    /// How long a line takes by itself.
    fn move_s(&mut self, from: &Move, to: &Move, way_m: f64) -> f64 {
        let Motion::Linear { speed_m_per_s } = to.motion else {
            return 0.0;
        };
        let share = self.task.joint_share;
        let joints_s = slowest_joint_s(self.task.robot, &from.posture, &to.posture, share);
        let feed_s = way_m / speed_m_per_s;
        if joints_s > feed_s && way_m > 0.0 {
            let (count, point) = self.motion.slowed.unwrap_or((0, to.path_point));
            self.motion.slowed = Some((count + 1, point));
        }
        feed_s.max(joints_s)
    }

    /// Postures along lines, from the last one on.
    fn postures(&self, places: &[Place], ends: &[usize]) -> Result<Vec<Vec<f64>>, ProgramError> {
        let (robot, program) = (self.task.robot, self.task.program);
        let flange = |place: &Place| program.world_from_flange(&place.pose());
        let poses: Vec<Isometry3<f64>> = places.iter().map(flange).collect();
        // Which knot a fault is about.
        let seen = Cell::new(0);
        let at_mm = |k: usize| {
            seen.set(k);
            places[k].along_m() * 1e3
        };
        let to = |k: usize| ends[(places[k].at_line().ceil() as usize).min(ends.len() - 1)];
        let at = |error: FollowError| self.led_to(to(seen.get()), error);
        let near = &self.motion.knots[self.motion.knots.len() - 1];
        let followed = (self.solver).follow(&poses, FrameId::Flange, near, &PathOptions::default());
        let mut postures = followed.map_err(|error| at(cannot_follow(error.kind(), &at_mm).1))?;
        // The arm stands where the motion before has left it: speeds are those from there.
        if let Some(first) = postures.first_mut() {
            first.clone_from(near);
        }
        check_singularities(&self.solver, &postures, &at_mm).map_err(at)?;
        let advice = "lower the feed, or the share of the joints' speed on lines";
        let interval_s = self.task.interval_s;
        check_speeds(robot, &postures, interval_s, &at_mm, "the path", advice).map_err(at)?;
        Ok(postures)
    }

    /// Keeps how far the blended places come off the lines between the poses of these moves.
    fn look_off(&mut self, places: &[Place], ends: &[usize]) {
        let moves = &self.task.program.moves;
        let end = |at: usize| &moves[ends[at]];
        let place = |at: usize| end(at).base_from_tool.translation.vector;
        let last = ends.len() - 1;
        let around = (0.5 * WINDOW_S / self.task.interval_s).ceil() as usize + 1;
        for (k, one) in places.iter().enumerate() {
            let low = places[k.saturating_sub(around)].at_line().floor() as usize;
            let high = places[(k + around).min(places.len() - 1)].at_line().ceil() as usize;
            let (low, high) = (low.min(last - 1), high.clamp(1, last));
            let near = (low..high.max(low + 1))
                .map(|at| off_line(&one.place_m(), &place(at), &place(at + 1)));
            let off_m = near.fold(f64::INFINITY, f64::min);
            if off_m > self.motion.off.0 {
                let at = (one.at_line().round() as usize).min(last);
                self.motion.off = (off_m, end(at).path_point);
            }
        }
        let corners = (1..last).map(|at| (self.short_of(at, ends, places), end(at).path_point));
        let shortest = corners.max_by(|a, b| a.0.total_cmp(&b.0));
        if let Some(short) = shortest.filter(|short| short.0 > self.motion.off.0) {
            self.motion.off = short;
        }
    }

    /// By how much the blended places stay short of a corner at which the path turns back, along
    /// the line that leads there: on the lines themselves, so that nothing else tells.
    fn short_of(&self, at: usize, ends: &[usize], places: &[Place]) -> f64 {
        let moves = &self.task.program.moves;
        let [before, corner, after] =
            [at - 1, at, at + 1].map(|at| moves[ends[at]].base_from_tool.translation.vector);
        let Some(towards) = (corner - before).try_normalize(0.0) else {
            return 0.0;
        };
        if towards.dot(&(after - corner)) >= 0.0 {
            return 0.0;
        }
        let index = at as f64;
        let low = places.partition_point(|one| one.at_line() < index - 1.0);
        let high = places.partition_point(|one| one.at_line() <= index + 1.0);
        let reached = places[low..high]
            .iter()
            .map(|one| towards.dot(&(one.place_m() - corner)));
        let furthest = reached.fold(f64::NEG_INFINITY, f64::max);
        if furthest.is_finite() { -furthest } else { 0.0 }
    }

    fn check_duration(&self, duration_s: f64, at: usize) -> Result<(), ProgramError> {
        let advice = "a faster feed, or a part of the path";
        check_duration(duration_s, self.task.longest_s, advice)
            .map_err(|error| self.led_to(at, error))
    }

    fn led_to(&self, at: usize, error: FollowError) -> ProgramError {
        let path_point = self.task.program.moves[at].path_point;
        ProgramErrorKind::NotLed { path_point, error }.into()
    }
}

/// Distance of a place from a straight piece.
fn off_line(place: &Vector3<f64>, from: &Vector3<f64>, to: &Vector3<f64>) -> f64 {
    let along = to - from;
    let length2 = along.norm_squared();
    let t = match length2 > 0.0 {
        true => ((place - from).dot(&along) / length2).clamp(0.0, 1.0),
        false => 0.0,
    };
    (place - from - along * t).norm()
}
