//! Recordings as Parquet: complete, compact, written once at the end.

use std::fs::File;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use parquet::arrow::ArrowWriter;
use parquet::arrow::arrow_reader::ParquetRecordBatchReaderBuilder;
use parquet::basic::Compression;
use parquet::file::properties::{EnabledStatistics, WriterProperties};
use truecut_recording::{Chunk, ClaimResult, Header, Recording, Sink, SinkError};

use crate::error::{FileError, Reason};
use crate::table;

/// Writes a recording at its full rate. Equal recordings give equal bytes: no clock, no host, no map order goes in.
///
/// # Errors
/// A file that cannot be written.
pub fn write_parquet(path: &Path, recording: &Recording) -> Result<(), FileError> {
    let failed = |reason: Reason| FileError::new(path, reason);
    let schema = table::schema_with_ending(recording).map_err(|error| failed(std::io::Error::from(error).into()))?;
    let schema = Arc::new(schema);
    let columns = recording.columns.iter().map(Vec::as_slice);
    let batch = table::batch(&schema, &recording.time_s, columns).map_err(|error| failed(error.into()))?;
    let file = File::create(path).map_err(|error| failed(error.into()))?;
    let written = ArrowWriter::try_new(file, schema, Some(properties())).and_then(|mut writer| {
        writer.write(&batch)?;
        writer.close()
    });
    written.map(|_| ()).map_err(|error| failed(error.into()))
}

/// Writes the Parquet file when the run ends, and nothing before.
pub struct ParquetSink {
    path: PathBuf,
}

impl ParquetSink {
    /// A sink for a file, which is made (or overwritten) when the run ends.
    pub fn new(path: impl Into<PathBuf>) -> ParquetSink {
        ParquetSink { path: path.into() }
    }
}

impl Sink for ParquetSink {
    fn begin(&mut self, _: &Header) -> Result<(), SinkError> {
        Ok(())
    }

    fn chunk(&mut self, _: &Chunk<'_>) -> Result<(), SinkError> {
        Ok(())
    }

    fn finish(&mut self, recording: &Recording, _: &[ClaimResult]) -> Result<(), SinkError> {
        write_parquet(&self.path, recording).map_err(|FileError { path, reason }| {
            SinkError::new(path.display().to_string(), "write the recording", reason)
        })
    }
}

/// Simulated values hardly repeat, so that a dictionary costs time and saves nothing.
fn properties() -> WriterProperties {
    WriterProperties::builder()
        .set_created_by("truecut".to_owned())
        .set_dictionary_enabled(false)
        .set_compression(Compression::SNAPPY)
        .set_statistics_enabled(EnabledStatistics::Chunk)
        .build()
}

/// Reads what [`write_parquet`] wrote, and any Parquet file whose first column is `time` in seconds and whose other
/// columns are 64-bit floats with a `unit` in their metadata.
///
/// # Errors
/// A file that cannot be read, or whose columns are not a recording's.
pub fn read_parquet(path: &Path) -> Result<Recording, FileError> {
    let failed = |reason: Reason| FileError::new(path, reason);
    let file = File::open(path).map_err(|error| failed(error.into()))?;
    let builder = ParquetRecordBatchReaderBuilder::try_new(file).map_err(|error| failed(error.into()))?;
    let not_ours = |reason: String| failed(Reason::NotARecording(reason));
    let mut recording = table::recording_from_schema(builder.schema()).map_err(not_ours)?;
    let reader = builder.with_batch_size(65_536).build().map_err(|error| failed(error.into()))?;
    for batch in reader {
        let batch = batch.map_err(|error| failed(error.into()))?;
        table::append(&mut recording, &batch).map_err(not_ours)?;
    }
    Ok(recording)
}

/// Reads a recording by the ending of its name: `.parquet` or `.arrows`.
///
/// # Errors
/// As [`read_parquet`] and [`crate::read_ipc_stream`]; any other ending.
pub fn read_recording(path: &Path) -> Result<Recording, FileError> {
    match path.extension().and_then(|extension| extension.to_str()) {
        Some("parquet") => read_parquet(path),
        Some("arrows") => crate::read_ipc_stream(path),
        _ => Err(FileError::new(path, Reason::UnknownKind)),
    }
}
