//! Measured data from files: tables of numbers, as other programs write them.

use std::fs::File;
use std::path::Path;

use arrow::array::{Array, Float64Array};
use arrow::compute::cast;
use arrow::datatypes::DataType;
use parquet::arrow::arrow_reader::ParquetRecordBatchReaderBuilder;
use truecut_recording::measured::{Column, Table};

use crate::error::{FileError, Reason};

/// Reads a table of numbers, by the ending of its name: `.csv` (also `.txt`, `.tsv`) or `.parquet`.
///
/// A CSV file may be delimited by semicolons, tabs, commas or blanks; lines that begin with `#` are comments.
/// With `header` its first row names the columns, else they are called "1", "2", …. Empty cells, `nan` and
/// `NA` are NaN, as are nulls in a Parquet file, whose columns may be of any type of number.
///
/// # Errors
/// A file that cannot be read; a cell that is not a number, with its line and column.
pub fn read_table(path: &Path, header: bool) -> Result<Table, FileError> {
    let ending = path.extension().and_then(|ending| ending.to_str());
    let read = match ending.map(str::to_ascii_lowercase).as_deref() {
        Some("csv" | "txt" | "tsv") => csv_table(path, header),
        Some("parquet") => parquet_table(path),
        _ => Err(Reason::UnknownTable),
    };
    let mut table = read.map_err(|reason| FileError::new(path, reason))?;
    table.source = path.display().to_string();
    Ok(table)
}

/// One row of a text file, with its line.
struct Row {
    line: usize,
    cells: Vec<String>,
}

fn csv_table(path: &Path, header: bool) -> Result<Table, Reason> {
    let bytes = std::fs::read(path)?;
    let text = String::from_utf8_lossy(&bytes);
    let text = text.trim_start_matches('\u{feff}');
    let mut rows = rows(text)?.into_iter().peekable();
    let Some(first) = rows.peek() else {
        return Err(Reason::NotATable("there is no row".into()));
    };
    let names = names(first, header)?;
    if header {
        rows.next();
    }
    let mut table = Table {
        columns: names
            .into_iter()
            .map(|name| Column {
                name,
                values: Vec::new(),
            })
            .collect(),
        ..Table::default()
    };
    for row in rows {
        if row.cells.len() != table.columns.len() {
            let message = format!(
                "{} cells, but there are {} columns",
                row.cells.len(),
                table.columns.len()
            );
            return Err(Reason::Line {
                line: row.line,
                message,
            });
        }
        for (column, cell) in table.columns.iter_mut().zip(&row.cells) {
            column.values.push(number(cell).ok_or_else(|| Reason::Cell {
                line: row.line,
                column: column.name.clone(),
                value: cell.clone(),
                hint: hint(cell),
            })?);
        }
        table.lines.push(row.line);
    }
    Ok(table)
}

/// The rows of a text, without comments and empty lines.
fn rows(text: &str) -> Result<Vec<Row>, Reason> {
    let Some(delimiter) = delimiter(text) else {
        // Columns that stand under each other: any number of blanks between two of them.
        let lines = text.lines().enumerate();
        let lines = lines.filter(|(_, line)| !line.trim().is_empty() && !line.starts_with('#'));
        let row = |(index, line): (usize, &str)| Row {
            line: index + 1,
            cells: line.split_whitespace().map(str::to_owned).collect(),
        };
        return Ok(lines.map(row).collect());
    };
    let mut reader = csv::ReaderBuilder::new()
        .delimiter(delimiter)
        .comment(Some(b'#'))
        .has_headers(false)
        .flexible(true)
        .trim(csv::Trim::All)
        .from_reader(text.as_bytes());
    let mut rows = Vec::new();
    for record in reader.records() {
        let record = record?;
        rows.push(Row {
            line: record
                .position()
                .map_or(0, |position| position.line() as usize),
            cells: record.iter().map(str::to_owned).collect(),
        });
    }
    Ok(rows)
}

/// What stands between the cells of the first row; `None` for blanks. A semicolon comes first: where it
/// delimits, commas are decimal.
fn delimiter(text: &str) -> Option<u8> {
    let first = text
        .lines()
        .find(|line| !line.trim().is_empty() && !line.starts_with('#'))?;
    let found = [';', '\t', ',']
        .into_iter()
        .find(|one| first.contains(*one));
    found.map(|one| one as u8).or_else(|| {
        // A single column has no delimiter; any will do.
        (first.split_whitespace().count() == 1).then_some(b',')
    })
}

fn names(first: &Row, header: bool) -> Result<Vec<String>, Reason> {
    if !header {
        return Ok((1..=first.cells.len())
            .map(|number| number.to_string())
            .collect());
    }
    let line = first.line;
    if first.cells.iter().all(|cell| number(cell).is_some()) {
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

fn number(cell: &str) -> Option<f64> {
    match cell {
        "" | "NA" | "na" | "N/A" | "null" => Some(f64::NAN),
        other => other.parse().ok(),
    }
}

fn hint(cell: &str) -> &'static str {
    let with_point = cell.replace(',', ".");
    if cell.contains(',') && with_point.parse::<f64>().is_ok() {
        "; write decimals with a point"
    } else {
        ""
    }
}

fn parquet_table(path: &Path) -> Result<Table, Reason> {
    let builder = ParquetRecordBatchReaderBuilder::try_new(File::open(path)?)?;
    let fields = builder.schema().fields().clone();
    if let Some(other) = fields.iter().find(|field| !field.data_type().is_numeric()) {
        let text = format!(
            "column \"{}\" is of type {}",
            other.name(),
            other.data_type()
        );
        return Err(Reason::NotATable(text));
    }
    let mut table = Table::default();
    for field in fields.iter() {
        table.columns.push(Column {
            name: field.name().clone(),
            values: Vec::new(),
        });
    }
    for batch in builder.with_batch_size(65_536).build()? {
        let batch = batch?;
        for (column, array) in table.columns.iter_mut().zip(batch.columns()) {
            let array = cast(array, &DataType::Float64)?;
            let array = array.as_any().downcast_ref::<Float64Array>();
            let array = array.ok_or_else(|| Reason::NotATable("no numbers".into()))?;
            column
                .values
                .extend(array.iter().map(|value| value.unwrap_or(f64::NAN)));
        }
    }
    Ok(table)
}
