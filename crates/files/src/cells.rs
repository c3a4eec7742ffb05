//! Tables in text, as spreadsheets, controllers and loggers write them.

use std::borrow::Cow;
use std::fmt;

/// The rows of a text, without comments and empty lines.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Cells {
    /// In their order.
    pub rows: Vec<CellRow>,
    /// A comma in a cell is decimal: so it is where commas do not delimit.
    pub decimal_comma: bool,
}

/// One row of a text, with its line, counted from 1.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct CellRow {
    /// Where it stands.
    pub line: usize,
    /// What stands in it, without blanks around it.
    pub cells: Vec<String>,
}

/// Why a text is no table.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct CellsError {
    /// Where, counted from 1.
    pub line: usize,
    /// What is wrong there.
    pub message: String,
}

impl fmt::Display for CellsError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "line {}: {}", self.line, self.message)
    }
}

impl std::error::Error for CellsError {}

impl Cells {
    /// Reads a text whose cells are delimited by semicolons, tabs, commas or blanks, whichever of
    /// them the first row has, in this order. A row is a line; lines that begin with `#` are
    /// comments ([`is_comment`]). Lines may end in CR LF, LF or CR.
    ///
    /// # Errors
    /// A quoted cell that goes on over several lines.
    pub fn of(text: &str) -> Result<Cells, CellsError> {
        let text = text.trim_start_matches('\u{feff}');
        let of_lines = |(index, line)| (index + 1, line);
        let lines: Vec<(usize, &str)> = (split(text).enumerate().map(of_lines))
            .filter(|(_, line)| !line.trim().is_empty() && !is_comment(line))
            .collect();
        let Some(delimiter) = lines.first().and_then(|(_, first)| delimiter(first)) else {
            // Columns that stand under each other: any number of blanks between two of them.
            let row = |&(line, text): &(usize, &str)| CellRow {
                line,
                cells: text.split_whitespace().map(str::to_owned).collect(),
            };
            return Ok(Cells {
                rows: lines.iter().map(row).collect(),
                decimal_comma: true,
            });
        };
        let kept: Vec<&str> = lines.iter().map(|(_, text)| *text).collect();
        let kept = kept.join("\n");
        let mut reader = csv::ReaderBuilder::new()
            .delimiter(delimiter)
            .has_headers(false)
            .flexible(true)
            .trim(csv::Trim::All)
            .from_reader(kept.as_bytes());
        let mut rows = Vec::with_capacity(lines.len());
        for (record, &(line, _)) in reader.records().zip(&lines) {
            let record = record.map_err(|error| CellsError {
                line,
                message: error.to_string(),
            })?;
            rows.push(CellRow {
                line,
                cells: record.iter().map(str::to_owned).collect(),
            });
        }
        if let Some(&(line, _)) = lines.get(rows.len()) {
            let message = "a quoted cell goes on over several lines".to_owned();
            return Err(CellsError { line, message });
        }
        Ok(Cells {
            rows,
            decimal_comma: delimiter != b',',
        })
    }

    /// A cell with a decimal point, for those who parse by themselves.
    pub fn plain<'a>(&self, cell: &'a str) -> Cow<'a, str> {
        plain(cell, self.decimal_comma)
    }

    /// The number in a cell, with a decimal comma where commas do not delimit.
    pub fn number(&self, cell: &str) -> Option<f64> {
        number(cell, self.decimal_comma)
    }
}

/// What spreadsheets write where a cell has no value.
const NO_VALUE: [&str; 2] = ["#NV", "#N/A"];

/// Whether a line is a comment: it begins with `#`, and not with a spreadsheet's cell without a
/// value, which would take the row away without a word.
pub fn is_comment(line: &str) -> bool {
    let is_cell = |rest: &str| rest.starts_with([';', '\t', ',']);
    let mut first = NO_VALUE.iter().filter_map(|cell| line.strip_prefix(cell));
    line.starts_with('#') && !first.any(is_cell)
}

/// The number in a cell, with a decimal comma or without.
pub fn number(cell: &str, decimal_comma: bool) -> Option<f64> {
    plain(cell, decimal_comma).parse().ok()
}

fn plain(cell: &str, decimal_comma: bool) -> Cow<'_, str> {
    if decimal_comma && cell.contains(',') {
        Cow::Owned(cell.replacen(',', ".", 1))
    } else {
        Cow::Borrowed(cell)
    }
}

/// Lines by LF or CR LF; by CR alone where there is no LF.
fn split(text: &str) -> Box<dyn Iterator<Item = &str> + '_> {
    if text.contains('\n') {
        Box::new(text.lines())
    } else {
        Box::new(text.trim_end_matches('\r').split('\r'))
    }
}

/// What stands between the cells of a line; `None` for blanks. A semicolon comes first: where it
/// delimits, commas are decimal. A single column has no delimiter; any will do.
fn delimiter(line: &str) -> Option<u8> {
    let found = [';', '\t', ','].into_iter().find(|one| line.contains(*one));
    let single = line.split_whitespace().count() == 1;
    found.map(|one| one as u8).or(single.then_some(b','))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_delimiter_and_end_of_line_gives_the_same_cells() {
        for delimiter in [", ", ",", ";", "\t", "  "] {
            for end in ["\n", "\r\n", "\r"] {
                let lines = ["# bench", "t|q", "0|1.5", "", "1|-2e3", ""];
                let text = lines.join(end).replace('|', delimiter);
                let cells = Cells::of(&text).unwrap();
                let found: Vec<usize> = cells.rows.iter().map(|row| row.line).collect();
                assert_eq!(found, [2, 3, 5], "{delimiter:?} {end:?}");
                assert_eq!(cells.rows[2].cells, ["1", "-2e3"]);
                assert_eq!(cells.number("1.5"), Some(1.5));
                let comma = cells.number("1,5");
                assert_eq!(comma, (!delimiter.contains(',')).then_some(1.5));
            }
        }
    }

    #[test]
    fn a_row_that_begins_without_a_value_is_no_comment() {
        let cells = Cells::of("a;b\n#NV;1\n#N/A;2\n#NV is a comment\n# so is this; 3\n").unwrap();
        let first: Vec<&str> = cells.rows.iter().map(|row| &*row.cells[0]).collect();
        assert_eq!(first, ["a", "#NV", "#N/A"]);
    }

    #[test]
    fn a_cell_over_several_lines_is_told_and_none_is_no_number() {
        let error = Cells::of("a,b\n1,\"2\n3\n").unwrap_err();
        assert_eq!(error.line, 3, "{error}");
        let cells = Cells::of("a;b\n1;2\n").unwrap();
        assert_eq!(cells.number("1,5,2"), None);
        assert_eq!(cells.number(""), None);
        assert_eq!(Cells::of("").unwrap().rows, []);
    }
}
