//! What a path is planned from: a face, lines on it, and postures that were taught.

use std::path::PathBuf;

use nalgebra::Isometry3;
use schemars::JsonSchema;
use serde::Deserialize;

use super::error::SurfacePathError;
use super::lines::{SurfacePath, plan_path};
use super::options::{FeedAlong, PathOptions, Strategy};
use super::wheel::ContactWheel;
use crate::surface::{MeshFace, MeshFile, PatchFile, SurfaceError, SurfaceFault};

/// The face to be finished.
#[derive(Debug, Clone, PartialEq)]
pub struct SurfaceSetup {
    /// Where the patch comes from.
    pub face: FaceSource,
    /// The whole workpiece as a closed mesh, in the patch's frame.
    pub body: Option<MeshFile>,
    /// Where the patch stands.
    pub world_from_patch: Isometry3<f64>,
}

/// Where a patch comes from.
#[derive(Debug, Clone, PartialEq)]
pub enum FaceSource {
    /// File of the patch.
    Patch(PathBuf),
    /// A face of a mesh.
    Mesh(MeshFace),
}

impl FaceSource {
    /// Reads the patch, or fits it.
    ///
    /// # Errors
    /// As [`PatchFile::load`] and [`MeshFace::load`].
    pub fn load(&self) -> Result<PatchFile, SurfaceError> {
        match self {
            Self::Patch(file) => PatchFile::load(file),
            Self::Mesh(face) => face.load(),
        }
    }

    /// The key of a path job that names the file.
    #[must_use]
    pub fn key(&self) -> &'static str {
        match self {
            Self::Patch(_) => "surface.patch",
            Self::Mesh(_) => "surface.mesh.file",
        }
    }

    /// The key of a path job whose value a fault is about.
    #[must_use]
    pub fn key_of(&self, fault: &SurfaceFault) -> &'static str {
        match (self, fault) {
            (Self::Mesh(_), SurfaceFault::OffThePart { .. }) => "surface.mesh.point_mm",
            (Self::Mesh(_), SurfaceFault::Deviates { .. }) => "surface.mesh.deviation_mm",
            (Self::Mesh(_), SurfaceFault::FaceTurns { .. }) => "surface.mesh.crease_deg",
            _ => self.key(),
        }
    }
}

/// The lines on the patch.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PathSetup {
    /// How lines are laid.
    pub strategy: Strategy,
    /// The parameter along which they are fed.
    pub along: FeedAlong,
    /// Axis of the wheel, and distances.
    pub options: PathOptions,
    /// How far the wheel is lifted before and after each line, m.
    pub lift_m: f64,
    /// Speed of the tool on a line, m/s.
    pub feed_m_per_s: f64,
    /// How deep the wheel may lie in patch and body, m.
    pub gouge_limit_m: f64,
}

impl PathSetup {
    /// Lines of contacts on a patch, in its frame.
    ///
    /// # Errors
    /// As [`plan_path`].
    pub fn lines(
        &self,
        wheel: &ContactWheel,
        patch: &PatchFile,
    ) -> Result<SurfacePath, SurfacePathError> {
        let (surface, boundary) = (patch.surface.as_ref(), patch.boundary.as_ref());
        let (strategy, along) = (self.strategy, self.along);
        plan_path(surface, boundary, wheel, strategy, along, &self.options)
    }
}

/// Postures recorded on the arm.
#[derive(Debug, Clone, PartialEq)]
pub struct TaughtFile {
    /// CSV file.
    pub file: PathBuf,
    /// When it is played.
    pub when: TaughtWhen,
}

/// When a taught file is played.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum TaughtWhen {
    /// Before the lines of each copy.
    Before,
    /// After the lines of each copy.
    After,
}
