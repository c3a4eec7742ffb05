//! Recordings: named channels with units on one time base, and everything that is read off them.
//!
//! A run and a measurement are the same thing here: a [`Recording`]. This crate knows no file
//! format, no engine and no scenario; what writes files implements [`Sink`].
//!
//! # A tour
//!
//! A simulator declares its channels, then pushes one row per step. The [`Recorder`] hands rows on
//! in chunks of at most a second, so that a run that dies leaves behind what it had done.
//!
//! ```
//! use truecut_recording::{ChannelSpec, Header, Outcome, Recorder, Scalar, Unit};
//!
//! let header = Header {
//!     scenario_name: "A swinging tool".into(),
//!     channels: vec![
//!         ChannelSpec::new("tool.displacement_y", Unit::Metre, "tool point, process frame"),
//!         ChannelSpec::new("foot.sliding", Unit::One, "1 while the foot slides"),
//!     ],
//!     ..Header::default()
//! };
//! let mut recorder = Recorder::new(header, Vec::new())?;
//! for step in 0..4000 {
//!     let t = f64::from(step) * 1e-3;
//!     let y = 2e-5 * (std::f64::consts::TAU * 5.0 * t).sin();
//!     recorder.push_row(t, &[y, if t < 2.6 { 0.0 } else { 1.0 }])?;
//! }
//! let spread = Scalar::new("chamfer.width_spread", Unit::Metre, 1.9e-5, "widest minus narrowest");
//! let (recording, sinks) = recorder.finish(vec![spread], Vec::new(), Outcome::Completed)?;
//! # assert_eq!(recording.time_s.len(), 4000);
//!
//! // A claim bounds a metric, in the unit of whoever wrote it.
//! use truecut_recording::{ClaimSpec, MetricSpec, Reducer, UserUnit, Window};
//!
//! let claim = ClaimSpec {
//!     name: "swings at the spindle's frequency".into(),
//!     metric: MetricSpec::Reduced {
//!         reducer: Reducer::SpectralLine { band_hz: [1.0, 50.0] },
//!         channels: vec!["tool.displacement_y".into()],
//!         window: Window::ALL,
//!     },
//!     unit: UserUnit::parse("Hz")?,
//!     min: Some(4.95),
//!     max: Some(5.05),
//!     reason: "the cutting force turns with the spindle, at 300 rpm".into(),
//!     relative_to: None,
//! };
//! let result = claim.evaluate(&recording, None)?;
//! assert!(result.holds, "{}", result.shown);
//! sinks.close(&recording, &[result])?;
//!
//! // Two recordings are compared channel by channel, each on its own time base.
//! use truecut_recording::compare;
//!
//! let deviation = compare(&recording, &recording, &["tool.displacement_y"], Window::ALL)?;
//! assert_eq!(deviation.nrmse, 0.0);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

#![warn(missing_docs)]

mod any_float;
mod claims;
mod compare;
pub mod fft;
pub mod filter;
pub mod measured;
mod metrics;
mod names;
mod part;
mod recorder;
mod recording;
pub mod reduce;
mod reducer;
mod scene;
mod sink;
pub mod spectrum;
mod spline;
mod summary;
mod unit;
mod window;

pub use any_float::NumberStatus;
pub use claims::{ClaimError, ClaimFault, ClaimResult, ClaimSpec, RunReference};
pub use compare::{CompareError, Deviation, compare};
pub use measured::{DataError, Mapping, Measured, MeasuredChannel, Pass, Role};
pub use metrics::{Metric, MetricError, MetricSpec};
pub use names::nearest;
pub use part::PartMesh;
pub use recorder::{OpenSinks, Pace, Recorder};
pub use recording::{ChannelSpec, Header, Outcome, Profile, Recording, Scalar, UnknownName};
pub use reducer::Reducer;
pub use scene::{Arrow, Body, Camera, Field, Frame, Geometry, Pose, Scene, Shape};
pub use sink::{Chunk, Sink, SinkError};
pub use spline::spline_slopes;
pub use summary::Summary;
pub use unit::{Unit, UnitError, UserUnit, short_number, significant};
pub use window::Window;
