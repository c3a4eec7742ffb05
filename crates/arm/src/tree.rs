//! The tree of links and joints that a URDF describes.

use std::path::PathBuf;

use nalgebra::{Isometry3, Matrix3, Vector3};

use crate::error::{ArmError, ArmErrorKind};
use crate::meshes::{LinkMesh, MeshReference};
use crate::model::{Limits, Visual};
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

#[derive(Debug)]
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
    pub(crate) meshes: Vec<MeshReference>,
    /// Those that are drawn and were found on disk.
    pub(crate) drawn: Vec<LinkMesh>,
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
    pub(crate) mimics: Option<String>,
}

impl TreeJoint {
    /// Whether the joint moves by itself or follows another one.
    pub(crate) fn moves(&self) -> bool {
        self.freedom != Freedom::Fixed
    }

    /// The joint that this one follows, if it can move at all.
    pub(crate) fn followed(&self) -> Option<&str> {
        self.mimics.as_deref().filter(|_| self.moves())
    }
}

#[derive(Debug)]
pub(crate) struct Tree {
    pub(crate) name: String,
    pub(crate) path: PathBuf,
    pub(crate) links: Vec<TreeLink>,
    pub(crate) joints: Vec<TreeJoint>,
    pub(crate) root: usize,
}

impl Tree {
    pub(crate) fn link_error(&self, link: usize, element: &str, kind: ArmErrorKind) -> ArmError {
        let line = self.links[link].lines.of(element);
        ArmError::in_file(&self.path, Some(line), kind)
    }

    pub(crate) fn joint_error(&self, joint: usize, element: &str, kind: ArmErrorKind) -> ArmError {
        let line = self.joints[joint].lines.of(element);
        ArmError::in_file(&self.path, Some(line), kind)
    }
}
