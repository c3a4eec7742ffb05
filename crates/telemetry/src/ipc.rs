//! Recordings as an Arrow IPC stream, `.arrows`: safe on disk while the run is still under way.
//!
//! The stream is what any Arrow reader understands. After its end mark, where such readers stop,
//! follows one line of JSON with the outcome, scalars and profiles, which were not known when the
//! stream began.

use std::fs::File;
use std::io::{BufReader, BufWriter, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use arrow::datatypes::SchemaRef;
use arrow::ipc::reader::StreamReader;
use arrow::ipc::writer::StreamWriter;
use truecut_files::fresh;
use truecut_recording::{Chunk, ClaimResult, Header, Outcome, Recording, Sink, SinkError};

use crate::contained::contained;
use crate::error::{FileError, Reason, failed};
use crate::frames::{self, End};
use crate::table;

/// Streams rows into a file; every chunk is with the operating system when [`Sink::chunk`] returns,
/// so that killing the program loses nothing of it.
pub struct IpcSink {
    path: PathBuf,
    open: Option<OpenStream>,
}

struct OpenStream {
    schema: SchemaRef,
    writer: StreamWriter<BufWriter<File>>,
}

impl IpcSink {
    /// A sink for a file, which is made (or overwritten) when the run begins.
    pub fn new(path: impl Into<PathBuf>) -> IpcSink {
        IpcSink {
            path: path.into(),
            open: None,
        }
    }
}

impl Sink for IpcSink {
    fn begin(&mut self, header: &Header) -> Result<(), SinkError> {
        let failed = failed::<Reason>(&self.path, "begin the stream");
        let schema = Arc::new(table::schema(header));
        let file = fresh(&self.path).map_err(|error| failed(error.into()))?;
        let writer = StreamWriter::try_new(BufWriter::new(file), &schema).and_then(|mut writer| {
            writer.flush()?;
            Ok(writer)
        });
        self.open = Some(OpenStream {
            schema,
            writer: writer.map_err(|error| failed(error.into()))?,
        });
        Ok(())
    }

    fn chunk(&mut self, chunk: &Chunk<'_>) -> Result<(), SinkError> {
        let failed = failed::<Reason>(&self.path, "write rows");
        let Some(open) = &mut self.open else {
            return Ok(());
        };
        if chunk.time_s.is_empty() {
            return Ok(());
        }
        let batch = table::batch(&open.schema, chunk.time_s, chunk.columns.iter().copied());
        let written = batch.and_then(|batch| {
            open.writer.write(&batch)?;
            open.writer.flush()
        });
        written.map_err(|error| failed(error.into()))
    }

    fn finish(&mut self, recording: &Recording, _: &[ClaimResult]) -> Result<(), SinkError> {
        let failed = failed::<Reason>(&self.path, "end the stream");
        let Some(OpenStream { mut writer, .. }) = self.open.take() else {
            return Ok(());
        };
        writer.finish().map_err(|error| failed(error.into()))?;
        let mut file = writer.into_inner().map_err(|error| failed(error.into()))?;
        let ending = table::Ending::of(recording)
            .to_json()
            .map_err(|error| failed(std::io::Error::from(error).into()))?;
        let written = writeln!(file, "{ending}").and_then(|()| file.flush());
        written.map_err(|error| failed(error.into()))
    }
}

/// Reads a `.arrows` file, also one whose run was killed: what is whole is taken, the outcome is
/// then [`Outcome::Interrupted`], and a note says where the rows end.
///
/// # Errors
/// A file that cannot be read, that does not begin as an Arrow stream or is damaged before its end,
/// or whose columns are not a recording's.
pub fn read_ipc_stream(path: &Path) -> Result<Recording, FileError> {
    contained(|| read_stream(path)).map_err(|reason| FileError::new(path, reason))
}

fn read_stream(path: &Path) -> Result<Recording, Reason> {
    let mut file = truecut_files::open(path)?;
    let (whole, end) = frames::whole(&mut file)?;
    file.rewind()?;
    let messages = BufReader::new(file.try_clone()?.take(whole));
    let reader = StreamReader::try_new(messages, None)?;
    let mut recording =
        table::recording_from_schema(&reader.schema()).map_err(Reason::NotARecording)?;
    for batch in reader {
        table::append(&mut recording, &batch?).map_err(Reason::NotARecording)?;
    }
    // The last line is missing, or torn, where the writer was killed before it.
    let mut last = String::new();
    file.seek(SeekFrom::Start(whole))?;
    let is_text = end == End::Marked && file.read_to_string(&mut last).is_ok();
    let ending = is_text.then(|| table::ending_from_json(&last).ok());
    match ending.flatten() {
        Some(table::Ending {
            outcome,
            scalars,
            profiles,
        }) => Ok(Recording {
            outcome,
            scalars,
            profiles,
            ..recording
        }),
        None => {
            let last_s = recording
                .time_s
                .last()
                .map_or("no rows".to_owned(), |time| format!("{time} s"));
            recording
                .header
                .notes
                .push(format!("the run was interrupted; rows end at {last_s}"));
            recording.outcome = Outcome::Interrupted;
            Ok(recording)
        }
    }
}
