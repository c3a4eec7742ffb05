//! A table of numbers as a file holds it.

use super::DataError;
use crate::names::nearest;

/// One column of a [`Table`].
#[derive(Clone, Debug, PartialEq, Default)]
pub struct Column {
    /// Its name; its number, counted from 1, in a file without header.
    pub name: String,
    /// One value a row; NaN where the file has none.
    pub values: Vec<f64>,
}

/// Columns of a file, all of one length.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct Table {
    /// Where it comes from, for messages.
    pub source: String,
    /// The columns.
    pub columns: Vec<Column>,
    /// Line of the file that each row stands in; empty if the file has no lines.
    pub lines: Vec<usize>,
}

impl Table {
    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.columns.first().map_or(0, |column| column.values.len())
    }

    /// The values of a column.
    ///
    /// # Errors
    /// A column that is not there; the nearest one is named.
    pub fn column(&self, name: &str) -> Result<&[f64], DataError> {
        let mut columns = self.columns.iter();
        let found = columns.find(|column| column.name == name);
        found.map(|column| &column.values[..]).ok_or_else(|| {
            let known = self.columns.iter().map(|column| column.name.as_str());
            DataError::NoColumn {
                source_name: self.source.clone(),
                column: name.to_owned(),
                nearest: nearest(name, known.clone()).map(str::to_owned),
                known: known.collect::<Vec<_>>().join(", "),
            }
        })
    }

    /// A row for a message: `row 12 (line 14)`, counted from 1.
    pub(super) fn place(&self, row: usize) -> String {
        match self.lines.get(row) {
            Some(line) => format!("row {} (line {line})", row + 1),
            None => format!("row {}", row + 1),
        }
    }
}
