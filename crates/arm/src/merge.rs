//! From a tree and its tip to a serial chain: what is fixed is merged, side branches at zero.

use nalgebra::{Isometry3, Unit};

use crate::bounds::{self, Masses};
use crate::error::{ArmError, ArmErrorKind};
use crate::inertials::Yardstick;
use crate::mass_sum::MassSum;
use crate::meshes::LinkMesh;
use crate::model::{Chain, Joint, JointKind, Link, MAX_JOINTS, Solids, Transmission, Visual};
use crate::moving::Follower;
use crate::tree::{Freedom, Tree};

/// A part of the path whose links do not move against each other.
struct RigidSegment {
    /// The joint that moves it, with its pose in the segment before; `None` for the base.
    joint: Option<(usize, Isometry3<f64>)>,
    /// Links on the path, each with its pose in the segment's first link.
    links: Vec<(usize, Isometry3<f64>)>,
}

/// Chain from the root to link `tip`, and last link from flange.
pub(crate) fn to_chain(
    tree: &mut Tree,
    tip: usize,
    masses: Masses,
) -> Result<(Chain, Isometry3<f64>), ArmError> {
    let path = joints_to(tree, tip);
    check_path(tree, tip, &path)?;
    let mut notes = bounds::check(tree, &path, masses)?;
    let mut signs = Vec::new();
    let made = chain_of(tree, &path, masses, &mut notes, &mut signs)?;
    tree.signs = signs;
    let (mut chain, last_link_from_flange) = made;
    chain.tip.clone_from(&tree.links[tip].name);
    chain.notes = notes;
    Ok((chain, last_link_from_flange))
}

/// The chain of the joints `path`; adds what is told of it to `notes`, and what speaks against its
/// masses to `signs`.
fn chain_of(
    tree: &Tree,
    path: &[usize],
    masses: Masses,
    notes: &mut Vec<String>,
    signs: &mut Vec<String>,
) -> Result<(Chain, Isometry3<f64>), ArmError> {
    let segments = split(tree, path);
    let mut yardstick = Yardstick::of(tree, segments.len() - 1);
    let mut massless_links: Vec<&str> = Vec::new();
    let mut parts = Parts::default();
    for segment in &segments {
        let mut body = MergedBody::default();
        for &(link, pose) in &segment.links {
            body.collect(tree, link, &pose, path, notes);
        }
        if let Some((j, _)) = segment.joint
            && body.masses.mass_kg == 0.0
        {
            if masses == Masses::Needed {
                return Err(massless(tree, j));
            }
            massless_links.push(&tree.links[tree.joints[j].child].name);
        }
        let members = std::mem::take(&mut body.members);
        let link = body.into_link(&tree.links[segment.links[0].0].name);
        let is_judged = masses == Masses::Needed && !tree.is_of_sheet;
        if segment.joint.is_some() && is_judged {
            signs.extend(yardstick.judge(tree, &link, &members)?);
        }
        parts.take(tree, segment.joint, link, notes);
    }
    notes.extend(held_followers(tree, path));
    if !massless_links.is_empty() {
        notes.push(format!(
            "no mass is known of {}: only questions of kinematics can be answered",
            massless_links.join(", ")
        ));
    }
    let flange = segments.last().and_then(|segment| segment.links.last());
    let last_link_from_flange = flange.map_or_else(Isometry3::identity, |&(_, pose)| pose);
    let chain = Chain {
        name: tree.name.clone(),
        followers: parts.followers(tree, notes),
        joints: parts.joints,
        links: parts.links,
        base: parts
            .base
            .unwrap_or_else(|| MergedBody::default().into_link("")),
        tip: String::new(),
        notes: Vec::new(),
        motion_doubts: Vec::new(),
        estimated_masses: Vec::new(),
        placeholders: None,
    };
    Ok((chain, last_link_from_flange))
}

/// Where a joint stands that does not move with the chain: fixed ones, and those that follow a
/// joint beside the chain, which is held at zero. `None` if it moves.
fn held_at(tree: &Tree, joint: usize, path: &[usize]) -> Option<f64> {
    let own = &tree.joints[joint];
    if !own.moves() {
        return Some(0.0);
    }
    own.followed()?;
    let leader = tree.leader(joint).ok()?;
    let is_led = path.contains(&leader.joint) && tree.joints[leader.joint].moves();
    (!is_led).then_some(leader.offset)
}

/// Joints on the chain that follow one which is not on it.
fn held_followers(tree: &Tree, path: &[usize]) -> Vec<String> {
    let moving = path.iter().filter(|&&j| tree.joints[j].moves());
    let held = moving.filter_map(|&j| {
        let at = held_at(tree, j, path)?;
        let leader = tree.leader(j).ok()?;
        Some(format!(
            "joint \"{}\" mimics \"{}\", which does not move this chain: it is held at {at}",
            tree.joints[j].name, tree.joints[leader.joint].name
        ))
    });
    held.collect()
}

/// Joints, links and followers of a chain as they are gathered.
#[derive(Default)]
struct Parts {
    base: Option<Link>,
    joints: Vec<Joint>,
    /// Which joint of the tree each of them is.
    numbers: Vec<usize>,
    links: Vec<Link>,
    /// Joints of the tree that follow, how many joints of the chain come before, what they move.
    followers: Vec<(usize, usize, Isometry3<f64>, Link)>,
}

impl Parts {
    /// Adds a link and the joint that moves it; the base has none.
    fn take(
        &mut self,
        tree: &Tree,
        joint: Option<(usize, Isometry3<f64>)>,
        link: Link,
        notes: &mut Vec<String>,
    ) {
        match joint {
            None => self.base = Some(link),
            Some((j, pose)) if tree.joints[j].followed().is_some() => {
                self.followers.push((j, self.joints.len(), pose, link));
            }
            Some((j, pose)) => {
                self.joints.push(chain_joint(tree, j, pose, notes));
                self.numbers.push(j);
                self.links.push(link);
            }
        }
    }

    /// The followers, once all joints are known: one may follow a joint that comes after it.
    fn followers(&mut self, tree: &Tree, notes: &mut Vec<String>) -> Vec<Follower> {
        let taken = std::mem::take(&mut self.followers).into_iter();
        let made = taken.filter_map(|(j, after, pose, link)| {
            let leader = tree.leader(j).ok()?;
            let follows = self.numbers.iter().position(|own| *own == leader.joint)?;
            let own = chain_joint(tree, j, pose, &mut Vec::new());
            notes.push(format!(
                "joint \"{}\" moves with \"{}\", {} times: it has no coordinate and no transmission of its own",
                own.name, self.joints[follows].name, leader.multiplier
            ));
            Some(Follower {
                name: own.name,
                kind: own.kind,
                parent_from_joint: pose,
                axis: own.axis,
                limits: own.limits,
                after,
                follows,
                multiplier: leader.multiplier,
                offset: leader.offset,
                link,
            })
        });
        made.collect()
    }
}

/// Joints from the root to a link, in that order.
pub(crate) fn joints_to(tree: &Tree, link: usize) -> Vec<usize> {
    let mut path = Vec::new();
    let mut at = link;
    while let Some(joint) = tree.links[at].parent_joint {
        path.push(joint);
        at = tree.joints[joint].parent;
    }
    path.reverse();
    path
}

fn check_path(tree: &Tree, tip: usize, path: &[usize]) -> Result<(), ArmError> {
    let tip_name = || tree.links[tip].name.clone();
    for &j in path {
        let joint = &tree.joints[j];
        if let Freedom::Other(kind) = joint.freedom {
            let kind = ArmErrorKind::JointType {
                joint: joint.name.clone(),
                tip: tip_name(),
                kind,
            };
            return Err(tree.joint_error(j, "joint", kind));
        }
        if joint.followed().is_some() {
            (tree.leader(j)).map_err(|kind| tree.joint_error(j, "mimic", kind))?;
        }
    }
    let moves_itself = |j: &&usize| {
        let joint = &tree.joints[**j];
        joint.moves() && joint.followed().is_none()
    };
    let count = path.iter().filter(moves_itself).count();
    if (1..=MAX_JOINTS).contains(&count) {
        return Ok(());
    }
    let kind = ArmErrorKind::JointCount {
        root: tree.links[tree.root].name.clone(),
        tip: tip_name(),
        count,
        limit: MAX_JOINTS,
    };
    Err(tree.link_error(tip, "link", kind))
}

fn split(tree: &Tree, path: &[usize]) -> Vec<RigidSegment> {
    let mut segments = Vec::new();
    let mut pose = Isometry3::identity();
    let mut open = RigidSegment {
        joint: None,
        links: vec![(tree.root, pose)],
    };
    for &j in path {
        let joint = &tree.joints[j];
        if let Some(q) = held_at(tree, j, path) {
            pose *= joint.parent_from_child(q);
        } else {
            pose *= joint.parent_from_joint;
            let next = RigidSegment {
                joint: Some((j, pose)),
                links: Vec::new(),
            };
            segments.push(std::mem::replace(&mut open, next));
            pose = Isometry3::identity();
        }
        open.links.push((joint.child, pose));
    }
    segments.push(open);
    segments
}

fn massless(tree: &Tree, joint: usize) -> ArmError {
    let child = tree.joints[joint].child;
    let kind = ArmErrorKind::MasslessMovingLink {
        link: tree.links[child].name.clone(),
        joint: tree.joints[joint].name.clone(),
    };
    tree.link_error(child, "mass", kind)
}

fn chain_joint(
    tree: &Tree,
    index: usize,
    parent_from_joint: Isometry3<f64>,
    notes: &mut Vec<String>,
) -> Joint {
    let joint = &tree.joints[index];
    let length = joint.axis.norm();
    if (length - 1.0).abs() > 1e-6 {
        notes.push(format!(
            "joint \"{}\": axis of length {length} was normalised",
            joint.name
        ));
    }
    let unbounded = |l: &crate::model::Limits| l.lower.is_infinite() && l.upper.is_infinite();
    if joint.freedom != Freedom::Continuous && joint.limits.as_ref().is_none_or(unbounded) {
        // Bounds that are given and still infinite were written as 0 to 0 (see `urdf::limits`), or
        // as such.
        let why = if joint.limits.is_some() {
            "; a <limit> from 0 to 0 counts as not given"
        } else {
            ""
        };
        notes.push(format!(
            "joint \"{}\" has no position limits{why}",
            joint.name
        ));
    }
    Joint {
        name: joint.name.clone(),
        kind: match joint.freedom {
            Freedom::Prismatic => JointKind::Prismatic,
            _ => JointKind::Revolute,
        },
        parent_from_joint,
        axis: Unit::new_normalize(joint.axis),
        limits: joint.limits,
        transmission: Transmission {
            damping: joint.damping,
            dry_friction: joint.friction,
            ..Transmission::default()
        },
        urdf_damping: joint.damping,
        urdf_friction: joint.friction,
    }
}

/// Everything that moves as one, in the frame of its first link.
#[derive(Default)]
struct MergedBody {
    masses: MassSum,
    visuals: Vec<Visual>,
    meshes: Vec<LinkMesh>,
    solids: Solids,
    /// The links that it is made of.
    members: Vec<usize>,
}

impl MergedBody {
    /// Adds link `start` and all side branches that hang on it, their joints at zero.
    fn collect(
        &mut self,
        tree: &Tree,
        start: usize,
        body_from_start: &Isometry3<f64>,
        path: &[usize],
        notes: &mut Vec<String>,
    ) {
        let mut held = Vec::new();
        let mut open = vec![(start, *body_from_start)];
        while let Some((at, pose)) = open.pop() {
            self.add(tree, at, &pose);
            for &j in tree.links[at]
                .child_joints
                .iter()
                .filter(|j| !path.contains(j))
            {
                let joint = &tree.joints[j];
                if joint.moves() {
                    held.push(match &joint.mimics {
                        Some(mimic) => format!("{} (mimics {})", joint.name, mimic.joint),
                        None => joint.name.clone(),
                    });
                }
                // With what it mimics at zero, a joint stands at its offset.
                let at = tree.leader(j).map_or(0.0, |leader| leader.offset);
                open.push((joint.child, pose * joint.parent_from_child(at)));
            }
        }
        if !held.is_empty() {
            notes.push(format!(
                "side branch at link \"{}\" is merged rigidly with its joints at zero: {}",
                tree.links[start].name,
                held.join(", ")
            ));
        }
    }

    fn add(&mut self, tree: &Tree, index: usize, body_from_link: &Isometry3<f64>) {
        let link = &tree.links[index];
        self.members.push(index);
        let pose = body_from_link * link.link_from_inertial;
        self.masses.add(link.mass_kg, &pose, &link.inertia_kg_m2);
        self.visuals
            .extend(link.visuals.iter().map(|visual| Visual {
                link_from_visual: body_from_link * visual.link_from_visual,
                ..visual.clone()
            }));
        self.meshes.extend(link.drawn.iter().map(|mesh| LinkMesh {
            link_from_mesh: body_from_link * mesh.link_from_mesh,
            ..mesh.clone()
        }));
        self.solids.take(link.solids.clone(), body_from_link);
    }

    fn into_link(self, name: &str) -> Link {
        let (com_m, inertia_about_com_kg_m2) = self.masses.about_centre();
        Link {
            name: name.to_owned(),
            mass_kg: self.masses.mass_kg,
            com_m,
            inertia_about_com_kg_m2,
            visuals: self.visuals,
            meshes: self.meshes,
            solids: self.solids,
        }
    }
}
