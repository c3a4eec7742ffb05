//! Bounds of masses, inertias and distances: numbers beyond them are slips, and squares of them
//! overflow.

use nalgebra::Isometry3;

use crate::error::{ArmError, ArmErrorKind};
use crate::tree::Tree;

/// Lightest link that has a mass at all, kg.
const LIGHTEST_KG: f64 = 1e-9;
/// Heaviest link, kg.
const HEAVIEST_KG: f64 = 1e6;
/// Largest entry of an inertia tensor, kg m².
const LARGEST_INERTIA_KG_M2: f64 = 1e9;
/// Farthest that an origin may be from the frame it is given in, along each axis, m.
const FARTHEST_M: f64 = 1e4;

/// Refuses what no robot has.
pub(crate) fn check(tree: &Tree) -> Result<(), ArmError> {
    for (index, link) in tree.links.iter().enumerate() {
        if link.mass_kg < 0.0 {
            let kind = ArmErrorKind::NegativeMass {
                link: link.name.clone(),
                mass_kg: link.mass_kg,
            };
            return Err(tree.link_error(index, "mass", kind));
        }
        let kind = |quantity, value, rule| ArmErrorKind::OutOfBounds {
            owner: format!("link \"{}\"", link.name),
            quantity,
            value,
            rule,
        };
        let weighs = (LIGHTEST_KG..=HEAVIEST_KG).contains(&link.mass_kg);
        if link.mass_kg != 0.0 && !weighs {
            let kind = kind("mass", link.mass_kg, "0, or between 1e-9 and 1e6 kg");
            return Err(tree.link_error(index, "mass", kind));
        }
        let inertia = link.inertia_kg_m2.iter();
        if let Some(value) = inertia.copied().find(|i| i.abs() > LARGEST_INERTIA_KG_M2) {
            let kind = kind("an entry of the inertia", value, "within 1e9 kg m^2");
            return Err(tree.link_error(index, "inertia", kind));
        }
        if let Some(value) = too_far(&link.link_from_inertial) {
            let kind = kind("a coordinate of the inertial origin", value, "within 1e4 m");
            return Err(tree.link_error(index, "origin", kind));
        }
    }
    for (index, joint) in tree.joints.iter().enumerate() {
        if let Some(value) = too_far(&joint.parent_from_joint) {
            let kind = ArmErrorKind::OutOfBounds {
                owner: format!("joint \"{}\"", joint.name),
                quantity: "a coordinate of the origin",
                value,
                rule: "within 1e4 m",
            };
            return Err(tree.joint_error(index, "origin", kind));
        }
    }
    Ok(())
}

fn too_far(pose: &Isometry3<f64>) -> Option<f64> {
    let coordinates = pose.translation.vector;
    coordinates.iter().copied().find(|x| x.abs() > FARTHEST_M)
}
