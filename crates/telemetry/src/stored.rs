//! The channels of a Parquet recording, one at a time.

use std::path::{Path, PathBuf};

use arrow::array::AsArray;
use arrow::datatypes::Float64Type;
use parquet::arrow::ProjectionMask;
use truecut_recording::Header;

use crate::bounded::Bounded;
use crate::contained::contained;
use crate::error::{FileError, Reason};
use crate::table;

/// A Parquet file that a run of this program has written, of which a channel at a time is read: a
/// long run takes no more memory than one of its columns.
#[derive(Debug, Clone)]
pub struct StoredRows {
    path: PathBuf,
    header: Header,
}

impl StoredRows {
    /// Looks into a file that [`crate::write_parquet`] or [`crate::ParquetSink`] wrote.
    ///
    /// # Errors
    /// As [`crate::read_parquet`].
    pub fn open(path: &Path) -> Result<StoredRows, FileError> {
        let read = || {
            let builder = Bounded::open_own(path)?;
            table::recording_from_schema(builder.schema()).map_err(Reason::NotARecording)
        };
        let recording = contained(read).map_err(|reason| FileError::new(path, reason))?;
        Ok(StoredRows {
            path: path.to_owned(),
            header: recording.header,
        })
    }

    /// What the file says of its channels.
    pub fn header(&self) -> &Header {
        &self.header
    }

    /// All values of a channel by its place in the header, SI.
    ///
    /// # Errors
    /// A file that cannot be read, or that is another one by now.
    pub fn column(&self, channel: usize) -> Result<Vec<f64>, FileError> {
        let read = || {
            let builder = Bounded::open_own(&self.path)?;
            // The times stand before the channels.
            let mask = ProjectionMask::leaves(builder.parquet_schema(), [channel + 1]);
            let mut values = Vec::new();
            for batch in builder
                .with_projection(mask)
                .with_batch_size(65_536)
                .build()?
            {
                let batch = batch?;
                let column = batch.columns().first();
                let column = column.and_then(|column| column.as_primitive_opt::<Float64Type>());
                let missing = || Reason::NotARecording(format!("no channel {channel}"));
                values.extend_from_slice(column.ok_or_else(missing)?.values());
            }
            Ok(values)
        };
        contained(read).map_err(|reason| FileError::new(&self.path, reason))
    }
}
