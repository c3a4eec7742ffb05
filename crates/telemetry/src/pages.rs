//! What the pages of a Parquet file state about themselves, looked at before memory is asked for.
//!
//! The library asks memory for a page's stated size and for a dictionary's stated count of values
//! before it looks whether they are there.
//! <https://parquet.apache.org/docs/file-format/data-pages/>

use std::fs::File;
use std::io::{Read, Seek, SeekFrom};

use parquet::basic::{Compression, Type};
use parquet::file::metadata::{ColumnChunkMetaData, ParquetMetaData};

use crate::error::Reason;
use crate::thrift::{Contents, STRUCTURE};

/// Bytes of a page's head: without and with statistics whose values are long.
const HEADS: [u64; 2] = [4 << 10, 1 << 20];
/// Bytes that a compressor adds to whatever it gets.
const WRAPPING: u64 = 64;

/// Refuses pages that state more than they can hold.
///
/// # Errors
/// As said, with the byte of the file; a file that cannot be read.
pub(crate) fn check(
    file: &mut File,
    length: u64,
    contents: &ParquetMetaData,
) -> Result<(), Reason> {
    for chunk in contents
        .row_groups()
        .iter()
        .flat_map(|group| group.columns())
    {
        let first = (chunk.dictionary_page_offset()).unwrap_or_else(|| chunk.data_page_offset());
        let ends = first.saturating_add(chunk.compressed_size());
        let (mut at, ends) = (unsigned(first)?, unsigned(ends)?);
        while at < ends {
            at = page(file, length, chunk, at)?;
        }
    }
    Ok(())
}

fn unsigned(offset: i64) -> Result<u64, Reason> {
    u64::try_from(offset).map_err(|_| Reason::Damaged(format!("a column begins at byte {offset}")))
}

/// Where the page after the one at this byte begins.
fn page(file: &mut File, length: u64, chunk: &ColumnChunkMetaData, at: u64) -> Result<u64, Reason> {
    let damaged = |what: &str| Reason::Damaged(format!("the page at byte {at} {what}"));
    let (head, begins) = head(file, at)?.ok_or_else(|| damaged("has no head"))?;
    let ends = (u64::try_from(head.compressed).ok())
        .and_then(|size| (at + begins).checked_add(size))
        .filter(|ends| *ends <= length)
        .ok_or_else(|| damaged("goes beyond the end of the file"))?;
    let size = u64::try_from(head.uncompressed).unwrap_or(u64::MAX);
    if size > most(chunk.compression(), ends - at - begins) {
        return Err(damaged("states more bytes than its own can hold"));
    }
    if let Some(values) = head.dictionary {
        let values = u64::try_from(values).unwrap_or(u64::MAX);
        if values.saturating_mul(least_bits(chunk)) > size.saturating_mul(8) {
            return Err(damaged("is a dictionary of more values than it holds"));
        }
    }
    Ok(ends)
}

/// Head of a page: sizes of what follows it, bytes; values of a dictionary.
#[derive(Default)]
struct Head {
    uncompressed: i64,
    compressed: i64,
    dictionary: Option<i64>,
}

/// The head at this byte of a file and its length; `None` if there is none.
fn head(file: &mut File, at: u64) -> Result<Option<(Head, u64)>, Reason> {
    for most in HEADS {
        file.seek(SeekFrom::Start(at))?;
        let mut bytes = Vec::new();
        (&mut *file).take(most).read_to_end(&mut bytes)?;
        let mut contents = Contents::new(&bytes);
        if let Some(head) = parsed(&mut contents) {
            return Ok(Some((head, contents.at as u64)));
        }
    }
    Ok(None)
}

/// `PageHeader` of the format: 2 and 3 are the sizes, 7 is `DictionaryPageHeader` whose 1 is the
/// count of values.
fn parsed(contents: &mut Contents<'_>) -> Option<Head> {
    let mut head = Head::default();
    contents.fields(0, &mut |contents, field, kind| {
        match (field, kind) {
            (_, ..=2) => return Some(false),
            (2, _) => head.uncompressed = contents.signed()?,
            (3, _) => head.compressed = contents.signed()?,
            (7, STRUCTURE) => contents.fields(1, &mut |contents, field, kind| {
                let is_count = field == 1 && kind > 2;
                if is_count {
                    head.dictionary = Some(contents.signed()?);
                }
                Some(is_count)
            })?,
            _ => return Some(false),
        }
        Some(true)
    })?;
    Some(head)
}

/// Most bytes that so many compressed ones can stand for.
fn most(compression: Compression, compressed: u64) -> u64 {
    let times = match compression {
        Compression::UNCOMPRESSED => 1,
        // A copy of 64 bytes takes three (format_description.txt of google/snappy).
        Compression::SNAPPY => 22,
        // A byte of a length stands for 255 (lz4_Block_format.md of lz4/lz4).
        Compression::LZ4 | Compression::LZ4_RAW => 255,
        // <https://www.zlib.net/zlib_tech.html>
        Compression::GZIP(_) => 1032,
        // A block of 128 KiB takes four bytes (RFC 8878, 3.1.1.2); others are not read.
        _ => 1 << 15,
    };
    compressed.saturating_add(WRAPPING).saturating_mul(times)
}

/// Least bits that a value takes in a dictionary.
fn least_bits(chunk: &ColumnChunkMetaData) -> u64 {
    match chunk.column_type() {
        Type::BOOLEAN => 1,
        Type::INT32 | Type::FLOAT | Type::BYTE_ARRAY => 32,
        Type::INT64 | Type::DOUBLE => 64,
        Type::INT96 => 96,
        Type::FIXED_LEN_BYTE_ARRAY => {
            8 * u64::try_from(chunk.column_descr().type_length()).unwrap_or(0)
        }
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;
    use std::sync::Arc;

    use arrow::array::{ArrayRef, Float64Array, RecordBatch};
    use parquet::arrow::ArrowWriter;
    use parquet::basic::{GzipLevel, ZstdLevel};
    use parquet::file::properties::WriterProperties;

    use super::*;
    use crate::read_table;

    const VALUES: usize = 100;

    /// A hundred different values, then one that repeats; a column that is constant.
    fn written(path: &Path, compression: Compression) -> Vec<u8> {
        let rows = 50_000;
        let some = Float64Array::from_iter_values((0..rows).map(|row| row.min(VALUES - 1) as f64));
        let same = Float64Array::from_iter_values((0..rows).map(|_| 0.25));
        let columns = [
            ("some", Arc::new(some) as ArrayRef),
            ("same", Arc::new(same)),
        ];
        let batch = RecordBatch::try_from_iter(columns).unwrap();
        let properties = (WriterProperties::builder())
            .set_compression(compression)
            .set_column_dictionary_enabled("same".into(), false)
            .build();
        let mut bytes = Vec::new();
        let mut writer =
            ArrowWriter::try_new(&mut bytes, batch.schema(), Some(properties)).unwrap();
        writer.write(&batch).unwrap();
        writer.close().unwrap();
        std::fs::write(path, &bytes).unwrap();
        bytes
    }

    #[test]
    fn pages_of_every_compression_are_read() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("data.parquet");
        for compression in [
            Compression::UNCOMPRESSED,
            Compression::SNAPPY,
            Compression::LZ4,
            Compression::LZ4_RAW,
            Compression::GZIP(GzipLevel::try_new(9).unwrap()),
            Compression::ZSTD(ZstdLevel::try_new(19).unwrap()),
        ] {
            written(&path, compression);
            let table = read_table(&path, true).unwrap();
            assert_eq!(table.columns[0].values[VALUES], 99.0, "{compression:?}");
        }
    }

    /// `PageHeader` of a dictionary of this many values, up to the count.
    fn dictionary(values: [u8; 2]) -> Vec<u8> {
        [&[0x4c, 0x15], &values[..]].concat()
    }

    #[test]
    fn pages_that_state_more_than_they_hold_are_refused() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("data.parquet");
        let refused = |bytes: &[u8]| {
            std::fs::write(&path, bytes).unwrap();
            read_table(&path, true).unwrap_err().to_string()
        };
        let bytes = written(&path, Compression::UNCOMPRESSED);
        // Numbers are zigzag: 100 and 8191 values.
        let (found, more) = (dictionary([0xc8, 0x01]), dictionary([0xfe, 0x7f]));
        let at = bytes.windows(4).position(|four| four == found).unwrap();
        let mut damaged = bytes.clone();
        damaged[at..at + 4].copy_from_slice(&more);
        let error = refused(&damaged);
        assert!(error.contains("a dictionary of more values"), "{error}");

        // Kind, then 800 bytes of a dictionary, uncompressed and as they are: 8191.
        let sizes = [0x15, 0x04, 0x15, 0xc0, 0x0c, 0x15, 0xc0, 0x0c];
        let at = bytes.windows(8).position(|eight| eight == sizes).unwrap();
        let mut damaged = bytes.clone();
        damaged[at + 3..at + 5].copy_from_slice(&[0xfe, 0x7f]);
        let error = refused(&damaged);
        assert!(error.contains("more bytes than its own"), "{error}");
        let mut damaged = bytes;
        damaged[at..at + 8].fill(0xff);
        let error = refused(&damaged);
        assert!(error.contains("has no head"), "{error}");
    }
}
