//! Structures of KRL: positions, frames and loads as named numbers, and the positions of a `.dat`.

use std::collections::BTreeMap;
use std::path::Path;

use nalgebra::Isometry3;

use super::SYNTAX;
use super::inline::{PARAMETERS, Words, words};
use crate::program::euler::pose_of;
use crate::program::number::finite;
use crate::program::source::{LINE_END, Source};
use crate::program::{ProgramError, ProgramErrorKind};

/// A structure of numbers: components by name.
pub(super) type Numbers = BTreeMap<String, f64>;

/// What the files declare, by name.
#[derive(Default)]
pub(super) struct Declared {
    pub places: BTreeMap<String, Numbers>,
    pub parameters: BTreeMap<String, Words>,
}

/// Types of places.
const PLACES: [&str; 5] = ["E6POS", "E6AXIS", "POS", "FRAME", "AXIS"];
/// Types that a declaration may begin with.
pub(super) const TYPES: [&str; 12] = [
    "E6POS", "E6AXIS", "POS", "FRAME", "AXIS", "INT", "REAL", "BOOL", "CHAR", "STRUC", "FDAT",
    "LDAT",
];

/// Positions of a `.dat`.
pub(super) fn read_data(text: &str, path: &Path, known: &mut Declared) -> Result<(), ProgramError> {
    let mut source = Source::new(text, path, &SYNTAX);
    let wanted = "DEFDAT, declarations or ENDDAT";
    let mut begun = false;
    loop {
        let word = source.word(wanted)?.to_uppercase();
        match word.as_str() {
            "DEFDAT" => begun = true,
            "ENDDAT" if begun => return Ok(()),
            "DECL" | "GLOBAL" => {
                declared(&mut source, known)?;
                continue;
            }
            _ if PLACES.contains(&word.as_str()) || PARAMETERS.contains(&word.as_str()) => {
                typed(&mut source, &word, known)?;
                continue;
            }
            _ => {}
        }
        source.skip_past(LINE_END)?;
    }
}

/// After DECL or GLOBAL.
pub(super) fn declared(source: &mut Source<'_>, known: &mut Declared) -> Result<(), ProgramError> {
    loop {
        let word = source.word("a type")?.to_uppercase();
        match word.as_str() {
            "GLOBAL" | "CONST" | "DECL" => {}
            _ => return typed(source, &word, known),
        }
    }
}

/// After the type: places and parameters are kept, other data left out.
pub(super) fn typed(
    source: &mut Source<'_>,
    kind: &str,
    known: &mut Declared,
) -> Result<(), ProgramError> {
    if PLACES.contains(&kind) {
        return position(source, known);
    }
    if PARAMETERS.contains(&kind) {
        let name = source.word("a name")?.to_uppercase();
        if source.take("=") {
            source.expect(&["{"])?;
            let value = words(source)?;
            known.parameters.insert(name, value);
        }
    }
    source.skip_past(LINE_END)
}

/// After the type.
fn position(source: &mut Source<'_>, known: &mut Declared) -> Result<(), ProgramError> {
    let name = source.word("a name")?.to_uppercase();
    if source.take("=") {
        let value = numbers(source)?;
        known.places.insert(name, value);
    }
    source.skip_past(LINE_END)
}

/// Most structures inside each other; a controller's own are two deep.
const DEEPEST: usize = 8;

/// `{X 1,Y 2}` or `{FRAME: X 1,Y 2}`; structures inside are named `CM.X`.
pub(super) fn numbers(source: &mut Source<'_>) -> Result<Numbers, ProgramError> {
    source.expect(&["{"])?;
    inside(source, 1)
}

/// After the brace: a place, or `None` of what is none.
pub(super) fn place_inside(source: &mut Source<'_>) -> Result<Option<Numbers>, ProgramError> {
    let begins = ["X", "A1"].iter().chain(&PLACES);
    let is_place = begins.into_iter().any(|word| source.comes(word));
    is_place.then(|| inside(source, 1)).transpose()
}

/// Components up to the closing brace of so many.
fn inside(source: &mut Source<'_>, depth: usize) -> Result<Numbers, ProgramError> {
    let rule = format!("at most {DEEPEST}");
    ProgramErrorKind::unless(depth <= DEEPEST, "the depth of structures", depth, rule)
        .map_err(|kind| source.error(source.last_line(), kind))?;
    let mut all = Numbers::new();
    loop {
        let name = source.word("a component")?.to_uppercase();
        if source.take(":") {
            continue;
        }
        if source.take("{") {
            for (inner, value) in inside(source, depth + 1)? {
                all.insert(format!("{name}.{inner}"), value);
            }
        } else {
            let value = number(source, &name)?;
            all.insert(name, value);
        }
        if source.take("}") {
            return Ok(all);
        }
        source.expect(&[","])?;
    }
}

/// A number, or bits: `'B110'`.
fn number(source: &mut Source<'_>, what: &str) -> Result<f64, ProgramError> {
    let word = source.word(what)?;
    let bits = word
        .strip_prefix("'B")
        .and_then(|rest| rest.strip_suffix('\''));
    match bits.map(|bits| u32::from_str_radix(bits, 2)) {
        Some(Ok(bits)) => Ok(f64::from(bits)),
        _ => finite(word, what).map_err(|kind| source.error(source.last_line(), kind)),
    }
}

pub(super) fn bits(value: f64, what: &str) -> Result<u8, ProgramErrorKind> {
    let fits = value.fract() == 0.0 && (0.0..256.0).contains(&value);
    ProgramErrorKind::unless(fits, what, value, "a whole number from 0 to 255")?;
    Ok(value as u8)
}

fn part(numbers: &Numbers, name: &str) -> Result<f64, ProgramErrorKind> {
    let found = numbers.get(name).copied();
    found.ok_or_else(|| ProgramErrorKind::unexpected("a position", &format!("one with {name}")))
}

pub(super) fn pose(numbers: &Numbers) -> Result<Isometry3<f64>, ProgramErrorKind> {
    let part = |name: &str| part(numbers, name);
    Ok(pose_of(
        [part("X")?, part("Y")?, part("Z")?],
        [part("C")?, part("B")?, part("A")?],
    ))
}

/// The place alone: a circle goes through its auxiliary point at any attitude.
pub(super) fn place(numbers: &Numbers) -> Result<Isometry3<f64>, ProgramErrorKind> {
    let part = |name: &str| part(numbers, name);
    Ok(pose_of([part("X")?, part("Y")?, part("Z")?], [0.0; 3]))
}
