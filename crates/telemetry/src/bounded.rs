//! A file for Parquet's reader that gives no memory for what it does not have.

use std::fs::File;
use std::io::{BufReader, Read, Seek, SeekFrom};
use std::path::Path;

use bytes::Bytes;
use parquet::arrow::arrow_reader::ParquetRecordBatchReaderBuilder;
use parquet::errors::{ParquetError, Result};
use parquet::file::reader::{ChunkReader, Length};

use crate::error::Reason;
use crate::{footer, pages};

pub(crate) type Builder = ParquetRecordBatchReaderBuilder<Bounded>;

/// A file and its length. Of a plain file the library asks memory for as many bytes as the file's
/// own table of contents says, before it looks whether they are there.
pub(crate) struct Bounded {
    file: File,
    length: u64,
}

impl Bounded {
    /// A file whose sizes and counts are looked at.
    pub(crate) fn open(path: &Path) -> std::result::Result<Builder, Reason> {
        Bounded::of(truecut_files::open(path)?)
    }

    /// The same of a file that this program wrote.
    pub(crate) fn open_own(path: &Path) -> std::result::Result<Builder, Reason> {
        Bounded::of(truecut_files::open_own(path)?)
    }

    fn of(mut file: File) -> std::result::Result<Builder, Reason> {
        let length = file.metadata()?.len();
        footer::check(&mut file, length)?;
        let mut pages = file.try_clone()?;
        let builder = Builder::try_new(Bounded { file, length })?;
        pages::check(&mut pages, length, builder.metadata())?;
        Ok(builder)
    }
}

impl Length for Bounded {
    fn len(&self) -> u64 {
        self.length
    }
}

impl ChunkReader for Bounded {
    type T = BufReader<File>;

    fn get_read(&self, start: u64) -> Result<Self::T> {
        let mut file = self.file.try_clone()?;
        file.seek(SeekFrom::Start(start))?;
        Ok(BufReader::new(file))
    }

    fn get_bytes(&self, start: u64, length: usize) -> Result<Bytes> {
        let ends = start.checked_add(length as u64);
        if ends.is_none_or(|ends| ends > self.length) {
            let what = format!(
                "{length} bytes at byte {start} of a file of {}",
                self.length
            );
            return Err(ParquetError::EOF(what));
        }
        let mut bytes = Vec::new();
        self.get_read(start)?
            .take(length as u64)
            .read_to_end(&mut bytes)?;
        Ok(bytes.into())
    }
}
