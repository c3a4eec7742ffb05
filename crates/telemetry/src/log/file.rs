//! The records of an MCAP file, in their order.
//!
//! Chunks are unpacked here, by libraries that end where a chunk says that it does: a damaged chunk
//! is an error, and no endless one.

use std::io::Read;
use std::path::Path;

use lz4_flex::frame::FrameDecoder;
use mcap::McapError;
use mcap::records::{ChunkHeader, Record};
use mcap::sans_io::{LinearReadEvent, LinearReader, LinearReaderOptions};

use super::record::{each, parsed};
use crate::error::Reason;

/// Longest record, and largest chunk once it is unpacked, bytes. Recorders make chunks of about a
/// megabyte.
const MOST_BYTES: u64 = 1 << 30;
/// Bytes read at once. A record is asked for whole; memory grows with what the file has of it.
const PIECE: usize = 1 << 20;

/// Gives each record of the data section to `take`; chunks are unpacked, and their checksums held.
pub(super) fn records(
    path: &Path,
    mut take: impl FnMut(Record) -> Result<(), Reason>,
) -> Result<(), Reason> {
    let most = MOST_BYTES.min(truecut_files::memory_limit() / 8);
    let options = LinearReaderOptions::default()
        .with_emit_chunks(true)
        .with_record_length_limit(usize::try_from(most).unwrap_or(usize::MAX));
    let mut reader = LinearReader::new_with_options(options);
    let mut file = truecut_files::open(path)?;
    let mut has_data_ended = false;
    while let Some(event) = reader.next_event() {
        match event.map_err(|error| told(&error, has_data_ended))? {
            LinearReadEvent::ReadRequest(bytes) => {
                let read = file.read(reader.insert(bytes.min(PIECE)))?;
                reader.notify_read(read);
            }
            LinearReadEvent::Record { data, opcode } => {
                let Some(record) = parsed(opcode, data)? else {
                    continue;
                };
                let record = record.map_err(|error| told(&error, has_data_ended))?;
                has_data_ended |= matches!(record, Record::DataEnd(_));
                match record {
                    // The summary that follows says again what was said.
                    _ if has_data_ended => {}
                    Record::Chunk { header, data } => chunk(&header, &data, most, &mut take)?,
                    record => take(record)?,
                }
            }
        }
    }
    Ok(())
}

/// The records of a chunk.
fn chunk(
    header: &ChunkHeader,
    packed: &[u8],
    most: u64,
    take: &mut impl FnMut(Record) -> Result<(), Reason>,
) -> Result<(), Reason> {
    let bytes = unpacked(header, packed, most)?;
    if header.uncompressed_crc != 0 && header.uncompressed_crc != crc32fast::hash(&bytes) {
        return Err(damaged("the checksum of a chunk is another"));
    }
    each(&bytes, |opcode, data| match parsed(opcode, data)? {
        Some(record) => take(record.map_err(|error| damaged(&error.to_string()))?),
        None => Ok(()),
    })
}

fn unpacked(header: &ChunkHeader, packed: &[u8], most: u64) -> Result<Vec<u8>, Reason> {
    let size = header.uncompressed_size;
    if size > most {
        let text = format!("a chunk would have {size} bytes; up to {most} are read");
        return Err(Reason::Log(text));
    }
    // One byte more tells a chunk that is longer than it says.
    let (taken, mut bytes) = (size.saturating_add(1), Vec::new());
    let read = match header.compression.as_str() {
        "" => packed.take(taken).read_to_end(&mut bytes),
        "zstd" => zstd::Decoder::with_buffer(packed)
            .and_then(|packed| packed.take(taken).read_to_end(&mut bytes)),
        "lz4" => FrameDecoder::new(packed)
            .take(taken)
            .read_to_end(&mut bytes),
        other => {
            return Err(Reason::Log(format!(
                "its chunks are compressed as \"{other}\"; \"zstd\", \"lz4\" and none are read"
            )));
        }
    };
    read.map_err(|error| damaged(&format!("a chunk cannot be unpacked: {error}")))?;
    match bytes.len() as u64 == size {
        true => Ok(bytes),
        false => Err(damaged("a chunk is not as long as it says")),
    }
}

fn damaged(what: &str) -> Reason {
    Reason::Damaged(what.to_owned())
}

fn told(error: &McapError, has_data_ended: bool) -> Reason {
    match error {
        McapError::BadMagic => {
            Reason::Log("it is not an MCAP file, or its end is missing".to_owned())
        }
        McapError::UnexpectedEof | McapError::UnexpectedEoc => {
            let where_it_ends = match has_data_ended {
                true => "in its summary",
                false => "in the middle of its data",
            };
            Reason::Log(format!(
                "the file ends {where_it_ends}: it was cut, or is still being written; the \
                 `mcap recover` tool saves what is there"
            ))
        }
        other => damaged(&other.to_string()),
    }
}
