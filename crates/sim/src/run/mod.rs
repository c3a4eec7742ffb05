//! A run in one call: a scenario, its measured data and an engine in; the recording and the claims
//! judged out.
//!
//! Everything that simulates goes through [`Run`]: [`Run::execute`] keeps the whole recording and
//! judges the claims, [`Run::rows`] gives a few channels as fast as they can be had.
//!
//! ```
//! use std::path::Path;
//! use truecut_scenario::Scenario;
//! use truecut_sim::run::{Engine, Run};
//!
//! let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios/arm/free_decay.toml");
//! let scenario = Scenario::load(&file, &[])?;
//! let rows = Run {
//!     engine: Engine::REDUCED,
//!     ..Run::of(&scenario)
//! }
//! .rows(&["tool.displacement_y"], None)?;
//! assert_eq!(rows.columns[0].len(), rows.time_s.len());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod clearance;
mod error;
mod judge;
mod record;
mod request;
mod rows;
mod runs;
mod scalars;

pub use crate::engine::{Engine, StepsPerPeriod};
pub use error::RunError;
pub use request::{Claims, Extent, Finished, Keep, ReadData, Run};
pub use rows::Rows;
pub use runs::Runs;
pub(crate) use scalars::taken;
