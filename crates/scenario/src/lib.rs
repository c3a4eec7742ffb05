//! The scenario file: schema, units, validation. No physics.
//!
//! A scenario says what arm does what to a workpiece, and what must hold of it. Keys carry their
//! units (`feed_mm_per_rev`); the typed form is SI throughout and is converted here, once.
//!
//! # A tour
//!
//! ```
//! use std::path::Path;
//! use truecut_scenario::{ProcessSpec, Scenario};
//!
//! let text = r#"
//! name = "Free decay"
//!
//! [robot]
//! urdf = "robot.urdf"
//! posture_deg = [90, 0]
//!
//! [run]
//! duration_s = 2
//!
//! [process.load]
//! release_n = [0, 1000, 0]
//! "#;
//! let path = Path::new("decay.toml");
//! let scenario = Scenario::from_str(path, text, &[])?;
//! assert_eq!(scenario.robot.posture_rad[0], std::f64::consts::FRAC_PI_2);
//! let ProcessSpec::Load(load) = &scenario.process else { unreachable!() };
//! assert_eq!(load.release_n.y, 1000.0);
//!
//! // Any key can be set from outside; the rest of the file stays as it is.
//! let longer = scenario.with_overrides(&[("run.duration_s".into(), "4".into())])?;
//! assert_eq!(longer.run.duration_s, 4.0);
//!
//! // A mistake names the place, the value and the rule.
//! let error = Scenario::from_str(path, &text.replace("= 2", "= -2"), &[]).unwrap_err();
//! assert_eq!(
//!     error.to_string(),
//!     "`run.duration_s` is -2, but must be greater than 0: time runs forward"
//! );
//! assert_eq!(error.problems().next().and_then(|problem| problem.line()), Some(9));
//! # Ok::<(), truecut_scenario::ScenarioError>(())
//! ```

#![warn(missing_docs)]

mod adjust;
mod cell;
mod check;
mod claim;
mod column;
mod control;
mod data;
mod document;
pub mod effect;
mod error;
mod excerpt;
mod excite;
mod fault;
mod file;
mod fit;
mod foot;
mod format;
pub mod identification;
mod metric;
mod modes;
mod overwrite;
pub mod path_job;
mod process;
mod processes;
mod reach;
mod relocate;
mod renamed;
mod robot;
mod roughness;
mod run;
mod scenario;
mod schema;
mod structure;
mod suggest;
mod sweep;
mod sweep_check;
mod sweep_sample;
mod sweep_spec;
mod uncertain;
mod uncertain_law;
mod units;
mod windows;
mod written;
mod xacro_arguments;

pub use adjust::{JointSpec, LinkSpec};
pub use cell::CellFile;
pub use data::DataSpec;
pub use error::{Problem, ScenarioError};
pub use excerpt::{excerpt, harmless_text};
pub use excite::{Criterion, ExciteSpec, JointLimits, MOTION_TIME, MotionColumn, PlannedMotion};
pub use fit::{CoupledMotor, FitSpec, Unknown};
pub use foot::FootSpec;
pub use identification::Identification;
pub use path_job::PathJob;
pub use process::belt::{BeltJob, BeltSpec};
pub use process::brush::{AlongEdges, BrushSpec, BrushWay, EdgePlace, EdgeSpec};
pub use process::chamfer::{ChamferSpec, FeedDirection, Regeneration};
pub use process::load::{ForceSweep, LoadFrame, LoadSpec, RotatingForce};
pub use process::milling::{MillingSpec, PlannedPath};
pub use process::path_milling::{PathMillingSpec, SpindleSpec, StockSpec};
pub use process::polish::{GrainSpec, PolishSpec, TextureSpec};
pub use process::replay::{ReplayMode, ReplaySpec, Turning};
pub use process::surface_polish::SurfacePolishSpec;
pub use process::wheel::WheelSpec;
pub use process::{
    BrokenRule, CustomSpec, Definition, Facts, Knob, ModesIn, Parts, PostureFrom, ProcessSpec,
    WheelHold, WheelPart,
};
pub use processes::{NameTaken, Processes};
pub use relocate::named_from;
pub use robot::{DriveKind, RobotSpec};
pub use run::{FaultRule, LONGEST_S, RunSpec};
pub use scenario::Scenario;
pub use sweep::{BisectSpec, SweepAxis, SweepClaim, SweepColumn, SweepSpec};
pub use truecut_plan::motion::straight::{PathStart, StraightPath, TurnKnot};
pub use uncertain::{CLOCK_RATE, UncertainSpec};
pub use uncertain_law::UncertainLaw;
pub use units::{key_unit, si_symbol};
