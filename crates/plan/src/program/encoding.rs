//! Texts of controllers and CAM systems, in the encodings that they write.

use encoding_rs::{SHIFT_JIS, WINDOWS_1252};

/// Bytes to which Windows-1252 gives no character.
const UNDEFINED: [u8; 5] = [0x81, 0x8d, 0x8f, 0x90, 0x9d];

/// The text of UTF-8; else of Windows-1252, of which Latin-1 is a part, or of Shift-JIS, whichever
/// fits: of a controller that may be set to Japanese Shift-JIS first. What is not ASCII stands in
/// comments and names, and characters that mean something to a reader are the same in all three.
///
/// # Errors
/// What is wrong, with the line, if none fits.
pub(super) fn decoded(bytes: Vec<u8>, may_be_japanese: bool) -> Result<String, String> {
    let bytes = match String::from_utf8(bytes) {
        Ok(text) => return Ok(text.trim_start_matches('\u{feff}').to_owned()),
        Err(error) => error.into_bytes(),
    };
    if let [0xff, 0xfe, ..] | [0xfe, 0xff, ..] = bytes[..] {
        return Err("the text is UTF-16; save it as UTF-8".to_owned());
    }
    if let Some(at) = bytes.iter().position(|byte| *byte == 0) {
        return Err(format!(
            "line {}: a byte 0: this is no text",
            line(&bytes, at)
        ));
    }
    let undefined = bytes.iter().position(|byte| UNDEFINED.contains(byte));
    let western = || undefined.is_none().then(|| western(&bytes));
    let found = match may_be_japanese {
        true => japanese(&bytes).or_else(western),
        false => western().or_else(|| japanese(&bytes)),
    };
    found.ok_or_else(|| {
        let at = undefined.unwrap_or(0);
        format!(
            "line {}: the byte {:#04x} is none of a text; it must be UTF-8, Windows-1252 (Latin-1) or \
             Shift-JIS",
            line(&bytes, at),
            bytes[at]
        )
    })
}

fn western(bytes: &[u8]) -> String {
    WINDOWS_1252
        .decode_without_bom_handling(bytes)
        .0
        .into_owned()
}

fn japanese(bytes: &[u8]) -> Option<String> {
    SHIFT_JIS
        .decode_without_bom_handling_and_without_replacement(bytes)
        .map(|text| text.into_owned())
}

/// The line of a byte, from 1.
fn line(bytes: &[u8], at: usize) -> usize {
    bytes[..at].iter().filter(|byte| **byte == b'\n').count() + 1
}

#[cfg(test)]
mod tests {
    use super::*;

    fn latin(text: &str) -> Vec<u8> {
        WINDOWS_1252.encode(text).0.into_owned()
    }

    #[test]
    fn comments_of_german_and_of_japanese_shops_are_read() {
        let german = "G21 (Tasche für Gehäuse, ø8, 30 °)\nG0 X1\n";
        assert_eq!(decoded(latin(german), false).unwrap(), german);
        // A comment that is no Shift-JIS: an umlaut stands before the bracket.
        let job = "///COMM (Gehä)\n";
        assert_eq!(decoded(latin(job), true).unwrap(), job);
        let japanese = "G21 (研磨、仕上げ)\nG0 X1\n";
        let bytes = SHIFT_JIS.encode(japanese).0.into_owned();
        for first in [false, true] {
            assert_eq!(decoded(bytes.clone(), first).unwrap(), japanese);
        }
        for bytes in [
            german.as_bytes().to_vec(),
            [&b"\xef\xbb\xbf"[..], german.as_bytes()].concat(),
        ] {
            assert_eq!(decoded(bytes, true).unwrap(), german);
        }
    }

    #[test]
    fn what_is_no_text_is_refused_with_its_line() {
        let error = |bytes: &[u8]| decoded(bytes.to_vec(), false).unwrap_err();
        assert!(error(b"\xff\xfeG\x000\x00").contains("UTF-16"));
        assert!(error(b"G0\n\xe4\n\x00").starts_with("line 3: a byte 0"));
        let told = error(b"G0 X1\n(\xe4 \x81)\n");
        assert!(told.starts_with("line 2: the byte 0x81"), "{told}");
        assert!(told.contains("Windows-1252"), "{told}");
    }
}
