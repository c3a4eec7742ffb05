//! Joint drives: command, motor coordinate, transmission.
//!
//! A joint is a motor coordinate θ, a transmission (stiffness K, damping D) and the link coordinate
//! q. The torque on the link is `K (θ - q) + D (θ' - q')`, and what the effects make of it
//! ([`JointLaw`]). The damping of the link's own velocity is *not* in the explicit torque: the
//! plant takes half of it implicitly.

use super::law::{JointDrive, JointMotion};
use super::play::Play;
use super::{Command, JointLaw, JointState};
use nalgebra::DMatrix;
use truecut_arm::Robot;
use truecut_scenario::DriveKind;

/// The drives of all joints.
///
/// A servo is P–P and turns a rotor:
/// `M_r θ'' = sat(k_v (k_p (c - θ) + f c' - θ')) - τ_transmission`. Where the transmission is rigid
/// it acts on the link, `sat(k_v (k_p (c - q) + f c' - q'))`: a spring `k_v k_p` to the command and
/// a damper `k_v`, which the plant takes half implicitly like any other.
#[derive(Debug, Clone)]
pub struct Drive {
    kind: DriveKind,
    joints: Vec<JointDrive>,
    /// Velocity of the command at this instant.
    command_velocity: Vec<f64>,
    /// Motor velocities at the last two half steps (servo only).
    half: Vec<f64>,
    half_before: Vec<f64>,
    /// Whether the velocities stand at half steps: until the first step they are those of t = 0.
    started: bool,
    dt_s: f64,
    /// Torque that the static load of the start asks of the motor, fed forward by the servo.
    feed_forward: Vec<f64>,
    /// Damping between all motors and links, in place of the transmissions' own: n×n.
    coupled: Option<DMatrix<f64>>,
}

impl Drive {
    /// Drives of `robot`, with the laws of its joints; every joint must have what the kind needs
    /// (checked when the cell is built). The first `base_joints` have no motor: they are springs to
    /// the ground.
    pub fn new(
        kind: DriveKind,
        robot: &Robot,
        base_joints: usize,
        laws: &[JointLaw],
        dt_s: f64,
    ) -> Self {
        let joints: Vec<_> = (robot.chain.joints.iter().zip(laws).enumerate())
            .map(|(i, (joint, law))| {
                let kind = if i < base_joints {
                    DriveKind::Position
                } else {
                    kind
                };
                JointDrive::new(kind, &joint.transmission, law.clone())
            })
            .collect();
        let zeros = vec![0.0; joints.len()];
        Self {
            kind,
            joints,
            command_velocity: zeros.clone(),
            half: zeros.clone(),
            half_before: zeros.clone(),
            started: false,
            dt_s,
            feed_forward: zeros,
            coupled: None,
        }
    }

    /// The same with the servos feeding forward what holds motors at `command` and links at `start`
    /// at rest: a servo carries the static load of the start, and its loops see only what changes.
    pub fn holding(mut self, command: &[f64], start: &[f64]) -> Self {
        for (i, joint) in self.joints.iter().enumerate() {
            let at = JointMotion {
                motor: command[i],
                motor_velocity: 0.0,
                position: start[i],
                velocity: 0.0,
            };
            self.feed_forward[i] = joint.law.gear(command[i]) * joint.static_torque(&at);
        }
        self
    }

    /// The same with a damping matrix D on what the links move against their motors, torque
    /// −D (q' − θ'); for motors that follow their commands.
    pub fn with_coupled_damping(mut self, damping: Option<DMatrix<f64>>) -> Self {
        self.coupled = damping;
        self
    }

    /// That matrix.
    pub(super) fn coupled_damping(&self) -> Option<&DMatrix<f64>> {
        self.coupled.as_ref()
    }

    /// What it exerts on a link at this instant.
    pub(super) fn coupled_torque(&self, joint: usize, state: &JointState) -> f64 {
        let Some(damping) = &self.coupled else {
            return 0.0;
        };
        let against = state.motor_velocity.iter().zip(&state.velocity);
        let row = damping.row(joint);
        let torques = row.iter().zip(against);
        torques.map(|(d, (motor, link))| d * (motor - link)).sum()
    }

    /// Motors move with their links at the start.
    pub fn start_at(&mut self, velocity: &[f64]) {
        self.half.copy_from_slice(velocity);
        self.half_before.copy_from_slice(velocity);
    }

    /// Damping of a joint's link velocity that the plant takes half implicitly, N m s/rad or N s/m.
    pub fn damping(&self, joint: usize) -> f64 {
        self.joints[joint].constant_damping()
    }

    /// The same of a plant that takes play as a torque beside spring and damper ([`super::play`]).
    pub(super) fn damping_without_play(&self, joint: usize) -> f64 {
        let drive = &self.joints[joint];
        if drive.has_play() {
            drive.constant_damping() + drive.damping()
        } else {
            drive.constant_damping()
        }
    }

    /// Joints whose motors follow their commands, whatever the links do, with the stiffness
    /// between.
    pub(super) fn prescribed(&self) -> Vec<(usize, f64)> {
        let joints = self.joints.iter().enumerate();
        let prescribed = joints.filter(|(_, drive)| drive.kind == DriveKind::Position);
        prescribed
            .map(|(i, drive)| (i, drive.stiffness()))
            .collect()
    }

    pub(super) fn joint(&self, joint: usize) -> &JointDrive {
        &self.joints[joint]
    }

    /// Joints with play.
    pub(super) fn with_play(&self) -> Vec<Play> {
        let joints = self.joints.iter().enumerate();
        let loose = joints.filter(|(_, joint)| joint.has_play());
        loose.map(|(i, _)| Play::new(i)).collect()
    }

    /// Sets motor state, what the transmissions pass on (friction of this step grows with it) and
    /// the explicit part of the joint torque (`K (θ - q) + D θ'` of a nominal joint) from the
    /// command and the state at this instant; `explicit` receives one value per joint.
    pub fn evaluate(&mut self, command: Command<'_>, state: &mut JointState, explicit: &mut [f64]) {
        state.command.copy_from_slice(command.position);
        self.command_velocity.copy_from_slice(command.velocity);
        for (i, joint) in self.joints.iter_mut().enumerate() {
            match joint.kind {
                DriveKind::Position => {
                    state.motor[i] = command.position[i];
                    state.motor_velocity[i] = command.velocity[i];
                }
                DriveKind::Servo => {
                    state.motor_velocity[i] = 1.5 * self.half[i] - 0.5 * self.half_before[i];
                }
                DriveKind::Force => {
                    state.motor[i] = state.position[i];
                    state.motor_velocity[i] = 0.0;
                }
            }
            if let Some(servo) = joint.rigid_servo() {
                state.motor[i] = command.position[i];
                state.motor_velocity[i] = servo.velocity_feed_forward * command.velocity[i];
                explicit[i] = joint.rigid_explicit(servo, &state.motion(i));
                continue;
            }
            let at = state.motion(i);
            joint.remember(&at);
            explicit[i] = joint.explicit_torque(&at);
            if joint.kind == DriveKind::Force {
                explicit[i] += command.force[i];
                state.drive[i] = command.force[i];
            }
        }
        // Only now are all motors known, which damping between joints couples.
        for i in 0..self.joints.len() {
            state.transmission[i] = self.transmission(i, state);
        }
    }

    /// Steps the rotors over one step by the same leapfrog as the arm: torques at this instant,
    /// velocities at half steps, the first of half a step before the start: else a rotor that its
    /// servo does not hold there (saturated, or rid of its load) would lead by half a step's Δv.
    pub fn advance(&mut self, state: &mut JointState) {
        if self.kind != DriveKind::Servo {
            return;
        }
        for i in 0..self.joints.len() {
            let mut v = self.half[i];
            if !self.started {
                v -= 0.5 * self.rotor_change(i, state, v).unwrap_or(0.0);
            }
            if let Some(change) = self.rotor_change(i, state, v) {
                self.half_before[i] = v;
                self.half[i] = v + change;
                state.motor_velocity[i] = v + 0.5 * change;
            }
        }
        self.started = true;
    }

    /// The change of a rotor's velocity in a step that begins with `v`. Velocity-dependent torques
    /// take the mean of both half steps; a saturated drive is a constant torque.
    fn rotor_change(&self, i: usize, state: &JointState, v: f64) -> Option<f64> {
        let joint = &self.joints[i];
        let servo = joint.servo.filter(|_| !joint.rigid)?;
        let now = state.motion(i);
        // The rotor carries the transmission's torque times the gear's true ratio (virtual work).
        let gear = joint.law.gear(now.motor);
        let (position_part, damping) = joint.on_rotor(&now);
        let transmission = gear * (position_part - damping * now.velocity);
        let damping = damping * gear * gear;
        let wish = servo.position_gain_per_s * (state.command[i] - state.motor[i])
            + servo.velocity_feed_forward * self.command_velocity[i];
        let at = |gain: f64| {
            // (M + dt/2 c) Δv = dt (τ - c v), c the sum of all velocity gains
            let c = damping + gain;
            let torque = gain * wish + self.feed_forward[i] - transmission - c * v;
            self.dt_s * torque / (joint.rotor + 0.5 * self.dt_s * c)
        };
        let change = at(servo.velocity_gain);
        let drive = servo.velocity_gain * (wish - (v + 0.5 * change)) + self.feed_forward[i];
        if drive.abs() <= servo.torque_limit {
            return Some(change);
        }
        let torque = servo.torque_limit.copysign(drive) - transmission - damping * v;
        Some(self.dt_s * torque / (joint.rotor + 0.5 * self.dt_s * damping))
    }

    /// The transmission's torque at this instant, from the state as it is now known.
    pub fn transmission(&self, joint: usize, state: &JointState) -> f64 {
        let (drive, at) = (&self.joints[joint], state.motion(joint));
        match drive.rigid_servo() {
            Some(servo) => drive.rigid_torque(servo, &at),
            None => drive.transmission(&at) + self.coupled_torque(joint, state),
        }
    }

    /// What the drive exerts at this instant: on the rotor (servo), else on the link.
    pub fn drive_force(&self, joint: usize, state: &JointState) -> f64 {
        match self.kind {
            DriveKind::Force => state.drive[joint],
            DriveKind::Servo if !self.joints[joint].rigid => self.servo_torque(joint, state),
            DriveKind::Servo | DriveKind::Position => state.transmission[joint],
        }
    }

    /// Moves the motor coordinates by the velocities just computed.
    pub fn drift(&self, state: &mut JointState) {
        if self.kind == DriveKind::Servo {
            for (motor, v) in state.motor.iter_mut().zip(&self.half) {
                *motor += self.dt_s * v;
            }
        }
    }

    /// Energy wound up in the transmissions and kinetic energy of servo-driven rotors, J.
    pub fn energy_j(&self, state: &JointState) -> (f64, f64) {
        let mut elastic = 0.0;
        let mut rotors = 0.0;
        for (i, joint) in self.joints.iter().enumerate() {
            elastic += joint.energy_j(&state.motion(i));
            if joint.kind == DriveKind::Servo && !joint.rigid {
                rotors += 0.5 * joint.rotor * state.motor_velocity[i].powi(2);
            }
        }
        (elastic, rotors)
    }

    /// Power that the motors put into the transmissions (position drive) or the drives' torques
    /// into the rotors (servo), W.
    pub fn power_w(&self, state: &JointState) -> f64 {
        (self.joints.iter().enumerate())
            .map(|(i, joint)| match joint.kind {
                _ if joint.rigid => state.transmission[i] * state.velocity[i],
                DriveKind::Position => {
                    let gear = joint.law.gear(state.motor[i]);
                    state.transmission[i] * (state.motor_velocity[i] * gear)
                }
                DriveKind::Servo => self.servo_torque(i, state) * state.motor_velocity[i],
                DriveKind::Force => state.drive[i] * state.velocity[i],
            })
            .sum()
    }

    /// Torque of a joint's drive, N m or N: what the servo gives, or what the transmission asks of
    /// a motor that follows its command exactly.
    pub fn torque(&self, joint: usize, state: &JointState) -> f64 {
        match self.kind {
            DriveKind::Position => state.transmission[joint],
            DriveKind::Servo => self.servo_torque(joint, state),
            DriveKind::Force => 0.0,
        }
    }

    fn servo_torque(&self, i: usize, state: &JointState) -> f64 {
        let Some(servo) = self.joints[i].servo else {
            return 0.0;
        };
        let wish = servo.position_gain_per_s * (state.command[i] - state.motor[i])
            + servo.velocity_feed_forward * self.command_velocity[i];
        let torque = servo.velocity_gain * (wish - state.motor_velocity[i]) + self.feed_forward[i];
        torque.clamp(-servo.torque_limit, servo.torque_limit)
    }

    /// Power lost in the transmissions' damping and in the joints' effects, W.
    pub fn dissipation_w(&self, state: &JointState) -> f64 {
        (self.joints.iter().enumerate())
            .map(|(i, joint)| {
                let against = state.motor_velocity[i] - state.velocity[i];
                joint.dissipation_w(&state.motion(i)) + self.coupled_torque(i, state) * against
            })
            .sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand_chacha::ChaCha8Rng;
    use rand_chacha::rand_core::SeedableRng;
    use rand_distr::{Distribution, Uniform};
    use truecut_arm::{Servo, Transmission};

    /// So short that velocities hardly change over it.
    const STEP_S: f64 = 1e-8;

    /// One joint with play of 2 mrad, and a servo too weak to hide what the transmission does.
    fn joint() -> JointDrive {
        let transmission = Transmission {
            stiffness: Some(1e6),
            damping: 3e3,
            rotor_inertia: 0.7,
            servo: Some(Servo {
                position_gain_per_s: 5.0,
                velocity_gain: 40.0,
                torque_limit: 1e3,
                velocity_feed_forward: 0.0,
            }),
            ..Transmission::default()
        };
        let law = JointLaw {
            gap: 2e-3,
            ..JointLaw::default()
        };
        JointDrive::new(DriveKind::Servo, &transmission, law)
    }

    /// Newton's second law of the rotor over a step, with Newton's third law at the flanks: servo
    /// less what acts on the link. In play, pressed, and parting faster than the spring pushes.
    #[test]
    fn verify_rotor_and_link_feel_opposite_torques() {
        let mut rng = ChaCha8Rng::seed_from_u64(20);
        let windup = Uniform::new(-1.5e-3, 1.5e-3).unwrap();
        let rate = Uniform::new(-0.4, 0.4).unwrap();
        let mut seen = [0; 3];
        for _ in 0..3000 {
            let before = rate.sample(&mut rng);
            let mut drive = Drive {
                kind: DriveKind::Servo,
                joints: vec![joint()],
                command_velocity: vec![0.0],
                half: vec![before],
                half_before: vec![before],
                started: true,
                dt_s: STEP_S,
                feed_forward: vec![0.0],
                coupled: None,
            };
            let mut state = JointState::at_rest(&[-windup.sample(&mut rng)], &[0.0]);
            state.velocity[0] = rate.sample(&mut rng);
            let command = Command {
                position: &[0.0],
                velocity: &[0.0],
                force: &[0.0],
            };
            drive.evaluate(command, &mut state, &mut [0.0]);
            let on_link = state.transmission[0];
            let touching = state.position[0].abs() > 1e-3;
            seen[usize::from(touching) + usize::from(on_link != 0.0)] += 1;
            drive.advance(&mut state);
            let on_rotor = drive.drive_force(0, &state) - 0.7 * (drive.half[0] - before) / STEP_S;
            assert!((on_rotor - on_link).abs() < 0.1, "{on_rotor} {on_link}");
        }
        assert!(seen.iter().all(|count| *count > 200), "{seen:?}");
    }
}
