//! What values of links and joints are refused: numbers that no robot has, and tensors that no body
//! has. On branches that the chain does not use they are told and left out.

use nalgebra::{Isometry3, Matrix3, SymmetricEigen};

use crate::error::{ArmError, ArmErrorKind};
use crate::tree::{Tree, TreeJoint, TreeLink};

/// Lightest link that has a mass at all, kg.
const LIGHTEST_KG: f64 = 1e-9;
/// Heaviest link, kg.
const HEAVIEST_KG: f64 = 1e6;
/// Largest entry of an inertia tensor, kg m².
const LARGEST_INERTIA_KG_M2: f64 = 1e9;
/// Farthest that an origin may be from the frame it is given in, along each axis, m.
const FARTHEST_M: f64 = 1e4;
/// Axes shorter than this count as zero.
const MIN_AXIS_LENGTH: f64 = 1e-9;
/// Share of the largest principal moment by which an inertia tensor may miss its rules; published
/// ones are rounded to six or seven digits.
const INERTIA_TOLERANCE: f64 = 1e-6;

/// Whether the links that move must have masses.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Masses {
    /// They must: what moves has inertia.
    #[default]
    Needed,
    /// They need not, and bad ones are told in a note: kinematics alone are asked for.
    NotNeeded,
}

/// An element and what is wrong with it.
type Found = (&'static str, ArmErrorKind);

/// Refuses faults of the joints `path` and of the links that they lead to. Those of other branches
/// are told in notes, and links with them count as without mass; so do all where masses are not
/// needed.
pub(crate) fn check(
    tree: &mut Tree,
    path: &[usize],
    masses: Masses,
) -> Result<Vec<String>, ArmError> {
    let mut notes = Vec::new();
    for index in 0..tree.joints.len() {
        let Some((element, kind)) = joint_fault(&tree.joints[index]) else {
            continue;
        };
        let is_misplaced = matches!(kind, ArmErrorKind::OutOfBounds { .. });
        if path.contains(&index) || is_misplaced {
            return Err(tree.joint_error(index, element, kind));
        }
        notes.push(format!("on a branch that the chain does not use: {kind}"));
    }
    let on_path: Vec<usize> = path.iter().map(|&j| tree.joints[j].child).collect();
    for index in 0..tree.links.len() {
        let link = &tree.links[index];
        let is_base = index == tree.root || !moves(tree, index);
        let tensor = || (!is_base).then(|| tensor_fault(link)).flatten();
        let Some((element, kind)) = link_fault(link).or_else(tensor) else {
            continue;
        };
        if masses == Masses::Needed && (on_path.contains(&index) || index == tree.root) {
            return Err(tree.link_error(index, element, kind));
        }
        notes.push(format!("{kind}; the link is taken as without mass"));
        let link = &mut tree.links[index];
        (link.mass_kg, link.inertia_kg_m2) = (0.0, Matrix3::zeros());
        link.link_from_inertial = Isometry3::identity();
    }
    Ok(notes)
}

/// Whether a joint above the link moves it.
fn moves(tree: &Tree, link: usize) -> bool {
    let mut at = link;
    while let Some(joint) = tree.links[at].parent_joint {
        if tree.joints[joint].moves() {
            return true;
        }
        at = tree.joints[joint].parent;
    }
    false
}

/// What is wrong with a link's mass, or the size of its inertia.
pub(crate) fn link_fault(link: &TreeLink) -> Option<Found> {
    if link.mass_kg < 0.0 {
        let kind = ArmErrorKind::NegativeMass {
            link: link.name.clone(),
            mass_kg: link.mass_kg,
        };
        return Some(("mass", kind));
    }
    let found = |element, quantity, value, rule| {
        let kind = ArmErrorKind::OutOfBounds {
            owner: format!("link \"{}\"", link.name),
            quantity,
            value,
            rule,
        };
        Some((element, kind))
    };
    let weighs = (LIGHTEST_KG..=HEAVIEST_KG).contains(&link.mass_kg);
    if link.mass_kg != 0.0 && !weighs {
        let rule = "0, or between 1e-9 and 1e6 kg";
        return found("mass", "mass", link.mass_kg, rule);
    }
    let inertia = link.inertia_kg_m2.iter();
    if let Some(value) = inertia.copied().find(|i| i.abs() > LARGEST_INERTIA_KG_M2) {
        let quantity = "an entry of the inertia";
        return found("inertia", quantity, value, "within 1e9 kg m^2");
    }
    let value = too_far(&link.link_from_inertial)?;
    let quantity = "a coordinate of the inertial origin";
    found("origin", quantity, value, "within 1e4 m")
}

/// The rules that every tensor in a moving body keeps: no negative principal moment, and none
/// larger than the sum of the other two.
pub(crate) fn tensor_fault(link: &TreeLink) -> Option<Found> {
    let eigen = SymmetricEigen::new(link.inertia_kg_m2).eigenvalues;
    let mut moments = [eigen[0], eigen[1], eigen[2]];
    moments.sort_by(f64::total_cmp);
    let [smallest, middle, largest] = moments;
    let tolerance = INERTIA_TOLERANCE * largest.abs().max(smallest.abs());
    let listed = format!("({smallest:.6e}, {middle:.6e}, {largest:.6e}) kg m^2");
    let kind = if smallest < -tolerance {
        ArmErrorKind::InertiaNotPositive {
            link: link.name.clone(),
            moments: listed,
        }
    } else if largest > smallest + middle + tolerance {
        ArmErrorKind::InertiaTriangle {
            link: link.name.clone(),
            moments: listed,
            largest,
            sum: smallest + middle,
        }
    } else {
        return None;
    };
    Some(("inertia", kind))
}

fn joint_fault(joint: &TreeJoint) -> Option<Found> {
    if let Some(value) = too_far(&joint.parent_from_joint) {
        let kind = ArmErrorKind::OutOfBounds {
            owner: format!("joint \"{}\"", joint.name),
            quantity: "a coordinate of the origin",
            value,
            rule: "within 1e4 m",
        };
        return Some(("origin", kind));
    }
    if !joint.moves() {
        return None;
    }
    let length = joint.axis.norm();
    if length < MIN_AXIS_LENGTH || !length.is_finite() {
        let kind = ArmErrorKind::ZeroAxis {
            joint: joint.name.clone(),
            length,
            limit: MIN_AXIS_LENGTH,
        };
        return Some(("axis", kind));
    }
    let mut amounts = vec![
        ("dynamics", "damping", joint.damping),
        ("dynamics", "friction", joint.friction),
    ];
    if let Some(limits) = joint.limits {
        if limits.lower > limits.upper {
            let kind = ArmErrorKind::LimitsReversed {
                joint: joint.name.clone(),
                lower: limits.lower,
                upper: limits.upper,
            };
            return Some(("limit", kind));
        }
        amounts.push(("limit", "velocity limit", limits.velocity));
        amounts.push(("limit", "effort limit", limits.effort));
    }
    let (element, quantity, value) = amounts.into_iter().find(|(.., value)| *value < 0.0)?;
    let kind = ArmErrorKind::NegativeJointValue {
        joint: joint.name.clone(),
        quantity,
        value,
    };
    Some((element, kind))
}

fn too_far(pose: &Isometry3<f64>) -> Option<f64> {
    let coordinates = pose.translation.vector;
    coordinates.iter().copied().find(|x| x.abs() > FARTHEST_M)
}
