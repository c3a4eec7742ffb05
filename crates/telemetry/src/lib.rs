//! Recordings to files and back.

#![warn(missing_docs)]

mod axis;
mod background;
mod decimate;
mod display;
mod error;
mod ipc;
mod parquet_file;
pub mod plot;
mod rrd;
mod table;

pub use background::Background;
pub use error::{FileError, Reason};
pub use ipc::{IpcSink, read_ipc_stream};
pub use parquet_file::{ParquetSink, read_parquet, read_recording, write_parquet};
pub use rrd::RrdSink;
