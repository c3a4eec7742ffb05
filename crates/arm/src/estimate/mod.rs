//! A `robot.toml` for an arm of which only a data sheet is known: masses, transmissions and servos
//! by stated rules, each value with its rule and the interval in which it is expected.
//!
//! Rules and their sources stand in `docs/physics/estimates.md`.

mod limits;
mod masses;
mod plausible;
mod text;
mod volume;

use std::collections::BTreeMap;
use std::path::Path;

use nalgebra::Isometry3;

use crate::bounds::Masses;
use crate::doubts;
use crate::error::{ArmError, ArmErrorKind};
use crate::load::Source;
use crate::merge::{joints_to, to_chain};
use crate::modal::Modes;
use crate::model::{Chain, JointKind, Robot};
use crate::packages::Packages;
use limits::LimitRule;
use masses::{LinkMass, MassRule};
pub(crate) use plausible::short;

/// What a data sheet says.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DataSheet {
    /// The arm with its base, kg; `None` leaves the URDF's masses.
    pub mass_kg: Option<f64>,
    /// What the arm may carry, kg.
    pub payload_kg: f64,
    /// How far from the first axis the arm reaches, m; held against the chain.
    pub reach_m: Option<f64>,
    /// Pose repeatability (ISO 9283), mm.
    pub repeatability_mm: Option<f64>,
}

/// What comes of a data sheet.
#[derive(Debug, Clone, PartialEq)]
pub struct Estimated {
    /// A `robot.toml`.
    pub text: String,
    /// What is rare in the data sheet, and what of the robot's file was not used.
    pub notes: Vec<String>,
}

/// Stiffness of a joint over the torque that it is sized for, 1/rad (1/m for a slide).
const STIFFNESS_PER_TORQUE: f64 = 450.0;
/// The same of a rotary joint that gravity cannot load, since its axis is always vertical: it is
/// measured at less than half of what such a torque would ask for.
const STIFFNESS_PER_TORQUE_UPRIGHT: f64 = 200.0;
const STIFFNESS_PER_FORCE: f64 = 1e4;
/// By how much a vertical axis may lean, as files write it, rad.
const UPRIGHT_RAD: f64 = 1e-3;
/// Inertia of motor and gear on the joint side over that torque, s².
const ROTOR_PER_TORQUE: f64 = 0.02;
/// Largest torque of a drive over that torque.
const LIMIT_PER_TORQUE: f64 = 2.0;
/// How far a payload's centre stands off the flange, as a part of the reach.
const STAND_OFF: f64 = 0.1;
/// Bandwidth of the velocity loop on the rotor, rad/s; the position loop has a tenth of it.
const VELOCITY_LOOP_RAD_S: f64 = 200.0;
/// Damping ratio of the modes.
const MODE_DAMPING: f64 = 0.02;
/// Factors by which a value may be off to both sides.
pub(crate) const STIFFNESS_FACTOR: f64 = 2.5;
const MASS_FACTOR: f64 = 3.0;
const ROTOR_FACTOR: f64 = 2.5;

/// A joint as it is estimated, in its own units.
#[derive(Debug, Clone, Copy, PartialEq)]
struct JointEstimate {
    /// Over the torque or force that the joint is sized for.
    stiffness_per_torque: f64,
    stiffness: f64,
    rotor_inertia: f64,
    velocity_gain: f64,
    torque_limit: f64,
    limit: LimitRule,
}

/// A `robot.toml` for the robot at `urdf`.
///
/// # Errors
/// Whatever is wrong with the robot's file; masses that are neither there nor given; a data sheet
/// that no arm of this reach has.
pub fn robot_toml(
    urdf: &Path,
    tip: Option<&str>,
    packages: &Packages,
    arguments: &BTreeMap<String, String>,
    sheet: DataSheet,
) -> Result<Estimated, ArmError> {
    check(&sheet)?;
    let source = Source::read(urdf, packages, arguments)?;
    let (mut tree, tip_link) = source.tree(urdf, tip)?;
    let path = joints_to(&tree, tip_link);
    let mut given = Vec::new();
    let mut unused = None;
    if let Some(mass_kg) = sheet.mass_kg {
        unused = masses::unused(&tree, mass_kg);
        given = masses::spread(&tree, &path, mass_kg, urdf, packages);
        masses::enter(&mut tree, &given);
        tree.is_of_sheet = true;
    }
    let (chain, flange) = to_chain(&mut tree, tip_link, Masses::Needed)
        .map_err(|error| source.at_origin(urdf, needs_mass(error, &sheet)))?;
    let lengths = Lengths::of(&chain, flange.translation.vector.norm());
    let mut notes = plausible::notes(&chain, &lengths, &sheet)?;
    let mut joints: Vec<JointEstimate> = (0..chain.joints.len())
        .map(|index| joint_estimate(&chain, &lengths, index, sheet.payload_kg))
        .collect();
    let draft = text::write(&chain, &sheet, &given, &joints, None);
    let settings = Some((draft.as_str(), Path::new("robot.toml")));
    let robot = Robot::from_texts((source.text(), urdf), settings, tip)
        .map_err(|error| source.at_origin(urdf, error))?;
    // What speaks against the file itself: lengths and angles in other units, a flange across the
    // wrist.
    notes.append(&mut tree.doubts);
    notes.extend(unused);
    notes.extend(doubts::of_geometry(&robot.chain, &robot.frames));
    let sized = |index| design_torque(&chain, &lengths, index, sheet.payload_kg);
    notes.extend(limits::replace_weak(
        &robot,
        sheet.payload_kg,
        sized,
        &mut joints,
    ));
    let modes = robot.modes(&robot.default_posture(), None)?;
    let model = Draft {
        first_hz: modes.frequency_hz[0],
        damping_s: damping_s(&modes, &joints),
        softest_n_per_m: robot.softest_n_per_m(&robot.default_posture()),
    };
    let text = text::write(&chain, &sheet, &given, &joints, Some(&model));
    Ok(Estimated { text, notes })
}

/// What the estimated arm is like at its default posture.
struct Draft {
    first_hz: f64,
    /// Damping over stiffness of each joint, s.
    damping_s: Vec<f64>,
    /// At the tool, in its softest direction.
    softest_n_per_m: Option<f64>,
}

/// Damping over stiffness of each joint so that modes are damped by [`MODE_DAMPING`]: 2ζ/ω,
/// averaged over the modes by their parts of the joint's compliance, Σ φ²/ω² = 1/k. One ratio of
/// damping to stiffness for all joints would damp a wrist of little mass, whose mode is a hundred
/// times as fast as the first, by more than 100 %.
fn damping_s(modes: &Modes, joints: &[JointEstimate]) -> Vec<f64> {
    let of_joint = |(at, joint): (usize, &JointEstimate)| {
        let parts = modes.frequency_hz.iter().enumerate().map(|(mode, hz)| {
            let omega = std::f64::consts::TAU * hz;
            let part = joint.stiffness * (modes.shapes[(at, mode)] / omega).powi(2);
            2.0 * MODE_DAMPING / omega * part
        });
        parts.sum()
    };
    joints.iter().enumerate().map(of_joint).collect()
}

fn check(sheet: &DataSheet) -> Result<(), ArmError> {
    let positive = [
        ("--mass", sheet.mass_kg),
        ("--payload", Some(sheet.payload_kg)),
        ("--reach", sheet.reach_m),
        ("--repeatability", sheet.repeatability_mm),
    ];
    for (quantity, value) in positive {
        if let Some(value) = value
            && !(value.is_finite() && value > 0.0)
        {
            let rule = "above 0";
            return Err(ArmErrorKind::Argument {
                quantity,
                value,
                rule,
            }
            .into());
        }
    }
    if let Some(mass_kg) = sheet.mass_kg
        && sheet.payload_kg > mass_kg
    {
        let kind = ArmErrorKind::Argument {
            quantity: "--payload",
            value: sheet.payload_kg,
            rule: "at most the mass of the arm: no arm carries more than it weighs",
        };
        return Err(kind.into());
    }
    Ok(())
}

/// What to do where masses are missing and were not given.
fn needs_mass(error: ArmError, sheet: &DataSheet) -> ArmError {
    match (error.kind(), sheet.mass_kg) {
        (ArmErrorKind::MasslessMovingLink { link, .. }, None) => {
            let link = link.clone();
            ArmErrorKind::MassNotGiven { link }.into()
        }
        _ => error,
    }
}

/// Distances along the stretched arm, m.
struct Lengths {
    /// From the joint of each link that moves to the next, the last one's to the flange.
    to_next: Vec<f64>,
    /// From the first joint to the flange.
    reach: f64,
}

impl Lengths {
    fn of(chain: &Chain, last_to_flange: f64) -> Lengths {
        let offsets = chain.moving().skip(1);
        let offsets = offsets.map(|body| body.parent_from_joint.translation.vector.norm());
        let to_next: Vec<f64> = offsets.chain([last_to_flange]).collect();
        let reach = to_next.iter().sum::<f64>().max(1e-3);
        Lengths { to_next, reach }
    }

    fn between(&self, from: usize, to: usize) -> f64 {
        self.to_next[from..to].iter().sum()
    }
}

/// The torque that gravity asks of a joint with the arm stretched out level and the payload on it;
/// drives and reducers are chosen by it.
fn design_torque(chain: &Chain, lengths: &Lengths, joint: usize, payload_kg: f64) -> f64 {
    let count = lengths.to_next.len();
    let is_slide = chain.joints[joint].kind == JointKind::Prismatic;
    let lever = |length: f64| if is_slide { 1.0 } else { length };
    // Followers before the joint are links that it does not carry.
    let before = |follower: &&crate::moving::Follower| follower.after <= joint;
    let first = joint + chain.followers.iter().filter(before).count();
    let links = chain.moving().enumerate().skip(first).map(|(at, body)| {
        let link = body.link;
        link.mass_kg * lever(lengths.between(first, at) + link.com_m.norm())
    });
    let payload = payload_kg * lever(lengths.between(first, count) + STAND_OFF * lengths.reach);
    9.81 * (links.sum::<f64>() + payload)
}

/// Whether a rotary joint's axis is vertical in all postures: itself, and those of all rotary ones
/// before it.
fn is_upright(chain: &Chain, joint: usize) -> bool {
    let zero = vec![0.0; chain.joints.len()];
    let mut world_from_link = Isometry3::identity();
    for body in chain.moving() {
        world_from_link *= body.parent_from_link(&zero);
        let axis = world_from_link * body.axis.into_inner();
        let turns = body.kind == JointKind::Revolute;
        if turns && axis.x.hypot(axis.y) > UPRIGHT_RAD {
            return false;
        }
        if body.joint == chain.joints[joint].name {
            return true;
        }
    }
    false
}

fn joint_estimate(
    chain: &Chain,
    lengths: &Lengths,
    joint: usize,
    payload_kg: f64,
) -> JointEstimate {
    let torque = design_torque(chain, lengths, joint, payload_kg);
    let per_torque = match chain.joints[joint].kind {
        JointKind::Revolute if is_upright(chain, joint) => STIFFNESS_PER_TORQUE_UPRIGHT,
        JointKind::Revolute => STIFFNESS_PER_TORQUE,
        JointKind::Prismatic => STIFFNESS_PER_FORCE,
    };
    let rotor_inertia = ROTOR_PER_TORQUE * torque;
    let effort = chain.joints[joint].limits.map(|limits| limits.effort);
    let (torque_limit, limit) = limits::limit(effort, torque);
    JointEstimate {
        stiffness_per_torque: per_torque,
        stiffness: per_torque * torque,
        rotor_inertia,
        velocity_gain: VELOCITY_LOOP_RAD_S * rotor_inertia,
        torque_limit,
        limit,
    }
}
