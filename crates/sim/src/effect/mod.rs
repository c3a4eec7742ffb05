//! The effects of a scenario, sorted by where they act: plant building, joint laws, process,
//! measurement.
//!
//! Effects at their neutral size are checked like the others and then left out, so that a run with
//! them is the nominal run to the last bit.
#![deny(clippy::wildcard_enum_match_arm)]

mod check;
mod process;
mod robot;
mod start;

pub use check::misfit;

pub(crate) use process::{CuttingEffects, FootEffects, MillingEffects, WheelEffects};
pub(crate) use robot::{Altered, alter, build_in, point_inertia};
pub(crate) use start::{at_rest, base_at_rest};

use crate::error::SimError;
use crate::measurement::Sensors;
use nalgebra::{Rotation3, Vector3};
use std::f64::consts::TAU;
use std::sync::Arc;
use truecut_arm::{Joint, JointKind, Robot};
use truecut_core::joint_law::{BoucWen, Counterbalance, Curve, JointLaw, LinkFriction, Ripple};
use truecut_scenario::Scenario;
use truecut_scenario::effect::{
    BaseEffect, ClockEffect, CurveEffect, Effect, JointEffect, RobotEffect, Typed,
};

/// All effects of a scenario.
#[derive(Debug, Clone, Default)]
pub(crate) struct Effects {
    /// One of each joint of the arm.
    pub joints: Vec<JointEffects>,
    pub payload: Option<Payload>,
    /// World axis and compliance (rad/(N m)) of every tilt of the base.
    pub base: Vec<(usize, f64)>,
    /// World axis and angle (rad) of every turn in which the base stands.
    pub tilts: Vec<(usize, f64)>,
    /// Speed of the motion over that by the times of the data, where these are not the motion's.
    pub clock_rate: Option<f64>,
    pub cutting: CuttingEffects,
    pub milling: MillingEffects,
    pub foot: FootEffects,
    pub wheel: WheelEffects,
    /// What is recorded as it is not.
    pub sensors: Sensors,
}

/// What acts in one joint.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct JointEffects {
    pub stiffness_factor: f64,
    pub damping_factor: f64,
    /// Beyond `robot.toml`'s dry friction.
    pub friction: LinkFriction,
    pub law: JointLaw,
    /// True coordinate less the one that is reported and commanded, rad (m).
    pub zero: f64,
    /// Of the link that it moves.
    pub mass_factor: f64,
    /// Of the same link: true centre of mass less the file's, in the link's frame, m.
    pub center_m: Vector3<f64>,
    /// Of the same link: true place of the next joint, or of the flange, less the file's, in the
    /// link's frame, m.
    pub carried_m: Vector3<f64>,
    /// True inertia (mass) of the rotor less the file's, kg m² (kg).
    pub rotor: f64,
}

impl Default for JointEffects {
    fn default() -> Self {
        Self {
            stiffness_factor: 1.0,
            damping_factor: 1.0,
            friction: LinkFriction::coulomb(0.0),
            law: JointLaw::default(),
            zero: 0.0,
            mass_factor: 1.0,
            center_m: Vector3::zeros(),
            carried_m: Vector3::zeros(),
            rotor: 0.0,
        }
    }
}

/// A mass at the flange.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Payload {
    pub mass_kg: f64,
    pub flange_from_center_m: Vector3<f64>,
}

impl Effects {
    /// Checks the scenario's effects against its robot and process, and sorts them.
    ///
    /// # Errors
    /// An effect on a joint that the robot does not have, with the keys of the other kind of joint,
    /// or that does not apply to the process or the drive.
    pub(crate) fn of(scenario: &Scenario, robot: &Robot) -> Result<Self, SimError> {
        for index in 0..scenario.effects.len() {
            check::applies(scenario, index, robot)?;
        }
        Ok(Effects::sum(&scenario.effects, &robot.chain.joints))
    }

    /// Sorts effects that apply to an arm with these joints.
    pub(crate) fn sum<'a>(
        effects: impl IntoIterator<Item = &'a Effect>,
        joints: &[Joint],
    ) -> Effects {
        let mut sum = Self {
            joints: vec![JointEffects::default(); joints.len()],
            ..Self::default()
        };
        for effect in effects {
            // Those of neutral size are left out, so that a run with them is the nominal one.
            if effect.is_neutral() {
                continue;
            }
            match effect.typed() {
                Some(Typed::Curve(joint, law)) => sum.joints[joint].add_curve(law, effect.curve()),
                Some(typed) => sum.add(typed, joints),
                None => {}
            }
        }
        sum
    }

    fn add(&mut self, effect: Typed<'_>, joints: &[Joint]) {
        match effect {
            Typed::Joint(joint, effect) => self.joints[joint].add(effect, joints[joint].kind),
            // By all its values: see `add_curve`.
            Typed::Curve(..) => {}
            Typed::Robot(RobotEffect::Payload {
                mass_kg,
                center_x_m,
                center_y_m,
                center_z_m,
            }) => {
                self.payload = Some(Payload {
                    mass_kg,
                    flange_from_center_m: Vector3::new(center_x_m, center_y_m, center_z_m),
                });
            }
            Typed::Base(
                axis,
                BaseEffect::Compliance {
                    compliance_rad_per_n_m,
                },
            ) => self.base.push((axis, compliance_rad_per_n_m)),
            Typed::Base(axis, BaseEffect::Tilt { angle_rad }) => self.tilts.push((axis, angle_rad)),
            Typed::Cutting(effect) => self.cutting.add(effect),
            Typed::Milling(effect) => self.milling.add(effect),
            Typed::Foot(effect) => self.foot.add(effect),
            Typed::Wheel(effect) => self.wheel.add(effect),
            Typed::Clock(ClockEffect::Rate { factor }) => self.clock_rate = Some(factor),
            Typed::Clock(effect) => self.sensors.add_clock(effect),
            Typed::Sensor(channel, effect) => self.sensors.add(channel, effect),
        }
    }
}

impl Effects {
    /// Gravity as a base feels it that stands as the effects have it: the arm and its part stay
    /// where they are in the base's frame. Turns about x and y are one about the axis between them,
    /// whatever their order.
    pub(crate) fn gravity_on_base(&self, level_m_s2: Vector3<f64>) -> Vector3<f64> {
        let mut turn = Vector3::zeros();
        for (axis, angle_rad) in &self.tilts {
            turn[*axis] += angle_rad;
        }
        Rotation3::new(-turn) * level_m_s2
    }
}

impl JointEffects {
    /// What the transmission must pass on against these effects, N m (N): friction opposes the
    /// motion, so the drive gives it; what pushes the link by itself the drive need not. Without
    /// friction that grows with the load, which depends on all that is passed on.
    pub(crate) fn against(&self, position: f64, velocity: f64) -> f64 {
        let friction = self.friction.at(position).force(velocity) + self.law.viscous * velocity;
        friction - self.law.link_torque(position)
    }

    /// Whether the arm's links, lengths, rotors or zeros are not those of its files.
    pub(crate) fn is_another_arm(&self) -> bool {
        let of_file = Self::default();
        self.zero != of_file.zero
            || self.mass_factor != of_file.mass_factor
            || self.center_m != of_file.center_m
            || self.carried_m != of_file.carried_m
            || self.rotor != of_file.rotor
    }

    /// Whether the robot's own numbers hold them, without a law beyond spring and damper.
    pub(crate) fn is_built_in(&self) -> bool {
        self.law == JointLaw::default() && self.friction.is_none()
    }

    /// A law without a name, by all its values.
    fn add_curve(&mut self, law: CurveEffect, curve: Option<Curve>) {
        let place = match law {
            CurveEffect::Position { .. } => &mut self.law.curve,
            CurveEffect::FrictionByPosition { .. } => &mut self.friction.by_position,
            CurveEffect::FrictionBySpeed { .. } => &mut self.friction.by_speed,
        };
        *place = curve.map(Arc::new);
    }

    fn add(&mut self, effect: JointEffect, kind: JointKind) {
        let (friction, law) = (&mut self.friction, &mut self.law);
        match effect {
            JointEffect::Stiffness { factor } => self.stiffness_factor = factor,
            JointEffect::Damping { factor } => self.damping_factor = factor,
            JointEffect::Viscous { viscous } => law.viscous = viscous,
            JointEffect::Coulomb { friction: level } => {
                friction.dry = friction.dry.map(|dry| dry + level);
            }
            JointEffect::LoadFriction { share } => friction.load_share = share,
            JointEffect::AsymmetricViscous { positive, negative } => {
                friction.viscous = [positive, negative];
            }
            JointEffect::AsymmetricCoulomb { positive, negative } => {
                friction.dry = [friction.dry[0] + positive, friction.dry[1] + negative];
            }
            JointEffect::Stribeck { excess, speed } => {
                friction.excess = excess;
                friction.stribeck_speed = speed;
            }
            JointEffect::Backlash { gap } => law.gap = gap,
            JointEffect::Hysteresis {
                amplitude,
                yield_windup,
            } => {
                law.hysteresis = Some(BoucWen {
                    amplitude,
                    yield_windup,
                });
            }
            JointEffect::CubicStiffness { cubic } => law.cubic = cubic,
            JointEffect::Ripple {
                cosine,
                sine,
                cycles,
            } => {
                law.ripple = Some(Ripple {
                    cosine,
                    sine,
                    phase_per_coordinate: match kind {
                        JointKind::Revolute => cycles,
                        JointKind::Prismatic => TAU * cycles,
                    },
                });
            }
            JointEffect::Counterbalance { cosine, sine } => {
                law.counterbalance = Some(Counterbalance { cosine, sine });
            }
            JointEffect::Offset { force } => law.offset = force,
            JointEffect::Zero { offset } => self.zero = offset,
            JointEffect::LinkMass { factor } => self.mass_factor = factor,
            JointEffect::LinkCenter { x, y, z } => self.center_m = Vector3::new(x, y, z),
            JointEffect::LinkLength { x, y, z } => self.carried_m = Vector3::new(x, y, z),
            JointEffect::Rotor { inertia } => self.rotor = inertia,
        }
    }
}
