//! Drive forces that a planned motion asks for, whatever is measured of it.

use super::motion::Motion;
use super::rigid::forces;
use crate::build::{NO_FOLLOWERS, gravity_m_s2, load_robot};
use crate::effect::{Effects, build_in};
use crate::error::SimError;
use nalgebra::Vector3;
use std::sync::Arc;
use truecut_arm::Robot;
use truecut_plan::motion::excitation::{JointRange, SampledMotion};
use truecut_recording::filter::Butterworth;
use truecut_scenario::Scenario;

/// The rigid arm of a scenario, with its rotors, the dry friction of robot.toml, a payload and the
/// effects on its joints.
pub struct PlannedArm {
    robot: Arc<Robot>,
    effects: Effects,
    gravity_m_s2: Vector3<f64>,
}

impl PlannedArm {
    /// The arm of a scenario.
    ///
    /// # Errors
    /// A robot that cannot be loaded, or whose joints take others along.
    pub fn new(scenario: &Scenario) -> Result<PlannedArm, SimError> {
        let mut robot = load_robot(&scenario.robot)?;
        robot.refuse_followers(NO_FOLLOWERS)?;
        let effects = Effects::sum(scenario.effects.iter(), &robot.chain.joints);
        build_in(&mut robot, &effects)?;
        Ok(PlannedArm {
            gravity_m_s2: effects.gravity_on_base(gravity_m_s2(&scenario.robot)),
            robot: Arc::new(robot),
            effects,
        })
    }

    /// The robot.
    pub fn robot(&self) -> &Robot {
        &self.robot
    }

    /// Name of a joint and unit of its coordinate.
    ///
    /// # Panics
    /// If there is no such joint.
    pub fn joint(&self, joint: usize) -> (&str, &'static str) {
        let joint = &self.robot.chain.joints[joint];
        (&joint.name, joint.kind.coordinate_unit())
    }

    /// What the robot's files say that a joint may do, and its drive: the tighter of URDF and
    /// servo. Infinite where they do not say it.
    ///
    /// # Panics
    /// If there is no such joint.
    pub fn bounds(&self, joint: usize) -> (JointRange, f64) {
        let joint = &self.robot.chain.joints[joint];
        let infinite = f64::INFINITY;
        let servo = joint.transmission.servo;
        let range = joint.limits.map_or([-infinite, infinite, infinite], |l| {
            [l.lower, l.upper, l.velocity]
        });
        let effort = joint.limits.map_or(infinite, |limits| limits.effort);
        let range = JointRange {
            lower: range[0],
            upper: range[1],
            speed: range[2],
            acceleration: infinite,
        };
        (
            range,
            effort.min(servo.map_or(infinite, |servo| servo.torque_limit)),
        )
    }

    /// Torques (forces) of all drives along a motion, `[joint][sample]`.
    pub fn drive_forces(&self, motion: &SampledMotion) -> Vec<Vec<f64>> {
        let states = Motion::of(motion, self.gravity_m_s2);
        let joints: Vec<usize> = (0..self.robot.dof()).collect();
        // Nothing is filtered: the cutoff is beyond half the rate.
        let unfiltered = Butterworth::low_pass(1, 1.0, 1.0);
        let rigid = forces(
            &self.robot,
            &states,
            &self.gravity_m_s2,
            &joints,
            &unfiltered,
        );
        let mut drive = rigid.drive;
        for (joint, column) in drive.iter_mut().enumerate() {
            let effects = &self.effects.joints[joint];
            if !effects.is_built_in() {
                let instants = motion.position[joint].iter().zip(&motion.velocity[joint]);
                for (force, (q, v)) in column.iter_mut().zip(instants) {
                    *force += effects.against(*q, *v);
                }
            }
        }
        drive
    }
}
