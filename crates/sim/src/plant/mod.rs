//! Plants: what the loads act on.
//!
//! A plant is stepped in parts, so that contacts can be solved between the smooth motion and the
//! step: [`Plant::begin`] gathers all that is known, [`Plant::free_velocity`] predicts the velocity
//! that the plant would have without further impulses, [`Plant::mobility`] says what an impulse
//! would change, [`Plant::finish`] applies the contacts' impulses and steps the velocities,
//! [`Plant::drift`] the positions.

mod drive;
mod foreseen;
mod law;
mod linear;
mod play;
mod rapier;
mod recurrence;
mod reduced;
mod smoothed;
mod world;

pub use drive::Drive;
pub use rapier::RapierPlant;
pub use reduced::{RENEWAL_RAD, ReducedPlant};
pub use truecut_core::joint_law::JointLaw;

use crate::loads::Attachment;
use nalgebra::{DVector, Isometry3, Matrix6xX, Vector3, Vector6};

/// Kinematics of one frame of the robot, world axes.
#[derive(Debug, Clone)]
pub struct FrameState {
    pub world_from_frame: Isometry3<f64>,
    /// Linear (0..3) and angular (3..6) rows.
    pub jacobian: Matrix6xX<f64>,
}

/// What joint rates add up to in three rows of a Jacobian, from `row` on. Matrices this small are
/// read as they lie: views of them would cost more than the sums.
pub(crate) fn combined(jacobian: &Matrix6xX<f64>, row: usize, rates: &[f64]) -> Vector3<f64> {
    let (columns, _) = jacobian.as_slice().as_chunks::<6>();
    let mut sum = Vector3::zeros();
    for (column, rate) in columns.iter().zip(rates) {
        for i in 0..3 {
            sum[i] += column[row + i] * rate;
        }
    }
    sum
}

/// Positions, velocities and forces of all joints at one instant.
#[derive(Debug, Clone)]
pub struct JointState {
    /// Link coordinates, rad or m.
    pub position: Vec<f64>,
    /// Link velocities, rad/s or m/s.
    pub velocity: Vec<f64>,
    /// Motor coordinates, rad or m, on the joint side of the gear.
    pub motor: Vec<f64>,
    /// Motor velocities.
    pub motor_velocity: Vec<f64>,
    /// Commanded coordinates.
    pub command: Vec<f64>,
    /// Torque (force) of the transmission on the link, N m or N.
    pub transmission: Vec<f64>,
    /// Torque (force) of the drive: on the rotor (servo), else on the link, N m or N.
    pub drive: Vec<f64>,
}

impl JointState {
    pub(crate) fn at_rest(position: &[f64], command: &[f64]) -> Self {
        let zeros = vec![0.0; position.len()];
        Self {
            position: position.to_vec(),
            velocity: zeros.clone(),
            motor: command.to_vec(),
            motor_velocity: zeros.clone(),
            command: command.to_vec(),
            transmission: zeros.clone(),
            drive: zeros,
        }
    }

    fn motion(&self, joint: usize) -> law::JointMotion {
        law::JointMotion {
            motor: self.motor[joint],
            motor_velocity: self.motor_velocity[joint],
            position: self.position[joint],
            velocity: self.velocity[joint],
        }
    }
}

/// Command of every joint at one time.
#[derive(Debug, Clone, Copy)]
pub struct Command<'a> {
    /// rad or m.
    pub position: &'a [f64],
    /// rad/s or m/s.
    pub velocity: &'a [f64],
    /// Given torque or force of each drive, N m or N; zero unless the drives are force drives.
    pub force: &'a [f64],
}

/// A force and moment on a frame, in world axes: (N, N m).
pub type WorldWrench = (Attachment, Vector6<f64>);

/// A mechanical system that can be stepped under loads.
///
/// Times are those of the leapfrog scheme: positions live at whole steps, velocities at half steps.
/// The velocity of a [`JointState`] belongs to the same instant as its position: extrapolated
/// (`3/2 v⁻ - 1/2 v⁻⁻`) before the step, the mean of both half steps after it.
pub trait Plant: Send {
    /// Number of joints.
    fn dof(&self) -> usize;

    /// Time step, s.
    fn time_step_s(&self) -> f64;

    /// Joint state at the instant of the step.
    fn joints(&self) -> &JointState;

    /// Kinematics at the instant of the step.
    fn frame(&self, attachment: Attachment) -> &FrameState;

    /// Starts a step: drives and smooth loads are gathered.
    fn begin(&mut self, command: Command<'_>, wrenches: &[WorldWrench]);

    /// Joint velocities half a step before the instant: those that the step starts from.
    fn half_step_velocity(&self) -> &DVector<f64>;

    /// Joint velocities that the step would end with, if no impulse were added.
    fn free_velocity(&mut self) -> &DVector<f64>;

    /// `M⁻¹ g` for a generalised impulse `g`, with `M` the mass that the step sees.
    fn mobility(&mut self, impulse: &DVector<f64>) -> DVector<f64>;

    /// Whether Jacobians of the frames and [`Plant::mobility`] are the same in every step.
    fn is_linear(&self) -> bool {
        false
    }

    /// Adds contact wrenches (averages over the step) and joint torques, and steps the velocities.
    /// The joint state still belongs to the instant of the step, its velocity now being the mean of
    /// both half steps.
    fn finish(&mut self, contacts: &[WorldWrench], joint_torques: &DVector<f64>);

    /// Moves positions, frames and velocities to the next instant.
    fn drift(&mut self);

    /// The same where no one looks at a frame at the next instant: they may stay behind.
    fn drift_unseen(&mut self) {
        self.drift();
    }

    /// Kinetic energy, and potential energy of gravity and transmissions, J, at the last instant.
    fn energy_j(&mut self) -> (f64, f64);

    /// Power of the drives at the last instant, W: what the moving command feeds in.
    fn drive_power_w(&self) -> f64;

    /// Torque (force) that the drive of a joint exerts at the last instant, N m or N: where the
    /// motor follows its command exactly, what the transmission asks for.
    fn drive_torque(&self, joint: usize) -> f64 {
        self.joints().transmission[joint]
    }

    /// Power lost in the transmissions and in viscous friction at the last instant, W. Negative
    /// only while a hysteresis gives back what it stores.
    fn dissipation_w(&self) -> f64;

    /// Poses of all links, base first.
    fn link_poses(&self) -> Vec<Isometry3<f64>>;
}
