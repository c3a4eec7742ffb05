//! Words of a block: a letter and a number each, comments left out.

use crate::program::ProgramErrorKind;

/// A word.
pub(super) type Word = (char, f64);

/// The words of a line. Numbers are read in double precision: single precision would leave 8 µm of
/// 100 mm.
pub(super) fn block(line: &str) -> Result<Vec<Word>, ProgramErrorKind> {
    let mut words = Vec::new();
    let mut rest = line.trim();
    if rest.starts_with('%') {
        return Ok(words);
    }
    // Block delete: blocks that begin with a slash are run unless its switch is on.
    rest = rest.strip_prefix('/').unwrap_or(rest);
    loop {
        rest = rest.trim_start();
        let Some(first) = rest.chars().next() else {
            return Ok(words);
        };
        match first {
            ';' => return Ok(words),
            '(' => {
                let end = rest.find(')').ok_or_else(|| {
                    ProgramErrorKind::unexpected(rest, "a comment that ends in its line")
                })?;
                rest = &rest[end + 1..];
            }
            ':' => {
                // A program's number.
                let end = rest[1..].find(|c: char| !c.is_ascii_digit());
                rest = end.map_or("", |end| &rest[end + 1..]);
            }
            _ if first.is_ascii_alphabetic() => {
                let after = rest[1..].trim_start();
                let in_number = |c: char| c.is_ascii_digit() || matches!(c, '.' | '+' | '-');
                let end = after.find(|c| !in_number(c)).unwrap_or(after.len());
                let number: Option<f64> = after[..end].parse().ok();
                let Some(number) = number.filter(|number| number.is_finite()) else {
                    let wanted = "a letter and a number, such as X12.5,";
                    let found = rest.split_whitespace().next().unwrap_or(rest);
                    return Err(ProgramErrorKind::unexpected(found, wanted));
                };
                words.push((first.to_ascii_uppercase(), number));
                rest = &after[end..];
            }
            _ => {
                let found = rest.split_whitespace().next().unwrap_or(rest);
                return Err(ProgramErrorKind::unexpected(found, "a word such as X12.5"));
            }
        }
    }
}
