//! How lines are laid on a patch.

use nalgebra::{Unit, Vector3};
use schemars::JsonSchema;
use serde::Deserialize;

use super::contact::AxisRule;

/// How a path covers a face.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PathOptions {
    pub rule: AxisRule,
    /// Share of the swath that the next line covers again, 0 to below 1.
    pub overlap: f64,
    /// Largest distance of points along a line, m.
    pub step_m: f64,
    /// Distance that the contact keeps from the borders of the patch, m.
    pub margin_m: f64,
}

/// How lines are laid; in every gap they take the same share of what is allowed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Strategy {
    /// Lines along which one parameter is constant, the next as far away as the narrowest place
    /// allows.
    IsoParametric,
    /// Each line as far from the one before, at every place of it, as leaves a ridge of one height
    /// (and no strip untouched).
    IsoScallop { scallop_m: f64 },
    /// Sections with planes of one normal, the next as far away as the narrowest place allows. A
    /// line ends where a corner of its contact meets a border, which leaves triangles at borders
    /// that the planes run askew to; `along_borders` lays a line along each border of the patch.
    ParallelPlane {
        normal: Unit<Vector3<f64>>,
        along_borders: bool,
    },
}

/// The parameter along which lines are fed; parallel planes choose it themselves.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum FeedAlong {
    /// u, lines beside one another along v.
    #[default]
    U,
    /// v, lines beside one another along u.
    V,
}
