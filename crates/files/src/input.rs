//! Files that a user names.

use std::fs::{File, FileType, Metadata};
use std::io::{Error, ErrorKind, Read, Result};
use std::path::Path;

use crate::memory::largest_file;
use crate::watched::{note_bytes, note_opened};

/// Largest file of data, of a mesh or of a robot program, bytes: what is read is held in memory.
pub const MOST_BYTES: u64 = 4 << 30;
/// Largest text of a scenario, a robot, a material and their like, bytes.
pub const MOST_TEXT_BYTES: u64 = 64 << 20;

/// Opens a file for reading.
///
/// # Errors
/// A file that is not there or cannot be opened, larger than [`MOST_BYTES`] or an eighth of the
/// memory that may be used ([`crate::limit_memory`]), or no file: of a pipe or a device nobody
/// knows how much will come.
pub fn open(path: &Path) -> Result<File> {
    let file = opened(path, MOST_BYTES)?;
    note_opened(path, &file.metadata()?);
    Ok(file)
}

/// Opens for reading what this program has just written itself, and reads in parts: it is no input,
/// and no limit is held against its size.
///
/// # Errors
/// A file that is not there or cannot be opened.
pub fn open_own(path: &Path) -> Result<File> {
    File::open(path)
}

/// The bytes of a file.
///
/// # Errors
/// As [`open`].
pub fn read(path: &Path) -> Result<Vec<u8>> {
    held(path, MOST_BYTES)
}

/// The text of a file.
///
/// # Errors
/// As [`open`], with [`MOST_TEXT_BYTES`]; bytes that are not UTF-8, with the first of them.
pub fn read_text(path: &Path) -> Result<String> {
    String::from_utf8(held(path, MOST_TEXT_BYTES)?).map_err(|error| {
        let good = error.utf8_error().valid_up_to();
        let line = error.as_bytes()[..good]
            .iter()
            .filter(|byte| **byte == b'\n');
        let text = format!(
            "it is not UTF-8 text: line {}, byte {good}",
            line.count() + 1
        );
        Error::new(ErrorKind::InvalidData, text)
    })
}

/// The bytes of a text that says itself how it is encoded.
///
/// # Errors
/// As [`open`], with [`MOST_TEXT_BYTES`].
pub fn read_raw_text(path: &Path) -> Result<Vec<u8>> {
    held(path, MOST_TEXT_BYTES)
}

fn opened(path: &Path, most: u64) -> Result<File> {
    // Before it is opened: opening a pipe waits for somebody to write into it.
    check(&path.metadata()?, most)?;
    let file = File::open(path)?;
    // Again, since the name may lead elsewhere by now.
    check(&file.metadata()?, most)?;
    Ok(file)
}

fn held(path: &Path, most: u64) -> Result<Vec<u8>> {
    let mut bytes = Vec::new();
    // A file that grows while it is read ends at the limit, too.
    let taken = most.min(largest_file()).saturating_add(1);
    opened(path, most)?.take(taken).read_to_end(&mut bytes)?;
    too_large(bytes.len() as u64, most)?;
    note_bytes(path, &bytes);
    Ok(bytes)
}

fn check(found: &Metadata, most: u64) -> Result<()> {
    // Reading a folder fails by itself, in the system's own words.
    if !found.is_file() && !found.is_dir() {
        let text = format!("it is {}, not a file", kind(found.file_type()));
        return Err(Error::new(ErrorKind::InvalidInput, text));
    }
    too_large(found.len(), most)
}

fn too_large(bytes: u64, most: u64) -> Result<()> {
    let within = largest_file();
    if bytes <= most.min(within) {
        return Ok(());
    }
    let text = if bytes > most {
        format!(
            "it has {} MiB; files of this kind are read up to {} MiB",
            bytes.div_ceil(1 << 20),
            most >> 20
        )
    } else {
        format!(
            "it has {bytes} bytes; with the memory that may be used, files are read up to {within}"
        )
    };
    Err(Error::new(ErrorKind::FileTooLarge, text))
}

#[cfg(unix)]
fn kind(found: FileType) -> &'static str {
    use std::os::unix::fs::FileTypeExt;
    if found.is_fifo() {
        "a pipe"
    } else if found.is_socket() {
        "a socket"
    } else {
        "a device"
    }
}

#[cfg(not(unix))]
fn kind(_: FileType) -> &'static str {
    "a device or a pipe"
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_no_file_is_refused_without_waiting_for_it() {
        let folder = tempfile::tempdir().unwrap();
        let pipe = folder.path().join("pipe");
        let made = std::process::Command::new("mkfifo").arg(&pipe).status();
        assert!(made.unwrap().success());
        let error = |path: &Path| read_text(path).unwrap_err().to_string();
        assert_eq!(error(&pipe), "it is a pipe, not a file");
        assert_eq!(error(Path::new("/dev/zero")), "it is a device, not a file");
        assert!(read(folder.path()).is_err() && read(&folder.path().join("none")).is_err());
    }

    #[test]
    fn size_and_encoding_are_told() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("large");
        let file = File::create(&path).unwrap();
        // Sparse: it takes no room.
        file.set_len(MOST_TEXT_BYTES + 1).unwrap();
        let error = read_text(&path).unwrap_err().to_string();
        assert_eq!(
            error,
            "it has 65 MiB; files of this kind are read up to 64 MiB"
        );
        file.set_len(MOST_BYTES + 1).unwrap();
        assert_eq!(open(&path).unwrap_err().kind(), ErrorKind::FileTooLarge);
        std::fs::write(&path, b"a\nb\xff").unwrap();
        let error = read_text(&path).unwrap_err().to_string();
        assert_eq!(error, "it is not UTF-8 text: line 2, byte 3");
        assert_eq!(read(&path).unwrap(), b"a\nb\xff");
    }
}
