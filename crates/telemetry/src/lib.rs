//! Recordings to files and back.
//!
//! - `.rrd`, written while the run is under way: what a person wants to see (the arm in 3-D,
//!   curves, states, spectra, claims). Read by the rerun viewer, 0.36.
//! - `.arrows`, written while the run is under way: every row, then the results. Read by
//!   [`read_ipc_stream`] and any Arrow reader.
//! - `.parquet`, written at the end: every row and the results, the same bytes for the same run.
//!   Read by [`read_parquet`] and any Parquet reader.
//!
//! Measured data comes in as CSV, as any Parquet or Arrow file of numbers ([`read_table`]), or as a
//! log of ROS 2 messages in an MCAP file ([`read_tables`]).
//!
//! Tables are SI, with `unit` and `description` in each column's metadata. The `.rrd` is for eyes:
//! µm, mm and degrees, at most a thousand points a second of each channel, the smallest and largest
//! of every interval among them.
//!
//! # A tour
//!
//! Sinks are given to a recorder. In the [`Background`] they do not hold the run up.
//!
//! ```
//! use truecut_recording::{ChannelSpec, Header, Outcome, Recorder, Sink, Unit};
//! use truecut_telemetry::{Background, IpcSink, ParquetSink, RrdSink};
//!
//! let folder = tempfile::tempdir()?;
//! let sinks: Vec<Box<dyn Sink + Send>> = vec![
//!     Box::new(RrdSink::new(folder.path().join("recording.rrd"))),
//!     Box::new(IpcSink::new(folder.path().join("recording.arrows"))),
//!     Box::new(ParquetSink::new(folder.path().join("recording.parquet"))),
//! ];
//! let header = Header {
//!     scenario_name: "A tool that is pushed aside".into(),
//!     channels: vec![ChannelSpec::new(
//!         "tool.displacement_y",
//!         Unit::Metre,
//!         "tool point, process frame",
//!     )],
//!     ..Header::default()
//! };
//! let mut recorder = Recorder::new(header, vec![Box::new(Background::new(sinks))])?;
//! for step in 0..2000 {
//!     let t = f64::from(step) * 1e-3;
//!     recorder.push_row(t, &[1e-5 * t])?;
//! }
//! let (recording, sinks) = recorder.finish(Vec::new(), Vec::new(), Outcome::Completed)?;
//! sinks.close(&recording, &[])?;
//!
//! // What was written is there again, bit by bit.
//! use truecut_telemetry::{read_ipc_stream, read_parquet};
//!
//! assert_eq!(read_parquet(&folder.path().join("recording.parquet"))?, recording);
//! assert_eq!(read_ipc_stream(&folder.path().join("recording.arrows"))?, recording);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

#![warn(missing_docs)]

mod axis;
mod background;
mod bounded;
mod columns;
mod contained;
#[cfg(any(test, feature = "contract"))]
pub mod contract;
mod decimate;
mod display;
mod error;
mod footer;
mod frames;
mod ipc;
mod layout;
mod log;
mod pages;
mod parquet_file;
mod rrd;
mod stored;
mod table;
mod tables;
mod thrift;

pub use background::Background;
pub use columns::{Column, Values, write_columns};
pub use error::{FileError, Reason};
pub use ipc::{IpcSink, read_ipc_stream};
pub use parquet_file::{ParquetSink, read_parquet, read_recording, write_parquet};
pub use rrd::{
    BeforeAfter, ChannelBeforeAfter, Chart, ChartPage, Curve, CurveStyle, FaceShown, PartShown,
    PlanShown, PlanStation, RrdSink, write_before_after, write_charts, write_part, write_plan,
};
pub use stored::StoredRows;
pub use table::record_batch;
pub use tables::{read_table, read_tables};
