//! Where a milling arm shall stand: tool paths, stability over the redundancy angle, the choice of
//! postures.
//!
//! A milling tool may turn about its own axis without any change to the cut. A six-axis arm that
//! holds it therefore has one angle left, the redundancy angle, and with it the stiffness, the
//! modes and the stability of the cut change. [`Planner::plan`] chooses that angle along a path, so
//! that the arm stands where the cut is stable by a criterion:
//!
//! - [`Criterion::Anisotropy`]: r = (k_max − k_min)/k_max in the cutting plane is at least 0.1: a
//!   published rule, no stability bound.
//! - [`Criterion::Flutter`]: the depth is below the undamped planar limit of mode coupling.
//! - [`Criterion::ModeCoupling`]: the depth is below the limit of all modes under the averaged cut,
//!   teeth meeting the nominal surface.
//! - [`Criterion::Regenerative`]: the depth is below the limit by spectral elements, teeth meeting
//!   the surface that earlier ones left, with the floor; and vibration at that depth dies away at
//!   least half as fast as the arm's slowest mode does on its own ([`LEAST_DECAY`]).
//!
//! Only the last describes real teeth (`docs/milling.md`); the others are there to be compared with
//! it.
//!
//! # Steps
//!
//! 1. [`Reach`]: all postures within joint limits and away from singularities, on a grid of path
//!    position and redundancy angle, joined into sheets within which the arm gets from one to the
//!    other without a jump.
//! 2. Intervals of stable angles at the midpoint of each segment, per sheet, their ends refined by
//!    bisection. Where decay is known only angles are in them that decay at least half as fast as
//!    the best at the place.
//! 3. The chain of overlapping intervals, one a segment, whose narrowest is widest.
//! 4. Segments at which an end of the interval moves by more than 10° from one to the next are
//!    halved, and 2 and 3 done again. (The published rule accepts a length if the ends differ by
//!    *more* than 10°; taken literally it accepts segments in which the interval may have moved
//!    anywhere.)
//! 5. An interval that opens faster than that from one segment to the next is used as far only as
//!    it opens by 10°.
//! 6. The angle turns from mid-interval to mid-interval, and every station of the path is assessed;
//!    segments that are not stable at one of them are halved once more.
//!
//! Angles follow [`truecut_arm::tool_pose`], axes of the cut the milling frame of
//! [`truecut_core::cutting::milling`].

mod arc;
mod assess;
mod assessment;
mod bounds;
pub mod cam;
mod chain;
pub mod clearance;
mod criterion;
pub mod edge_path;
mod error;
mod intervals;
pub mod lobes;
pub mod map;
pub mod motion;
mod options;
mod parts;
pub mod path_file;
mod plan;
mod planner;
pub mod polish_path;
pub mod precession;
pub mod program;
mod reach;
pub mod section;
mod sheets;
mod singularity;
pub mod spread;
pub mod surface;
pub mod surface_path;
mod tool_path;
mod tube;
mod walk;

pub use assess::{assess, modes_in_cut};
pub use assessment::{Assessment, Decay, LEAST_DECAY, Stability};
pub use bounds::OutOfBounds;
pub use criterion::{Criterion, Cut, LEAST_ANISOTROPY};
pub use error::PlanError;
pub use intervals::Interval;
pub use options::PlannerOptions;
pub use plan::{MarginMap, Plan, PlanPoint, Segment};
pub use planner::Planner;
pub use reach::{Candidate, Column, Family, Reach};
pub use singularity::SingularityLimits;
pub use tool_path::ToolPath;
