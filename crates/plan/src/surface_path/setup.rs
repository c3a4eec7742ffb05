//! What a path is planned from: a face, lines on it, and postures that were taught.

use std::path::PathBuf;

use nalgebra::Isometry3;
use schemars::JsonSchema;
use serde::Deserialize;

use super::error::SurfacePathError;
use super::lines::{SurfacePath, plan_path};
use super::options::{FeedAlong, PathOptions, Strategy};
use super::wheel::ContactWheel;
use crate::surface::{MeshFile, PatchFile};

/// The face to be finished.
#[derive(Debug, Clone, PartialEq)]
pub struct SurfaceSetup {
    /// File of the patch.
    pub patch: PathBuf,
    /// The whole workpiece as a closed mesh, in the patch's frame.
    pub body: Option<MeshFile>,
    /// Where the patch stands.
    pub world_from_patch: Isometry3<f64>,
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
