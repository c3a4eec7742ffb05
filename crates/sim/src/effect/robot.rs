//! The robot as it really is: payload, compliant base, other transmissions.

use super::{Effects, Payload};
use crate::error::SimError;
use nalgebra::{Isometry3, Matrix3, Unit, Vector3};
use truecut_arm::{FrameId, Joint, JointKind, Link, MAX_JOINTS, Robot, Transmission};
use truecut_core::joint_law::{JointLaw, LinkFriction};

/// A robot with the effects of a scenario built in. Joints of the base come before those of the
/// arm.
pub(crate) struct Altered {
    pub robot: Robot,
    /// How many joints of the base there are.
    pub base_joints: usize,
    /// Of every joint.
    pub laws: Vec<JointLaw>,
    /// Of every joint, beyond `robot.toml`'s dry friction.
    pub friction: Vec<LinkFriction>,
}

/// Builds the effects into the nominal robot.
pub(crate) fn alter(nominal: &Robot, effects: &Effects) -> Result<Altered, SimError> {
    let mut robot = nominal.clone();
    for (joint, effect) in robot.chain.joints.iter_mut().zip(&effects.joints) {
        let t = &mut joint.transmission;
        if effect.stiffness_factor != 1.0 {
            t.stiffness = t.stiffness.map(|k| k * effect.stiffness_factor);
        }
        if effect.damping_factor != 1.0 {
            t.damping *= effect.damping_factor;
        }
    }
    build_in(&mut robot, effects)?;
    let base_joints = effects.base.len();
    if robot.dof() + base_joints > MAX_JOINTS {
        return Err(SimError::scenario(
            "effect",
            format!(
                "{} joints and {base_joints} tilts of the base are more than the {MAX_JOINTS} that a chain \
                 may have",
                robot.dof()
            ),
        ));
    }
    for (axis, compliance) in effects.base.iter().rev() {
        let (joint, link) = tilt(*axis, *compliance);
        robot.chain.joints.insert(0, joint);
        robot.chain.links.insert(0, link);
    }
    let base = std::iter::repeat_n(super::JointEffects::default(), base_joints);
    let all: Vec<_> = base.chain(effects.joints.iter().cloned()).collect();
    Ok(Altered {
        robot,
        base_joints,
        laws: all.iter().map(|joint| joint.law.clone()).collect(),
        friction: all.iter().map(|joint| joint.friction.clone()).collect(),
    })
}

/// Builds the arm as it stands: its payload, links as heavy and as long as they are with their
/// centres and rotors, and where the zeros of their joints leave them. Coordinates stay those
/// reported.
pub(crate) fn build_in(robot: &mut Robot, effects: &Effects) -> Result<(), SimError> {
    for (joint, effect) in robot.chain.joints.iter_mut().zip(&effects.joints) {
        if effect.zero != 0.0 {
            joint.shift_zero(effect.zero);
        }
        if effect.rotor != 0.0 {
            joint.transmission.rotor_inertia =
                rotor_with(joint, effect.rotor).map_err(|why| SimError::scenario("effect", why))?;
        }
    }
    for (link, effect) in robot.chain.links.iter_mut().zip(&effects.joints) {
        if effect.mass_factor != 1.0 {
            link.mass_kg *= effect.mass_factor;
            link.inertia_about_com_kg_m2 *= effect.mass_factor;
        }
        if effect.center_m != Vector3::zeros() {
            link.com_m += effect.center_m;
        }
    }
    let carried = robot.chain.joints.iter_mut().skip(1);
    let carried = carried.map(|joint| &mut joint.parent_from_joint);
    let carried = carried.chain([&mut robot.frames.last_link_from_flange]);
    for (place, effect) in carried.zip(&effects.joints) {
        place.translation.vector += effect.carried_m;
    }
    match &effects.payload {
        Some(payload) => add_payload(robot, payload),
        None => Ok(()),
    }
}

/// A joint's rotor that is heavier than its file says, kg m² (kg); why not, if it cannot be.
pub(super) fn rotor_with(joint: &Joint, more: f64) -> Result<f64, String> {
    let of_file = joint.transmission.rotor_inertia;
    let sum = of_file + more;
    if sum >= 0.0 {
        return Ok(sum);
    }
    let unit = match joint.kind {
        JointKind::Revolute => "kg m²",
        JointKind::Prismatic => "kg",
    };
    Err(format!(
        "a rotor of {more} {unit} beyond the {of_file} {unit} of joint `{}` leaves it {sum} {unit}; it must \
         not be negative",
        joint.name
    ))
}

/// A massless link that turns about a world axis through the world's origin, on a spring.
fn tilt(axis: usize, compliance_rad_per_n_m: f64) -> (Joint, Link) {
    let name = ["base_tilt_x", "base_tilt_y", "base_tilt_z"][axis.min(2)];
    let mut direction = Vector3::zeros();
    direction[axis.min(2)] = 1.0;
    let joint = Joint {
        name: name.into(),
        kind: JointKind::Revolute,
        parent_from_joint: Isometry3::identity(),
        axis: Unit::new_normalize(direction),
        limits: None,
        transmission: Transmission {
            stiffness: Some(1.0 / compliance_rad_per_n_m),
            ..Transmission::default()
        },
        urdf_damping: 0.0,
        urdf_friction: 0.0,
    };
    let link = Link {
        name: name.into(),
        mass_kg: 0.0,
        com_m: Vector3::zeros(),
        inertia_about_com_kg_m2: Matrix3::zeros(),
        visuals: Vec::new(),
        meshes: Vec::new(),
        solids: Default::default(),
    };
    (joint, link)
}

/// Inertia of a point mass about the origin of its lever, kg m².
pub(crate) fn point_inertia(mass_kg: f64, lever_m: &Vector3<f64>) -> Matrix3<f64> {
    (Matrix3::identity() * lever_m.norm_squared() - lever_m * lever_m.transpose()) * mass_kg
}

/// Merges a point mass with the last link.
fn add_payload(robot: &mut Robot, payload: &Payload) -> Result<(), SimError> {
    let flange = robot.last_link_from_frame(FrameId::Flange);
    let at = (flange * nalgebra::Point3::from(payload.flange_from_center_m)).coords;
    let Some(link) = robot.chain.links.last_mut() else {
        return Ok(());
    };
    let mass = link.mass_kg + payload.mass_kg;
    let refuse = |what: String| {
        Err(SimError::scenario(
            "effect",
            format!(
                "a payload of {} kg leaves link `{}` {what}",
                payload.mass_kg, link.name
            ),
        ))
    };
    if mass <= 0.0 {
        return refuse(format!("a mass of {mass} kg; it must be positive"));
    }
    let center = (link.com_m * link.mass_kg + at * payload.mass_kg) / mass;
    let inertia = link.inertia_about_com_kg_m2
        + point_inertia(link.mass_kg, &(link.com_m - center))
        + point_inertia(payload.mass_kg, &(at - center));
    let least = inertia.symmetric_eigenvalues().min();
    if least < 0.0 {
        return refuse(format!(
            "an inertia of {least} kg m²; it must not be negative"
        ));
    }
    link.mass_kg = mass;
    link.com_m = center;
    link.inertia_about_com_kg_m2 = inertia;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Merging is summing: mass, first and second moment about the link's origin.
    #[test]
    fn verify_a_payload_adds_its_moments_of_mass() {
        let urdf = std::path::Path::new(env!("CARGO_MANIFEST_DIR"))
            .join("../../assets/robots/irb6600_175_255/robot.urdf");
        let nominal = Robot::load(&urdf, None, None).expect("asset");
        let payload = Payload {
            mass_kg: 35.0,
            flange_from_center_m: Vector3::new(0.05, -0.02, 0.2),
        };
        let mut loaded = nominal.clone();
        add_payload(&mut loaded, &payload).expect("a payload");
        let flange = nominal.last_link_from_frame(FrameId::Flange);
        let at = (flange * nalgebra::Point3::from(payload.flange_from_center_m)).coords;
        let about_origin =
            |link: &Link| link.inertia_about_com_kg_m2 + point_inertia(link.mass_kg, &link.com_m);
        let (before, after) = (&nominal.chain.links[5], &loaded.chain.links[5]);
        assert_eq!(after.mass_kg, before.mass_kg + 35.0);
        let first = after.com_m * after.mass_kg - before.com_m * before.mass_kg;
        assert!((first - at * 35.0).norm() < 1e-12);
        let second = about_origin(after) - about_origin(before);
        assert!((second - point_inertia(35.0, &at)).norm() < 1e-12);
    }

    /// A link of another mass is the one whose mass a scenario's `[[robot.link]]` changes: mass and
    /// inertia about the centre grow alike, nothing else does.
    #[test]
    fn verify_a_link_of_another_mass() {
        let urdf = std::path::Path::new(env!("CARGO_MANIFEST_DIR"))
            .join("../../assets/robots/irb6600_175_255/robot.urdf");
        let nominal = Robot::load(&urdf, None, None).expect("asset");
        let mut effects = Effects {
            joints: vec![super::super::JointEffects::default(); nominal.dof()],
            ..Effects::default()
        };
        effects.joints[2].mass_factor = 1.3;
        let mut altered = nominal.clone();
        build_in(&mut altered, &effects).expect("a link");
        for (at, (before, after)) in nominal
            .chain
            .links
            .iter()
            .zip(&altered.chain.links)
            .enumerate()
        {
            let factor = if at == 2 { 1.3 } else { 1.0 };
            assert_eq!(after.mass_kg, before.mass_kg * factor);
            assert_eq!(after.com_m, before.com_m);
            let inertia = before.inertia_about_com_kg_m2 * factor;
            assert_eq!(after.inertia_about_com_kg_m2, inertia);
        }
    }
}
