//! How far the messages of an Arrow stream are whole, and whether a file of them is.
//!
//! A message is a mark, the length of what describes it, that description, and its body. Lengths
//! are looked at before anything is read by them: a damaged one asks for memory that the file does
//! not have.

use std::io::{Read, Seek, SeekFrom};

use arrow::ipc::reader::read_footer_length;
use arrow::ipc::{Block, CompressionType, Message, RecordBatch, root_as_footer, root_as_message};

use crate::error::Reason;

/// Begins every message.
const MARK: [u8; 4] = [0xff; 4];
/// Bytes of the mark and the length.
const HEAD: u64 = 8;
/// Bytes of a file's end: the length of its footer, and what it began with.
const TRAILER: usize = 10;
/// A compressed buffer begins with its length as it will be, in so many bytes.
const PREFIX: u64 = 8;
/// So many times its bytes holds an LZ4 block at most: a match's length grows by 255 a byte.
const LZ4_HOLDS: u64 = 255;
/// So many times its bytes holds a Zstandard frame at most: four bytes repeat one 128 Ki times.
const ZSTD_HOLDS: u64 = 32 * 1024;
/// What a frame of a few bytes may hold beyond its share, bytes.
const AND_HOLDS: u64 = 64 * 1024;

/// How a stream ends.
#[derive(Debug, PartialEq)]
pub(crate) enum End {
    /// With its end mark.
    Marked,
    /// Within a message, as a writer leaves it that was killed.
    Torn,
}

/// The bytes of whole messages with the end mark, and how the stream ends.
///
/// # Errors
/// Bytes that begin no message; a description that is none.
pub(crate) fn whole(stream: &mut (impl Read + Seek)) -> Result<(u64, End), Reason> {
    let length = stream.seek(SeekFrom::End(0))?;
    stream.rewind()?;
    let mut at = 0;
    while length - at >= HEAD {
        let mut head = [0; HEAD as usize];
        stream.read_exact(&mut head)?;
        let [mark, described] = [0, 4].map(|from| [0, 1, 2, 3].map(|i| head[from + i]));
        if mark != MARK {
            return Err(damaged(at, "no message begins here".to_owned()));
        }
        let described = i32::from_le_bytes(described);
        if described == 0 {
            return Ok((at + HEAD, End::Marked));
        }
        let Ok(described) = u64::try_from(described) else {
            return Err(damaged(at + 4, format!("a length of {described} bytes")));
        };
        if described > length - at - HEAD {
            break;
        }
        let mut description = Vec::new();
        stream.take(described).read_to_end(&mut description)?;
        let message = root_as_message(&description);
        let message = message.map_err(|error| damaged(at + HEAD, error.to_string()))?;
        let Ok(body) = u64::try_from(message.bodyLength()) else {
            let what = format!("a body of {} bytes", message.bodyLength());
            return Err(damaged(at + HEAD, what));
        };
        if body > length - at - HEAD - described {
            break;
        }
        compressed(stream, &message, at + HEAD + described, body)?;
        at += HEAD + described + body;
        stream.seek(SeekFrom::Start(at))?;
    }
    Ok((at, End::Torn))
}

/// Looks at the lengths that a file of Arrow (not a stream) states.
///
/// # Errors
/// A footer, a message or a buffer that the file does not have; a description that is none.
pub(crate) fn whole_file(file: &mut (impl Read + Seek)) -> Result<(), Reason> {
    let length = file.seek(SeekFrom::End(0))?;
    let Some(trailer) = length.checked_sub(TRAILER as u64) else {
        return Err(damaged(0, format!("a file of {length} bytes has no end")));
    };
    let mut end = [0; TRAILER];
    file.seek(SeekFrom::Start(trailer))?;
    file.read_exact(&mut end)?;
    let footer = read_footer_length(end)? as u64;
    if footer > trailer {
        let what = format!("a footer of {footer} bytes in a file of {length}");
        return Err(damaged(trailer, what));
    }
    let bytes = read(file, trailer - footer, footer)?;
    let footer = root_as_footer(&bytes);
    let footer = footer.map_err(|error| damaged(trailer, error.to_string()))?;
    let batches = footer.recordBatches().into_iter().flatten();
    let dictionaries = footer.dictionaries().into_iter().flatten();
    dictionaries
        .chain(batches)
        .try_for_each(|block| whole_block(file, block, length))
}

fn whole_block(file: &mut (impl Read + Seek), block: &Block, length: u64) -> Result<(), Reason> {
    let parts = (
        u64::try_from(block.offset()),
        u64::try_from(block.metaDataLength()),
        u64::try_from(block.bodyLength()),
    );
    let (Ok(at), Ok(described), Ok(body)) = parts else {
        return Err(damaged(length, format!("a block of {block:?}")));
    };
    let ends = at
        .checked_add(described)
        .and_then(|at| at.checked_add(body));
    if described < HEAD || ends.is_none_or(|ends| ends > length) {
        let what = format!("a block of {described} and {body} bytes in a file of {length}");
        return Err(damaged(at, what));
    }
    let bytes = read(file, at, described)?;
    // Files of before 2019 have the length without a mark before it.
    let head = if bytes[..4] == MARK { 8 } else { 4 };
    let message = root_as_message(&bytes[head..]);
    let message = message.map_err(|error| damaged(at, error.to_string()))?;
    compressed(file, &message, at + described, body)
}

/// Looks at the lengths that a message's compressed buffers say that they will have.
///
/// # Errors
/// A buffer outside of the body; a length that none of its compression can have.
fn compressed(
    file: &mut (impl Read + Seek),
    message: &Message<'_>,
    body_at: u64,
    body: u64,
) -> Result<(), Reason> {
    let dictionary = message.header_as_dictionary_batch();
    let batch = message.header_as_record_batch();
    let batch: Option<RecordBatch<'_>> = batch.or_else(|| dictionary.and_then(|it| it.data()));
    let Some(compression) = batch.and_then(|batch| batch.compression()) else {
        return Ok(());
    };
    let holds = match compression.codec() {
        CompressionType::LZ4_FRAME => LZ4_HOLDS,
        _ => ZSTD_HOLDS,
    };
    for buffer in batch
        .and_then(|batch| batch.buffers())
        .into_iter()
        .flatten()
    {
        let parts = (
            u64::try_from(buffer.offset()),
            u64::try_from(buffer.length()),
        );
        let inside = match parts {
            (Ok(from), Ok(long)) => from
                .checked_add(long)
                .filter(|end| *end <= body)
                .map(|_| (body_at + from, long)),
            _ => None,
        };
        let Some((at, long)) = inside else {
            let what = format!("a buffer outside of its message's {body} bytes");
            return Err(damaged(body_at, what));
        };
        if long < PREFIX {
            continue;
        }
        file.seek(SeekFrom::Start(at))?;
        let mut prefix = [0; PREFIX as usize];
        file.read_exact(&mut prefix)?;
        // −1 says that the buffer is as it is.
        let says = i64::from_le_bytes(prefix);
        let most = (long - PREFIX).saturating_mul(holds) + AND_HOLDS;
        if says < -1 || u64::try_from(says).is_ok_and(|says| says > most) {
            let what = format!("{} compressed bytes say they are {says}", long - PREFIX);
            return Err(damaged(at, what));
        }
    }
    Ok(())
}

fn read(file: &mut (impl Read + Seek), at: u64, length: u64) -> Result<Vec<u8>, Reason> {
    let mut bytes = Vec::new();
    file.seek(SeekFrom::Start(at))?;
    file.take(length).read_to_end(&mut bytes)?;
    Ok(bytes)
}

fn damaged(at: u64, what: String) -> Reason {
    Reason::Damaged(format!("byte {at}: {what}"))
}

#[cfg(test)]
mod tests {
    use std::io::Cursor;
    use std::sync::Arc;

    use arrow::array::{Float64Array, RecordBatch};
    use arrow::datatypes::{DataType, Field, Schema};
    use arrow::ipc::writer::StreamWriter;

    use super::*;

    fn stream() -> Vec<u8> {
        let field = Field::new("time", DataType::Float64, false);
        let schema = Arc::new(Schema::new(vec![field]));
        let mut writer = StreamWriter::try_new(Vec::new(), &schema).unwrap();
        for batch in 0..3 {
            let rows = (0..5).map(|row| f64::from(5 * batch + row));
            let rows = Arc::new(Float64Array::from_iter_values(rows));
            let batch = RecordBatch::try_new(Arc::clone(&schema), vec![rows]).unwrap();
            writer.write(&batch).unwrap();
        }
        writer.into_inner().unwrap()
    }

    #[test]
    fn a_stream_is_whole_to_its_end_mark_whatever_follows() {
        let mut bytes = stream();
        let length = bytes.len() as u64;
        assert_eq!(
            whole(&mut Cursor::new(&bytes)).unwrap(),
            (length, End::Marked)
        );
        bytes.extend(b"{\"outcome\": 1}\n");
        assert_eq!(
            whole(&mut Cursor::new(&bytes)).unwrap(),
            (length, End::Marked)
        );
    }

    #[test]
    fn a_stream_cut_anywhere_is_whole_up_to_a_message_before() {
        let bytes = stream();
        for cut in 0..bytes.len() {
            let (whole, end) = whole(&mut Cursor::new(&bytes[..cut])).unwrap();
            assert!(whole <= cut as u64, "{whole} of {cut}");
            // The end mark takes the last eight bytes.
            assert_eq!(end, End::Torn);
        }
    }

    #[test]
    fn what_begins_no_message_and_lengths_below_zero_are_told_with_their_place() {
        let mut bytes = stream();
        bytes[4..8].copy_from_slice(&(-5_i32).to_le_bytes());
        let error = whole(&mut Cursor::new(&bytes)).unwrap_err().to_string();
        assert_eq!(error, "the file is damaged: byte 4: a length of -5 bytes");
        bytes[0] = 0;
        let error = whole(&mut Cursor::new(&bytes)).unwrap_err().to_string();
        assert_eq!(error, "the file is damaged: byte 0: no message begins here");
    }
}
