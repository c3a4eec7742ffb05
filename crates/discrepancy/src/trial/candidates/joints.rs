//! Typical sizes of effects in joints and on the links that they move.

use std::f64::consts::TAU;

use truecut_scenario::effect::JointEffect;

use super::SHARE;
use crate::trial::signals::JointSignals;

/// Most cycles per 2 pi of the coordinate that are looked for.
const MOST_CYCLES: f64 = 160.0;
/// A joint that turns the phase of a ripple by less than this shows a constant, which a ripple
/// cannot be told from, rad.
const LEAST_PHASE: f64 = 0.1;

/// Under a load that varies by less than this part of itself, friction that grows with the load is
/// dry friction. Above it the data say which of the two it is, or that they do not tell.
const LEAST_VARIATION: f64 = 0.01;

/// By as much a link's centre, or what it carries, may well be off, m.
const OFF_CENTER_M: f64 = 0.02;

/// Of a joint that turns by less than this, standard deviation in rad, a balancing spring is an
/// offset and a stiffness: its amplitude would be whatever makes up for a transmission's.
const LEAST_TURN: f64 = 0.02;

pub(super) fn joint_scale(joint: &JointSignals, effect: JointEffect) -> Option<JointEffect> {
    use JointEffect as E;
    let effort = SHARE * joint.effort;
    let per_speed = effort / joint.speed;
    let windup = joint.stiffness.map(|k| joint.effort / k);
    Some(match effect {
        E::Stiffness { .. } => joint.stiffness.map(|_| E::Stiffness { factor: SHARE })?,
        E::Damping { .. } => joint.stiffness.map(|_| E::Damping { factor: 1.0 })?,
        E::Viscous { .. } => E::Viscous { viscous: per_speed },
        E::AsymmetricViscous { .. } => E::AsymmetricViscous {
            positive: per_speed,
            negative: per_speed,
        },
        E::Coulomb { .. } => E::Coulomb { friction: effort },
        E::Offset { .. } => E::Offset { force: effort },
        E::Zero { .. } => E::Zero {
            offset: SHARE * SHARE,
        },
        E::LinkMass { .. } => E::LinkMass { factor: SHARE },
        E::LinkCenter { .. } => E::LinkCenter {
            x: OFF_CENTER_M,
            y: OFF_CENTER_M,
            z: OFF_CENTER_M,
        },
        E::LinkLength { .. } => E::LinkLength {
            x: OFF_CENTER_M,
            y: OFF_CENTER_M,
            z: OFF_CENTER_M,
        },
        // The acceleration of a swing is the square of its speed over its travel.
        E::Rotor { .. } => E::Rotor {
            inertia: effort * joint.travel / joint.speed.powi(2),
        },
        E::LoadFriction { .. } => {
            if joint.effort_varies.is_nan() || joint.effort_varies < LEAST_VARIATION {
                return None;
            }
            E::LoadFriction { share: 0.5 * SHARE }
        }
        E::AsymmetricCoulomb { .. } => E::AsymmetricCoulomb {
            positive: effort,
            negative: effort,
        },
        E::Counterbalance { .. } => {
            if joint.rotary && joint.travel < LEAST_TURN {
                return None;
            }
            E::Counterbalance {
                cosine: effort,
                sine: effort,
            }
        }
        E::Stribeck { .. } => E::Stribeck {
            excess: effort,
            speed: 0.2 * joint.speed,
        },
        E::Backlash { .. } => E::Backlash {
            gap: 2.0 * SHARE * windup?,
        },
        E::Hysteresis { .. } => E::Hysteresis {
            amplitude: effort,
            yield_windup: windup?,
        },
        E::CubicStiffness { .. } => E::CubicStiffness {
            cubic: SHARE * joint.stiffness? / windup?.powi(2),
        },
        E::Ripple { .. } => {
            let turn = if joint.rotary { 1.0 } else { TAU };
            if MOST_CYCLES * turn * joint.travel < LEAST_PHASE {
                return None;
            }
            let amplitude = SHARE * windup?;
            E::Ripple {
                cosine: amplitude,
                sine: amplitude,
                cycles: 0.1 / joint.travel,
            }
        }
    })
}
