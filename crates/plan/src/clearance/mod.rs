//! How near an arm and what it carries come to what stands about them.
//!
//! A [`Cell`] holds bodies: the links of the arm, what the flange carries, the part, fixtures.
//! Convex bodies move (a mesh of the arm counts as its convex hull), everything that stands counts
//! as it is. Distances between two bodies are parry's (Gilbert, Johnson and Keerthi, a tree of
//! boxes over triangles). Along a path ([`Cell::along`]) they are asked for at places that follow
//! from how fast the bodies can near each other (conservative advancement, `mirtich1996`), so that
//! nothing is passed between them.

mod body;
mod cell;
mod distance;
mod error;
mod hull;
mod motion;
mod nearest;
mod solid;
#[cfg(test)]
mod tests;

pub use cell::{Cell, Drawn, Own};
pub use error::{CellError, CellFault};
pub use nearest::{Approach, Clearances, Place, Station, TOLERANCE_M, TOLERANCE_SHARE};
pub use solid::{Form, Solid};

use nalgebra::Isometry3;

/// What stands about an arm and what its flange carries, as a file says it.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct CellSetup {
    /// Clearance that is asked for, m: 0 lets bodies come as near as they do not touch.
    pub least_m: f64,
    /// The part, where no job gives it.
    pub part: Option<Standing>,
    /// Tables, vices, clamps, walls.
    pub fixtures: Vec<Standing>,
    /// Spindles, brackets, cables.
    pub carried: Vec<Carried>,
}

/// Something that stands still.
#[derive(Debug, Clone, PartialEq)]
pub struct Standing {
    pub name: String,
    pub form: Form,
    pub world_from_form: Isometry3<f64>,
    /// Links and carried bodies whose clearance from it does not matter.
    pub may_touch: Vec<String>,
}

/// Something fixed to the flange.
#[derive(Debug, Clone, PartialEq)]
pub struct Carried {
    pub name: String,
    pub form: Form,
    pub flange_from_form: Isometry3<f64>,
    /// Whether it works on the part: then it may touch that where the tool is fed.
    pub cuts: bool,
}

/// A tool that a job or a process brings, fixed to the flange. It works on the part.
#[derive(Debug, Clone, PartialEq)]
pub struct Tool {
    pub name: String,
    pub solid: Solid,
    pub flange_from_solid: Isometry3<f64>,
}
