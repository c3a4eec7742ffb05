//! The simulator: a robot in rapier, a process that loads it, and the recorder.
//!
//! [`run`] is the one call that runs a scenario. One step of it: read tool and joint state →
//! [`process::Process::evaluate`] (changes nothing) → contacts are solved from the plant's free
//! velocity → everything is injected and the plant steps → [`process::Process::commit`] advances
//! the process's memory, once → one row is recorded.
//!
//! - [`plant`]: what the loads act on: the arm in rapier, or linearised and exactly stepped; its
//!   drives.
//! - [`process`]: what the tool does: chamfering, milling, a wheel on a plate, polishing a face, a
//!   belt over a face, a brush along edges, given forces.
//! - `contract`: laws that every plant and every process keeps, as tests (feature `contract`).
//! - [`elastic`]: the arm as an elastic structure: deflection under a load, modes; what
//!   identification needs.
//! - [`loads`]: what a process may ask for.
//! - [`measurement`]: what a sensor makes of a channel.
//! - [`run`]: one scenario, its data and an engine in; recording and claims judged out.
//! - [`replay`]: measured inputs that drive a model, forward or inverse.
//! - [`stability`]: what stability tools need of a milling scenario: arm, path, cut.
//! - [`sweep`]: a scenario over one or two parameters, as independent jobs.

mod adjust;
mod build;
mod cell;
mod channels;
mod command;
mod contact;
#[cfg(any(test, feature = "contract"))]
pub mod contract;
mod effect;
pub mod elastic;
mod engine;
mod error;
mod estimates;
mod guard;
pub mod loads;
pub mod measurement;
mod mjcf;
mod motion;

pub mod facts;
pub mod plant;
mod posture;
pub mod process;
pub mod replay;
mod robots;
pub mod run;
mod scene;
mod spring_use;
pub mod stability;
mod step_size;
pub mod sweep;
mod theory;
mod torque_use;
mod travel_view;

pub use effect::misfit;
pub use error::SimError;
pub use estimates::estimates;
pub use mjcf::export_mjcf;
pub use motion::edges::{LaidTool, LaidWay, laid_way};
pub use replay::along::PlannedArm;
pub use replay::inverse::InverseModel;
pub use replay::rigid::Forces;
pub use replay::start::{FoundStart, found_start};
pub use replay::steady::SteadyModel;
pub use robots::Robots;
pub use scene::{Surroundings, arm_view, mesh_body};
pub use travel_view::travel_view;
