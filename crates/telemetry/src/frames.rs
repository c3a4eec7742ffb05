//! How far the messages of an Arrow stream are whole.
//!
//! A message is a mark, the length of what describes it, that description, and its body. Lengths
//! are looked at before anything is read by them: a damaged one asks for memory that the file does
//! not have.

use std::io::{Read, Seek, SeekFrom};

use arrow::ipc::root_as_message;

use crate::error::Reason;

/// Begins every message.
const MARK: [u8; 4] = [0xff; 4];
/// Bytes of the mark and the length.
const HEAD: u64 = 8;

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
    let damaged = |at: u64, what: String| Reason::Damaged(format!("byte {at}: {what}"));
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
        at += HEAD + described + body;
        stream.seek(SeekFrom::Start(at))?;
    }
    Ok((at, End::Torn))
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
