//! The arm as a linear system about a posture, stepped exactly.
//!
//! `M x'' + D x' = r`, `x = q - q₀`, with the transmissions' stiffness and the gravity stiffness in
//! `r`:
//!
//! `r = torque of the drives - g₀ - G x + Jᵀ w`.
//!
//! The drives' torque is taken as the [`Drive`] gives it, nonlinear parts included; only its linear
//! part enters the [`Recurrence`], which is exact for it. `M`, `J` and the gravity stiffness `G`
//! are those of the posture `q₀`, poses are of first order in `x`. That is what an arm does that
//! vibrates about one posture (0.5 mm at 2 m reach: 0.06 µm of second order).
//!
//! The recurrence sees the arm from axes that move on with the motors' velocity of the instant, so
//! that a steady feed, too, is met exactly.
//!
//! The recurrence holds `r` over the steps before and after an instant; what is not constant over
//! them enters with its mean under their hat. A motor on a curved path adds `K θ'' dt²/12`,
//! processes are [`Smoothed`], the kinks of [`Play`] are averaged along the wind-up's path.
//!
//! An arm that *travels* (a commanded path, free revolute joints, or a swing under given forces
//! with nothing in contact) has poses, Jacobians and velocity products computed anew in every step;
//! mass and recurrence are renewed when a revolute joint has turned by [`RENEWAL_RAD`]. In between,
//! `(M(q) - M) a` is one torque more, with the acceleration `a` [`Foreseen`] from the two instants
//! before: a correction of a percent or two of the torque, and itself good to a percent or so.

mod frames;

use super::foreseen::Foreseen;
use super::linear::{Arm, Linear};
use super::play::Play;
use super::recurrence::add_product;
use super::smoothed::Smoothed;
use super::{Command, Drive, FrameState, JointState, Plant, WorldWrench};
use crate::engine::StepsPerPeriod;
use crate::loads::Attachment;
use nalgebra::{DVector, Isometry3, Vector3};
use std::sync::Arc;
use truecut_arm::{FrameId, JointKind, Robot};
use truecut_scenario::DriveKind;

/// A travelling arm is linearised anew when one of its revolute joints has turned so far, rad.
pub const RENEWAL_RAD: f64 = 2e-2;

/// The arm, linearised.
pub struct ReducedPlant {
    arm: Arm,
    drive: Drive,
    travels: bool,
    linear: Linear,
    joints: JointState,
    last_from_tool: Isometry3<f64>,
    last_from_foot: Isometry3<f64>,
    tool: FrameState,
    foot: FrameState,
    /// Mean velocities over the step ahead (after `finish`) and over the step before.
    mean: DVector<f64>,
    /// All torques at this instant but the damping between link and motor: `r`, seen from the
    /// carried axes.
    force: DVector<f64>,
    /// Velocities of the motors at this instant, with which the recurrence's axes are carried
    /// along.
    carried: DVector<f64>,
    /// With which the mass at hand is told from that of the linearisation.
    acceleration: Foreseen,
    /// Coordinates of the motors at this instant and before, where a command moves them.
    motors: Smoothed,
    /// Joints whose motors follow a moving command, with their stiffness.
    prescribed: Vec<(usize, f64)>,
    plays: Vec<Play>,
    /// Distance from the posture of the linearisation.
    shift: DVector<f64>,
    /// Torques of the process at this instant and before.
    process: Smoothed,
    bias: DVector<f64>,
    free: DVector<f64>,
    free_is_known: bool,
    velocity: DVector<f64>,
    predicted: DVector<f64>,
    momentum: DVector<f64>,
    scratch: DVector<f64>,
    explicit: Vec<f64>,
    started: bool,
}

impl ReducedPlant {
    /// The arm at rest at posture `q`, with its drives. `path` says that the command moves. `None`
    /// if the arm's mass matrix is singular, or the step a whole number of half periods of one of
    /// its modes.
    pub fn new(
        robot: Arc<Robot>,
        q: &[f64],
        command: &[f64],
        (kind, drive): (DriveKind, Drive),
        gravity_m_s2: Vector3<f64>,
        dt_s: f64,
        path: bool,
    ) -> Option<Self> {
        let n = robot.dof();
        let turns = (robot.chain.joints.iter()).any(|j| j.kind == JointKind::Revolute);
        let springs = kind != DriveKind::Force;
        let mut arm = Arm::new(robot, &drive, springs, gravity_m_s2, dt_s);
        let linear = arm.about(q)?;
        let zeros = DVector::zeros(n);
        Some(Self {
            last_from_tool: arm.robot.last_link_from_frame(FrameId::Tool),
            last_from_foot: arm.robot.last_link_from_frame(FrameId::Foot),
            travels: turns && (path || !springs),
            tool: linear.tool.clone(),
            foot: linear.foot.clone(),
            joints: JointState::at_rest(q, command),
            mean: zeros.clone(),
            force: zeros.clone(),
            carried: zeros.clone(),
            acceleration: Foreseen::new(n),
            motors: Smoothed::new(n),
            prescribed: if path { drive.prescribed() } else { Vec::new() },
            plays: drive.with_play(),
            shift: zeros.clone(),
            bias: linear.gravity_torque.clone(),
            free: zeros.clone(),
            velocity: zeros.clone(),
            predicted: zeros.clone(),
            momentum: zeros.clone(),
            process: Smoothed::new(n),
            scratch: zeros,
            explicit: vec![0.0; n],
            free_is_known: false,
            started: false,
            arm,
            drive,
            linear,
        })
    }

    /// The same arm with its joints moving at the start.
    pub(crate) fn moving(mut self, velocity: &[f64]) -> Self {
        self.joints.velocity.copy_from_slice(velocity);
        self.drive.start_at(velocity);
        self
    }

    /// The same arm, exact for swings of any size if it `swings`: to first order about its start,
    /// the end of the swing, 3 mm of a free decay are off by up to 4 %. Joints that only slide have
    /// nothing of higher order.
    pub(crate) fn swinging(mut self, swings: bool) -> Self {
        let joints = &self.arm.robot.chain.joints;
        self.travels |= swings && joints.iter().any(|j| j.kind == JointKind::Revolute);
        self
    }

    /// What a header says of this plant.
    pub(crate) fn note(&self, steps: StepsPerPeriod) -> String {
        let about = if self.travels {
            let renewal = RENEWAL_RAD * 1e3;
            format!("linearised along its path, every {renewal:.0} mrad")
        } else {
            "linearised about its start".to_string()
        };
        let (without_play, with_play) = (steps.without_play, steps.with_play);
        format!(
            "time step {:.6} ms, exact for the arm {about}: at most 0.8 ms, 1/{without_play} of the fastest mode's \
             period with contact springs and rotors (1/{with_play} with play, 1/5 of a mode of the base), 1/40 of the \
             tooth period and of the fastest given force's, unless run.time_step_ms sets it",
            self.time_step_s() * 1e3
        )
    }

    /// Torques of gravity and, for a travelling arm, of velocity products and of what its mass
    /// differs by from that of the linearisation, under the acceleration foreseen.
    fn update_bias(&mut self) {
        if self.travels {
            let acceleration = self.acceleration.acceleration();
            self.arm.dynamics.inverse_dynamics_into(
                &self.joints.position,
                &self.joints.velocity,
                acceleration.as_slice(),
                &self.arm.gravity_m_s2,
                self.bias.as_mut_slice(),
            );
            self.momentum.fill(0.0);
            add_product(&self.linear.mass, acceleration, &mut self.momentum);
            self.bias -= &self.momentum;
        } else {
            self.bias.copy_from(&self.linear.gravity_torque);
            add_product(&self.linear.gravity_stiffness, &self.shift, &mut self.bias);
        }
    }

    /// Torques of joints with play, from their values at the instant to their means about it.
    fn meet_flanks(&mut self) {
        let dt_s = self.linear.recurrence.step_s();
        let mut plays = std::mem::take(&mut self.plays);
        for play in &mut plays {
            let i = play.joint;
            let now = self.joints.motion(i);
            let windup = self.drive.joint(i).windup(&now);
            let rate = self.drive.joint(i).rate(&now);
            self.free_velocity();
            let ahead = windup
                + dt_s * (rate + now.velocity - self.free[i])
                + 0.5 * self.motors.curvature(i);
            let drive = self.drive.joint(i);
            let correction = play.correction(drive, (windup, rate), ahead, dt_s);
            if correction != 0.0 {
                self.force[i] += correction;
                self.free_is_known = false;
            }
            play.pass(windup);
        }
        self.plays = plays;
    }

    fn add_wrenches(&self, wrenches: &[WorldWrench], torque: &mut DVector<f64>) {
        for (attachment, wrench) in wrenches {
            let jacobian = &self.frame(*attachment).jacobian;
            for (t, column) in torque.iter_mut().zip(jacobian.column_iter()) {
                *t += column.dot(wrench);
            }
        }
    }

    /// Sets both mean velocities about the start, at which the arm has its first velocity under
    /// `force`.
    fn start(&mut self) {
        let recurrence = &self.linear.recurrence;
        self.scratch.copy_from_slice(&self.joints.velocity);
        self.scratch -= &self.carried;
        recurrence.before_start(&self.scratch, &self.force, &mut self.mean);
        self.mean += &self.carried;
        self.free_is_known = false;
        self.free_velocity();
        self.started = true;
    }
}

impl Plant for ReducedPlant {
    fn dof(&self) -> usize {
        self.joints.position.len()
    }

    fn time_step_s(&self) -> f64 {
        self.linear.recurrence.step_s()
    }

    fn joints(&self) -> &JointState {
        &self.joints
    }

    fn frame(&self, attachment: Attachment) -> &FrameState {
        match attachment {
            Attachment::Tool => &self.tool,
            Attachment::Foot => &self.foot,
        }
    }

    fn begin(&mut self, command: Command<'_>, wrenches: &[WorldWrench]) {
        self.drive
            .evaluate(command, &mut self.joints, &mut self.explicit);
        let mut force = std::mem::replace(&mut self.force, DVector::zeros(0));
        for i in 0..force.len() {
            let carried = self.joints.motor_velocity[i];
            self.carried[i] = carried;
            force[i] =
                self.explicit[i] - self.drive.damping_without_play(i) * carried - self.bias[i];
        }
        if !self.prescribed.is_empty() {
            self.motors.advance();
            self.motors.now().copy_from_slice(&self.joints.motor);
        }
        for (i, stiffness) in &self.prescribed {
            force[*i] += stiffness * self.motors.curvature(*i) / 12.0;
        }
        for play in &self.plays {
            // The drive's torque has this damping in it already.
            let i = play.joint;
            force[i] += self.drive.joint(i).damping() * self.joints.velocity[i];
        }
        self.process.advance();
        let mut now = std::mem::replace(self.process.now(), DVector::zeros(0));
        self.add_wrenches(wrenches, &mut now);
        *self.process.now() = now;
        self.process.add_to(&mut force);
        self.force = force;
        self.free_is_known = false;
        if self.started && !self.plays.is_empty() {
            self.meet_flanks();
        }
    }

    fn half_step_velocity(&self) -> &DVector<f64> {
        &self.mean
    }

    fn free_velocity(&mut self) -> &DVector<f64> {
        if !self.free_is_known {
            let recurrence = &self.linear.recurrence;
            self.scratch.copy_from(&self.mean);
            self.scratch -= &self.carried;
            recurrence.mean_velocity(&self.scratch, &self.force, &mut self.free);
            self.free += &self.carried;
            self.free_is_known = true;
        }
        &self.free
    }

    fn mobility(&mut self, impulse: &DVector<f64>) -> DVector<f64> {
        self.linear.recurrence.response(impulse)
    }

    fn is_linear(&self) -> bool {
        !self.travels
    }

    fn finish(&mut self, contacts: &[WorldWrench], joint_torques: &DVector<f64>) {
        self.free_velocity();
        let mut added = std::mem::replace(&mut self.scratch, DVector::zeros(0));
        added.copy_from(joint_torques);
        self.add_wrenches(contacts, &mut added);
        self.force += &added;
        if self.started {
            self.linear.recurrence.add_force(&added, &mut self.free);
            self.scratch = added;
        } else {
            self.scratch = added;
            self.start();
        }
        // From here on `mean` is of the step ahead.
        std::mem::swap(&mut self.mean, &mut self.free);
        let recurrence = &self.linear.recurrence;
        self.scratch.copy_from(&self.mean);
        self.scratch -= &self.carried;
        recurrence.velocity(&self.scratch, &self.force, &mut self.velocity);
        for (i, velocity) in self.joints.velocity.iter_mut().enumerate() {
            *velocity = self.velocity[i] + self.carried[i];
        }
        self.drive.advance(&mut self.joints);
        for i in 0..self.joints.transmission.len() {
            self.joints.transmission[i] = self.drive.transmission(i, &self.joints);
            self.joints.drive[i] = self.drive.drive_force(i, &self.joints);
        }
    }

    fn drift(&mut self) {
        self.drift_unseen();
        self.update_frames();
    }

    fn drift_unseen(&mut self) {
        let recurrence = &self.linear.recurrence;
        recurrence.next_velocity(&self.velocity, &self.force, &mut self.predicted);
        let dt_s = recurrence.step_s();
        for (q, u) in self.joints.position.iter_mut().zip(self.mean.iter()) {
            *q += u * dt_s;
        }
        for (i, velocity) in self.joints.velocity.iter_mut().enumerate() {
            *velocity = self.predicted[i] + self.carried[i];
        }
        self.drive.drift(&mut self.joints);
        if self.travels {
            // `free` is the mean velocity of the step before.
            self.acceleration.follow(&self.mean, &self.free, dt_s);
            self.renew();
        }
        self.shift.copy_from_slice(&self.joints.position);
        self.shift -= &self.linear.posture;
        self.update_bias();
    }

    fn energy_j(&mut self) -> (f64, f64) {
        let (elastic, rotors) = self.drive.energy_j(&self.joints);
        let (q, v) = (&self.joints.position, &self.joints.velocity);
        if self.travels {
            let energy = self.arm.dynamics.energy(q, v, &self.arm.gravity_m_s2);
            return (energy.kinetic_j + rotors, energy.potential_j + elastic);
        }
        let velocity = &mut self.scratch;
        velocity.copy_from_slice(v);
        self.momentum.fill(0.0);
        add_product(&self.linear.mass, velocity, &mut self.momentum);
        let kinetic = 0.5 * self.momentum.dot(velocity);
        // Between posture and shift the torque of gravity has grown linearly.
        let work = self.linear.gravity_torque.dot(&self.shift) + self.bias.dot(&self.shift);
        let potential = self.linear.gravity_j + 0.5 * work;
        (kinetic + rotors, potential + elastic)
    }

    fn drive_power_w(&self) -> f64 {
        self.drive.power_w(&self.joints)
    }

    fn dissipation_w(&self) -> f64 {
        self.drive.dissipation_w(&self.joints)
    }

    fn link_poses(&self) -> Vec<Isometry3<f64>> {
        self.arm.robot.world_from_links(&self.joints.position)
    }
}
