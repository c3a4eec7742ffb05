//! Records of an MCAP file, whose strings are looked at before they are read.
//!
//! A string is its length and its bytes. The library asks memory for as many as are said, up to
//! four gigabytes, before it looks whether they are there.

use mcap::McapResult;
use mcap::records::{Record, op};

use crate::error::Reason;

/// Bytes of a record's opcode and length.
const HEAD: usize = 9;

/// A record, or what a file says it is.
pub(super) type Parsed<'a> = Option<McapResult<Record<'a>>>;

/// A record of a kind that carries measured data, parsed; `None` for any other kind.
///
/// # Errors
/// A string, or a map of strings, that is longer than its record.
pub(super) fn parsed(opcode: u8, data: &[u8]) -> Result<Parsed<'_>, Reason> {
    let is_whole = match opcode {
        op::MESSAGE | op::DATA_END => Some(()),
        // Its number, then name and encoding.
        op::SCHEMA => after(data, 2).and_then(string).and_then(string).map(|_| ()),
        // Its number and its schema's, then topic, encoding and metadata.
        op::CHANNEL => after(data, 4)
            .and_then(string)
            .and_then(string)
            .and_then(map),
        // Times, size and checksum, then the compression.
        op::CHUNK => after(data, 28).and_then(string).map(|_| ()),
        _ => return Ok(None),
    };
    match is_whole {
        Some(()) => Ok(Some(mcap::parse_record(opcode, data))),
        None => Err(Reason::Damaged("a record ends in a string".to_owned())),
    }
}

/// Opcode and body of each record of an unpacked chunk.
///
/// # Errors
/// What `take` says; a record that is longer than the rest of the chunk.
pub(super) fn each(
    mut chunk: &[u8],
    mut take: impl FnMut(u8, &[u8]) -> Result<(), Reason>,
) -> Result<(), Reason> {
    let cut = || Reason::Damaged("a chunk ends in a record".to_owned());
    while !chunk.is_empty() {
        let (head, rest) = chunk.split_at_checked(HEAD).ok_or_else(cut)?;
        let length = std::array::from_fn(|i| head[1 + i]);
        let length = usize::try_from(u64::from_le_bytes(length)).map_err(|_| cut())?;
        let (body, rest) = rest.split_at_checked(length).ok_or_else(cut)?;
        take(head[0], body)?;
        chunk = rest;
    }
    Ok(())
}

fn after(data: &[u8], count: usize) -> Option<&[u8]> {
    data.get(count..)
}

/// What follows a string.
fn string(data: &[u8]) -> Option<&[u8]> {
    let (length, rest) = data.split_first_chunk()?;
    after(rest, usize::try_from(u32::from_le_bytes(*length)).ok()?)
}

/// Whether a map of strings is whole: its length in bytes, and pairs of strings.
fn map(data: &[u8]) -> Option<()> {
    let (length, rest) = data.split_first_chunk()?;
    let mut pairs = rest.get(..usize::try_from(u32::from_le_bytes(*length)).ok()?)?;
    while !pairs.is_empty() {
        pairs = string(pairs).and_then(string)?;
    }
    Some(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn text(text: &str) -> Vec<u8> {
        let length = u32::try_from(text.len()).unwrap().to_le_bytes();
        [&length, text.as_bytes()].concat()
    }

    #[test]
    fn a_channel_is_parsed_as_it_was_written_and_refused_where_it_is_cut() {
        let map = [text("a"), text("one")].concat();
        let length = u32::try_from(map.len()).unwrap().to_le_bytes().to_vec();
        let channel = [vec![7, 0, 3, 0], text("/topic"), text("cdr"), length, map].concat();
        let Some(Ok(Record::Channel(read))) = parsed(op::CHANNEL, &channel).unwrap() else {
            panic!("no channel");
        };
        assert_eq!((read.id, read.topic.as_str()), (7, "/topic"));
        assert_eq!(read.metadata["a"], "one");
        for cut in 0..channel.len() {
            assert!(parsed(op::CHANNEL, &channel[..cut]).is_err(), "{cut}");
        }
    }

    /// The library would ask for four gigabytes.
    #[test]
    fn lengths_beyond_the_record_ask_for_no_memory() {
        let long = u32::MAX.to_le_bytes();
        let schema = [&[1, 0], &long[..], b"name"].concat();
        assert!(parsed(op::SCHEMA, &schema).is_err());
        let chunk = [&[0; 28], &long[..], b"zstd"].concat();
        assert!(parsed(op::CHUNK, &chunk).is_err());
    }

    #[test]
    fn a_chunk_is_its_records() {
        let body = [1, 2, 3];
        let record = [&[op::MESSAGE], &3_u64.to_le_bytes()[..], &body].concat();
        let chunk = record.repeat(2);
        let mut count = 0;
        let taken = each(&chunk, |opcode, read| {
            count += usize::from(opcode == op::MESSAGE && read == body);
            Ok(())
        });
        assert!(taken.is_ok() && count == 2);
        assert!(each(&chunk[..chunk.len() - 1], |_, _| Ok(())).is_err());
    }
}
