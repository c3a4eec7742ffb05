//! Texts in XML: UTF-8, or what the first line says.

use std::path::Path;

use encoding_rs::Encoding;

use crate::error::{ArmError, ArmErrorKind};

/// Bytes in which the head of a file ends.
const HEAD_BYTES: usize = 256;

/// The text of a file in XML. What is UTF-8 is read as that, whatever its head says.
pub(crate) fn read(path: &Path) -> Result<String, ArmError> {
    let bytes = truecut_files::read_raw_text(path)
        .map_err(|error| ArmError::in_file(path, None, ArmErrorKind::Unreadable(error)))?;
    decoded(bytes).map_err(|(line, kind)| ArmError::in_file(path, line, kind))
}

fn decoded(bytes: Vec<u8>) -> Result<String, (usize, ArmErrorKind)> {
    let error = match String::from_utf8(bytes) {
        Ok(text) => return Ok(text),
        Err(error) => error,
    };
    let bytes = error.as_bytes();
    let good = error.utf8_error().valid_up_to();
    let line = bytes[..good].iter().filter(|byte| **byte == b'\n').count() + 1;
    let not_utf8 = || {
        let byte = bytes[good];
        (line, ArmErrorKind::NotUtf8 { byte, at: good })
    };
    let Some(name) = declared(bytes) else {
        return Err(not_utf8());
    };
    let unknown = || {
        let found = name.clone();
        (1, ArmErrorKind::UnknownEncoding { found })
    };
    let encoding = Encoding::for_label(name.as_bytes()).ok_or_else(unknown)?;
    if encoding == encoding_rs::UTF_8 {
        return Err(not_utf8());
    }
    let text = encoding.decode_without_bom_handling_and_without_replacement(bytes);
    // Readers of XML that go by the head shall not decode it again.
    text.map(|text| text.replacen(&name, "UTF-8", 1))
        .ok_or_else(unknown)
}

/// The encoding that the head of a file names.
fn declared(bytes: &[u8]) -> Option<String> {
    let head = String::from_utf8_lossy(&bytes[..bytes.len().min(HEAD_BYTES)]);
    let head = head.trim_start().strip_prefix("<?xml")?.split_once("?>")?.0;
    let value = head.split_once("encoding")?.1.trim_start();
    let value = value.strip_prefix('=')?.trim_start();
    let quote = value
        .chars()
        .next()
        .filter(|quote| "\"\'".contains(*quote))?;
    let (name, _) = value[1..].split_once(quote)?;
    Some(name.to_owned())
}
