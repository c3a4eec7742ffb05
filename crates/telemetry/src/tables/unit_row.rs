//! Rows of units below the names of a table's columns.

use std::collections::BTreeMap;

use truecut_recording::{Unit, UnitError, UserUnit};

use super::text::number;

/// Whether a row below the names is one of units: none is a number but for the unit "1", and one is
/// a unit that is known or stands in brackets. Of the others some may be unknown.
pub(super) fn are_units(cells: &[String]) -> bool {
    let is_unit =
        |cell: &String| unbracketed(cell).is_some() || Unit::symbol_in_files(cell).is_some();
    let is_number = |cell: &String| !has_no_unit(cell) && number(cell, true).is_some();
    cells.iter().all(|cell| is_unit(cell) || !is_number(cell))
        && cells.iter().any(|cell| is_unit(cell) && !is_number(cell))
}

/// Whether a cell of a row of units says that its column has none.
fn has_no_unit(cell: &str) -> bool {
    cell.is_empty() || cell == "-"
}

/// Cells of a row of units that are none, unless they stand in brackets: who writes these says that
/// it is a unit, though one that is of no use here.
pub(super) fn unknown_units(cells: &[String]) -> impl Iterator<Item = (usize, UnitError)> {
    let unknown = |(at, cell): (usize, &String)| {
        let is_known = Unit::symbol_in_files(cell).is_some();
        if is_known || has_no_unit(cell) || unbracketed(cell).is_some() {
            return None;
        }
        Some((at, UserUnit::parse(cell).err()?))
    };
    cells.iter().enumerate().filter_map(unknown)
}

/// What stands in the brackets that a cell consists of.
fn unbracketed(cell: &str) -> Option<&str> {
    let within = |open, close| cell.strip_prefix(open)?.strip_suffix(close);
    within('[', ']').or_else(|| within('(', ')'))
}

/// Units of the columns: from the row of them, else from brackets behind the names.
pub(super) fn units_of(names: &[String], row: Option<Vec<String>>) -> BTreeMap<String, String> {
    let of_row = |cell: &String| {
        let written = unbracketed(cell).unwrap_or(cell).trim();
        Unit::symbol_in_files(written).unwrap_or(written).to_owned()
    };
    let of_name = |name: &String| {
        let from = name.rfind(['[', '('])?;
        let unit = unbracketed(&name[from..])?.trim();
        let symbol = Unit::symbol_in_files(unit).filter(|_| from > 0);
        symbol.map(str::to_owned)
    };
    let units = names.iter().enumerate().filter_map(|(index, name)| {
        let unit = match &row {
            Some(row) => of_row(&row[index]),
            None => of_name(name)?,
        };
        let unit = if unit == "-" { "1".to_owned() } else { unit };
        (!unit.is_empty()).then(|| (name.clone(), unit))
    });
    units.collect()
}
