//! Tables of numbers as a file holds them.

use std::collections::BTreeMap;

use super::{DataError, Mapping};
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
    /// Units of columns, as the file writes them, where it does.
    pub units: BTreeMap<String, String>,
    /// Columns that are there and cannot be used, and why, with the place in the file.
    pub unusable: BTreeMap<String, String>,
    /// What was found or done on reading, one sentence each.
    pub notes: Vec<String>,
}

/// What a file of measured data holds: one table, or one for each topic of a log, with rows and
/// times of its own.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct Tables {
    /// Where they come from, for messages.
    pub source: String,
    /// At least one. Names of columns that are in several (clocks) are alike in all that have them.
    pub tables: Vec<Table>,
    /// Topics that are there and cannot be read: name and reason.
    pub unread: Vec<(String, String)>,
}

impl From<Table> for Tables {
    fn from(table: Table) -> Tables {
        Tables {
            source: table.source.clone(),
            tables: vec![table],
            unread: Vec::new(),
        }
    }
}

impl Tables {
    /// Which table has a column; the first, of those that several have.
    ///
    /// # Errors
    /// A column that is not there; the nearest one is named, or why its topic cannot be read.
    pub fn index_of(&self, column: &str) -> Result<usize, DataError> {
        let mut tables = self.tables.iter();
        let has = |table: &Table| table.columns.iter().any(|one| one.name == column);
        if let Some(found) = tables.position(has) {
            return Ok(found);
        }
        let mut unread = self.unread.iter();
        let of_topic = |(topic, _): &&(String, String)| {
            let rest = column.strip_prefix(topic.as_str());
            rest.is_some_and(|rest| rest.is_empty() || rest.starts_with('/'))
        };
        if let Some((topic, why)) = unread.find(of_topic) {
            return Err(DataError::File {
                source_name: self.source.clone(),
                message: format!("column \"{column}\": topic {topic} cannot be read: {why}"),
            });
        }
        Err(self.no_column(column))
    }

    fn no_column(&self, column: &str) -> DataError {
        let mut known: Vec<&str> = Vec::new();
        for one in self.tables.iter().flat_map(|table| &table.columns) {
            if !known.contains(&one.name.as_str()) {
                known.push(&one.name);
            }
        }
        let topics = self.tables.iter().map(|table| table.source.as_str());
        let listed = match self.tables.len() {
            0 | 1 => known.join(", "),
            // A log has hundreds of columns: its topics, where that many would hide them.
            _ if known.len() > MOST_LISTED => {
                format!("the topics {}", topics.collect::<Vec<_>>().join(", "))
            }
            _ => known.join(", "),
        };
        DataError::NoColumn {
            source_name: self.source.clone(),
            column: column.to_owned(),
            nearest: nearest(column, known).map(str::to_owned),
            known: listed,
        }
    }
}

/// Most columns that a message lists by name.
const MOST_LISTED: usize = 40;

impl Table {
    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.columns.first().map_or(0, |column| column.values.len())
    }

    /// The values of a column.
    ///
    /// # Errors
    /// A column that is not there; the nearest one is named. One that cannot be used, and why.
    pub fn column(&self, name: &str) -> Result<&[f64], DataError> {
        self.usable(name)?;
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

    fn usable(&self, name: &str) -> Result<(), DataError> {
        match self.unusable.get(name) {
            None => Ok(()),
            Some(why) => Err(DataError::File {
                source_name: self.source.clone(),
                message: why.clone(),
            }),
        }
    }

    /// Whether no column of a mapping is one that cannot be used.
    pub(super) fn usable_by(&self, mapping: &Mapping) -> Result<(), DataError> {
        let mut terms = mapping.channels.iter().flat_map(|channel| &channel.terms);
        terms.try_for_each(|term| self.usable(&term.column))
    }

    /// A row for a message: `row 12 (line 14)`, counted from 1.
    pub(super) fn place(&self, row: usize) -> String {
        match self.lines.get(row) {
            Some(line) => format!("row {} (line {line})", row + 1),
            None => format!("row {}", row + 1),
        }
    }
}
