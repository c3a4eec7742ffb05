//! Drive forces per unit of each unknown.

use nalgebra::Matrix3;
use rayon::prelude::*;
use truecut_scenario::effect::{Effect, EffectKind, Target};
use truecut_scenario::{CoupledMotor, FitSpec, Scenario, Unknown};
use truecut_sim::facts::robot_facts;
use truecut_sim::{InverseModel, SimError};

use crate::trial::parallel::picked;

/// One unknown.
#[derive(Debug, Clone)]
pub(crate) struct Column {
    pub name: String,
    pub unit: &'static str,
    /// What the scenario has.
    pub nominal: f64,
    /// Whether it is dry friction, which gives anything up to its size at rest.
    pub is_dry: bool,
    /// What the parameter is, if no machine has less than nothing of it.
    pub never_negative: Option<&'static str>,
    /// `[channel][sample]`, filtered and thinned.
    pub values: Vec<Vec<f64>>,
}

/// Inertial parameters of a body about the origin of its link, in the link's axes.
const INERTIAL: [(&str, &str); 10] = [
    ("mass", "kg"),
    ("m x", "kg m"),
    ("m y", "kg m"),
    ("m z", "kg m"),
    ("I xx", "kg m^2"),
    ("I yy", "kg m^2"),
    ("I zz", "kg m^2"),
    ("I xy", "kg m^2"),
    ("I xz", "kg m^2"),
    ("I yz", "kg m^2"),
];

/// Columns of all unknowns that the fit asks for, every so many-th sample.
///
/// # Errors
/// A joint that the chain lacks, or whose drive force was not measured.
pub(crate) fn columns(
    scenario: &Scenario,
    model: &InverseModel,
    spec: &FitSpec,
    every: usize,
) -> Result<Vec<Column>, SimError> {
    let builder = Builder {
        scenario,
        model,
        every,
        without: model.predict(&[])?,
        rotary: (robot_facts(scenario)?.joints.iter())
            .map(|joint| joint.rotary)
            .collect(),
    };
    let joints = match &spec.joints {
        Some(joints) => joints.clone(),
        None => model.joints().to_vec(),
    };
    builder.check("fit.joints", &joints)?;
    let mut all = Vec::new();
    for unknown in &spec.unknowns {
        match unknown {
            Unknown::Links => {
                let links = (0..model.robot().dof()).into_par_iter();
                let each: Vec<Vec<Column>> = links
                    .map(|link| builder.link(link, &format!("link {}", link + 1)))
                    .collect();
                all.extend(each.into_iter().flatten());
            }
            Unknown::Payload => {
                all.extend(builder.link(model.robot().dof() - 1, "payload"));
            }
            Unknown::Rotors => all.extend(joints.iter().map(|joint| builder.rotor(*joint))),
            Unknown::Viscous => builder.friction(EffectKind::JointViscous, &joints, &mut all)?,
            Unknown::Coulomb => builder.friction(EffectKind::JointCoulomb, &joints, &mut all)?,
            Unknown::Offset => builder.friction(EffectKind::JointOffset, &joints, &mut all)?,
        }
    }
    for (index, motor) in spec.coupled_motors.iter().enumerate() {
        builder.check(&format!("fit.coupled_motor.{index}.joints"), &motor.joints)?;
        all.extend(builder.coupled(motor));
    }
    Ok(all)
}

struct Builder<'a> {
    scenario: &'a Scenario,
    model: &'a InverseModel,
    every: usize,
    /// Drive forces of the scenario as it is.
    without: Vec<Vec<f64>>,
    rotary: Vec<bool>,
}

impl Builder<'_> {
    fn check(&self, key: &str, joints: &[usize]) -> Result<(), SimError> {
        let known = self.model.joints();
        match joints.iter().find(|joint| !known.contains(joint)) {
            None => Ok(()),
            Some(joint) => {
                let known: Vec<String> = known.iter().map(|one| (one + 1).to_string()).collect();
                let message = format!(
                    "`{key}` holds joint {}, but drive forces were measured of {}",
                    joint + 1,
                    known.join(", ")
                );
                Err(SimError::scenario(key, message))
            }
        }
    }

    fn column(&self, name: String, unit: &'static str, values: Vec<Vec<f64>>) -> Column {
        Column {
            name,
            unit,
            nominal: 0.0,
            is_dry: false,
            never_negative: None,
            values: (values.iter())
                .map(|values| picked(values, self.every))
                .collect(),
        }
    }

    /// A drive force of one channel, not yet filtered.
    fn of_joint(&self, joint: usize, force: &[f64]) -> Vec<Vec<f64>> {
        let of = |other: &usize| match *other == joint {
            true => self.model.filtered(force),
            false => vec![0.0; force.len()],
        };
        self.model.joints().iter().map(of).collect()
    }

    fn link(&self, link: usize, name: &str) -> Vec<Column> {
        let body = &self.model.robot().chain.links[link];
        let (m, c) = (body.mass_kg, body.com_m);
        let about_origin: Matrix3<f64> = body.inertia_about_com_kg_m2
            + (Matrix3::identity() * c.norm_squared() - c * c.transpose()) * m;
        let i = |a, b| about_origin[(a, b)];
        let (x, y, z) = (m * c.x, m * c.y, m * c.z);
        let inertia = [i(0, 0), i(1, 1), i(2, 2), i(0, 1), i(0, 2), i(1, 2)];
        let nominal = [m, x, y, z].into_iter().chain(inertia);
        let columns = self.model.inertial_columns(link).into_iter();
        (INERTIAL.iter().zip(columns).zip(nominal))
            .map(|(((parameter, unit), values), nominal)| Column {
                nominal: if name == "payload" { 0.0 } else { nominal },
                ..self.column(format!("{name} {parameter}"), unit, values)
            })
            .collect()
    }

    fn rotor(&self, joint: usize) -> Column {
        let unit = if self.rotary[joint] { "kg m^2" } else { "kg" };
        let values = self.of_joint(joint, self.model.acceleration(joint));
        Column {
            nominal: (self.model.robot().chain.joints[joint].transmission).rotor_inertia,
            never_negative: Some("a rotor's inertia"),
            ..self.column(format!("rotor {}", joint + 1), unit, values)
        }
    }

    /// What one unit more of an effect does on each of the joints.
    fn friction(
        &self,
        kind: EffectKind,
        joints: &[usize],
        all: &mut Vec<Column>,
    ) -> Result<(), SimError> {
        let info = &kind.parameters()[0];
        for &joint in joints {
            let target = Target::Joint(joint);
            let own = |effect: &&Effect| effect.kind == kind && effect.target == target;
            let own = self.scenario.effects.iter().find(own);
            let nominal = own.map_or(0.0, |effect| effect.values[0]);
            let more = Effect {
                kind,
                target,
                values: vec![nominal + 1.0],
            };
            let mut values = self.model.predict(&[more])?;
            for (values, without) in values.iter_mut().zip(&self.without) {
                values.iter_mut().zip(without).for_each(|(a, b)| *a -= b);
            }
            let is_dry = kind == EffectKind::JointCoulomb;
            let chain = &self.model.robot().chain.joints[joint];
            let built_in = if is_dry {
                chain.transmission.dry_friction
            } else {
                0.0
            };
            let unit = if self.rotary[joint] {
                info.rotary_unit
            } else {
                info.unit
            };
            let what = kind.name().trim_start_matches("joint_");
            all.push(Column {
                nominal: nominal + built_in,
                is_dry,
                never_negative: match kind {
                    EffectKind::JointViscous => Some("viscous friction"),
                    EffectKind::JointCoulomb => Some("dry friction"),
                    _ => None,
                },
                ..self.column(format!("{what} {}", joint + 1), unit.symbol(), values)
            });
        }
        Ok(())
    }

    /// Inertia, viscous and dry friction of a motor that turns with several joints. What it does to
    /// each joint by that joint's own motion is in the joint's own rotor and viscous friction.
    fn coupled(&self, motor: &CoupledMotor) -> [Column; 3] {
        let joints: Vec<String> = motor
            .joints
            .iter()
            .map(|one| (one + 1).to_string())
            .collect();
        let name = |what: &str| format!("{what} of the motor of {}", joints.join(" and "));
        let turning = |rate: &dyn Fn(usize) -> Vec<f64>, without: Option<usize>| -> Vec<f64> {
            let mut sum = vec![0.0; self.without[0].len()];
            for (joint, ratio) in motor.joints.iter().zip(&motor.ratios) {
                if without != Some(*joint) {
                    sum.iter_mut()
                        .zip(rate(*joint))
                        .for_each(|(s, x)| *s += ratio * x);
                }
            }
            sum
        };
        let velocity = |joint: usize| self.model.velocity(joint).to_vec();
        let acceleration = |joint: usize| self.model.acceleration(joint).to_vec();
        let on_joints = |force: &dyn Fn(usize) -> Vec<f64>| -> Vec<Vec<f64>> {
            let ratio = |joint: usize| {
                let at = motor.joints.iter().position(|one| *one == joint);
                at.map_or(0.0, |at| motor.ratios[at])
            };
            (self.model.joints().iter())
                .map(|&joint| match ratio(joint) {
                    0.0 => vec![0.0; self.without[0].len()],
                    ratio => {
                        let scaled: Vec<f64> = force(joint).iter().map(|x| ratio * x).collect();
                        self.model.filtered(&scaled)
                    }
                })
                .collect()
        };
        let sign = |x: f64| if x == 0.0 { 0.0 } else { x.signum() };
        let dry = |_: usize| turning(&velocity, None).into_iter().map(sign).collect();
        let rotary = self.rotary[motor.joints[0]];
        let [inertia, viscous, force] = match rotary {
            true => ["kg m^2", "N m s/rad", "N m"],
            false => ["kg", "N s/m", "N"],
        };
        [
            self.column(
                name("inertia"),
                inertia,
                on_joints(&|joint| turning(&acceleration, Some(joint))),
            ),
            self.column(
                name("viscous friction"),
                viscous,
                on_joints(&|joint| turning(&velocity, Some(joint))),
            ),
            Column {
                is_dry: true,
                ..self.column(name("dry friction"), force, on_joints(&dry))
            },
        ]
    }
}
