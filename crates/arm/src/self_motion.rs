//! What an arm does with joints that a pose leaves free: it changes by least from pose to pose,
//! slows joints down before their limits, and can move while its tool stands still.
//!
//! A step is the least one of those that lead to the pose, root of the sum of squared joint motions
//! (rad and m). A joint that moves towards a limit counts the more the nearer it is: its motion
//! ends there, and its velocity does not jump.

use nalgebra::{DVector, Isometry3, Matrix6, Vector6};

use crate::ik::{IkOptions, within};
use crate::ik_branches::{IkSolver, travel};
use crate::model::{FrameId, JointKind, Limits, Robot};
use crate::opw::wrap;

/// Joints that a pose asks for.
const OF_A_POSE: usize = 6;
/// How far joints keep from their limits where they are free to, rad or m: an arm gives way.
const CLEAR: f64 = 0.5 * std::f64::consts::PI / 180.0;
/// Room before that in which a joint slows down, rad or m.
const SLOWS_WITHIN: f64 = 0.1;
/// Newton steps to a pose, and how far one may move a joint: further away the arm is another.
const STEPS: usize = 20;
const LONGEST_STEP: f64 = 0.2;
/// Times that it is asked which joints move towards a limit; mostly none does.
const ASKED: usize = 8;
/// Damping of a step, a share of the trace of its matrix: it bounds steps at a singularity.
const DAMPING: f64 = 1e-12;
/// Steps of a motion with the tool at rest, the longest of a joint, and the least that counts.
const DRAWS: usize = 200;
const LONGEST_DRAW: f64 = 0.1;
const LEAST_DRAW: f64 = 1e-6;
/// Least share of the step that is wished for which is tried before the motion ends.
const LEAST_SHARE: f64 = 1e-2;
/// Postures from which the way to another, or into the limits, is looked for.
const DRAWN: usize = 12;
/// Postures that agree to this in every joint after they were drawn are one.
const SAME: f64 = 1e-4;

impl Robot {
    /// Whether the arm has more joints than a pose asks for, so that it can move with its tool at
    /// rest.
    #[must_use]
    pub fn has_joints_to_spare(&self) -> bool {
        self.dof() > OF_A_POSE
    }

    /// The posture within limits to which steps of least length lead; `None` if they do not, or if
    /// a joint would move by more than a step may.
    pub(crate) fn least_change(
        &self,
        world_from_target: &Isometry3<f64>,
        frame: FrameId,
        from: &[f64],
    ) -> Option<Vec<f64>> {
        let motion = SelfMotion {
            robot: self,
            frame,
            world_from_target,
            keeps_limits: true,
        };
        let found = motion.reached(from.to_vec())?;
        self.check_posture(&found).is_ok().then_some(found)
    }
}

/// Motion of an arm at a pose.
struct SelfMotion<'a> {
    robot: &'a Robot,
    frame: FrameId,
    world_from_target: &'a Isometry3<f64>,
    /// Whether joints slow down before their limits.
    keeps_limits: bool,
}

impl SelfMotion<'_> {
    /// The posture at the pose that steps of least length lead to.
    fn reached(&self, mut q: Vec<f64>) -> Option<Vec<f64>> {
        let options = IkOptions::default();
        let rest = DVector::zeros(q.len());
        for _ in 0..STEPS {
            let error = self
                .robot
                .pose_error(&q, self.frame, self.world_from_target);
            if within(&error, &options) {
                return Some(q);
            }
            let step = self.step(&q, &error, &rest)?;
            if step.amax() > LONGEST_STEP {
                return None;
            }
            q.iter_mut().zip(step.iter()).for_each(|(q, by)| *q += by);
        }
        None
    }

    /// The step that takes an error of the pose away and is otherwise as near to a wish as the pose
    /// lets it: with no wish the least one.
    fn step(&self, q: &[f64], error: &Vector6<f64>, wish: &DVector<f64>) -> Option<DVector<f64>> {
        let jacobian = self.robot.jacobian(q, self.frame);
        let mut freedom = DVector::from_element(q.len(), 1.0);
        let mut asked = 0;
        loop {
            let mut weighted = jacobian.clone();
            for (mut column, share) in weighted.column_iter_mut().zip(freedom.iter()) {
                column *= *share;
            }
            let square: Matrix6<f64> = &weighted * jacobian.transpose();
            let damped = square + Matrix6::identity() * (DAMPING * square.trace());
            let left: Vector6<f64> = error - &weighted * wish;
            let pull: DVector<f64> = jacobian.tr_mul(&damped.cholesky()?.solve(&left)) + wish;
            asked += 1;
            let next = self.freedom(q, &pull);
            if next == freedom || asked == ASKED {
                return Some(pull.component_mul(&freedom));
            }
            freedom = next;
        }
    }

    /// The share of a pull that each joint follows: all of it, less towards a limit that is near.
    fn freedom(&self, q: &[f64], pull: &DVector<f64>) -> DVector<f64> {
        let joints = self.robot.chain.joints.iter().zip(q).zip(pull.iter());
        let each = joints.map(|((joint, &q), &pull)| match joint.limits {
            Some(limits) if self.keeps_limits => {
                let room = if pull > 0.0 {
                    limits.upper - q
                } else {
                    q - limits.lower
                };
                ((room - CLEAR) / SLOWS_WITHIN).clamp(0.0, 1.0)
            }
            _ => 1.0,
        });
        DVector::from_iterator(q.len(), each)
    }

    /// Moves the arm with its tool at rest as long as that makes what is wished for less.
    fn drawn(&self, mut q: Vec<f64>, wish: &dyn Fn(&[f64]) -> DVector<f64>) -> Vec<f64> {
        let mut wished = wish(&q);
        let mut share = 1.0_f64;
        for _ in 0..DRAWS {
            let Some(step) = self.step(&q, &Vector6::zeros(), &wished) else {
                break;
            };
            let longest = step.amax();
            if longest <= LEAST_DRAW {
                break;
            }
            let scale = share.min(LONGEST_DRAW / longest);
            let moved = q.iter().zip(step.iter()).map(|(q, by)| q + by * scale);
            let trial = self.reached(moved.collect());
            let better = trial.map(|trial| (wish(&trial), trial));
            match better.filter(|(left, _)| left.norm() < wished.norm()) {
                Some((left, trial)) => {
                    (wished, q) = (left, trial);
                    share = (2.0 * share).min(1.0);
                }
                None if share < LEAST_SHARE => break,
                None => share *= 0.5,
            }
        }
        q
    }
}

impl IkSolver<'_> {
    /// Postures within limits that put `frame` at a pose, in the order of their travel from another
    /// posture, a few. Of an arm with joints to spare each lies as near to that as it comes with
    /// its tool at rest.
    #[must_use]
    pub fn starts_near(
        &self,
        world_from_target: &Isometry3<f64>,
        frame: FrameId,
        to: &[f64],
    ) -> Vec<Vec<f64>> {
        let mut found = self.within_limits(world_from_target, frame);
        if self.robot().has_joints_to_spare() {
            let led = self.led_to(world_from_target, frame, to);
            found.extend(led.filter(|q| self.robot().check_posture(q).is_ok()));
        }
        let mut drawn = self.drawn_near(world_from_target, frame, found, to);
        drawn.truncate(DRAWN);
        drawn
    }

    /// Where the search goes that begins in a posture, its limits not asked.
    pub(crate) fn led_to(
        &self,
        world_from_target: &Isometry3<f64>,
        frame: FrameId,
        from: &[f64],
    ) -> Option<Vec<f64>> {
        let numeric = &self.options().numeric;
        let found = (self.unlimited()).inverse_kinematics(world_from_target, frame, from, numeric);
        let middle = |q: &[f64]| -> Vec<f64> {
            let joints = self.robot().chain.joints.iter().zip(q);
            joints
                .map(|(joint, q)| nearest_turn(joint.kind, joint.limits, *q))
                .collect()
        };
        found.ok().map(|q| match self.robot().check_posture(&q) {
            Ok(()) => q,
            Err(_) => middle(&q),
        })
    }

    /// Postures within limits by their travel from another one; of an arm with joints to spare the
    /// nearest are drawn towards it with the tool at rest.
    pub(crate) fn drawn_near(
        &self,
        world_from_target: &Isometry3<f64>,
        frame: FrameId,
        mut postures: Vec<Vec<f64>>,
        to: &[f64],
    ) -> Vec<Vec<f64>> {
        let by_travel = |a: &Vec<f64>, b: &Vec<f64>| travel(a, to).total_cmp(&travel(b, to));
        postures.sort_by(by_travel);
        if !self.robot().has_joints_to_spare() {
            return postures;
        }
        postures.truncate(DRAWN);
        let motion = SelfMotion {
            robot: self.robot(),
            frame,
            world_from_target,
            keeps_limits: true,
        };
        let wish =
            |q: &[f64]| DVector::from_iterator(q.len(), to.iter().zip(q).map(|(to, q)| to - q));
        let mut drawn: Vec<Vec<f64>> = Vec::new();
        for posture in postures {
            let found = motion.drawn(posture.clone(), &wish);
            // A joint that is beyond its slowing room already may end beyond its limit.
            let found = match self.robot().check_posture(&found) {
                Ok(()) => found,
                Err(_) => posture,
            };
            let is_known = |known: &Vec<f64>| {
                let mut apart = known.iter().zip(&found).map(|(a, b)| (a - b).abs());
                apart.all(|apart| apart < SAME)
            };
            if !drawn.iter().any(is_known) {
                drawn.push(found);
            }
        }
        drawn.sort_by(by_travel);
        drawn
    }

    /// Of postures beyond limits those that the arm brings within with its tool at rest.
    pub(crate) fn brought_within(
        &self,
        world_from_target: &Isometry3<f64>,
        frame: FrameId,
        postures: &[Vec<f64>],
    ) -> Vec<Vec<f64>> {
        if !self.robot().has_joints_to_spare() {
            return Vec::new();
        }
        let joints = &self.robot().chain.joints;
        let motion = SelfMotion {
            robot: self.robot(),
            frame,
            world_from_target,
            keeps_limits: false,
        };
        let wish = |q: &[f64]| {
            let each = joints.iter().zip(q);
            DVector::from_iterator(q.len(), each.map(|(joint, &q)| into(joint.limits, q)))
        };
        let turned = |q: &Vec<f64>| -> Vec<f64> {
            let each = joints.iter().zip(q);
            each.map(|(joint, q)| nearest_turn(joint.kind, joint.limits, *q))
                .collect()
        };
        let mut nearest: Vec<(f64, Vec<f64>)> = (postures.iter().map(turned))
            .map(|q| (wish(&q).norm(), q))
            .collect();
        nearest.sort_by(|a, b| a.0.total_cmp(&b.0));
        nearest.truncate(DRAWN);
        let brought = nearest.into_iter().map(|(_, q)| motion.drawn(q, &wish));
        brought
            .filter(|q| self.robot().check_posture(q).is_ok())
            .collect()
    }
}

/// How far a coordinate is from its limits, with what joints keep from them; zero within.
fn into(limits: Option<Limits>, q: f64) -> f64 {
    let Some(limits) = limits else { return 0.0 };
    let (low, high) = (limits.lower + CLEAR, limits.upper - CLEAR);
    if low > high {
        return 0.5 * (limits.lower + limits.upper) - q;
    }
    q.clamp(low, high) - q
}

/// The coordinate turned as near to the middle of its range as whole turns bring it.
fn nearest_turn(kind: JointKind, limits: Option<Limits>, q: f64) -> f64 {
    let middle = limits.map_or(0.0, |l| 0.5 * (l.lower + l.upper));
    match kind {
        JointKind::Revolute if middle.is_finite() => middle + wrap(q - middle),
        _ => q,
    }
}
