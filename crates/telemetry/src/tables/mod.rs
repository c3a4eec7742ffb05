//! Measured data from files: tables of numbers, as other programs write them.

mod arrow_table;
mod telegrams;
#[cfg(test)]
mod tests;
mod text;
mod unit_row;

use std::path::Path;

use truecut_recording::measured::{Table, Tables};

use crate::contained::contained;
use crate::error::{FileError, Reason};
use crate::log;

/// Reads a table of numbers, by the ending of its name: `.csv` (also `.txt`, `.tsv`, `.log`),
/// `.parquet`, `.arrow` (also `.feather`, `.arrows`), `.xml` for telegrams.
///
/// A CSV file may be delimited by semicolons, tabs, commas or blanks, and decimals written with a
/// comma where that does not delimit; lines that begin with `#` are comments. With `header` its
/// first row names the columns, else they are called "1", "2", …. Before the names there may be
/// lines of something else, and behind them a row of units, which become those of the columns.
/// Empty cells, `nan`, `NA` and `#N/A` are NaN, as are nulls in a Parquet or Arrow file, whose
/// columns may be of any type of number. Stamps (2026-05-04T09:30:00.125Z; in Parquet and Arrow the
/// type for them) are seconds since the beginning of 1970. A text that is not UTF-8 is read as
/// Latin-1 (Windows-1252).
///
/// A text that begins with a telegram `<Rob …>` of KUKA.RobotSensorInterface is a log of these: a
/// row a telegram, a column an attribute (`AIPos.A1`, deg; `RIst.X`, mm), times in `IPOC`, ms. What
/// an answer `<Sen …>` of the same `IPOC` holds stands in the same row.
///
/// # Errors
/// A file that cannot be read; a cell that is not a number, with its line and column; a log.
pub fn read_table(path: &Path, header: bool) -> Result<Table, FileError> {
    let read = match kind(path) {
        Some(Kind::Text) => text::text_table(path, header),
        Some(Kind::Parquet) => contained(|| arrow_table::parquet_table(path)),
        Some(Kind::Arrow) => contained(|| arrow_table::arrow_table(path)),
        Some(Kind::Log | Kind::Sqlite) => Err(Reason::LogForTable),
        Some(Kind::Hierarchical) => Err(Reason::Hierarchical),
        None => Err(Reason::UnknownTable),
    };
    let mut table = read.map_err(|reason| FileError::new(path, reason))?;
    table.source = path.display().to_string();
    Ok(table)
}

/// Reads whatever measured data comes in: a table as [`read_table`] does, or a log (`.mcap`) of
/// ROS 2 messages with one table a topic.
///
/// Of a message each number is a column, `/wrench/wrench/force/x`; numbers that go with names, as
/// in `sensor_msgs/JointState`, are called by them: `/joint_states/position/joint_1`. Each table
/// has the times at which its messages were written down (`log_time`) and, where they have a
/// header, those of their stamps (`header_stamp`); both are seconds since the log's first message.
///
/// # Errors
/// As [`read_table`]; a log that is cut or damaged, or in which no topic can be read.
pub fn read_tables(path: &Path, header: bool) -> Result<Tables, FileError> {
    let read = match kind(path) {
        Some(Kind::Log) => contained(|| log::read(path)),
        Some(Kind::Sqlite) => Err(Reason::Sqlite),
        _ if path.is_dir() => Err(Reason::Folder),
        _ => return read_table(path, header).map(Tables::from),
    };
    let mut tables = read.map_err(|reason| FileError::new(path, reason))?;
    tables.source = path.display().to_string();
    Ok(tables)
}

enum Kind {
    Text,
    Parquet,
    Arrow,
    Log,
    Sqlite,
    Hierarchical,
}

fn kind(path: &Path) -> Option<Kind> {
    let ending = path.extension()?.to_str()?.to_ascii_lowercase();
    Some(match ending.as_str() {
        "csv" | "txt" | "tsv" | "log" | "xml" => Kind::Text,
        "parquet" => Kind::Parquet,
        "arrow" | "feather" | "arrows" => Kind::Arrow,
        "mcap" => Kind::Log,
        "db3" => Kind::Sqlite,
        "mat" | "h5" | "hdf5" => Kind::Hierarchical,
        _ => return None,
    })
}
