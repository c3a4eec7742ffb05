//! The effects of a scenario, sorted by where they act: plant building, joint laws, process, measurement.
//!
//! Effects at their neutral size are checked like the others and then left out, so that a run with them is
//! the nominal run to the last bit.

mod check;
mod process;
mod robot;
mod start;

pub(crate) use process::{CuttingEffects, FootEffects, WheelEffects};
pub(crate) use robot::{Altered, alter};
pub(crate) use start::{at_rest, base_at_rest};

use crate::error::SimError;
use crate::measurement::ChannelModel;
use crate::plant::{DriveKind, JointLaw};
use nalgebra::Vector3;
use std::f64::consts::TAU;
use truecut_arm::{JointKind, Robot};
use truecut_core::joint_law::{BoucWen, Counterbalance, LinkFriction, Ripple};
use truecut_scenario::Scenario;
use truecut_scenario::effect::{Effect, EffectKind, Family, Target};

/// All effects of a scenario.
#[derive(Debug, Clone, Default)]
pub(crate) struct Effects {
    /// One of each joint of the arm.
    pub joints: Vec<JointEffects>,
    pub payload: Option<Payload>,
    /// World axis and compliance (rad/(N m)) of every tilt of the base.
    pub base: Vec<(usize, f64)>,
    pub cutting: CuttingEffects,
    pub foot: FootEffects,
    pub wheel: WheelEffects,
    /// Channels that are not recorded as they are, with the entry in the scenario.
    pub sensors: Vec<(String, ChannelModel)>,
}

/// What acts in one joint.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct JointEffects {
    pub stiffness_factor: f64,
    pub damping_factor: f64,
    /// Beyond `robot.toml`'s dry friction.
    pub friction: LinkFriction,
    pub law: JointLaw,
}

impl Default for JointEffects {
    fn default() -> Self {
        Self {
            stiffness_factor: 1.0,
            damping_factor: 1.0,
            friction: LinkFriction::coulomb(0.0),
            law: JointLaw::default(),
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
    /// An effect on a joint that the robot does not have, with the keys of the other kind of joint, or that
    /// does not apply to the process or the drive.
    pub(crate) fn of(
        scenario: &Scenario,
        robot: &Robot,
        drive: DriveKind,
    ) -> Result<Self, SimError> {
        let mut effects = Self {
            joints: vec![JointEffects::default(); robot.dof()],
            ..Self::default()
        };
        for (index, effect) in scenario.effects.iter().enumerate() {
            check::applies(scenario, index, robot, drive)?;
            if !effect.is_neutral() {
                effects.add(effect, robot);
            }
        }
        Ok(effects)
    }

    fn add(&mut self, effect: &Effect, robot: &Robot) {
        let v = &effect.values;
        match (effect.kind.family(), &effect.target) {
            (Family::Joint, Target::Joint(joint)) => {
                let kind = robot.chain.joints[*joint].kind;
                self.joints[*joint].add(effect, kind);
            }
            (Family::Robot, Target::Axis(axis)) => self.base.push((*axis, v[0])),
            (Family::Robot, _) => {
                self.payload = Some(Payload {
                    mass_kg: v[0],
                    flange_from_center_m: Vector3::new(v[1], v[2], v[3]),
                });
            }
            (Family::Cutting, _) => self.cutting.add(effect),
            (Family::Foot, _) => self.foot.add(effect),
            (Family::Wheel, _) => self.wheel.add(effect),
            (Family::Sensor, Target::Channel(channel)) => {
                let known = self.sensors.iter().position(|(name, _)| name == channel);
                let at = known.unwrap_or(self.sensors.len());
                if at == self.sensors.len() {
                    self.sensors
                        .push((channel.clone(), ChannelModel::default()));
                }
                self.sensors[at].1.add(effect);
            }
            // The scenario holds no effect whose target does not fit its kind.
            (Family::Joint | Family::Sensor, _) => {}
        }
    }
}

impl JointEffects {
    fn add(&mut self, effect: &Effect, joint: JointKind) {
        let v = &effect.values;
        let (friction, law) = (&mut self.friction, &mut self.law);
        match effect.kind {
            EffectKind::JointStiffness => self.stiffness_factor = v[0],
            EffectKind::JointDamping => self.damping_factor = v[0],
            EffectKind::JointViscous => law.viscous = v[0],
            EffectKind::JointCoulomb => friction.dry = friction.dry.map(|dry| dry + v[0]),
            EffectKind::JointLoadFriction => friction.load_share = v[0],
            EffectKind::JointAsymmetricViscous => friction.viscous = [v[0], v[1]],
            EffectKind::JointAsymmetricCoulomb => {
                friction.dry = [friction.dry[0] + v[0], friction.dry[1] + v[1]];
            }
            EffectKind::JointStribeck => {
                friction.excess = v[0];
                friction.stribeck_speed = v[1];
            }
            EffectKind::JointBacklash => law.gap = v[0],
            EffectKind::JointHysteresis => {
                law.hysteresis = Some(BoucWen {
                    amplitude: v[0],
                    yield_windup: v[1],
                });
            }
            EffectKind::JointCubicStiffness => law.cubic = v[0],
            EffectKind::JointRipple => {
                law.ripple = Some(Ripple {
                    cosine: v[0],
                    sine: v[1],
                    phase_per_coordinate: match joint {
                        JointKind::Revolute => v[2],
                        JointKind::Prismatic => TAU * v[2],
                    },
                });
            }
            EffectKind::JointCounterbalance => {
                law.counterbalance = Some(Counterbalance {
                    cosine: v[0],
                    sine: v[1],
                });
            }
            EffectKind::JointOffset => law.offset = v[0],
            _ => {}
        }
    }
}
