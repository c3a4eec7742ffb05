//! The tree of links and joints that a URDF describes.

use std::path::PathBuf;

use nalgebra::{Isometry3, Matrix3, Unit, Vector3};

use crate::error::{ArmError, ArmErrorKind};
use crate::meshes::{LinkMesh, MeshReference};
use crate::model::{JointKind, Limits, Solids, Visual};
use crate::moving::motion;
use crate::urdf::known_names;
use crate::xml::ElementLines;

/// What a URDF joint allows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Freedom {
    Revolute,
    Continuous,
    Prismatic,
    Fixed,
    /// More than one degree of freedom.
    Other(&'static str),
}

#[derive(Debug, Clone)]
pub(crate) struct TreeLink {
    pub(crate) name: String,
    pub(crate) lines: ElementLines,
    pub(crate) mass_kg: f64,
    /// Link frame from the frame at the centre of mass in which the tensor is given.
    pub(crate) link_from_inertial: Isometry3<f64>,
    pub(crate) inertia_kg_m2: Matrix3<f64>,
    pub(crate) visuals: Vec<Visual>,
    /// Where mass, centre and inertia come from, if not from the URDF.
    pub(crate) mass_source: Option<String>,
    /// File and line of them, if not of the URDF.
    pub(crate) mass_place: Option<(PathBuf, Option<usize>)>,
    pub(crate) meshes: Vec<MeshReference>,
    /// Those that are drawn and were found on disk.
    pub(crate) drawn: Vec<LinkMesh>,
    pub(crate) solids: Solids,
    pub(crate) parent_joint: Option<usize>,
    pub(crate) child_joints: Vec<usize>,
}

#[derive(Debug)]
pub(crate) struct TreeJoint {
    pub(crate) name: String,
    pub(crate) lines: ElementLines,
    pub(crate) freedom: Freedom,
    pub(crate) parent: usize,
    pub(crate) child: usize,
    pub(crate) parent_from_joint: Isometry3<f64>,
    pub(crate) axis: Vector3<f64>,
    pub(crate) limits: Option<Limits>,
    pub(crate) damping: f64,
    pub(crate) friction: f64,
    pub(crate) mimics: Option<Mimic>,
}

/// `<mimic>`: coordinate = multiplier × that of another joint + offset.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Mimic {
    pub(crate) joint: String,
    pub(crate) multiplier: f64,
    pub(crate) offset: f64,
}

/// What turns a joint, in the end.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Leader {
    /// The joint that all mimicry leads to: one that moves by itself, or a fixed one.
    pub(crate) joint: usize,
    pub(crate) multiplier: f64,
    pub(crate) offset: f64,
}

impl TreeJoint {
    /// Whether the joint moves by itself or follows another one.
    pub(crate) fn moves(&self) -> bool {
        self.freedom != Freedom::Fixed
    }

    /// What this one follows, if it can move at all.
    pub(crate) fn followed(&self) -> Option<&Mimic> {
        self.mimics.as_ref().filter(|_| self.moves())
    }

    /// The frame before the joint from the link that it moves, with the joint at `q`.
    pub(crate) fn parent_from_child(&self, q: f64) -> Isometry3<f64> {
        let kind = match self.freedom {
            Freedom::Revolute | Freedom::Continuous => JointKind::Revolute,
            Freedom::Prismatic => JointKind::Prismatic,
            Freedom::Fixed | Freedom::Other(_) => return self.parent_from_joint,
        };
        match Unit::try_new(self.axis, f64::EPSILON) {
            Some(axis) => self.parent_from_joint * motion(kind, &axis, q),
            None => self.parent_from_joint,
        }
    }
}

#[derive(Debug)]
pub(crate) struct Tree {
    pub(crate) name: String,
    pub(crate) path: PathBuf,
    pub(crate) links: Vec<TreeLink>,
    pub(crate) joints: Vec<TreeJoint>,
    pub(crate) root: usize,
    /// What was left out of the file.
    pub(crate) notes: Vec<String>,
    /// What speaks against its values.
    pub(crate) doubts: Vec<String>,
    /// What makes its masses and inertias look like placeholders.
    pub(crate) signs: Vec<String>,
    /// Whether its masses are those of a data sheet, which is judged by itself.
    pub(crate) is_of_sheet: bool,
}

impl Tree {
    /// What turns a joint in the end, and how much.
    ///
    /// # Errors
    /// If a joint follows one that is not there, or itself through others.
    pub(crate) fn leader(&self, joint: usize) -> Result<Leader, ArmErrorKind> {
        let mut leader = Leader {
            joint,
            multiplier: 1.0,
            offset: 0.0,
        };
        for _ in 0..=self.joints.len() {
            let at = &self.joints[leader.joint];
            let Some(mimic) = at.followed() else {
                return Ok(leader);
            };
            let Some(next) = self.joints.iter().position(|j| j.name == mimic.joint) else {
                return Err(ArmErrorKind::UnknownMimicked {
                    joint: at.name.clone(),
                    mimicked: mimic.joint.clone(),
                    hint: known_names(self.joints.iter().map(|j| j.name.as_str())),
                });
            };
            leader = Leader {
                joint: next,
                multiplier: leader.multiplier * mimic.multiplier,
                offset: leader.multiplier * mimic.offset + leader.offset,
            };
        }
        let joint = self.joints[joint].name.clone();
        Err(ArmErrorKind::MimicsItself { joint })
    }

    pub(crate) fn link_error(&self, link: usize, element: &str, kind: ArmErrorKind) -> ArmError {
        let line = self.links[link].lines.of(element);
        ArmError::in_file(&self.path, Some(line), kind)
    }

    pub(crate) fn joint_error(&self, joint: usize, element: &str, kind: ArmErrorKind) -> ArmError {
        let line = self.joints[joint].lines.of(element);
        ArmError::in_file(&self.path, Some(line), kind)
    }
}
