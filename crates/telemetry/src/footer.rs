//! What a Parquet file states about itself, looked at before memory is asked for.
//!
//! The table of contents at the end of the file is written in Thrift's compact protocol. The
//! library asks memory for as many entries as a list states before it looks whether they are there.

use std::io::{Error, ErrorKind, Read, Result, Seek, SeekFrom};

use crate::layout;
use crate::thrift::Contents;

/// Behind the table of contents: its length and the format's mark.
const END: u64 = 8;
const MARK: &[u8] = b"PAR1";

/// Refuses a table of contents that states more entries, or longer ones, than it holds, or whose
/// fields are not those of the format. What is no Parquet file is left to the library.
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
    layout::contents(&mut contents).ok_or_else(|| {
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

    /// Version 1, a schema of one element called "a", no rows, these row groups, and the end.
    fn contents(row_groups: &[u8]) -> Vec<u8> {
        [
            &[0x15, 2, 0x19, 0x1c, 0x48, 1, b'a', 0, 0x16, 0, 0x19],
            row_groups,
            &[0],
        ]
        .concat()
    }

    /// One of no column, bytes and rows, with a field behind them.
    fn row_group(further: &[u8]) -> Vec<u8> {
        [&[0x1c, 0x19, 0x0c, 0x16, 0, 0x16, 0], further, &[0]].concat()
    }

    fn refused(contents: &[u8]) {
        let error = checked(contents).unwrap_err();
        assert!(error.to_string().contains("damaged at byte"), "{error}");
    }

    #[test]
    fn a_list_that_states_more_than_there_is_is_refused() {
        checked(&contents(&[0x0c])).unwrap();
        checked(&contents(&row_group(&[]))).unwrap();
        // A list of 2^28 row groups; one of 127 bytes of a name; structures without an end; none.
        refused(&contents(&[0xfc, 0xff, 0xff, 0xff, 0x7f, 0]));
        refused(&[
            0x15, 2, 0x19, 0x1c, 0x48, 0x7f, b'a', 0, 0x16, 0, 0x19, 0x0c, 0,
        ]);
        refused(&[0x1c; 100]);
        refused(&[]);
    }

    /// The library reads the fourth field of a row group as a list, of whatever kind it is: a
    /// number, a text, or a list of numbers as one of structures. A structure without what it must
    /// have stands for hundreds of bytes by one.
    #[test]
    fn fields_of_another_kind_are_refused() {
        let sorted = [0x19, 0x1c, 0x15, 0, 0x11, 0x11, 0];
        checked(&contents(&row_group(&sorted))).unwrap();
        refused(&contents(&row_group(&[0x16, 0xfc, 0xff, 0xff, 0x7f])));
        refused(&contents(&row_group(&[0x18, 2, b'a', b'b'])));
        refused(&contents(&row_group(&[0x19, 0x35, 1, 2, 3])));
        refused(&contents(&row_group(&[0x19, 0x1c, 0])));
        refused(&contents(&[0x3c, 0, 0, 0]));
        // Field 65540, of which the library keeps the fourth.
        refused(&contents(&row_group(&[0x08, 0x88, 0x80, 0x08, 0])));
        // What a later version of the format may have.
        checked(&contents(&row_group(&[0x98, 1, b'a']))).unwrap();
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
