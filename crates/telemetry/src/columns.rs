//! Tables of results as Parquet: columns of numbers, the unit of each in its field's metadata.

use std::collections::HashMap;
use std::fs::File;
use std::path::Path;
use std::sync::Arc;

use arrow::array::{ArrayRef, Float64Array, RecordBatch, StringArray};
use arrow::datatypes::{DataType, Field, Schema};
use parquet::arrow::ArrowWriter;
use parquet::file::properties::WriterProperties;

use truecut_files::write_whole;

use crate::error::{FileError, Reason};

/// A column of a table.
#[derive(Debug, Clone, PartialEq)]
pub struct Column<'a> {
    /// Its name.
    pub name: &'a str,
    /// What it holds.
    pub values: Values<'a>,
}

/// What a column holds.
#[derive(Debug, Clone, PartialEq)]
pub enum Values<'a> {
    /// Numbers in this unit; what does not exist is NaN.
    Numbers(&'a str, Vec<f64>),
    /// Words.
    Words(Vec<&'a str>),
}

impl<'a> Column<'a> {
    /// A column of numbers.
    pub fn numbers(name: &'a str, unit: &'a str, values: Vec<f64>) -> Column<'a> {
        Column {
            name,
            values: Values::Numbers(unit, values),
        }
    }

    fn field(&self) -> Field {
        match &self.values {
            Values::Numbers(unit, _) => {
                let unit = HashMap::from([("unit".to_owned(), (*unit).to_owned())]);
                Field::new(self.name, DataType::Float64, false).with_metadata(unit)
            }
            Values::Words(_) => Field::new(self.name, DataType::Utf8, false),
        }
    }

    fn array(&self) -> ArrayRef {
        match &self.values {
            Values::Numbers(_, values) => Arc::new(Float64Array::from(values.clone())),
            Values::Words(words) => Arc::new(StringArray::from_iter_values(words)),
        }
    }
}

/// Writes columns of equal length, with the text of their scenario. Equal columns give equal bytes.
///
/// # Errors
/// A file that cannot be written; columns of unequal length.
pub fn write_columns(
    path: &Path,
    columns: &[Column<'_>],
    scenario_text: &str,
) -> Result<(), FileError> {
    let write = |file: &mut File| -> Result<(), Reason> {
        let fields: Vec<Field> = columns.iter().map(Column::field).collect();
        let metadata =
            HashMap::from([("truecut.scenario_text".to_owned(), scenario_text.to_owned())]);
        let schema = Arc::new(Schema::new(fields).with_metadata(metadata));
        let arrays = columns.iter().map(Column::array).collect();
        let batch = RecordBatch::try_new(Arc::clone(&schema), arrays)?;
        let properties = WriterProperties::builder()
            .set_created_by("truecut".to_owned())
            .build();
        let mut writer = ArrowWriter::try_new(file, schema, Some(properties))?;
        writer.write(&batch)?;
        writer.close()?;
        Ok(())
    };
    write_whole(path, write).map_err(|reason| FileError::new(path, reason))
}
