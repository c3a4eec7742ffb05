//! Drive forces of the rigid arm along a measured motion, without effects.

use super::motion::Motion;
use nalgebra::Vector3;
use std::sync::Arc;
use truecut_arm::{Dynamics, Robot};
use truecut_core::joint_law::LinkFriction;
use truecut_recording::filter::Butterworth;

/// Forces (torques) without effects, one column per predicted joint; see
/// [`InverseModel::nominal_for`](crate::InverseModel::nominal_for).
#[derive(Debug, Clone)]
pub struct Forces {
    /// The arm that they are of.
    pub(super) robot: Arc<Robot>,
    /// Of the drives, filtered.
    pub(super) drive: Vec<Vec<f64>>,
    /// What the transmissions pass on to the links, without a filter.
    pub(super) passed_on: Vec<Vec<f64>>,
}

/// Rigid arm, rotors and the dry friction of robot.toml, filtered: `[joint][sample]`.
pub(super) fn nominal(
    robot: &Arc<Robot>,
    motion: &Motion,
    joints: &[usize],
    filter: &Butterworth,
) -> Forces {
    forces(robot, motion, &motion.gravity_m_s2, joints, filter)
}

/// The same under another gravity.
pub(super) fn forces(
    robot: &Arc<Robot>,
    motion: &Motion,
    gravity_m_s2: &Vector3<f64>,
    joints: &[usize],
    filter: &Butterworth,
) -> Forces {
    let mut passed_on = motion.inverse_dynamics(&mut Dynamics::new(robot), gravity_m_s2, joints);
    for (column, &joint) in passed_on.iter_mut().zip(joints) {
        let transmission = &robot.chain.joints[joint].transmission;
        let friction = LinkFriction::coulomb(transmission.dry_friction);
        for (sum, v) in column.iter_mut().zip(&motion.velocity[joint]) {
            *sum += friction.force(*v);
        }
    }
    let drive = with_rotors(robot, motion, joints, filter, &passed_on);
    Forces {
        robot: Arc::clone(robot),
        drive,
        passed_on,
    }
}

/// Drive forces of links and rotors alone, filtered, `[joint][sample]`: no friction, which is
/// another law at each side of standstill.
pub(super) fn without_friction(
    robot: &Robot,
    motion: &Motion,
    joints: &[usize],
    filter: &Butterworth,
) -> Vec<Vec<f64>> {
    let dynamics = &mut Dynamics::new(robot);
    let passed_on = motion.inverse_dynamics(dynamics, &motion.gravity_m_s2, joints);
    with_rotors(robot, motion, joints, filter, &passed_on)
}

/// What drives give for what transmissions pass on, filtered.
fn with_rotors(
    robot: &Robot,
    motion: &Motion,
    joints: &[usize],
    filter: &Butterworth,
    passed_on: &[Vec<f64>],
) -> Vec<Vec<f64>> {
    let columns = passed_on.iter().zip(joints);
    let drive = columns.map(|(column, &joint)| {
        let inertia = robot.chain.joints[joint].transmission.rotor_inertia;
        let pairs = column.iter().zip(&motion.acceleration[joint]);
        let sum: Vec<f64> = pairs
            .map(|(passed_on, a)| passed_on + inertia * a)
            .collect();
        filter.zero_phase(&sum)
    });
    drive.collect()
}
