//! Damages files, as bytes and as text.

use arbitrary::{Result, Unstructured};

/// Numbers at which readers break: beyond what is meant, beyond what a type holds, none at all.
const NUMBERS: &[&str] = &[
    "0",
    "-0",
    "-1",
    "1",
    "2",
    "255",
    "65536",
    "2147483648",
    "4294967295",
    "9223372036854775807",
    "18446744073709551616",
    "1e-320",
    "1e-30",
    "1e30",
    "1e308",
    "-1e308",
    "1e400",
    "nan",
    "inf",
    "-inf",
    "NaN",
    "0x10",
    "1_000",
    "1,5",
    "",
    "0.5e",
    "--1",
    "00000000001",
    "3.141592653589793",
];

/// Words that several formats give a meaning to.
const WORDS: &[&str] = &[
    "\"",
    "'",
    "[",
    "]",
    "[[",
    "]]",
    "{",
    "}",
    "(",
    ")",
    "<",
    ">",
    "</",
    "/>",
    "<!--",
    "-->",
    "=",
    ",",
    ";",
    ":",
    "#",
    "!",
    "%",
    "$(",
    "${",
    "}}",
    "\\",
    "\n",
    "\r",
    "\r\n",
    "\t",
    "\0",
    "\u{1b}[2J",
    "\u{feff}",
    "é",
    "日本",
    "../",
    "/dev/zero",
    "true",
    "false",
    "null",
    "inf = nan",
    "&amp;",
    "&x;",
    "\"\"\"",
    "'''",
    "DEF",
    "END",
    "MoveL",
    "G2",
    "G91",
    "NOP",
    "f 1 2 3",
    "f -1 -2 -3",
    "v 0 0 0",
    "element face 4294967295",
    "property list uchar int vertex_indices",
    "solid",
    "facet normal 0 0 1",
];

/// Bytes that lengths and counts in binary files are made of.
const INTEGERS: &[u64] = &[
    0,
    1,
    0x7f,
    0x80,
    0xff,
    0x7fff,
    0xffff,
    0x7fff_ffff,
    0x8000_0000,
    0xffff_ffff,
    0x7fff_ffff_ffff_ffff,
    u64::MAX,
];

/// Longest file that a case may be, bytes.
const LONGEST: usize = 1 << 20;
/// Most that one operation repeats.
const MOST_REPEATS: usize = 20_000;

/// One of the files, damaged one to four times, seldom not at all.
///
/// # Errors
/// If the choices ran out.
pub fn damaged(files: &[&[u8]], choices: &mut Unstructured) -> Result<(usize, Vec<u8>)> {
    let index = choices.choose_index(files.len())?;
    let mut bytes = files[index].to_vec();
    for _ in 0..choices.int_in_range(0..=4)? {
        damage(&mut bytes, files, choices)?;
        bytes.truncate(LONGEST);
    }
    Ok((index, bytes))
}

fn damage(bytes: &mut Vec<u8>, files: &[&[u8]], choices: &mut Unstructured) -> Result<()> {
    match choices.int_in_range(0..=13)? {
        0 => {
            let at = place(bytes, choices)?;
            if let Some(byte) = bytes.get_mut(at) {
                *byte ^= 1 << choices.int_in_range(0..=7)?;
            }
        }
        1 => {
            let at = place(bytes, choices)?;
            let byte = choices.arbitrary()?;
            bytes.insert(at, byte);
        }
        2 => bytes.truncate(place(bytes, choices)?),
        3 => {
            let span = span(bytes, choices)?;
            bytes.drain(span);
        }
        4 => {
            let part = bytes[span(bytes, choices)?].to_vec();
            let at = place(bytes, choices)?;
            bytes.splice(at..at, part);
        }
        5 => repeat(bytes, choices)?,
        6 => overwrite(bytes, choices)?,
        7 => {
            let at = place(bytes, choices)?;
            let word = choices.choose(WORDS)?.as_bytes();
            bytes.splice(at..at, word.iter().copied());
        }
        8 | 9 => number(bytes, choices)?,
        10 => {
            let [first, second] = [line(bytes, choices)?, line(bytes, choices)?];
            let moved = bytes[first].to_vec();
            bytes.splice(second.start..second.start, moved);
        }
        11 => {
            let line = line(bytes, choices)?;
            bytes.drain(line);
        }
        12 => {
            let word = word(bytes, choices)?;
            let other = *choices.choose(files)?;
            let put = other[self::word(other, choices)?].to_vec();
            bytes.splice(word, put);
        }
        _ => {
            let other = *choices.choose(files)?;
            let part = &other[span(other, choices)?];
            let at = place(bytes, choices)?;
            bytes.splice(at..at, part.iter().copied());
        }
    }
    Ok(())
}

/// A place from the first byte to behind the last.
fn place(bytes: &[u8], choices: &mut Unstructured) -> Result<usize> {
    choices.int_in_range(0..=bytes.len())
}

/// Some bytes in a row; mostly few.
fn span(bytes: &[u8], choices: &mut Unstructured) -> Result<std::ops::Range<usize>> {
    let start = place(bytes, choices)?;
    let most = match choices.int_in_range(0..=3)? {
        0 => bytes.len(),
        1 => 256,
        _ => 16,
    };
    let length = choices.int_in_range(0..=most)?.min(bytes.len() - start);
    Ok(start..start + length)
}

/// What depth and length do: a few bytes, many times.
fn repeat(bytes: &mut Vec<u8>, choices: &mut Unstructured) -> Result<()> {
    let at = place(bytes, choices)?;
    let end = bytes.len().min(at + choices.int_in_range(1..=64)?);
    let part = bytes[at..end].to_vec();
    // Seldom: reading a megabyte takes as long as a thousand small files.
    let times = match choices.int_in_range(0..=63)? {
        0 => MOST_REPEATS,
        _ => choices.int_in_range(2..=50)?,
    };
    bytes.splice(at..at, part.repeat(times).into_iter().take(LONGEST));
    Ok(())
}

/// An integer of one to eight bytes, in either order.
fn overwrite(bytes: &mut [u8], choices: &mut Unstructured) -> Result<()> {
    let integer = *choices.choose(INTEGERS)?;
    let width = 1 << choices.int_in_range(0..=3)?;
    let at = place(bytes, choices)?;
    let mut put = integer.to_le_bytes()[..width].to_vec();
    if choices.arbitrary()? {
        put.reverse();
    }
    for (byte, new) in bytes[at..].iter_mut().zip(put) {
        *byte = new;
    }
    Ok(())
}

/// Puts another number in the place of the first one from some place on.
fn number(bytes: &mut Vec<u8>, choices: &mut Unstructured) -> Result<()> {
    let from = place(bytes, choices)?;
    let other = choices.choose(NUMBERS)?.as_bytes();
    let Some(first) = bytes[from..].iter().position(u8::is_ascii_digit) else {
        return Ok(());
    };
    let start = from + first;
    let belongs = |byte: &u8| byte.is_ascii_digit() || b"._eE+-".contains(byte);
    let length = bytes[start..]
        .iter()
        .take_while(|byte| belongs(byte))
        .count();
    bytes.splice(start..start + length, other.iter().copied());
    Ok(())
}

/// The line around some place, with its end.
fn line(bytes: &[u8], choices: &mut Unstructured) -> Result<std::ops::Range<usize>> {
    around(bytes, choices, |byte| byte == b'\n')
}

/// The word around some place.
fn word(bytes: &[u8], choices: &mut Unstructured) -> Result<std::ops::Range<usize>> {
    around(bytes, choices, |byte| !byte.is_ascii_alphanumeric())
}

fn around(
    bytes: &[u8],
    choices: &mut Unstructured,
    ends: impl Fn(u8) -> bool,
) -> Result<std::ops::Range<usize>> {
    let at = place(bytes, choices)?;
    let start = (bytes[..at].iter().rposition(|byte| ends(*byte))).map_or(0, |before| before + 1);
    let end = bytes[at..].iter().position(|byte| ends(*byte));
    Ok(start..end.map_or(bytes.len(), |length| at + length))
}
