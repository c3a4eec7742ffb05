//! Tables in Arrow's types: Parquet files, Arrow files and streams.

use std::io::{BufReader, Read, Seek, SeekFrom};
use std::path::Path;

use arrow::array::{Array, Float64Array, RecordBatch};
use arrow::compute::cast;
use arrow::datatypes::{DataType, Fields, TimeUnit};
use arrow::ipc::reader::{FileReader, StreamReader};
use truecut_recording::measured::{Column, Table};

use crate::bounded::Bounded;
use crate::error::Reason;
use crate::frames::{self, End};

/// What an Arrow file begins with; a stream does not.
const ARROW_FILE: &[u8] = b"ARROW1";
/// Key of a field's metadata that holds its unit, as our own files have it.
const UNIT: &str = "unit";

pub(super) fn parquet_table(path: &Path) -> Result<Table, Reason> {
    let builder = Bounded::open(path)?;
    let mut table = empty(builder.schema().fields())?;
    for batch in builder.with_batch_size(65_536).build()? {
        append(&mut table, &batch?)?;
    }
    Ok(table)
}

pub(super) fn arrow_table(path: &Path) -> Result<Table, Reason> {
    let mut file = truecut_files::open(path)?;
    let mut head = Vec::new();
    (&mut file)
        .take(ARROW_FILE.len() as u64)
        .read_to_end(&mut head)?;
    if head == ARROW_FILE {
        frames::whole_file(&mut file)?;
        file.rewind()?;
        let file = BufReader::new(file);
        let reader = FileReader::try_new(file, None)?;
        let mut table = empty(reader.schema().fields())?;
        reader
            .into_iter()
            .try_for_each(|batch| append(&mut table, &batch?))?;
        return Ok(table);
    }
    let (whole, end) = frames::whole(&mut file)?;
    if end == End::Torn && whole < file.seek(SeekFrom::End(0))? {
        let what = format!("the stream breaks off in the message at byte {whole}");
        return Err(Reason::Damaged(what));
    }
    file.rewind()?;
    let reader = StreamReader::try_new(BufReader::new(file.take(whole)), None)?;
    let mut table = empty(reader.schema().fields())?;
    reader
        .into_iter()
        .try_for_each(|batch| append(&mut table, &batch?))?;
    Ok(table)
}

/// A table without rows, with the units of its columns.
fn empty(fields: &Fields) -> Result<Table, Reason> {
    if let Some(other) = fields
        .iter()
        .find(|field| factor(field.data_type()).is_none())
    {
        let text = format!(
            "column \"{}\" is of type {}",
            other.name(),
            other.data_type()
        );
        return Err(Reason::NotATable(text));
    }
    let mut table = Table::default();
    for field in fields {
        let name = field.name().clone();
        if let Some(unit) = field.metadata().get(UNIT) {
            table.units.insert(name.clone(), unit.clone());
        }
        let values = Vec::new();
        table.columns.push(Column { name, values });
    }
    Ok(table)
}

fn append(table: &mut Table, batch: &RecordBatch) -> Result<(), Reason> {
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
    Ok(())
}

/// What makes numbers of this type SI; `None` if it is none of numbers.
fn factor(kind: &DataType) -> Option<f64> {
    match kind {
        DataType::Timestamp(unit, _) => Some(in_seconds(*unit)),
        kind => kind.is_numeric().then_some(1.0),
    }
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
