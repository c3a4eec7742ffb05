//! A URDF as a checked tree of links and joints.

use std::collections::HashMap;
use std::path::Path;

use nalgebra::{Matrix3, Vector3};
use urdf_rs::JointType;

use crate::doubts;
use crate::error::{ArmError, ArmErrorKind};
use crate::meshes;
use crate::model::{Limits, Solids};
use crate::tree::{Freedom, Mimic, Tree, TreeJoint, TreeLink};
use crate::undrawn;
use crate::visual::{Palette, color, palette, pose, visual};
use crate::xml::{ElementLines, UrdfLines, scan};

/// Reads `text` as the URDF at `path` and checks what does not depend on the choice of a tip.
pub(crate) fn read_tree(text: &str, path: &Path) -> Result<Tree, ArmError> {
    let (text, notes) = undrawn::taken_out(text);
    let (meshes, solids) = meshes::references(&text);
    let (lines, text) = scan(&text, path)?;
    let urdf = urdf_rs::read_from_string(&text).map_err(|error| {
        let message = error.to_string().replace('\n', " ");
        ArmError::in_file(path, None, ArmErrorKind::Urdf(message))
    })?;
    if urdf.links.is_empty() {
        return Err(ArmError::in_file(path, None, ArmErrorKind::NoLinks));
    }
    let index = unique_names(&urdf, &lines, path)?;
    let palette = palette(&urdf);
    let links = urdf.links.iter().zip(lines.links);
    let joints = urdf.joints.iter().zip(lines.joints);
    let mut tree = Tree {
        name: urdf.name.clone(),
        path: path.to_owned(),
        links: links.map(|(l, lines)| link(l, lines, &palette)).collect(),
        joints: Vec::with_capacity(urdf.joints.len()),
        root: 0,
        notes,
        doubts: doubts::of_turns(&urdf).into_iter().collect(),
        signs: Vec::new(),
        is_of_sheet: false,
    };
    for (urdf_joint, lines) in joints {
        let joint = joint(urdf_joint, lines, &index, path)?;
        tree.joints.push(joint);
    }
    connect(&mut tree)?;
    tree.root = find_root(&tree)?;
    for (link, own) in tree.links.iter_mut().zip(solids) {
        link.solids.shapes = own;
    }
    for ((link, own), urdf) in tree.links.iter_mut().zip(meshes).zip(&urdf.links) {
        link.meshes = own;
        let seen = link.meshes.iter_mut().filter(|mesh| !mesh.is_collision);
        let is_mesh =
            |visual: &&urdf_rs::Visual| matches!(visual.geometry, urdf_rs::Geometry::Mesh { .. });
        for (mesh, visual) in seen.zip(urdf.visual.iter().filter(is_mesh)) {
            mesh.color_rgba = color(visual, &palette);
        }
    }
    Ok(tree)
}

/// Index of every link by name; refuses duplicate link and joint names.
fn unique_names<'a>(
    urdf: &'a urdf_rs::Robot,
    lines: &UrdfLines,
    path: &Path,
) -> Result<HashMap<&'a str, usize>, ArmError> {
    let duplicate = |element, name: &str, first: &ElementLines, second: &ElementLines| {
        let kind = ArmErrorKind::DuplicateName {
            element,
            name: name.to_owned(),
            first_line: first.line(),
        };
        ArmError::in_file(path, Some(second.line()), kind)
    };
    let mut links = HashMap::new();
    for (i, link) in urdf.links.iter().enumerate() {
        if let Some(first) = links.insert(link.name.as_str(), i) {
            return Err(duplicate(
                "link",
                &link.name,
                &lines.links[first],
                &lines.links[i],
            ));
        }
    }
    let mut joints = HashMap::new();
    for (i, joint) in urdf.joints.iter().enumerate() {
        if let Some(first) = joints.insert(joint.name.as_str(), i) {
            return Err(duplicate(
                "joint",
                &joint.name,
                &lines.joints[first],
                &lines.joints[i],
            ));
        }
    }
    Ok(links)
}

fn link(urdf: &urdf_rs::Link, lines: ElementLines, palette: &Palette) -> TreeLink {
    let i = &urdf.inertial.inertia;
    let visuals: Vec<_> = (urdf.visual.iter())
        .filter_map(|v| visual(v, palette))
        .collect();
    TreeLink {
        name: urdf.name.clone(),
        lines,
        mass_kg: urdf.inertial.mass.value,
        link_from_inertial: pose(&urdf.inertial.origin),
        inertia_kg_m2: Matrix3::new(
            i.ixx, i.ixy, i.ixz, //
            i.ixy, i.iyy, i.iyz, //
            i.ixz, i.iyz, i.izz,
        ),
        mass_source: None,
        mass_place: None,
        meshes: Vec::new(),
        drawn: Vec::new(),
        solids: Solids::default(),
        visuals,
        parent_joint: None,
        child_joints: Vec::new(),
    }
}

fn joint(
    urdf: &urdf_rs::Joint,
    lines: ElementLines,
    index: &HashMap<&str, usize>,
    path: &Path,
) -> Result<TreeJoint, ArmError> {
    let find = |role: &'static str, name: &str| {
        index.get(name).copied().ok_or_else(|| {
            let kind = ArmErrorKind::UnknownLink {
                joint: urdf.name.clone(),
                role,
                link: name.to_owned(),
                hint: known_names(index.keys().copied()),
            };
            ArmError::in_file(path, Some(lines.of(role)), kind)
        })
    };
    let freedom = match urdf.joint_type {
        JointType::Revolute => Freedom::Revolute,
        JointType::Continuous => Freedom::Continuous,
        JointType::Prismatic => Freedom::Prismatic,
        JointType::Fixed => Freedom::Fixed,
        JointType::Floating => Freedom::Other("floating"),
        JointType::Planar => Freedom::Other("planar"),
        JointType::Spherical => Freedom::Other("spherical"),
    };
    let (parent, child) = (
        find("parent", &urdf.parent.link)?,
        find("child", &urdf.child.link)?,
    );
    Ok(TreeJoint {
        name: urdf.name.clone(),
        freedom,
        parent,
        child,
        parent_from_joint: pose(&urdf.origin),
        axis: Vector3::from(urdf.axis.xyz.0),
        limits: lines.has("limit").then(|| limits(&urdf.limit, freedom)),
        damping: urdf.dynamics.as_ref().map_or(0.0, |d| d.damping),
        friction: urdf.dynamics.as_ref().map_or(0.0, |d| d.friction),
        mimics: urdf.mimic.as_ref().map(|own| Mimic {
            joint: own.joint.clone(),
            multiplier: own.multiplier.unwrap_or(1.0),
            offset: own.offset.unwrap_or(0.0),
        }),
        lines,
    })
}

/// Bounds with "not given" as infinite. Exporters write 0 for an unknown speed or effort, and a
/// range from 0 to 0 is what a `<limit>` without `lower` and `upper` is read as.
fn limits(urdf: &urdf_rs::JointLimit, freedom: Freedom) -> Limits {
    let given = |value: f64| if value == 0.0 { f64::INFINITY } else { value };
    let unbounded = freedom == Freedom::Continuous || (urdf.lower == 0.0 && urdf.upper == 0.0);
    Limits {
        lower: if unbounded {
            f64::NEG_INFINITY
        } else {
            urdf.lower
        },
        upper: if unbounded { f64::INFINITY } else { urdf.upper },
        velocity: given(urdf.velocity),
        effort: given(urdf.effort),
    }
}

/// `; known: a, b, c` with at most twenty names.
pub(crate) fn known_names<'a>(names: impl Iterator<Item = &'a str>) -> String {
    let mut names: Vec<_> = names.collect();
    names.sort_unstable();
    let more = if names.len() > 20 { ", ..." } else { "" };
    names.truncate(20);
    format!("; known: {}{more}", names.join(", "))
}

/// Enters each joint at its two links; refuses a link with two parents.
fn connect(tree: &mut Tree) -> Result<(), ArmError> {
    for j in 0..tree.joints.len() {
        let (parent, child) = (tree.joints[j].parent, tree.joints[j].child);
        if let Some(first) = tree.links[child].parent_joint {
            let kind = ArmErrorKind::TwoParents {
                link: tree.links[child].name.clone(),
                first: tree.joints[first].name.clone(),
                second: tree.joints[j].name.clone(),
            };
            return Err(tree.joint_error(j, "child", kind));
        }
        tree.links[child].parent_joint = Some(j);
        tree.links[parent].child_joints.push(j);
    }
    Ok(())
}

/// The one link without a parent; refuses several, and links that hang on a closed loop.
fn find_root(tree: &Tree) -> Result<usize, ArmError> {
    let is_root = |i: &usize| tree.links[*i].parent_joint.is_none();
    let roots: Vec<usize> = (0..tree.links.len()).filter(is_root).collect();
    let mut reached = vec![false; tree.links.len()];
    let mut open = roots.clone();
    while let Some(i) = open.pop() {
        reached[i] = true;
        let children = tree.links[i].child_joints.iter();
        open.extend(children.map(|&j| tree.joints[j].child));
    }
    if let Some(start) = reached.iter().position(|reached| !reached) {
        return Err(cycle_error(tree, start));
    }
    if let [root] = roots[..] {
        return Ok(root);
    }
    let names: Vec<_> = roots
        .iter()
        .map(|&i| format!("\"{}\"", tree.links[i].name))
        .collect();
    let kind = ArmErrorKind::ManyRoots {
        count: roots.len(),
        names: names.join(", "),
    };
    Err(tree.link_error(roots[1], "link", kind))
}

/// Walks up from a link that no root reaches until a link repeats.
fn cycle_error(tree: &Tree, start: usize) -> ArmError {
    let mut seen = Vec::new();
    let mut at = start;
    while !seen.contains(&at) {
        seen.push(at);
        let Some(joint) = tree.links[at].parent_joint else {
            break;
        };
        at = tree.joints[joint].parent;
    }
    let from = seen.iter().position(|&i| i == at).unwrap_or(0);
    let mut names: Vec<_> = seen[from..]
        .iter()
        .map(|&i| tree.links[i].name.as_str())
        .collect();
    names.reverse();
    names.push(names[0]);
    let kind = ArmErrorKind::Cycle {
        cycle: names.join(" -> "),
    };
    tree.link_error(at, "link", kind)
}
