//! The positions of an `.LS`, after `/POS`.

use std::collections::BTreeMap;
use std::path::Path;

use super::{Config, SYNTAX};
use crate::program::source::Source;
use crate::program::{ProgramError, ProgramErrorKind};

/// A position as the file says it.
#[derive(Debug, Clone, Default)]
pub(super) struct Position {
    pub line: usize,
    pub config: Option<Config>,
    /// X, Y, Z in mm, W, P, R, J1 … and E1 … in degrees, by name.
    pub numbers: BTreeMap<String, f64>,
    pub user_frame: f64,
}

/// Reads `P[1]{ … };` up to `/END`. `text` is the whole file with the lines before blanked, so that
/// lines count as in the file.
pub(super) fn read(text: &str, path: &Path) -> Result<BTreeMap<u32, Position>, ProgramError> {
    let mut source = Source::new(text, path, &SYNTAX);
    let mut all = BTreeMap::new();
    loop {
        let line = source.line();
        match source.word("P[...] or /END")? {
            "/END" if source.ended() => return Ok(all),
            "P" => {}
            _ => return Err(source.unexpected("P[...] or /END, at the end,")),
        }
        source.expect(&["["])?;
        let number = source.number("the position's number")?;
        if source.take(":") {
            // A comment in quotes.
            source.skip_past("]")?;
        } else {
            source.expect(&["]"])?;
        }
        source.expect(&["{"])?;
        ProgramErrorKind::unless_too_many(all.len() + 1)
            .map_err(|kind| source.error(line, kind))?;
        let mut position = Position {
            line,
            ..Position::default()
        };
        group(&mut source, &mut position)?;
        source.expect(&[";"])?;
        if let Some(first) = all.insert(number as u32, position) {
            let what = format!("P[{number}]");
            let first_line = first.line;
            return Err(source.error(line, ProgramErrorKind::Twice { what, first_line }));
        }
    }
}

/// The first motion group, up to the brace.
fn group(source: &mut Source<'_>, position: &mut Position) -> Result<(), ProgramError> {
    source.expect(&["GP1", ":"])?;
    loop {
        let name = source.word("a component of a position")?.to_uppercase();
        let line = source.last_line();
        match name.as_str() {
            "GP2" | "GP3" => {
                let rule = "GP1: one group is read, a turntable as its E1";
                let kind = ProgramErrorKind::value("the motion group", &name, rule);
                return Err(source.error(line, kind));
            }
            "CONFIG" => {
                source.expect(&[":", "'"])?;
                let mut text = String::new();
                while !source.take("'") {
                    match source.take(",") {
                        true => text.push(','),
                        false => {
                            text.push(' ');
                            text.push_str(source.word("the configuration")?);
                        }
                    }
                }
                let config = Config::parse(&text).map_err(|kind| source.error(line, kind))?;
                position.config = Some(config);
            }
            _ => {
                if !source.take(":") {
                    source.expect(&["="])?;
                }
                // F: the frame that is selected when the position is moved to.
                if matches!(name.as_str(), "UF" | "UT") && source.take("F") {
                    source.expect(&[","])?;
                    continue;
                }
                let value = source.number(&name)?;
                if name == "UF" {
                    position.user_frame = value;
                }
                let unit = if matches!(name.as_str(), "X" | "Y" | "Z") {
                    "mm"
                } else {
                    "deg"
                };
                let other = if unit == "mm" { "deg" } else { "mm" };
                if !source.take(unit) && source.take(other) {
                    let rule = format!("in {unit}: of further axes a turntable is read, as E1");
                    let kind = ProgramErrorKind::value(&name, format!("{value} {other}"), rule);
                    return Err(source.error(line, kind));
                }
                position.numbers.insert(name, value);
            }
        }
        let comma = source.take(",");
        if source.take("}") {
            return Ok(());
        }
        if !comma && !source.comes("GP2") {
            source.expect(&[","])?;
        }
    }
}
