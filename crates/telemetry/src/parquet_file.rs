//! Recordings as Parquet: complete and compact.

use std::fs::File;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use arrow::datatypes::SchemaRef;
use parquet::arrow::ArrowWriter;
use parquet::basic::Compression;
use parquet::file::metadata::KeyValue;
use parquet::file::properties::{EnabledStatistics, WriterProperties};
use truecut_files::{fresh, write_whole};
use truecut_recording::{Chunk, ClaimResult, Header, Recording, Sink, SinkError};

use crate::bounded::Bounded;
use crate::contained::contained;
use crate::error::{FileError, Reason, failed};
use crate::table;

/// Rows of a row group. Fixed, so that the file does not depend on when rows arrived.
const GROUP_ROWS: usize = 4096;

/// A Parquet file under construction.
struct RowWriter {
    schema: SchemaRef,
    writer: ArrowWriter<File>,
}

impl RowWriter {
    fn begin(file: File, header: &Header) -> Result<RowWriter, Reason> {
        let schema = Arc::new(table::schema(header));
        // Simulated values hardly repeat, so that a dictionary costs time and saves nothing.
        let properties = WriterProperties::builder()
            .set_created_by("truecut".to_owned())
            .set_dictionary_enabled(false)
            .set_compression(Compression::SNAPPY)
            .set_statistics_enabled(EnabledStatistics::Chunk)
            .build();
        let writer = ArrowWriter::try_new(file, Arc::clone(&schema), Some(properties))?;
        Ok(RowWriter { schema, writer })
    }

    fn group<'a>(
        &mut self,
        time_s: &'a [f64],
        columns: impl Iterator<Item = &'a [f64]>,
    ) -> Result<(), Reason> {
        self.writer
            .write(&table::batch(&self.schema, time_s, columns)?)?;
        Ok(self.writer.flush()?)
    }

    fn end(mut self, recording: &Recording) -> Result<(), Reason> {
        let ending = table::Ending::of(recording)
            .to_json()
            .map_err(std::io::Error::from)?;
        self.writer
            .append_key_value_metadata(KeyValue::new(table::ENDING.to_owned(), ending));
        self.writer.close()?;
        Ok(())
    }
}

/// Writes a recording at its full rate. Equal recordings give equal bytes: no clock, no host, no
/// map order goes in.
///
/// # Errors
/// A file that cannot be written.
pub fn write_parquet(path: &Path, recording: &Recording) -> Result<(), FileError> {
    let write = |file: &mut File| {
        let mut writer = RowWriter::begin(file.try_clone()?, &recording.header)?;
        let rows = recording.time_s.len();
        for start in (0..rows).step_by(GROUP_ROWS) {
            let group = start..rows.min(start + GROUP_ROWS);
            let columns = recording
                .columns
                .iter()
                .map(|column| &column[group.clone()]);
            writer.group(&recording.time_s[group.clone()], columns)?;
        }
        writer.end(recording)
    };
    write_whole(path, write).map_err(|reason| FileError::new(path, reason))
}

/// Writes a Parquet file while the run is under way; it bears its name only when it is complete,
/// and is then the same, byte by byte, as [`write_parquet`] writes.
pub struct ParquetSink {
    path: PathBuf,
    open: Option<OpenFile>,
}

struct OpenFile {
    writer: RowWriter,
    part: PartialFile,
    /// Rows that do not fill a group yet: time, then the channels.
    waiting: Vec<Vec<f64>>,
}

/// A file that is not complete. It is of no use to anyone, so it goes when its run does.
struct PartialFile(PathBuf);

impl Drop for PartialFile {
    fn drop(&mut self) {
        // Not there after it was given its name; else there is nobody to tell that it stays.
        let _ = std::fs::remove_file(&self.0);
    }
}

impl ParquetSink {
    /// A sink for a file, which is made (or overwritten) when the run ends.
    pub fn new(path: impl Into<PathBuf>) -> ParquetSink {
        ParquetSink {
            path: path.into(),
            open: None,
        }
    }
}

impl OpenFile {
    /// Writes the first so many of the waiting rows.
    fn group(&mut self, rows: usize) -> Result<(), Reason> {
        let mut columns = self.waiting.iter().map(|column| &column[..rows]);
        let time_s = columns.next().unwrap_or_default();
        self.writer.group(time_s, columns)?;
        for column in &mut self.waiting {
            column.drain(..rows);
        }
        Ok(())
    }

    fn waiting_rows(&self) -> usize {
        self.waiting.first().map_or(0, Vec::len)
    }

    fn end(mut self, path: &Path, recording: &Recording) -> Result<(), Reason> {
        if self.waiting_rows() > 0 {
            self.group(self.waiting_rows())?;
        }
        self.writer.end(recording)?;
        Ok(std::fs::rename(&self.part.0, path)?)
    }
}

impl Sink for ParquetSink {
    fn begin(&mut self, header: &Header) -> Result<(), SinkError> {
        let mut name = self.path.clone().into_os_string();
        name.push(".part");
        let part = PartialFile(name.into());
        let writer = fresh(&part.0)
            .map_err(Reason::from)
            .and_then(|file| RowWriter::begin(file, header))
            .map_err(failed(&self.path, "begin the recording"))?;
        let waiting = vec![Vec::new(); header.channels.len() + 1];
        self.open = Some(OpenFile {
            writer,
            part,
            waiting,
        });
        Ok(())
    }

    fn chunk(&mut self, chunk: &Chunk<'_>) -> Result<(), SinkError> {
        let failed = failed(&self.path, "write rows");
        let Some(open) = &mut self.open else {
            return Ok(());
        };
        let arrived = std::iter::once(&chunk.time_s).chain(&chunk.columns);
        for (waiting, arrived) in open.waiting.iter_mut().zip(arrived) {
            waiting.extend_from_slice(arrived);
        }
        while open.waiting_rows() >= GROUP_ROWS {
            open.group(GROUP_ROWS).map_err(&failed)?;
        }
        Ok(())
    }

    fn finish(&mut self, recording: &Recording, _: &[ClaimResult]) -> Result<(), SinkError> {
        let failed = failed(&self.path, "end the recording");
        self.open
            .take()
            .map_or(Ok(()), |open| open.end(&self.path, recording))
            .map_err(failed)
    }
}

/// Reads what [`write_parquet`] wrote, and any Parquet file whose first column is `time` in seconds
/// and whose other columns are 64-bit floats with a `unit` in their metadata.
///
/// # Errors
/// A file that cannot be read, or whose columns are not a recording's.
pub fn read_parquet(path: &Path) -> Result<Recording, FileError> {
    let read = || {
        let builder = Bounded::open(path)?;
        let mut recording =
            table::recording_from_schema(builder.schema()).map_err(Reason::NotARecording)?;
        for batch in builder.with_batch_size(65_536).build()? {
            table::append(&mut recording, &batch?).map_err(Reason::NotARecording)?;
        }
        Ok(recording)
    };
    contained(read).map_err(|reason| FileError::new(path, reason))
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
