//! Tables in text: CSV and what else controllers, loggers and spreadsheets write.

use std::path::Path;

use arrow::compute::kernels::cast_utils::string_to_timestamp_nanos;
use encoding_rs::WINDOWS_1252;
use truecut_files::{CellRow, Cells};
use truecut_recording::UserUnit;
use truecut_recording::measured::{Column, Table};

use super::telegrams;
use crate::error::Reason;

pub(super) fn text_table(path: &Path, header: bool) -> Result<Table, Reason> {
    let bytes = truecut_files::read(path)?;
    let (mut text, mut notes) = decoded(bytes)?;
    if telegrams::are_in(&text) {
        let mut table = telegrams::table(&text)?;
        table.notes.append(&mut notes);
        return Ok(table);
    }
    if text.trim_start().starts_with('<') {
        let text = "an XML file is read where it holds telegrams <Rob …> of KUKA's RSI, and there \
                    is none near its beginning";
        return Err(Reason::NotATable(text.into()));
    }
    if header && let Some((first, last)) = preamble(&text) {
        notes.push(match first == last {
            true => format!("line {first} is no part of the table"),
            false => format!("lines {first} to {last} are no part of the table"),
        });
        text = blanked(&text, last);
    }
    let cells = Cells::of(&text).map_err(|error| Reason::Line {
        line: error.line,
        message: error.message,
    })?;
    let mut table = table_of(cells, header)?;
    table.notes = notes;
    Ok(table)
}

fn table_of(cells: Cells, header: bool) -> Result<Table, Reason> {
    let decimal_comma = cells.decimal_comma;
    let mut rows = cells.rows.into_iter().peekable();
    let Some(first) = rows.peek() else {
        return Err(Reason::NotATable("there is no row".into()));
    };
    let names = names(first, header)?;
    let mut table = Table::default();
    if header {
        rows.next();
        let is_units = |row: &CellRow| row.cells.len() == names.len() && are_units(&row.cells);
        let units = rows.next_if(is_units).map(|row| row.cells);
        table.units = units_of(&names, units);
    }
    let column = |name| Column {
        name,
        values: Vec::new(),
    };
    table.columns = names.into_iter().map(column).collect();
    for row in rows {
        append(&mut table, &row, decimal_comma)?;
    }
    if table.lines.is_empty() {
        let text = "there is no row below the names of the columns";
        return Err(Reason::NotATable(text.into()));
    }
    Ok(table)
}

fn append(table: &mut Table, row: &CellRow, decimal_comma: bool) -> Result<(), Reason> {
    let line = row.line;
    let is_first = table.lines.is_empty();
    if row.cells.len() != table.columns.len() {
        let message = format!(
            "{} cells, but there are {} columns",
            row.cells.len(),
            table.columns.len()
        );
        return Err(Reason::Line { line, message });
    }
    for (column, cell) in table.columns.iter_mut().zip(&row.cells) {
        let value = number(cell, decimal_comma).ok_or_else(|| Reason::Cell {
            line,
            column: column.name.clone(),
            value: cell.clone(),
        })?;
        column.values.push(value);
        if is_first && is_stamp(cell, decimal_comma) {
            let unit = table.units.entry(column.name.clone());
            unit.or_insert_with(|| "s".to_owned());
        }
    }
    table.lines.push(line);
    Ok(())
}

/// The text, with a note where it had to be guessed how it is encoded: what is not UTF-8 is taken
/// for Windows-1252, of which Latin-1 is a part.
fn decoded(bytes: Vec<u8>) -> Result<(String, Vec<String>), Reason> {
    let other = match bytes[..] {
        [0xff, 0xfe, ..] | [0xfe, 0xff, ..] => Some("UTF-16"),
        _ => bytes.contains(&0).then_some("not a text"),
    };
    if let Some(other) = other {
        return Err(Reason::NotATable(format!(
            "it is {other}; save it as UTF-8"
        )));
    }
    Ok(match String::from_utf8(bytes) {
        Ok(text) => (text, Vec::new()),
        Err(error) => {
            let (text, _) = WINDOWS_1252.decode_without_bom_handling(error.as_bytes());
            let note = "it is not UTF-8 and was read as Latin-1 (Windows-1252)";
            (text.into_owned(), vec![note.to_owned()])
        }
    })
}

/// First and last line of what stands before the names of the columns, if something does.
///
/// The table is read off its end: rows of as many numbers as the last. The names are the row right
/// before the first of these, or before a row of units. Several rows of that many words are
/// ambiguous, and taken as they always were: the first has the names.
fn preamble(text: &str) -> Option<(usize, usize)> {
    let lines: Vec<(usize, &str)> = (1..)
        .zip(text.lines())
        .filter(|(_, line)| !line.trim().is_empty() && !line.starts_with('#'))
        .collect();
    let (_, last) = lines.last()?;
    // What does not stand in a line does not delimit it: else a decimal comma would join two cells.
    let delimits = |delimiter: &Option<char>| delimiter.is_none_or(|one| last.contains(one));
    let (delimiter, cells) = [Some(';'), Some('\t'), Some(','), None]
        .into_iter()
        .filter(delimits)
        .find_map(|delimiter| Some((delimiter, numbers(last, delimiter)?)))?;
    let data = (lines.iter()).position(|(_, line)| numbers(line, delimiter) == Some(cells))?;
    let is_head = |&(_, line): &(usize, &str)| {
        let head = split(line, delimiter);
        head.len() == cells && head.iter().all(|cell| number(cell, true).is_none())
    };
    let mut names = data.checked_sub(1)?;
    if are_units(&split(lines[names].1, delimiter)) {
        names = names.checked_sub(1)?;
    }
    let adjoins = |upper: usize| lines[upper].0 + 1 == lines[upper + 1].0;
    let above = names.checked_sub(1)?;
    if !is_head(&lines[names]) || (is_head(&lines[above]) && adjoins(above)) {
        return None;
    }
    Some((lines[0].0, lines[above].0))
}

/// How many cells a line has, if each is a number or empty and one is a number.
fn numbers(line: &str, delimiter: Option<char>) -> Option<usize> {
    let cells = split(line, delimiter);
    let values = cells
        .iter()
        .map(|cell| number(cell, delimiter != Some(',')));
    let values: Vec<f64> = values.collect::<Option<_>>()?;
    values
        .iter()
        .any(|value| value.is_finite())
        .then_some(values.len())
}

/// The cells of a line that is not looked at closer.
fn split(line: &str, delimiter: Option<char>) -> Vec<String> {
    let bare = |cell: &str| cell.trim().trim_matches('"').trim().to_owned();
    match delimiter {
        Some(delimiter) => line.split(delimiter).map(bare).collect(),
        None => line.split_whitespace().map(bare).collect(),
    }
}

/// The text with its first lines emptied, so that those that are left keep their numbers.
fn blanked(text: &str, lines: usize) -> String {
    let rest = text.split_inclusive('\n').skip(lines);
    let empty = "\n".repeat(lines);
    std::iter::once(empty.as_str()).chain(rest).collect()
}

/// Whether a row below the names is one of units: none is a number but for the unit "1", and one is
/// a unit that is known or stands in brackets.
fn are_units(cells: &[String]) -> bool {
    let is_unit = |cell: &String| {
        let bare = unbracketed(cell);
        bare.is_some() || UserUnit::parse(cell).is_ok()
    };
    let is_none = |cell: &String| cell.is_empty() || cell == "-";
    let is_number = |cell: &String| !is_none(cell) && number(cell, true).is_some();
    cells.iter().all(|cell| is_unit(cell) || is_none(cell))
        && cells.iter().any(|cell| is_unit(cell) && !is_number(cell))
}

/// What stands in the brackets that a cell consists of.
fn unbracketed(cell: &str) -> Option<&str> {
    let within = |open, close| cell.strip_prefix(open)?.strip_suffix(close);
    within('[', ']').or_else(|| within('(', ')'))
}

/// Units of the columns: from the row of them, else from brackets behind the names.
fn units_of(
    names: &[String],
    row: Option<Vec<String>>,
) -> std::collections::BTreeMap<String, String> {
    let of_row = |cell: &String| unbracketed(cell).unwrap_or(cell).trim().to_owned();
    let of_name = |name: &String| {
        let from = name.rfind(['[', '('])?;
        let unit = unbracketed(&name[from..])?.trim();
        (from > 0 && UserUnit::parse(unit).is_ok()).then(|| unit.to_owned())
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

fn names(first: &CellRow, header: bool) -> Result<Vec<String>, Reason> {
    if !header {
        return Ok((1..=first.cells.len())
            .map(|number| number.to_string())
            .collect());
    }
    let line = first.line;
    if first.cells.iter().all(|cell| number(cell, true).is_some()) {
        let message = "the first row should name the columns, but holds numbers; \
                       set `header = false` in [data]";
        return Err(Reason::Line {
            line,
            message: message.into(),
        });
    }
    for (index, name) in first.cells.iter().enumerate() {
        if name.is_empty() {
            let message = format!("column {} has no name", index + 1);
            return Err(Reason::Line { line, message });
        }
        if first.cells[..index].contains(name) {
            let message = format!("two columns are called \"{name}\"");
            return Err(Reason::Line { line, message });
        }
    }
    Ok(first.cells.clone())
}

fn number(cell: &str, decimal_comma: bool) -> Option<f64> {
    match cell {
        "" | "NA" | "na" | "N/A" | "null" => Some(f64::NAN),
        // As Python writes them.
        "True" | "true" => Some(1.0),
        "False" | "false" => Some(0.0),
        other => {
            truecut_files::number(other, decimal_comma).or_else(|| stamp(other, decimal_comma))
        }
    }
}

/// Whether a cell is a date with a time of day: what it is read as is in seconds.
fn is_stamp(cell: &str, decimal_comma: bool) -> bool {
    truecut_files::number(cell, decimal_comma).is_none() && stamp(cell, decimal_comma).is_some()
}

fn stamp(cell: &str, decimal_comma: bool) -> Option<f64> {
    let with_point = || decimal_comma.then(|| seconds(&cell.replacen(',', ".", 1)))?;
    seconds(cell).or_else(with_point)
}

/// Seconds of a date with a time of day.
fn seconds(cell: &str) -> Option<f64> {
    let nanoseconds = string_to_timestamp_nanos(cell).ok()?;
    Some(nanoseconds as f64 * 1e-9)
}
