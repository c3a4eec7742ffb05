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

/// By how much numbers of one coordinate system may differ where it is said again.
const SAME_SYSTEM: f64 = 1e-6;

/// The coordinate system that points are in, as MSYS says it, with its line.
#[derive(Default)]
pub(super) struct System(Option<(usize, Vec<String>)>);

impl System {
    /// Takes what MSYS says. It is the work frame; points in two of them would have to be turned
    /// and moved against each other.
    pub fn take(
        &mut self,
        parts: &[&str],
        line: usize,
        has_points: bool,
    ) -> Result<(), ProgramErrorKind> {
        let before = self.0.as_ref();
        if before.is_some_and(|(_, known)| is_same(known, parts)) {
            return Ok(());
        }
        if has_points {
            let place = before.map_or("before the first point".to_owned(), |(line, _)| {
                format!("that of line {line}")
            });
            let rule =
                format!("{place}: one is read, the work frame; post others to files of their own");
            let what = "the coordinate system MSYS";
            return Err(ProgramErrorKind::value(what, parts.join(","), rule));
        }
        self.0 = Some((line, parts.iter().map(|part| (*part).to_owned()).collect()));
        Ok(())
    }
}

fn is_same(known: &[String], parts: &[&str]) -> bool {
    let number = |text: &str| text.parse::<f64>().ok();
    let agree = |(a, b): (&String, &&str)| match (number(a), number(b)) {
        (Some(a), Some(b)) => (a - b).abs() <= SAME_SYSTEM,
        _ => a.eq_ignore_ascii_case(b),
    };
    known.len() == parts.len() && known.iter().zip(parts).all(agree)
}

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
