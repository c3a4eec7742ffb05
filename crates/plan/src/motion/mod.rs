//! Motion: when the tool is where.
//!
//! | words | mean |
//! | --- | --- |
//! | knot | a place, or a posture, with its time or its distance along the path |
//! | timing law | how a path's clock runs, so that it starts and ends at rest ([`timing`]) |
//! | trajectory | knots run through by a timing law, corners blended ([`trajectory`]) |
//! | move by joints | all joints together, the slowest at its share of its top speed ([`joints`]) |
//!
//! [`interpolation`] holds the cubics between even knots, [`branch`] finds postures along poses,
//! [`follow`] says what an arm cannot do. The motions of the processes are made of these: [`lines`]
//! over a face, a raster with a precessing wheel ([`polish`]), a [`straight`] path, postures that
//! were [`taught`], a program by which an arm is [`led`].

pub mod branch;
pub mod excitation;
pub mod follow;
pub mod interpolation;
pub mod joints;
pub mod led;
pub mod lines;
pub mod polish;
pub mod raster;
pub mod straight;
pub mod taught;
pub mod timing;
pub mod trajectory;

pub use timing::{LeadIn, TimingLaw};
pub use trajectory::Trajectory;
