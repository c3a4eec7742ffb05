//! What can go wrong with a file.

use std::path::{Path, PathBuf};

use truecut_recording::SinkError;

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
    /// Lengths or contents that contradict each other.
    #[error("the file is damaged: {0}")]
    Damaged(String),
    /// Readable, but not a recording.
    #[error("not a recording: {0}")]
    NotARecording(String),
    /// Not CSV.
    #[error(transparent)]
    Csv(#[from] csv::Error),
    /// A cell of a table.
    #[error("line {line}, column \"{column}\": \"{value}\" is not a number")]
    Cell {
        /// Counted from 1.
        line: usize,
        /// Its name.
        column: String,
        /// As in the file.
        value: String,
    },
    /// A cell of a table that is wrong in a way of its own.
    #[error("line {line}, column \"{column}\": {message}")]
    CellFault {
        /// Counted from 1.
        line: usize,
        /// Its name.
        column: String,
        /// Value and rule.
        message: String,
    },
    /// A line of a table.
    #[error("line {line}: {message}")]
    Line {
        /// Counted from 1.
        line: usize,
        /// Value and rule.
        message: String,
    },
    /// Readable, but not a table of numbers.
    #[error("not a table of numbers: {0}")]
    NotATable(String),
    /// Neither of the endings of a table.
    #[error(
        "unknown kind of file; measured data ends in .csv, .txt, .xml, .parquet, .arrow or .mcap"
    )]
    UnknownTable,
    /// A log where one table is needed.
    #[error("a log has topics with times of their own; it is read as `data.file` of a scenario")]
    LogForTable,
    /// Not an MCAP file, a broken one, or one that ends too early.
    #[error("{0}")]
    Log(String),
    /// A ROS 2 bag in SQLite.
    #[error(
        "a ROS 2 bag in SQLite is not read; make an MCAP file of it with \
         `pip install rosbags` and `rosbags-convert --src BAG --dst NEW_BAG --dst-storage mcap`"
    )]
    Sqlite,
    /// A file of MATLAB's, or in HDF5.
    #[error(
        "files of MATLAB and HDF5 are not read; make a table of it with \
         `pip install \"truecut[convert]\"` and `python -m truecut.convert FILE -o NEW.parquet`"
    )]
    Hierarchical,
    /// A folder, which a ROS 2 bag is.
    #[error("it is a folder; of a ROS 2 bag, give the .mcap file in it")]
    Folder,
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

/// What a writer says of a file where it could not do something.
pub(crate) fn failed<E>(path: &Path, action: &'static str) -> impl Fn(E) -> SinkError + use<E>
where
    E: Into<Box<dyn std::error::Error + Send + Sync>>,
{
    let target = path.display().to_string();
    move |error| SinkError::new(target.clone(), action, error)
}
