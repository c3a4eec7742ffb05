//! A driven slide behind an elastic transmission: motor on a given path, link a mass with friction,
//! a known force on the link. Runge-Kutta of fourth order.

use truecut_recording::{ChannelSpec, Unit};
use truecut_scenario::UncertainSpec;
use truecut_scenario::effect::{Effect, EffectKind, Target};

use crate::model::{Candidate, Columns, Experiment, Model, PredictError};

pub const INTERVAL_S: f64 = 0.004;
pub const SUBSTEPS: usize = 4;
const MASS_KG: f64 = 20.0;
const STIFFNESS_N_PER_M: f64 = 1e5;
const DAMPING_N_S_PER_M: f64 = 60.0;

/// Link position and force of the transmission.
pub struct Slide {
    channels: Vec<ChannelSpec>,
    nominal: Vec<UncertainSpec>,
    candidates: Vec<Candidate>,
    samples: usize,
    substeps: usize,
    /// At the beginning, in the middle and at the end of each substep.
    course: Vec<Given>,
}

/// What is given at one instant.
#[derive(Clone, Copy)]
struct Given {
    motor: f64,
    rate: f64,
    load_n: f64,
}

/// What a simulation is made with; `extra_n` is a force on the link that no effect knows, of time,
/// position and velocity.
pub struct Truth<'a> {
    pub mass_kg: f64,
    pub effects: &'a [Effect],
    pub extra_n: &'a dyn Fn(f64, f64, f64) -> f64,
}

struct Parts {
    mass: f64,
    stiffness: f64,
    damping: f64,
    cubic: f64,
    gap: f64,
    ripple: [f64; 3],
    friction: Vec<(EffectKind, Vec<f64>)>,
}

impl Slide {
    pub fn new(samples: usize) -> Slide {
        Slide::stepped(samples, SUBSTEPS)
    }

    /// With so many substeps between two samples.
    pub fn stepped(samples: usize, substeps: usize) -> Slide {
        let scales: &[(EffectKind, &[f64])] = &[
            (EffectKind::JointStiffness, &[0.2]),
            (EffectKind::JointDamping, &[0.5]),
            (EffectKind::JointViscous, &[50.0]),
            (EffectKind::JointCoulomb, &[20.0]),
            (EffectKind::JointAsymmetricViscous, &[50.0, 50.0]),
            (EffectKind::JointAsymmetricCoulomb, &[20.0, 20.0]),
            (EffectKind::JointStribeck, &[20.0, 0.02]),
            (EffectKind::JointBacklash, &[1e-4]),
            (EffectKind::JointCubicStiffness, &[1e10]),
            (EffectKind::JointRipple, &[1e-4, 1e-4, 50.0]),
            (EffectKind::JointCounterbalance, &[50.0, 50.0]),
            (EffectKind::JointOffset, &[20.0]),
        ];
        let joint = scales.iter().map(|(kind, scale)| Candidate {
            kind: *kind,
            target: Target::Joint(0),
            rotary: false,
            scale: scale.to_vec(),
        });
        let channels = vec![
            ChannelSpec::new("joint1.position", Unit::Metre, "of the link"),
            ChannelSpec::new("joint1.drive_force", Unit::Newton, "of the transmission"),
        ];
        let sensors = [
            (EffectKind::SensorGain, 0.02, 20.0),
            (EffectKind::SensorOffset, 1e-4, 20.0),
            (EffectKind::SensorDelay, 0.004, 0.0),
        ];
        let sensors = sensors.into_iter().flat_map(|(kind, position, force)| {
            let scales = [
                position,
                if kind == EffectKind::SensorOffset {
                    force
                } else {
                    position
                },
            ];
            ["joint1.position", "joint1.drive_force"]
                .into_iter()
                .zip(scales)
                .map(move |(name, scale)| Candidate {
                    kind,
                    target: Target::Channel(name.into()),
                    rotary: false,
                    scale: vec![scale],
                })
        });
        Slide {
            candidates: joint.chain(sensors).collect(),
            channels,
            nominal: vec![UncertainSpec {
                key: "robot.mass_kg".into(),
                value: MASS_KG,
                sigma: 0.02 * MASS_KG,
            }],
            course: course(samples, substeps),
            samples,
            substeps,
        }
    }

    pub fn simulate(&self, truth: &Truth, push: f64) -> Columns {
        let parts = parts(truth);
        let (mut x, mut v) = (motor(0.0).0, motor(0.0).1);
        let (mut positions, mut forces) = (Vec::new(), Vec::new());
        let h = INTERVAL_S / self.substeps as f64;
        for i in 0..self.samples {
            let t = i as f64 * INTERVAL_S;
            positions.push(x);
            forces.push(spring(&parts, &self.course[2 * i * self.substeps], x, v));
            for s in 0..self.substeps {
                let t = t + s as f64 * h;
                let course = &self.course[2 * (i * self.substeps + s)..][..3];
                let slope = |half: usize, x: f64, v: f64| {
                    let (t, given) = (t + half as f64 * h / 2.0, &course[half]);
                    let extra = (truth.extra_n)(t, x, v) + push * given.load_n;
                    let own = spring(&parts, given, x, v) - friction(&parts, x, v);
                    (v, (own + extra) / parts.mass)
                };
                let a = slope(0, x, v);
                let b = slope(1, x + h / 2.0 * a.0, v + h / 2.0 * a.1);
                let c = slope(1, x + h / 2.0 * b.0, v + h / 2.0 * b.1);
                let d = slope(2, x + h * c.0, v + h * c.1);
                x += h / 6.0 * (a.0 + 2.0 * b.0 + 2.0 * c.0 + d.0);
                v += h / 6.0 * (a.1 + 2.0 * b.1 + 2.0 * c.1 + d.1);
            }
        }
        let mut columns = vec![positions, forces];
        measure(&mut columns, truth.effects);
        columns
    }
}

/// What is given, at every half substep: the same for all that is tried.
fn course(samples: usize, substeps: usize) -> Vec<Given> {
    let half_s = 0.5 * INTERVAL_S / substeps as f64;
    let given = |k: usize| {
        let t = k as f64 * half_s;
        let (motor, rate) = motor(t);
        let load_n = load(t);
        Given {
            motor,
            rate,
            load_n,
        }
    };
    (0..=2 * samples * substeps).map(given).collect()
}

/// Path and velocity of the motor.
fn motor(t: f64) -> (f64, f64) {
    let waves = [(0.04, 3.1, 0.0), (0.02, 7.9, 1.0), (0.003, 31.0, 0.4)];
    let x = waves.iter().map(|(a, w, p)| a * (w * t + p).sin()).sum();
    let v = waves
        .iter()
        .map(|(a, w, p)| a * w * (w * t + p).cos())
        .sum();
    (x, v)
}

/// The known force on the link.
fn load(t: f64) -> f64 {
    120.0 * (5.3 * t).sin() + 80.0 * (17.0 * t + 0.3).sin() + 40.0 * (47.0 * t).sin()
}

fn parts(truth: &Truth) -> Parts {
    let mut parts = Parts {
        mass: truth.mass_kg,
        stiffness: STIFFNESS_N_PER_M,
        damping: DAMPING_N_S_PER_M,
        cubic: 0.0,
        gap: 0.0,
        ripple: [0.0, 0.0, 1.0],
        friction: Vec::new(),
    };
    for effect in truth.effects {
        let p = &effect.values;
        match effect.kind {
            EffectKind::JointStiffness => parts.stiffness *= p[0],
            EffectKind::JointDamping => parts.damping *= p[0],
            EffectKind::JointCubicStiffness => parts.cubic = p[0],
            EffectKind::JointBacklash => parts.gap = p[0],
            EffectKind::JointRipple => parts.ripple = [p[0], p[1], p[2]],
            _ => parts.friction.push((effect.kind, p.clone())),
        }
    }
    parts
}

fn spring(parts: &Parts, given: &Given, x: f64, v: f64) -> f64 {
    let Given {
        mut motor, rate, ..
    } = *given;
    let [cosine, sine, cycles] = parts.ripple;
    if cosine != 0.0 || sine != 0.0 {
        motor += cosine * (cycles * motor).cos() + sine * (cycles * motor).sin();
    }
    let windup = motor - x;
    let wound = windup - windup.clamp(-0.5 * parts.gap, 0.5 * parts.gap);
    parts.stiffness * wound + parts.cubic * wound.powi(3) + parts.damping * (rate - v)
}

fn friction(parts: &Parts, x: f64, v: f64) -> f64 {
    if parts.friction.is_empty() {
        return 0.0;
    }
    let sign = (v / 1e-3).tanh();
    let (up, down) = (0.5 * (1.0 + sign), 0.5 * (1.0 - sign));
    let of = |(kind, p): &(EffectKind, Vec<f64>)| match kind {
        EffectKind::JointViscous => p[0] * v,
        EffectKind::JointCoulomb => p[0] * sign,
        EffectKind::JointAsymmetricViscous => (p[0] * up + p[1] * down) * v,
        EffectKind::JointAsymmetricCoulomb => p[0] * up - p[1] * down,
        EffectKind::JointStribeck => p[0] * sign * (-(v / p[1]).powi(2)).exp(),
        EffectKind::JointCounterbalance => -(p[0] * x.cos() + p[1] * x.sin()),
        EffectKind::JointOffset => -p[0],
        _ => 0.0,
    };
    parts.friction.iter().map(of).sum()
}

fn measure(columns: &mut Columns, effects: &[Effect]) {
    for effect in effects {
        let Target::Channel(name) = &effect.target else {
            continue;
        };
        let column = &mut columns[usize::from(name != "joint1.position")];
        let p = effect.values[0];
        match effect.kind {
            EffectKind::SensorGain => column.iter_mut().for_each(|y| *y *= p),
            EffectKind::SensorOffset => column.iter_mut().for_each(|y| *y += p),
            EffectKind::SensorDelay => {
                let at = |i: usize| {
                    let place = (i as f64 - p / INTERVAL_S).clamp(0.0, (column.len() - 1) as f64);
                    let (low, part) = (place.floor() as usize, place.fract());
                    column[low] * (1.0 - part) + column[(low + 1).min(column.len() - 1)] * part
                };
                *column = (0..column.len()).map(at).collect();
            }
            _ => unreachable!("not a sensor"),
        }
    }
}

impl Model for Slide {
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
        self.predict_experiment(&self.experiments()[0], nominal, effects)
    }

    fn experiments(&self) -> Vec<Experiment> {
        let push = |factor: &str| Experiment {
            description: format!("{factor} times the force on the link"),
            overrides: vec![("process.replay.force_scale".into(), factor.into())],
        };
        ["1.0", "0.5", "3.0"].into_iter().map(push).collect()
    }

    fn predict_experiment(
        &self,
        experiment: &Experiment,
        nominal: &[f64],
        effects: &[Effect],
    ) -> Result<Columns, PredictError> {
        let push: f64 = experiment.overrides[0].1.parse().unwrap();
        let truth = Truth {
            mass_kg: nominal[0],
            effects,
            extra_n: &|_, _, _| 0.0,
        };
        Ok(self.simulate(&truth, push))
    }
}
