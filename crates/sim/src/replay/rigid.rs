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
    let mut drive = Vec::with_capacity(joints.len());
    for (column, &joint) in passed_on.iter_mut().zip(joints) {
        let transmission = &robot.chain.joints[joint].transmission;
        let friction = LinkFriction::coulomb(transmission.dry_friction);
        for (sum, v) in column.iter_mut().zip(&motion.velocity[joint]) {
            *sum += friction.force(*v);
        }
        let with_rotor = column.iter().zip(&motion.acceleration[joint]);
        let with_rotor: Vec<f64> = with_rotor
            .map(|(passed_on, a)| passed_on + transmission.rotor_inertia * a)
            .collect();
        drive.push(filter.zero_phase(&with_rotor));
    }
    Forces {
        robot: Arc::clone(robot),
        drive,
        passed_on,
    }
}
