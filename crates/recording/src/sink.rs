//! Where rows go while a run is under way.

use crate::claims::ClaimResult;
use crate::recording::{Header, Recording};
use crate::scene::Frame;

/// Rows and frames that leave together.
#[derive(Clone, Debug)]
pub struct Chunk<'a> {
    /// Ascending times of the rows; never empty unless there are frames.
    pub time_s: &'a [f64],
    /// One slice for each channel, as long as `time_s`, SI.
    pub columns: Vec<&'a [f64]>,
    /// Frames since the last chunk, fewer than rows.
    pub frames: &'a [Frame],
}

/// Takes a recording piece by piece, e.g. into a file. Called in the order `begin`, `chunk` any
/// number of times, `finish`; a run that is killed never gets to `finish`, so what a chunk holds
/// must be safe when `chunk` returns (or soon after, where a sink works in the background).
pub trait Sink {
    /// Before the first row.
    ///
    /// # Errors
    /// What cannot be written.
    fn begin(&mut self, header: &Header) -> Result<(), SinkError>;

    /// The next rows.
    ///
    /// # Errors
    /// What cannot be written.
    fn chunk(&mut self, chunk: &Chunk<'_>) -> Result<(), SinkError>;

    /// After the last row, with everything that the run computed. The recording has the times of
    /// all rows, but columns of those channels alone that the run keeps: all were in the chunks.
    ///
    /// # Errors
    /// What cannot be written.
    fn finish(&mut self, recording: &Recording, claims: &[ClaimResult]) -> Result<(), SinkError>;
}

/// What could not be written, where, and why.
#[derive(Debug, thiserror::Error)]
#[error("{target}: cannot {action}: {source}")]
pub struct SinkError {
    /// The file or stream.
    pub target: String,
    /// What was tried.
    pub action: &'static str,
    /// Why it failed.
    pub source: Box<dyn std::error::Error + Send + Sync>,
}

impl SinkError {
    /// What could not be written, where, and why.
    pub fn new(
        target: impl Into<String>,
        action: &'static str,
        source: impl Into<Box<dyn std::error::Error + Send + Sync>>,
    ) -> SinkError {
        SinkError {
            target: target.into(),
            action,
            source: source.into(),
        }
    }
}
