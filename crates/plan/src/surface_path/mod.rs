//! Tool paths on surfaces: a cylindrical contact wheel led over a patch.
//!
//! A [`ContactWheel`] lies on the surface with its axis tangent to it; its centre stands at O = P +
//! (R − k h) n (`yang2016hub`, eq. 1). [`AxisRule`] says where the axis points, [`Contact`] what
//! follows from that at one place, and [`plan_path`] leads the wheel along lines over the face.
//! [`copies`] turns a path about a turntable's axis, [`TaughtPoints`] are postures recorded on the
//! arm, and [`solve`] finds the arm's postures along all of them.

mod axis;
mod borders;
mod chord;
mod contact;
mod coverage;
mod error;
mod graph;
mod layout;
mod lines;
mod options;
mod outer;
mod planes;
mod scallop;
mod sequence;
mod setup;
mod solve;
mod spacing;
mod taught;
mod wheel;

pub use chord::Chord;
pub use contact::{AxisRule, Contact, wheel_pose};
pub use error::SurfacePathError;
pub use lines::{SurfacePath, plan_path};
pub use options::{FeedAlong, PathOptions, Strategy};
pub use sequence::{Part, Speeds, Symmetry, parts_of, program_of};
pub use setup::{FaceSource, PathSetup, SurfaceSetup, TaughtFile, TaughtWhen};
pub use solve::{Segment, copies, solve};
pub use taught::{TaughtPoints, joint_cells};
pub use wheel::ContactWheel;
