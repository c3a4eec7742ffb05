//! What can go wrong with a file.

use std::path::{Path, PathBuf};

/// A file that cannot be written or read.
#[derive(Debug, thiserror::Error)]
#[error("{}: {reason}", .path.display())]
pub struct FileError {
    /// The file.
    pub path: PathBuf,
    /// What is wrong with it.
    pub reason: Reason,
}

/// What is wrong with a file.
#[derive(Debug, thiserror::Error)]
pub enum Reason {
    /// The file system refuses.
    #[error(transparent)]
    Io(#[from] std::io::Error),
    /// Not an Arrow stream, or a broken one.
    #[error(transparent)]
    Arrow(#[from] arrow::error::ArrowError),
    /// Not a Parquet file, or a broken one.
    #[error(transparent)]
    Parquet(#[from] parquet::errors::ParquetError),
    /// Readable, but not a recording.
    #[error("not a recording: {0}")]
    NotARecording(String),
    /// Neither of the endings that are known.
    #[error("unknown kind of file; recordings end in .parquet or .arrows")]
    UnknownKind,
}

impl FileError {
    pub(crate) fn new(path: &Path, reason: impl Into<Reason>) -> FileError {
        FileError {
            path: path.to_owned(),
            reason: reason.into(),
        }
    }
}
