//! Identification from measurements of the arm itself: joint stiffness from load and deflection,
//! modes from hammer FRFs.
//!
//! | module | what it holds |
//! | --- | --- |
//! | [`readings`] | a table of loads and displacements, as rows in SI |
//! | [`stiffness`] | joint stiffnesses from them, with intervals and identifiability |
//! | [`frf`] | FRFs from files |
//! | [`impact`] | FRFs from the signals of hammer and sensor: H1 and coherence |
//! | [`modal`] | poles and residues common to FRFs |
//! | [`modes`] | measured modes paired with those of the model |
//! | [`tool`] | modes of what the arm holds, from FRFs at its tip |

pub mod frf;
pub mod impact;
pub mod modal;
pub mod modes;
pub mod readings;
pub mod stiffness;
pub mod tool;

#[cfg(test)]
mod tests;

use truecut_recording::measured::Table;

/// Coverage of the intervals of this module.
pub const CONFIDENCE: f64 = 0.95;

/// Unusable data, at the key of the identification file.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("{message}")]
pub struct IdentifyError {
    /// Dotted key.
    pub key: String,
    /// Value and rule.
    pub message: String,
}

impl IdentifyError {
    /// An error at a key.
    pub fn new(key: impl Into<String>, message: impl std::fmt::Display) -> IdentifyError {
        IdentifyError {
            key: key.into(),
            message: message.to_string(),
        }
    }
}

/// A fault in a row of a table, at a key.
fn at_row(
    table: &Table,
    row: usize,
    key: impl Into<String>,
    message: impl std::fmt::Display,
) -> IdentifyError {
    let message = format!("{}: {}: {message}", table.source, place(table, row));
    IdentifyError::new(key, message)
}

/// A row of a table, as named in messages.
fn place(table: &Table, row: usize) -> String {
    match table.lines.get(row) {
        Some(line) => format!("row {} (line {line})", row + 1),
        None => format!("row {}", row + 1),
    }
}
