//! A slide whose motion is given: the drive force in closed form. Fast enough for hundreds of
//! diagnoses.

use truecut_recording::{ChannelSpec, Unit};
use truecut_scenario::UncertainSpec;
use truecut_scenario::effect::{Effect, EffectKind, Target};

use crate::model::{Candidate, Columns, Model, PredictError};

pub const INTERVAL_S: f64 = 0.01;
pub const MASS_KG: f64 = 20.0;

/// Force of a slide of uncertain mass that moves along `position`.
pub struct Force {
    channels: Vec<ChannelSpec>,
    nominal: Vec<UncertainSpec>,
    candidates: Vec<Candidate>,
    pub position: Vec<f64>,
    pub velocity: Vec<f64>,
    acceleration: Vec<f64>,
}

pub fn effect(kind: EffectKind, values: &[f64]) -> Effect {
    Effect {
        kind,
        target: Target::Joint(0),
        values: values.to_vec(),
    }
}

impl Force {
    /// `amplitude_m` scales the motion: two sines that are not in step.
    pub fn new(samples: usize, amplitude_m: f64) -> Force {
        let waves = [(1.0, 1.95, 0.0), (0.5, 5.21, 1.0)];
        let at = |t: f64, f: &dyn Fn(f64, f64) -> f64| -> f64 {
            waves
                .iter()
                .map(|(a, w, p)| amplitude_m * a * f(*w, w * t + p))
                .sum()
        };
        let times: Vec<f64> = (0..samples).map(|i| i as f64 * INTERVAL_S).collect();
        let of = |f: &dyn Fn(f64, f64) -> f64| times.iter().map(|t| at(*t, f)).collect();
        let scales: &[(EffectKind, &[f64])] = &[
            (EffectKind::JointViscous, &[50.0]),
            (EffectKind::JointCoulomb, &[10.0]),
            (EffectKind::JointAsymmetricViscous, &[50.0, 50.0]),
            (EffectKind::JointAsymmetricCoulomb, &[10.0, 10.0]),
            (EffectKind::JointStribeck, &[10.0, 0.02]),
            (EffectKind::JointCounterbalance, &[10.0, 10.0]),
            (EffectKind::JointOffset, &[10.0]),
        ];
        let joint = scales.iter().map(|(kind, scale)| Candidate {
            kind: *kind,
            target: Target::Joint(0),
            rotary: false,
            scale: scale.to_vec(),
        });
        let sensor = [
            (EffectKind::SensorOffset, vec![10.0]),
            (EffectKind::SensorGain, vec![0.1]),
            (EffectKind::SensorDrift, vec![5.0, 10.0]),
        ];
        let sensor = sensor.into_iter().map(|(kind, scale)| Candidate {
            kind,
            target: Target::Channel("joint1.drive_force".into()),
            rotary: false,
            scale,
        });
        Force {
            channels: vec![ChannelSpec::new(
                "joint1.drive_force",
                Unit::Newton,
                "of the slide",
            )],
            nominal: vec![UncertainSpec {
                key: "robot.mass_kg".into(),
                value: MASS_KG,
                sigma: 0.05 * MASS_KG,
            }],
            candidates: joint.chain(sensor).collect(),
            position: of(&|_, x| x.sin()),
            velocity: of(&|w, x| w * x.cos()),
            acceleration: of(&|w, x| -w * w * x.sin()),
        }
    }

    /// The force, by a formula for each effect.
    pub fn force(&self, mass_kg: f64, effects: &[Effect]) -> Vec<f64> {
        let mut force: Vec<f64> = self.acceleration.iter().map(|a| mass_kg * a).collect();
        for effect in effects {
            let p = &effect.values;
            for (i, f) in force.iter_mut().enumerate() {
                let (x, v) = (self.position[i], self.velocity[i]);
                let sign = (v / 1e-4).tanh();
                let (up, down) = (0.5 * (1.0 + sign), 0.5 * (1.0 - sign));
                match effect.kind {
                    EffectKind::JointViscous => *f += p[0] * v,
                    EffectKind::JointCoulomb => *f += p[0] * sign,
                    EffectKind::JointAsymmetricViscous => *f += (p[0] * up + p[1] * down) * v,
                    EffectKind::JointAsymmetricCoulomb => *f += p[0] * up - p[1] * down,
                    EffectKind::JointStribeck => *f += p[0] * sign * (-(v / p[1]).powi(2)).exp(),
                    EffectKind::JointCounterbalance => *f += p[0] * x.cos() + p[1] * x.sin(),
                    EffectKind::JointOffset | EffectKind::SensorOffset => *f += p[0],
                    EffectKind::SensorGain => *f *= p[0],
                    EffectKind::SensorDrift => {
                        *f += p[0] * (1.0 - (-(i as f64) * INTERVAL_S / p[1]).exp())
                    }
                    _ => unreachable!("not a candidate"),
                }
            }
        }
        force
    }
}

impl Model for Force {
    fn channels(&self) -> &[ChannelSpec] {
        &self.channels
    }

    fn nominal(&self) -> &[UncertainSpec] {
        &self.nominal
    }

    fn candidates(&self) -> Vec<Candidate> {
        self.candidates.clone()
    }

    fn predict(&self, nominal: &[f64], effects: &[Effect]) -> Result<Columns, PredictError> {
        Ok(vec![self.force(nominal[0], effects)])
    }
}
