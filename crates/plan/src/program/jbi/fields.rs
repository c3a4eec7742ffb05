//! Fields of a job's lines.

use super::Rconf;
use crate::program::ProgramErrorKind;
use crate::program::number::whole;

/// Instructions that move nothing; they are left aside with a note.
pub(super) const IDLE: &[&str] = &[
    // Variables: no move that is read goes by them.
    "SET ",
    "SETE ",
    "INC ",
    "DEC ",
    "ADD ",
    "SUB ",
    "CLEAR ",
    "GETS ",
    "MSG ",
    "DIN ",
    "DOUT ",
    "ARCON",
    "ARCOF",
    "TIMER ",
    "WAIT ",
    "PULSE ",
    "AOUT ",
    "PAUSE",
    "NOP",
    "CALL MACRO",
];

pub(super) fn unexpected(found: &str, wanted: &str) -> ProgramErrorKind {
    ProgramErrorKind::unexpected(found, wanted)
}

/// Comma-separated fields, as many as one of `counts`.
pub(super) fn fields<'a>(
    text: &'a str,
    what: &str,
    counts: &[usize],
) -> Result<Vec<&'a str>, ProgramErrorKind> {
    let parts: Vec<&str> = text.split(',').collect();
    if counts.contains(&parts.len()) {
        return Ok(parts);
    }
    let counts: Vec<String> = counts.iter().map(usize::to_string).collect();
    Err(ProgramErrorKind::Fields {
        what: what.to_owned(),
        found: parts.len(),
        wanted: counts.join(" or "),
    })
}

pub(super) fn missing(name: &str) -> ProgramErrorKind {
    ProgramErrorKind::MissingPosition {
        name: name.to_owned(),
    }
}

pub(super) fn numbered(text: &str, prefix: &str) -> Result<u32, ProgramErrorKind> {
    let number = text.strip_prefix(prefix);
    let number = number.ok_or_else(|| unexpected(text, &format!("a position {prefix}...")))?;
    whole(number, "the position's number")
}

pub(super) fn position_type(text: &str) -> Result<&str, ProgramErrorKind> {
    let found = text.to_owned();
    match text {
        "BASE" | "PULSE" => Ok(text),
        "ROBOT" | "TOOL" | "USER" | "MTOOL" => Err(ProgramErrorKind::ForeignPositionType { found }),
        _ => Err(ProgramErrorKind::UnknownPositionType { found }),
    }
}

/// Six flags; later controllers append others, of which nothing is read: 8 or 24 in all.
pub(super) fn rconf(text: &str) -> Result<Rconf, ProgramErrorKind> {
    let texts = fields(text, "///RCONF", &[6, 8, 24])?;
    let mut flags = [false; 6];
    for (flag, text) in flags.iter_mut().zip(texts) {
        *flag = match text.trim() {
            "0" => false,
            "1" => true,
            other => {
                return Err(ProgramErrorKind::value(
                    "a flag of ///RCONF",
                    other,
                    "0 or 1",
                ));
            }
        };
    }
    Ok(Rconf::from_fields(flags))
}
