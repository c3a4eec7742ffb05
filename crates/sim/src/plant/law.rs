//! One joint as the drive sees it: transmission with its effects, and torques on the link.

use truecut_arm::{Servo, Transmission};
use truecut_core::joint_law::{Elastic, JointLaw};
use truecut_scenario::DriveKind;

/// Drive of one joint with the memory of its transmission.
#[derive(Debug, Clone)]
pub(super) struct JointDrive {
    pub kind: DriveKind,
    pub rotor: f64,
    pub servo: Option<Servo>,
    /// The servo acts on the link, through no transmission.
    pub rigid: bool,
    elastic: Elastic,
    damping: f64,
    pub law: JointLaw,
    /// State of the hysteresis and the wind-up at which it was reached; `None` before the first
    /// step.
    hysteresis: Option<(f64, f64)>,
}

/// Motor and link of one joint at one instant.
#[derive(Debug, Clone, Copy)]
pub(super) struct JointMotion {
    pub motor: f64,
    pub motor_velocity: f64,
    pub position: f64,
    pub velocity: f64,
}

impl JointDrive {
    pub fn new(kind: DriveKind, transmission: &Transmission, law: JointLaw) -> Self {
        let free = kind == DriveKind::Force;
        Self {
            kind,
            rotor: transmission.rotor_inertia,
            servo: transmission.servo,
            rigid: kind == DriveKind::Servo && transmission.rigid_servo,
            elastic: Elastic {
                stiffness: if free {
                    0.0
                } else {
                    transmission.stiffness.unwrap_or(0.0)
                },
                cubic: law.cubic,
                gap: law.gap,
            },
            damping: if free { 0.0 } else { transmission.damping },
            law,
            hysteresis: None,
        }
    }

    /// Damping of the link's own velocity that does not depend on the state: the bearings', and the
    /// transmission's unless play parts motor and link at times.
    pub fn constant_damping(&self) -> f64 {
        let through = if self.law.gap > 0.0 {
            0.0
        } else {
            self.damping
        };
        through + self.law.viscous
    }

    pub fn windup(&self, at: &JointMotion) -> f64 {
        self.law.seen(at.motor) - at.position
    }

    /// What the rotor carries of the transmission at this instant: the torque that depends on
    /// positions, and the damping of the wind-up's rate; on the link act the same, turned round.
    pub fn on_rotor(&self, at: &JointMotion) -> (f64, f64) {
        if self.flanks_press(self.windup(at), self.rate(at)) {
            (self.static_torque(at), self.damping)
        } else {
            (self.hysteresis_torque().unwrap_or(0.0), 0.0)
        }
    }

    /// Torque on the link that depends on positions only: spring and hysteresis of the
    /// transmission.
    pub fn static_torque(&self, at: &JointMotion) -> f64 {
        let spring = self.elastic.torque(self.windup(at));
        spring + self.hysteresis_torque().unwrap_or(0.0)
    }

    fn hysteresis_torque(&self) -> Option<f64> {
        Some(self.law.hysteresis?.torque(self.hysteresis?.0))
    }

    /// Moves the hysteresis to the wind-up of this instant.
    pub fn remember(&mut self, at: &JointMotion) {
        if let Some(law) = self.law.hysteresis {
            let windup = self.windup(at);
            let (state, before) = self.hysteresis.unwrap_or((0.0, windup));
            self.hysteresis = Some((law.advance(state, windup - before), windup));
        }
    }

    /// Torque on the link without the part of [`JointDrive::constant_damping`].
    pub fn explicit_torque(&self, at: &JointMotion) -> f64 {
        let torque = if self.law.gap > 0.0 {
            self.transmission(at)
        } else {
            let fed = at.motor_velocity * self.law.gear(at.motor);
            self.static_torque(at) + self.damping * fed
        };
        if self.law.loads_link() {
            torque + self.law.link_torque(at.position)
        } else {
            torque
        }
    }

    /// The servo, if it acts on the link.
    pub fn rigid_servo(&self) -> Option<Servo> {
        self.servo.filter(|_| self.rigid)
    }

    /// Torque of a servo on its link: `at` holds the command and its velocity as motor coordinates.
    pub fn rigid_torque(&self, servo: Servo, at: &JointMotion) -> f64 {
        let torque = self.elastic.torque(at.motor - at.position)
            + self.damping * (at.motor_velocity - at.velocity);
        torque.clamp(-servo.torque_limit, servo.torque_limit)
    }

    /// The same with the torques on the link, without the part that is proportional to the link's
    /// velocity, which the plant adds. A drive at its limit takes that part back, at the velocity
    /// foreseen.
    pub fn rigid_explicit(&self, servo: Servo, at: &JointMotion) -> f64 {
        let drive = self.rigid_torque(servo, at) + self.damping * at.velocity;
        if self.law.loads_link() {
            drive + self.law.link_torque(at.position)
        } else {
            drive
        }
    }

    /// Torque of the whole transmission on the link.
    pub fn transmission(&self, at: &JointMotion) -> f64 {
        let flank = self.flank_torque(self.windup(at), self.rate(at));
        flank + self.hysteresis_torque().unwrap_or(0.0)
    }

    /// Rate of the wind-up.
    pub fn rate(&self, at: &JointMotion) -> f64 {
        at.motor_velocity * self.law.gear(at.motor) - at.velocity
    }

    /// Whether spring and damper act: always without play, else while flanks press on each other;
    /// their damping cannot make them pull.
    fn flanks_press(&self, windup: f64, rate: f64) -> bool {
        if self.law.gap <= 0.0 {
            return true;
        }
        let spring = self.elastic.torque(windup);
        self.elastic.engaged(windup) && (spring + self.damping * rate) * spring > 0.0
    }

    /// Torque of spring and damper.
    fn flank_torque(&self, windup: f64, rate: f64) -> f64 {
        if self.flanks_press(windup, rate) {
            self.elastic.torque(windup) + self.damping * rate
        } else {
            0.0
        }
    }

    /// Linear stiffness of the transmission.
    pub fn stiffness(&self) -> f64 {
        self.elastic.stiffness
    }

    /// Damping of the transmission while motor and link touch.
    pub fn damping(&self) -> f64 {
        self.damping
    }

    /// Whether there is play between motor and link.
    pub fn has_play(&self) -> bool {
        self.law.gap > 0.0 && !self.rigid && self.kind != DriveKind::Force
    }

    /// What play takes away from the torque of spring and damper.
    pub fn taken_by_play(&self, windup: f64, rate: f64) -> f64 {
        self.elastic.stiffness * windup + self.damping * rate - self.flank_torque(windup, rate)
    }

    /// Whether flanks may meet, part, or press less than their damping pulls, within `span` of this
    /// wind-up.
    pub fn meets_flank(&self, windup: f64, span: f64, rate: f64) -> bool {
        let pulls = self.damping * rate.abs() / self.elastic.stiffness;
        (windup.abs() - 0.5 * self.law.gap).abs() <= span + pulls
    }

    /// Energy of spring and of torques on the link, J.
    pub fn energy_j(&self, at: &JointMotion) -> f64 {
        // A servo without transmission stores nothing.
        let spring = if self.rigid {
            0.0
        } else {
            self.elastic.energy_j(self.windup(at))
        };
        if self.law.loads_link() {
            spring + self.law.link_energy_j(at.position)
        } else {
            spring
        }
    }

    /// Power lost, W: damping, viscous friction, and what the hysteresis takes (and in part gives
    /// back).
    pub fn dissipation_w(&self, at: &JointMotion) -> f64 {
        let rate = at.velocity - at.motor_velocity * self.law.gear(at.motor);
        let mut lost = if self.rigid {
            0.0
        } else if self.law.gap > 0.0 {
            (self.static_torque(at) - self.transmission(at)) * rate
        } else {
            self.damping * rate.powi(2)
        };
        if self.law.viscous > 0.0 {
            lost += self.law.viscous * at.velocity.powi(2);
        }
        if let Some(torque) = self.hysteresis_torque() {
            lost -= torque * rate;
        }
        lost
    }
}
