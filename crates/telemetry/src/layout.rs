//! What the table of contents of a Parquet file is made of.
//!
//! <https://github.com/apache/parquet-format/blob/master/src/main/thrift/parquet.thrift>
//!
//! The library goes by the numbers of fields and takes their kinds for granted: of a text in the
//! place of a list it reads the text's length as the list's, and asks memory for it.

use crate::thrift::{Contents, STRUCTURE};

/// Kinds of the compact protocol.
const BYTE: u8 = 3;
const NUMBERS: std::ops::RangeInclusive<u8> = 4..=6;
const DOUBLE: u8 = 7;
const TEXT: u8 = 8;
const LIST: u8 = 9;

/// What a field holds.
#[derive(Clone, Copy)]
enum Holds {
    Truth,
    Byte,
    /// Of 16, 32 or 64 bits, which are written alike.
    Number,
    Double,
    Text,
    List(&'static Holds),
    Structure(Structure),
}

use Holds::{Byte, Double, List, Number, Text, Truth};

/// Fields by their numbers.
type Structure = &'static [(i64, Holds, Need)];

/// Whether a structure may be without a field. One that may not takes bytes, so that the entries of
/// a list are no fewer than what is there allows.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Need {
    Must,
    May,
}

use Need::{May, Must};

const EMPTY: Holds = Holds::Structure(&[]);

/// All of it.
const CONTENTS: Structure = &[
    (1, Number, Must),
    (2, List(&Holds::Structure(SCHEMA_ELEMENT)), Must),
    (3, Number, Must),
    (4, List(&Holds::Structure(ROW_GROUP)), Must),
    (5, List(&Holds::Structure(KEY_VALUE)), May),
    (6, Text, May),
    (7, List(&EMPTY), May),
    (8, EMPTY, May),
    (9, Text, May),
];

const SCHEMA_ELEMENT: Structure = &[
    (1, Number, May),
    (2, Number, May),
    (3, Number, May),
    (4, Text, Must),
    (5, Number, May),
    (6, Number, May),
    (7, Number, May),
    (8, Number, May),
    (9, Number, May),
    (10, Holds::Structure(LOGICAL_TYPE), May),
];

const LOGICAL_TYPE: Structure = &[
    (1, EMPTY, May),
    (2, EMPTY, May),
    (3, EMPTY, May),
    (4, EMPTY, May),
    (
        5,
        Holds::Structure(&[(1, Number, Must), (2, Number, Must)]),
        May,
    ),
    (6, EMPTY, May),
    (7, TIME, May),
    (8, TIME, May),
    (
        10,
        Holds::Structure(&[(1, Byte, Must), (2, Truth, Must)]),
        May,
    ),
    (11, EMPTY, May),
    (12, EMPTY, May),
    (13, EMPTY, May),
    (14, EMPTY, May),
    (15, EMPTY, May),
    (16, Holds::Structure(&[(1, Byte, May)]), May),
    (17, Holds::Structure(&[(1, Text, May)]), May),
    (
        18,
        Holds::Structure(&[(1, Text, May), (2, Number, May)]),
        May,
    ),
];

const TIME: Holds = Holds::Structure(&[(1, Truth, Must), (2, TIME_UNIT, Must)]);
const TIME_UNIT: Holds = Holds::Structure(&[(1, EMPTY, May), (2, EMPTY, May), (3, EMPTY, May)]);

const KEY_VALUE: Structure = &[(1, Text, Must), (2, Text, May)];

const ROW_GROUP: Structure = &[
    (1, List(&Holds::Structure(COLUMN_CHUNK)), Must),
    (2, Number, Must),
    (3, Number, Must),
    (4, List(&Holds::Structure(SORTING_COLUMN)), May),
    (5, Number, May),
    (6, Number, May),
    (7, Number, May),
];

const SORTING_COLUMN: Structure = &[(1, Number, Must), (2, Truth, Must), (3, Truth, Must)];

const COLUMN_CHUNK: Structure = &[
    (1, Text, May),
    (2, Number, Must),
    (3, Holds::Structure(COLUMN), May),
    (4, Number, May),
    (5, Number, May),
    (6, Number, May),
    (7, Number, May),
    (8, EMPTY, May),
    (9, Text, May),
];

const COLUMN: Structure = &[
    (1, Number, Must),
    (2, List(&Number), Must),
    (3, List(&Text), Must),
    (4, Number, Must),
    (5, Number, Must),
    (6, Number, Must),
    (7, Number, Must),
    (8, List(&Holds::Structure(KEY_VALUE)), May),
    (9, Number, Must),
    (10, Number, May),
    (11, Number, May),
    (12, Holds::Structure(STATISTICS), May),
    (13, List(&Holds::Structure(PAGE_ENCODING)), May),
    (14, Number, May),
    (15, Number, May),
    (16, Holds::Structure(SIZE_STATISTICS), May),
    (17, Holds::Structure(GEOSPATIAL_STATISTICS), May),
];

const STATISTICS: Structure = &[
    (1, Text, May),
    (2, Text, May),
    (3, Number, May),
    (4, Number, May),
    (5, Text, May),
    (6, Text, May),
    (7, Truth, May),
    (8, Truth, May),
];

const PAGE_ENCODING: Structure = &[(1, Number, Must), (2, Number, Must), (3, Number, Must)];

const SIZE_STATISTICS: Structure = &[
    (1, Number, May),
    (2, List(&Number), May),
    (3, List(&Number), May),
];

const GEOSPATIAL_STATISTICS: Structure = &[
    (1, Holds::Structure(BOUNDING_BOX), May),
    (2, List(&Number), May),
];

const BOUNDING_BOX: Structure = &[
    (1, Double, Must),
    (2, Double, Must),
    (3, Double, Must),
    (4, Double, Must),
    (5, Double, May),
    (6, Double, May),
    (7, Double, May),
    (8, Double, May),
];

/// Goes over a table of contents; `None` where one of its fields is of another kind, or is not
/// there. Fields that the format does not have yet are gone over as they are.
pub(crate) fn contents(contents: &mut Contents<'_>) -> Option<()> {
    structure(contents, CONTENTS, 0)
}

fn structure(contents: &mut Contents<'_>, layout: Structure, depth: usize) -> Option<()> {
    let mut found = 0_u32;
    contents.fields(depth, &mut |contents, field, kind| {
        // The library keeps 16 bits of a number.
        i16::try_from(field).ok()?;
        let Some(at) = layout.iter().position(|known| known.0 == field) else {
            return Some(false);
        };
        found |= 1 << at;
        value(contents, layout[at].1, kind, depth + 1)
    })?;
    let mut needed = layout
        .iter()
        .enumerate()
        .filter(|(_, known)| known.2 == Must);
    needed.all(|(at, _)| found & 1 << at != 0).then_some(())
}

/// Looks at a value of that kind; whether it was read.
fn value(contents: &mut Contents<'_>, holds: Holds, kind: u8, depth: usize) -> Option<bool> {
    let fits = match holds {
        Truth => kind <= 2,
        Byte => kind == BYTE,
        Number => NUMBERS.contains(&kind),
        Double => kind == DOUBLE,
        Text => kind == TEXT,
        List(_) => kind == LIST,
        Holds::Structure(_) => kind == STRUCTURE,
    };
    match holds {
        _ if !fits => None,
        List(each) => list(contents, *each, depth).map(|()| true),
        Holds::Structure(layout) => structure(contents, layout, depth).map(|()| true),
        _ => Some(false),
    }
}

fn list(contents: &mut Contents<'_>, each: Holds, depth: usize) -> Option<()> {
    let (count, kind) = contents.list_head()?;
    for _ in 0..count {
        if !value(contents, each, kind, depth + 1)? {
            contents.value(kind, depth + 1)?;
        }
    }
    Some(())
}
