//! Measured data from files: tables of numbers, as other programs write them.

use std::path::Path;

use arrow::array::{Array, Float64Array};
use arrow::compute::cast;
use arrow::compute::kernels::cast_utils::string_to_timestamp_nanos;
use arrow::datatypes::{DataType, TimeUnit};
use parquet::arrow::arrow_reader::ParquetRecordBatchReaderBuilder;
use truecut_files::{CellRow, Cells};
use truecut_recording::measured::{Column, Table};

use crate::contained::contained;
use crate::error::{FileError, Reason};

/// Reads a table of numbers, by the ending of its name: `.csv` (also `.txt`, `.tsv`) or `.parquet`.
///
/// A CSV file may be delimited by semicolons, tabs, commas or blanks, and decimals written with a
/// comma where that does not delimit; lines that begin with `#` are comments. With `header` its
/// first row names the columns, else they are called "1", "2", …. Empty cells, `nan` and `NA` are
/// NaN, as are nulls in a Parquet file, whose columns may be of any type of number. Stamps
/// (2026-05-04T09:30:00.125Z; in Parquet the type for them) are seconds since the beginning of
/// 1970.
///
/// # Errors
/// A file that cannot be read; a cell that is not a number, with its line and column.
pub fn read_table(path: &Path, header: bool) -> Result<Table, FileError> {
    let ending = path.extension().and_then(|ending| ending.to_str());
    let read = match ending.map(str::to_ascii_lowercase).as_deref() {
        Some("csv" | "txt" | "tsv") => csv_table(path, header),
        Some("parquet") => contained(|| parquet_table(path)),
        _ => Err(Reason::UnknownTable),
    };
    let mut table = read.map_err(|reason| FileError::new(path, reason))?;
    table.source = path.display().to_string();
    Ok(table)
}

fn csv_table(path: &Path, header: bool) -> Result<Table, Reason> {
    let bytes = truecut_files::read(path)?;
    if let Some(other) = not_utf8(&bytes) {
        return Err(Reason::NotATable(format!(
            "it is {other}; save it as UTF-8"
        )));
    }
    let text = String::from_utf8_lossy(&bytes);
    let cells = Cells::of(&text).map_err(|error| Reason::Line {
        line: error.line,
        message: error.message,
    })?;
    let decimal_comma = cells.decimal_comma;
    let mut rows = cells.rows.into_iter().peekable();
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
            column
                .values
                .push(number(cell, decimal_comma).ok_or_else(|| Reason::Cell {
                    line: row.line,
                    column: column.name.clone(),
                    value: cell.clone(),
                })?);
        }
        table.lines.push(row.line);
    }
    if table.lines.is_empty() {
        let text = "there is no row below the names of the columns";
        return Err(Reason::NotATable(text.into()));
    }
    Ok(table)
}

/// What a file is in which every second byte is none of a text.
fn not_utf8(bytes: &[u8]) -> Option<&'static str> {
    match bytes {
        [0xff, 0xfe, ..] | [0xfe, 0xff, ..] => Some("UTF-16"),
        _ if bytes.contains(&0) => Some("not a text"),
        _ => None,
    }
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
        if name.contains(char::REPLACEMENT_CHARACTER) {
            let message = format!(
                "the name of column {}, \"{name}\", is not in UTF-8; save the file as UTF-8",
                index + 1
            );
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
        other => truecut_files::number(other, decimal_comma).or_else(|| stamp(other)),
    }
}

/// Seconds of a date with a time of day.
fn stamp(cell: &str) -> Option<f64> {
    let nanoseconds = string_to_timestamp_nanos(cell).ok()?;
    Some(nanoseconds as f64 * 1e-9)
}

/// Numbers of a column of stamps are in its own unit.
fn in_seconds(unit: TimeUnit) -> f64 {
    match unit {
        TimeUnit::Second => 1.0,
        TimeUnit::Millisecond => 1e-3,
        TimeUnit::Microsecond => 1e-6,
        TimeUnit::Nanosecond => 1e-9,
    }
}

fn parquet_table(path: &Path) -> Result<Table, Reason> {
    let builder = ParquetRecordBatchReaderBuilder::try_new(truecut_files::open(path)?)?;
    let fields = builder.schema().fields().clone();
    let factor = |kind: &DataType| match kind {
        DataType::Timestamp(unit, _) => Some(in_seconds(*unit)),
        kind => kind.is_numeric().then_some(1.0),
    };
    if let Some(other) = (fields.iter()).find(|field| factor(field.data_type()).is_none()) {
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
            let factor = factor(array.data_type()).unwrap_or(f64::NAN);
            let array = match array.data_type() {
                DataType::Timestamp(..) => &cast(array, &DataType::Int64)?,
                _ => array,
            };
            let array = cast(array, &DataType::Float64)?;
            let array = array.as_any().downcast_ref::<Float64Array>();
            let array = array.ok_or_else(|| Reason::NotATable("no numbers".into()))?;
            let values = array.iter().map(|value| value.unwrap_or(f64::NAN));
            column.values.extend(values.map(|value| factor * value));
        }
    }
    Ok(table)
}

#[cfg(test)]
mod tests {
    use super::*;
    use arrow::array::{
        ArrayRef, Float32Array, Int16Array, RecordBatch, StringArray, TimestampNanosecondArray,
    };
    use parquet::arrow::ArrowWriter;
    use parquet::basic::{Compression, GzipLevel, ZstdLevel};
    use parquet::file::properties::WriterProperties;
    use std::sync::Arc;

    fn csv(text: &str, header: bool) -> Result<Table, FileError> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("bench.csv");
        std::fs::write(&path, text).unwrap();
        read_table(&path, header)
    }

    fn parquet(columns: Vec<(&str, ArrayRef)>) -> Result<Table, FileError> {
        compressed(columns, Compression::UNCOMPRESSED)
    }

    fn compressed(
        columns: Vec<(&str, ArrayRef)>,
        compression: Compression,
    ) -> Result<Table, FileError> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("bench.parquet");
        let batch = RecordBatch::try_from_iter_with_nullable(
            columns.into_iter().map(|(name, array)| (name, array, true)),
        )
        .unwrap();
        let file = std::fs::File::create(&path).unwrap();
        let how = WriterProperties::builder().set_compression(compression);
        let mut writer = ArrowWriter::try_new(file, batch.schema(), Some(how.build())).unwrap();
        writer.write(&batch).unwrap();
        writer.close().unwrap();
        read_table(&path, true)
    }

    #[test]
    fn every_delimiter_gives_the_same_table() {
        for delimiter in [",", ";", "\t", " ", "   ", ", "] {
            let text = ["# bench", "t,q", "0,1.5", "", "# pause", "1,-2e3"]
                .join("\n")
                .replace(',', delimiter);
            let table = csv(&text, true).unwrap();
            assert_eq!(table.column("t").unwrap(), [0.0, 1.0], "{delimiter:?}");
            assert_eq!(table.column("q").unwrap(), [1.5, -2e3], "{delimiter:?}");
            assert_eq!(table.lines, [3, 6], "{delimiter:?}");
        }
    }

    #[test]
    fn decimals_with_a_comma_and_stamps_are_read() {
        for delimiter in ["; ", "\t", " "] {
            let text = "t|q\n0,5|-1,25e-3\n1,0|2".replace('|', delimiter);
            let table = csv(&text, true).unwrap();
            assert_eq!(table.column("t").unwrap(), [0.5, 1.0], "{delimiter:?}");
            assert_eq!(table.column("q").unwrap(), [-1.25e-3, 2.0], "{delimiter:?}");
        }
        let text = "t,q\n1970-01-02T00:00:00.250Z,1\n1970-01-02 02:00:01.5+02:00,2\n";
        assert_eq!(
            csv(text, true).unwrap().column("t").unwrap(),
            [86_400.25, 86_401.5]
        );
        for thousands in ["t;q\n0,5,1;2\n", "t,q\n\"1,500\",2\n"] {
            assert!(csv(thousands, true).is_err(), "{thousands}");
        }
    }

    #[test]
    fn a_parquet_column_of_stamps_is_in_seconds() {
        let stamps = TimestampNanosecondArray::from(vec![1_000_000, 2_500_000_000]);
        let table = parquet(vec![("t", Arc::new(stamps) as ArrayRef)]).unwrap();
        assert_eq!(table.column("t").unwrap(), [1e-3, 2.5]);
    }

    #[test]
    fn columns_without_names_are_numbered() {
        let table = csv("\u{feff}0,1\n1,2\n", false).unwrap();
        assert_eq!(table.column("2").unwrap(), [1.0, 2.0]);
        assert_eq!(table.rows(), 2);
    }

    #[test]
    fn what_is_missing_is_not_a_number() {
        let table = csv("t,q\n0,\n1,nan\n2,NA\n3,4\n", true).unwrap();
        let q = table.column("q").unwrap();
        assert!(q[..3].iter().all(|value| value.is_nan()) && q[3] == 4.0);
    }

    #[test]
    fn parquet_columns_of_any_number_are_read() {
        let table = parquet(vec![
            ("t", Arc::new(Int16Array::from(vec![0, 1, 2])) as ArrayRef),
            (
                "q",
                Arc::new(Float32Array::from(vec![Some(0.5), None, Some(2.0)])),
            ),
        ])
        .unwrap();
        assert_eq!(table.column("t").unwrap(), [0.0, 1.0, 2.0]);
        let q = table.column("q").unwrap();
        assert!(q[0] == 0.5 && q[1].is_nan() && q[2] == 2.0);
    }

    /// What pandas, Polars and Arrow write by default or on request.
    #[test]
    fn parquet_is_read_however_it_is_compressed() {
        let numbers: Vec<f32> = (0_i16..5000).map(|k| f32::from(k % 97)).collect();
        for compression in [
            Compression::UNCOMPRESSED,
            Compression::SNAPPY,
            Compression::ZSTD(ZstdLevel::default()),
            Compression::GZIP(GzipLevel::default()),
            Compression::LZ4_RAW,
        ] {
            let column = Arc::new(Float32Array::from(numbers.clone())) as ArrayRef;
            let table = compressed(vec![("force", column)], compression).unwrap();
            let read = table.column("force").unwrap();
            assert!(
                read.iter()
                    .copied()
                    .eq(numbers.iter().copied().map(f64::from))
            );
        }
    }

    #[test]
    fn a_parquet_column_of_texts_is_refused_by_name() {
        let texts = Arc::new(StringArray::from(vec!["a"])) as ArrayRef;
        let error = parquet(vec![("mode", texts)]).unwrap_err().to_string();
        assert!(
            error.ends_with("not a table of numbers: column \"mode\" is of type Utf8"),
            "{error}"
        );
    }
}
