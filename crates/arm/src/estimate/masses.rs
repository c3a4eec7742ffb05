//! A total mass, spread over the links.

use std::path::Path;

use nalgebra::{Isometry3, Matrix3, Vector3};

use super::volume::{Body, of_meshes};
use crate::packages::Packages;
use crate::tree::Tree;

/// Diameter of a link that nothing else is known of: a part of the reach, and of what lies beyond
/// it.
const DIAMETER_PER_REACH: f64 = 0.06;
const DIAMETER_PER_REST: f64 = 0.08;

/// Mass, centre and inertia of a link as they are estimated.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct LinkMass {
    pub(super) link: String,
    pub(super) mass_kg: f64,
    pub(super) center_m: Vector3<f64>,
    pub(super) inertia_kg_m2: Matrix3<f64>,
    pub(super) rule: MassRule,
}

/// How a link's mass is found.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum MassRule {
    /// By the volume within its mesh.
    Mesh,
    /// By a cylinder to the next joint.
    Cylinder,
    /// It counts as part of what it is fixed to.
    Part,
}

/// Spreads `mass_kg` over the base and the links that the joints `path` move, by volume: that of
/// their meshes if every one of them has closed ones, else that of cylinders from joint to joint.
/// Every other link of the tree counts as part of what it is fixed to.
pub(super) fn spread(
    tree: &Tree,
    path: &[usize],
    mass_kg: f64,
    urdf: &Path,
    packages: &Packages,
) -> Vec<LinkMass> {
    let segments = segments(tree, path);
    let folder = urdf.parent().unwrap_or(Path::new("."));
    let by_mesh: Option<Vec<Body>> = (segments.iter())
        .map(|segment| {
            let mut bodies = segment.links.iter();
            bodies.find_map(|&link| of_meshes(&tree.links[link].meshes, folder, packages))
        })
        .collect();
    let is_mesh = by_mesh.is_some();
    let bodies = by_mesh.unwrap_or_else(|| cylinders(&segments));
    let volume_m3: f64 = bodies.iter().map(|body| body.volume_m3).sum();
    let of_segment = |(segment, body): (&Segment, &Body)| {
        let own_kg = mass_kg * body.volume_m3 / volume_m3;
        let holder = if is_mesh {
            let has_mesh = |link: &&usize| !tree.links[**link].meshes.is_empty();
            segment
                .links
                .iter()
                .find(has_mesh)
                .unwrap_or(&segment.links[0])
        } else {
            &segment.links[0]
        };
        LinkMass {
            link: tree.links[*holder].name.clone(),
            mass_kg: own_kg,
            center_m: body.center_m(),
            inertia_kg_m2: body.inertia_kg_m2(own_kg),
            rule: if is_mesh {
                MassRule::Mesh
            } else {
                MassRule::Cylinder
            },
        }
    };
    let mut all: Vec<LinkMass> = segments.iter().zip(&bodies).map(of_segment).collect();
    let is_other = |name: &str| all.iter().all(|mass| mass.link != name);
    let others = tree.links.iter();
    let others = others.filter(|link| link.mass_kg != 0.0 && is_other(&link.name));
    let others: Vec<LinkMass> = others
        .map(|link| LinkMass {
            link: link.name.clone(),
            mass_kg: 0.0,
            center_m: Vector3::zeros(),
            inertia_kg_m2: Matrix3::zeros(),
            rule: MassRule::Part,
        })
        .collect();
    all.extend(others);
    all
}

/// Tells the masses of the file in whose place others are entered.
pub(super) fn unused(tree: &Tree, mass_kg: f64) -> Option<String> {
    let with_mass = tree.links.iter().filter(|link| link.mass_kg > 0.0);
    let of_file: Vec<String> = with_mass
        .map(|link| format!("{} ({:.4} kg)", link.name, link.mass_kg))
        .collect();
    (!of_file.is_empty()).then(|| {
        format!(
            "--mass spreads {mass_kg} kg over all links, so that masses and inertias of the file are not used: {}; \
             put those that are known into [[link]], or leave --mass out",
            of_file.join(", ")
        )
    })
}

/// Enters the masses in place of all that the file gives.
pub(super) fn enter(tree: &mut Tree, masses: &[LinkMass]) {
    for link in &mut tree.links {
        link.mass_kg = 0.0;
        link.inertia_kg_m2 = Matrix3::zeros();
        link.link_from_inertial = Isometry3::identity();
        if let Some(own) = masses.iter().find(|mass| mass.link == link.name) {
            link.mass_kg = own.mass_kg;
            link.inertia_kg_m2 = own.inertia_kg_m2;
            link.link_from_inertial =
                Isometry3::from_parts(own.center_m.into(), nalgebra::UnitQuaternion::identity());
        }
    }
}

/// Links on the chain that move as one.
struct Segment {
    /// The first carries the frame of the joint that moves them.
    links: Vec<usize>,
    /// The next joint, or the flange, in the frame of the first link.
    to_next_m: Vector3<f64>,
}

fn segments(tree: &Tree, path: &[usize]) -> Vec<Segment> {
    let mut segments = Vec::new();
    let mut open = Segment {
        links: vec![tree.root],
        to_next_m: Vector3::zeros(),
    };
    let mut pose = Isometry3::identity();
    for &j in path {
        let joint = &tree.joints[j];
        pose *= joint.parent_from_joint;
        open.to_next_m = pose.translation.vector;
        if joint.moves() {
            let next = Segment {
                links: Vec::new(),
                to_next_m: Vector3::zeros(),
            };
            segments.push(std::mem::replace(&mut open, next));
            pose = Isometry3::identity();
        }
        open.links.push(joint.child);
    }
    segments.push(open);
    segments
}

/// A cylinder for each: from its joint to the next, longer by its own diameter for the joints' own
/// housings, thinner towards the flange.
fn cylinders(segments: &[Segment]) -> Vec<Body> {
    let reach: f64 = segments[1..].iter().map(|s| s.to_next_m.norm()).sum();
    let reach = reach.max(1e-3);
    let mut rest = reach;
    let of = |segment: &Segment, rest: f64| {
        let length = segment.to_next_m.norm();
        let diameter = DIAMETER_PER_REACH * reach + DIAMETER_PER_REST * rest;
        let along = if length > 1e-9 {
            segment.to_next_m / length
        } else {
            Vector3::z()
        };
        let (from, to) = (along * (-0.5 * diameter), along * (length + 0.5 * diameter));
        (Body::cylinder(from, to, diameter), length)
    };
    let mut bodies = Vec::new();
    for (index, segment) in segments.iter().enumerate() {
        let (body, length) = of(segment, rest);
        if index > 0 {
            rest = (rest - length).max(0.0);
        }
        bodies.push(body);
    }
    bodies
}
