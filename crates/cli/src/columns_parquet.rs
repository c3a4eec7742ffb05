//! Columns of numbers as Parquet, the unit of each in its field's metadata.

use std::collections::HashMap;
use std::fs::File;
use std::path::Path;
use std::sync::Arc;

use arrow::array::{ArrayRef, Float64Array, RecordBatch};
use arrow::datatypes::{DataType, Field, Schema};
use parquet::arrow::ArrowWriter;
use parquet::file::properties::WriterProperties;

use crate::failure::Failure;

/// A column: name, unit, values. What does not exist is NaN.
pub struct Column<'a> {
    pub name: &'a str,
    pub unit: &'a str,
    pub values: Vec<f64>,
}

/// Writes columns of equal length, with the scenario's text. Equal columns give equal bytes.
pub fn write(path: &Path, columns: &[Column<'_>], scenario_text: &str) -> Result<(), Failure> {
    let failed =
        |error: &dyn std::fmt::Display| Failure::message(format!("{}: {error}", path.display()));
    let fields: Vec<Field> = (columns.iter())
        .map(|column| {
            let unit = HashMap::from([("unit".to_owned(), column.unit.to_owned())]);
            Field::new(column.name, DataType::Float64, false).with_metadata(unit)
        })
        .collect();
    let metadata = HashMap::from([("truecut.scenario_text".to_owned(), scenario_text.to_owned())]);
    let schema = Arc::new(Schema::new(fields).with_metadata(metadata));
    let arrays = (columns.iter())
        .map(|column| Arc::new(Float64Array::from(column.values.clone())) as ArrayRef)
        .collect();
    let batch = RecordBatch::try_new(Arc::clone(&schema), arrays).map_err(|e| failed(&e))?;
    let properties = WriterProperties::builder()
        .set_created_by("truecut".to_owned())
        .build();
    let file = File::create(path).map_err(|e| failed(&e))?;
    let mut writer =
        ArrowWriter::try_new(file, schema, Some(properties)).map_err(|e| failed(&e))?;
    writer.write(&batch).map_err(|e| failed(&e))?;
    writer.close().map_err(|e| failed(&e))?;
    Ok(())
}
