//! Tables in text: CSV and what else controllers, loggers and spreadsheets write.

use std::path::Path;

use arrow::compute::kernels::cast_utils::string_to_timestamp_nanos;
use encoding_rs::{UTF_16BE, UTF_16LE, WINDOWS_1252};
use truecut_files::{CellRow, Cells, is_comment};
use truecut_recording::measured::{Column, Table};

use super::telegrams;
use super::unit_row::{are_units, units_of, unknown_units};
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
    let mut cells = Cells::of(&text).map_err(|error| Reason::Line {
        line: error.line,
        message: error.message,
    })?;
    drop_empty_end(&mut cells.rows);
    if !cells.decimal_comma && are_decimals_quoted(&cells.rows) {
        cells.decimal_comma = true;
        notes.push("commas in quoted numbers are read as decimal ones".to_owned());
    }
    let mut table = table_of(cells, header)?;
    let aside = table.unusable.values();
    notes.extend(aside.map(|why| format!("left aside: {why}")));
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
        let units = rows.next_if(is_units);
        let line = units.as_ref().map_or(0, |row| row.line);
        for (at, error) in units.iter().flat_map(|row| unknown_units(&row.cells)) {
            let told = format!("line {line}, column \"{}\": {error}", names[at]);
            table.unusable.insert(names[at].clone(), told);
        }
        table.units = units_of(&names, units.map(|row| row.cells));
    }
    let rows: Vec<CellRow> = rows.collect();
    for (at, name) in names.iter().enumerate() {
        if let Some((line, cell)) = text_in(&rows, at, decimal_comma) {
            let told = format!(
                "line {line}, column \"{name}\": \"{cell}\" is not a number, nor is any of its cells"
            );
            table.unusable.insert(name.clone(), told);
        }
    }
    if table.unusable.len() == names.len() {
        table.unusable.clear();
    }
    let column = |name| Column {
        name,
        values: Vec::new(),
    };
    table.columns = names.into_iter().map(column).collect();
    for row in &rows {
        append(&mut table, row, decimal_comma)?;
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
        let of_text = || {
            table
                .unusable
                .contains_key(&column.name)
                .then_some(f64::NAN)
        };
        let value = number(cell, decimal_comma)
            .or_else(of_text)
            .ok_or_else(|| of_cell(line, &column.name, cell, decimal_comma))?;
        column.values.push(value);
        if is_first && is_stamp(cell, decimal_comma) {
            let unit = table.units.entry(column.name.clone());
            unit.or_insert_with(|| "s".to_owned());
        }
    }
    table.lines.push(line);
    Ok(())
}

/// The first text of a column in which no cell is a number: remarks, states. With its line.
fn text_in(rows: &[CellRow], at: usize, decimal_comma: bool) -> Option<(usize, &str)> {
    let mut cells = rows
        .iter()
        .filter_map(|row| Some((row.line, row.cells.get(at)?.as_str())));
    let is_number = |cell: &str| {
        let read = number(cell, decimal_comma).is_some_and(f64::is_finite);
        read || truecut_files::number(cell, decimal_comma).is_some()
    };
    // Digits and marks alone are a number that is written in another way.
    let is_text = |cell: &str| cell.contains(char::is_alphabetic);
    let is_mark = |cell: &str| number(cell, decimal_comma).is_none() && !is_text(cell);
    if cells
        .clone()
        .any(|(_, cell)| is_number(cell) || is_mark(cell))
    {
        return None;
    }
    cells.find(|(_, cell)| number(cell, decimal_comma).is_none())
}

/// Why a cell is not read.
fn of_cell(line: usize, column: &str, cell: &str, decimal_comma: bool) -> Reason {
    let column = column.to_owned();
    let value = truecut_files::number(cell, decimal_comma);
    match value.is_some_and(|value| is_overflow(cell, value)) {
        true => Reason::CellFault {
            line,
            column,
            message: format!(
                "\"{cell}\" is beyond the largest number that can be held, {:.1e}: the file is damaged, or it stands \
                 for no value and belongs empty",
                f64::MAX
            ),
        },
        false => Reason::Cell {
            line,
            column,
            value: cell.to_owned(),
        },
    }
}

/// Takes away the empty cell behind a delimiter that ends every row, that of the names or not: a
/// column without a name and without a value. Where one row has none, a cell may be lost.
fn drop_empty_end(rows: &mut [CellRow]) {
    let ends_empty =
        |row: &CellRow| row.cells.len() > 1 && row.cells.last().is_some_and(String::is_empty);
    let Some((first, rest)) = rows.split_first_mut() else {
        return;
    };
    let named = first.cells.len() - usize::from(ends_empty(first));
    let is_longer = |row: &CellRow| row.cells.len() == named + 1 && ends_empty(row);
    if !rest.is_empty() && rest.iter().all(is_longer) {
        first.cells.truncate(named);
        rest.iter_mut().for_each(|row| row.cells.truncate(named));
    }
}

/// Whether commas within quotes are decimal, in a text that commas delimit: one of them cannot part
/// thousands, and no number of the text has a decimal point.
fn are_decimals_quoted(rows: &[CellRow]) -> bool {
    let cells = || rows.iter().flat_map(|row| &row.cells);
    let is_number = |cell: &&String| truecut_files::number(cell, true).is_some();
    let mut with_comma = cells().filter(|cell| cell.contains(',')).filter(is_number);
    with_comma.any(|cell| parts_no_thousands(cell))
        && !cells().filter(is_number).any(|cell| cell.contains('.'))
}

/// Whether the comma of a number cannot stand between thousands: three digits follow those, and one
/// to three go before, the first no zero.
fn parts_no_thousands(cell: &str) -> bool {
    let Some((whole, rest)) = cell.split_once(',') else {
        return false;
    };
    let whole = whole.trim_start_matches(['+', '-']);
    let digits = rest.chars().take_while(char::is_ascii_digit).count();
    digits != 3 || whole.starts_with('0') || !(1..=3).contains(&whole.len())
}

/// The text, with a note where it is not UTF-8: what begins with the mark of UTF-16 is that, other
/// bytes are taken for Windows-1252, of which Latin-1 is a part.
fn decoded(bytes: Vec<u8>) -> Result<(String, Vec<String>), Reason> {
    let wide = match bytes[..] {
        [0xff, 0xfe, ..] => Some(UTF_16LE),
        [0xfe, 0xff, ..] => Some(UTF_16BE),
        _ => None,
    };
    if let Some(wide) = wide {
        let (text, is_damaged) = wide.decode_with_bom_removal(&bytes);
        let note = "it is UTF-16 and was read as such".to_owned();
        return match is_damaged {
            true => Err(Reason::NotATable("it is UTF-16, but damaged".into())),
            false => Ok((text.into_owned(), vec![note])),
        };
    }
    if bytes.contains(&0) {
        let told = "it is not a text; save it as UTF-8";
        return Err(Reason::NotATable(told.into()));
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
        .filter(|(_, line)| !line.trim().is_empty() && !is_comment(line))
        .collect();
    let (_, last) = lines.last()?;
    // What does not stand in a line does not delimit it: else a decimal comma would join two cells.
    let delimits = |delimiter: &Option<char>| delimiter.is_none_or(|one| last.contains(one));
    let delimiters = [Some(';'), Some('\t'), Some(','), None];
    let delimited = |rule: fn(&[bool]) -> bool| {
        let mut those = delimiters.iter().copied().filter(delimits);
        those.find_map(|delimiter| {
            let shape = numbers(last, delimiter)?;
            rule(&shape).then_some((delimiter, shape))
        })
    };
    // Columns of remarks hold no numbers.
    let (delimiter, shape) = delimited(|shape| shape.iter().all(|one| *one)).or_else(|| {
        delimited(|shape| 2 * shape.iter().filter(|one| **one).count() >= shape.len())
    })?;
    let cells = shape.len();
    let is_row = |line: &str| {
        let found = numbers(line, delimiter).filter(|found| found.len() == cells);
        found.is_some_and(|found| shape.iter().zip(found).all(|(wanted, is)| is || !wanted))
    };
    let data = lines.iter().position(|(_, line)| is_row(line))?;
    let are_words = |cells: &[String]| cells.iter().all(|cell| number(cell, true).is_none());
    let is_head = |&(_, line): &(usize, &str)| {
        let head = split(line, delimiter);
        head.len() == cells && are_words(&head)
    };
    // A delimiter that ends the rows ends that of the names, too.
    let is_names = |line: &(usize, &str)| match split(line.1, delimiter).split_last() {
        Some((last, rest)) if last.is_empty() && !rest.is_empty() => {
            rest.len() + 1 == cells && are_words(rest)
        }
        _ => is_head(line),
    };
    let adjoins = |upper: usize| lines[upper].0 + 1 == lines[upper + 1].0;
    let mut names = data.checked_sub(1)?;
    let units = split(lines[names].1, delimiter);
    // Names may be those of units: with one that is none, the names stand right above.
    let is_named = |above: usize| is_names(&lines[above]) && adjoins(above);
    if are_units(&units)
        && (unknown_units(&units).next().is_none() || names.checked_sub(1).is_some_and(is_named))
    {
        names = names.checked_sub(1)?;
    }
    let above = names.checked_sub(1)?;
    if !is_names(&lines[names]) || (is_head(&lines[above]) && adjoins(above)) {
        return None;
    }
    Some((lines[0].0, lines[above].0))
}

/// Which cells of a line are numbers or empty, if one is a number.
fn numbers(line: &str, delimiter: Option<char>) -> Option<Vec<bool>> {
    let cells = split(line, delimiter);
    let values = cells
        .iter()
        .map(|cell| number(cell, delimiter != Some(',')));
    let values: Vec<Option<f64>> = values.collect();
    let is_one = values.iter().flatten().any(|value| value.is_finite());
    is_one.then(|| values.iter().map(Option::is_some).collect())
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

pub(super) fn number(cell: &str, decimal_comma: bool) -> Option<f64> {
    match cell {
        "" | "NA" | "na" | "N/A" | "n/a" | "#N/A" | "#NV" | "null" => Some(f64::NAN),
        // As Python writes them.
        "True" | "true" => Some(1.0),
        "False" | "false" => Some(0.0),
        other => match truecut_files::number(other, decimal_comma) {
            Some(value) => (!is_overflow(other, value)).then_some(value),
            None => stamp(other, decimal_comma),
        },
    }
}

/// Whether a cell has the digits of a number that is too large to be held. As infinity, which some
/// programs write by a word, it would be missing, and nobody would be told.
fn is_overflow(cell: &str, value: f64) -> bool {
    value.is_infinite() && cell.contains(|letter: char| letter.is_ascii_digit())
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
