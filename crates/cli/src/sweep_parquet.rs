//! A sweep's results as Parquet: one column for each axis and result, its unit in the field's metadata; how each
//! row's runs ended in the last.

use std::collections::HashMap;
use std::fs::File;
use std::path::Path;
use std::sync::Arc;

use arrow::array::{ArrayRef, Float64Array, RecordBatch, StringArray};
use arrow::datatypes::{DataType, Field, Schema};
use parquet::arrow::ArrowWriter;
use parquet::file::properties::WriterProperties;

use crate::sweep::SweepTable;

/// Name of the column that says how a row's runs ended: `completed`, or what diverged.
pub const OUTCOME: &str = "outcome";

/// Writes the table; values are in the unit of their column. Equal tables give equal bytes.
pub fn write(
    path: &Path,
    table: &SweepTable,
    scenario_text: &str,
) -> Result<(), parquet::errors::ParquetError> {
    let mut fields: Vec<Field> = table
        .columns
        .iter()
        .map(|column| {
            let unit = HashMap::from([("unit".to_owned(), column.unit.symbol.clone())]);
            Field::new(&column.name, DataType::Float64, false).with_metadata(unit)
        })
        .collect();
    fields.push(Field::new(OUTCOME, DataType::Utf8, false));
    let metadata = HashMap::from([("truecut.scenario_text".to_owned(), scenario_text.to_owned())]);
    let schema = Arc::new(Schema::new(fields).with_metadata(metadata));
    let mut arrays: Vec<ArrayRef> = (0..table.columns.len())
        .map(|index| {
            let values: Vec<f64> = table.rows.iter().map(|row| row[index]).collect();
            Arc::new(Float64Array::from(values)) as ArrayRef
        })
        .collect();
    let outcomes = table.diverged.iter();
    let outcomes = outcomes.map(|why| why.as_deref().unwrap_or("completed"));
    arrays.push(Arc::new(StringArray::from_iter_values(outcomes)));
    let batch = RecordBatch::try_new(Arc::clone(&schema), arrays)?;
    let properties = WriterProperties::builder()
        .set_created_by("truecut".to_owned())
        .build();
    let mut writer = ArrowWriter::try_new(File::create(path)?, schema, Some(properties))?;
    writer.write(&batch)?;
    writer.close()?;
    Ok(())
}
