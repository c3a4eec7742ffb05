//! Words of APT that are not read, and the numbers of those that are.

use crate::program::ProgramErrorKind;
use crate::program::number::finite;

/// By how much the length of an axis may differ from 1: three decimals are written at least.
pub(super) const UNIT_WITHIN: f64 = 1e-3;
/// Words that move nothing; they are left aside.
pub(super) const IDLE: &[&str] = &[
    "PARTNO",
    "PPRINT",
    "CUTTER",
    "COOLNT",
    "INTOL",
    "OUTTOL",
    "MACHIN",
    "TLDATA",
    "TOOL PATH",
    "PAINT",
    "MSYS",
    "OPSTOP",
    "STOP",
    "DELAY",
    "REMARK",
    "CLEARP",
    "AUXFUN",
    "SEQNO",
    "TPRINT",
    "END-OF-PATH",
    "INSERT",
    "THICK",
    "ROTABL",
    "MODE",
    "HEAD",
    "LOAD",
    "SELECT",
    "CATIA0",
    "CLDATA",
    "PREFUN",
    "TLAXIS",
];
/// Words that would need what is not known.
pub(super) const REFUSED: [(&str, &str); 6] = [
    ("CYCLE", "canned cycles"),
    ("CUTCOM", "compensation of the cutter's radius"),
    ("CALL", "subprograms"),
    ("CALSUB", "subprograms"),
    ("MACRO", "subprograms"),
    ("COPY", "copies"),
];

/// Numbers after the slash.
pub(super) fn numbers<const N: usize>(
    word: &str,
    parts: &[&str],
) -> Result<[f64; N], ProgramErrorKind> {
    // CIRCLE may be followed by tolerances and the cutter's shape.
    if parts.len() < N || (parts.len() > N && word != "CIRCLE") {
        return Err(ProgramErrorKind::Fields {
            what: word.to_owned(),
            found: parts.len(),
            wanted: N.to_string(),
        });
    }
    let mut numbers = [0.0; N];
    for (number, part) in numbers.iter_mut().zip(parts) {
        *number = finite(part, word)?;
    }
    Ok(numbers)
}
