//! What a Parquet file states about itself, looked at before memory is asked for.
//!
//! The table of contents at the end of the file is written in Thrift's compact protocol. The
//! library asks memory for as many entries as a list states before it looks whether they are there.

use std::io::{Error, ErrorKind, Read, Result, Seek, SeekFrom};

use crate::thrift::Contents;

/// Behind the table of contents: its length and the format's mark.
const END: u64 = 8;
const MARK: &[u8] = b"PAR1";

/// Refuses a table of contents that states more entries, or longer ones, than it holds. What is no
/// Parquet file is left to the library.
///
/// # Errors
/// As said, with the byte of the file; a file that cannot be read.
pub(crate) fn check(file: &mut (impl Read + Seek), length: u64) -> Result<()> {
    let Some(end) = length.checked_sub(END) else {
        return Ok(());
    };
    let mut last = [0; END as usize];
    file.seek(SeekFrom::Start(end))?;
    file.read_exact(&mut last)?;
    let stated = u64::from(u32::from_le_bytes([last[0], last[1], last[2], last[3]]));
    let Some(start) = end.checked_sub(stated).filter(|_| last.ends_with(MARK)) else {
        return Ok(());
    };
    file.seek(SeekFrom::Start(start))?;
    let mut bytes = Vec::new();
    file.take(stated).read_to_end(&mut bytes)?;
    let mut contents = Contents::new(&bytes);
    contents.structure(0).ok_or_else(|| {
        let at = start + contents.at as u64;
        let text = format!("its table of contents is damaged at byte {at}");
        Error::new(ErrorKind::InvalidData, text)
    })
}

#[cfg(test)]
mod tests {
    use std::io::Cursor;

    use super::*;

    fn checked(contents: &[u8]) -> Result<()> {
        let length = u32::try_from(contents.len()).unwrap().to_le_bytes();
        let file = [MARK, contents, &length, MARK].concat();
        check(&mut Cursor::new(&file), file.len() as u64)
    }

    #[test]
    fn a_list_that_states_more_than_there_is_is_refused() {
        // Field 2, a list of three numbers of a byte; a text of two bytes; a truth; the end.
        checked(&[0x29, 0x35, 1, 2, 3, 0x18, 2, b'a', b'b', 0x11, 0]).unwrap();
        let error = checked(&[0x29, 0xf5, 0xff, 0xff, 0xff, 0x7f, 1, 2, 3, 0]).unwrap_err();
        assert!(error.to_string().contains("damaged at byte"), "{error}");
        checked(&[0x18, 0x7f, b'a', 0]).unwrap_err();
        checked(&[0x1c; 100]).unwrap_err();
        checked(&[]).unwrap_err();
    }

    #[test]
    fn what_is_no_parquet_file_is_left_to_the_library() {
        for bytes in [
            &b""[..],
            b"PAR1",
            b"no parquet file",
            b"\xff\xff\xff\xffPAR1",
        ] {
            check(&mut Cursor::new(bytes), bytes.len() as u64).unwrap();
        }
    }
}
