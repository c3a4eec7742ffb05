//! The simulator: a robot in rapier, a process that loads it, and the recorder.
//!
//! One step, in [`Cell::run`]: read tool and joint state → [`process::Process::evaluate`] (changes nothing) →
//! contacts are solved from the plant's free velocity → everything is injected and the plant steps →
//! [`process::Process::commit`] advances the process's memory, once → one row is recorded.
//!
//! | module | what it holds |
//! | --- | --- |
//! | [`path_job`] | what a path job's tables mean to the planner of its lines |
//! | [`plant`] | what the loads act on: the arm in rapier, or linearised and exactly stepped; its drives |
//! | [`process`] | what the tool does: chamfering, milling, a wheel on a plate, polishing a face, a belt over a face, given forces |
//! | [`elastic`] | the arm as an elastic structure: deflection under a load, modes; what identification needs |
//! | [`loads`] | what a process may ask for |
//! | [`measurement`] | what a sensor makes of a channel |
//! | [`replay`] | measured inputs that drive a model, forward or inverse |
//! | [`stability`] | what stability tools need of a milling scenario: arm, path, cut |
//! | [`sweep`] | a scenario over one or two parameters, as independent jobs |

mod adjust;
mod belt_path;
mod brush_path;
mod build;
mod cell;
mod channels;
mod command;
mod contact;
mod course;
mod effect;
pub mod elastic;
mod error;
mod guard;
mod led_path;
pub mod loads;
pub mod measurement;
mod mjcf;
pub mod path_job;

pub mod facts;
pub mod plant;
mod polish_path;
mod posture;
pub mod process;
pub mod replay;
mod robots;
mod scene;
mod simulate;
pub mod stability;
mod step_size;
pub mod sweep;
mod theory;
mod tool_path;
mod torque_use;
mod translate;

pub use build::rotary_joints;
pub use cell::{Cell, RunEnd};
pub use error::SimError;
pub use mjcf::export_mjcf;
pub use replay::inverse::{Forces, InverseModel};
pub use replay::steady::SteadyModel;
pub use robots::Robots;
pub use simulate::{Engine, Rows, reduced_step_s, simulate};
