//! Laws that every reader of rows keeps, as tests: CSV, Parquet, Arrow stream, and others' formats
//! (feature `contract`). [`reader_contract!`](crate::reader_contract) makes a module of them.

use std::path::Path;

use truecut_recording::measured::{Column, Table};

/// A format: how a table is written, and read again.
#[derive(Clone, Copy)]
pub struct Format {
    /// Ending of its files' names, without the dot.
    pub ending: &'static str,
    /// Writes names and values of the columns, the first of which is the time.
    pub write: fn(&Path, &[Column]),
    /// Reads them again; what went wrong, as a person is told.
    pub read: fn(&Path) -> Result<Table, String>,
    /// How many bytes of a file to leave so that a reader must see that the rest is missing.
    pub cut: fn(&[u8]) -> usize,
}

/// Tests of a reader: `reader_contract!(name, format)` with a [`Format`](contract::Format).
#[macro_export]
macro_rules! reader_contract {
    ($name:ident, $format:expr) => {
        $crate::reader_contract!(
            @ $name,
            $format,
            what_was_written_is_read,
            reading_twice_is_the_same,
            a_truncated_file_is_an_error,
            an_empty_file_is_an_error,
            a_file_of_something_else_is_an_error,
            a_missing_file_is_named,
        );
    };
    (@ $name:ident, $format:expr, $($law:ident),* $(,)?) => {
        mod $name {
            $(#[test]
            fn $law() {
                $crate::contract::$law($format);
            })*
        }
    };
}

/// Numbers that a text or a narrower type would spoil, and one that is missing.
fn columns() -> Vec<Column> {
    let time: Vec<f64> = (0..300).map(|row| f64::from(row) * 0.1).collect();
    let hard = [0.1 + 0.2, f64::MIN_POSITIVE, -1e300, f64::NAN, -0.0];
    let force = time.iter().enumerate().map(|(row, t)| match row % 7 {
        k if k < hard.len() => hard[k],
        _ => (3.7 * t).sin(),
    });
    vec![
        Column {
            name: "time".into(),
            values: time.clone(),
        },
        Column {
            name: "force".into(),
            values: force.collect(),
        },
        Column {
            name: "joint1.angle".into(),
            values: time.iter().map(|t| t.cos()).collect(),
        },
    ]
}

fn bits(values: &[f64]) -> Vec<u64> {
    // Any NaN stands for a missing number.
    let one = |v: &f64| {
        if v.is_nan() {
            f64::NAN.to_bits()
        } else {
            v.to_bits()
        }
    };
    values.iter().map(one).collect()
}

/// A file with those columns in a folder of its own.
fn written(format: Format) -> (tempfile::TempDir, std::path::PathBuf) {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join(format!("table.{}", format.ending));
    (format.write)(&path, &columns());
    (folder, path)
}

/// Every column with its name and its bits, in order.
pub fn what_was_written_is_read(format: Format) {
    let (_folder, path) = written(format);
    let table = (format.read)(&path).expect("what was written");
    let expected = columns();
    let names = |columns: &[Column]| columns.iter().map(|c| c.name.clone()).collect::<Vec<_>>();
    assert_eq!(names(&table.columns), names(&expected));
    for (found, expected) in table.columns.iter().zip(&expected) {
        assert_eq!(
            bits(&found.values),
            bits(&expected.values),
            "{}",
            expected.name
        );
    }
}

/// Reading changes neither the file nor the answer.
pub fn reading_twice_is_the_same(format: Format) {
    let (_folder, path) = written(format);
    let before = std::fs::read(&path).expect("a file");
    let [first, second] = [(); 2].map(|()| (format.read)(&path).expect("what was written"));
    assert_eq!(format!("{first:?}"), format!("{second:?}"));
    assert_eq!(before, std::fs::read(&path).expect("a file"));
}

/// A file that ends too early is not taken for a short one.
pub fn a_truncated_file_is_an_error(format: Format) {
    let (_folder, path) = written(format);
    let whole = std::fs::read(&path).expect("a file");
    std::fs::write(&path, &whole[..(format.cut)(&whole)]).expect("a file");
    refused(format, &path);
}

/// Nothing is no table.
pub fn an_empty_file_is_an_error(format: Format) {
    let (_folder, path) = written(format);
    std::fs::write(&path, "").expect("a file");
    refused(format, &path);
}

/// A file that only has the name of the format.
pub fn a_file_of_something_else_is_an_error(format: Format) {
    let (_folder, path) = written(format);
    std::fs::write(&path, b"\x89PNG\r\n\x1a\n\xff\xfe\x00\x01 and so on").expect("a file");
    refused(format, &path);
}

/// The message says which file was not there.
pub fn a_missing_file_is_named(format: Format) {
    let folder = tempfile::tempdir().expect("a folder");
    refused(
        format,
        &folder.path().join(format!("missing.{}", format.ending)),
    );
}

fn refused(format: Format, path: &Path) {
    let told = (format.read)(path).expect_err("it is at fault");
    assert!(told.contains(&path.display().to_string()), "{told}");
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{IpcSink, read_ipc_stream, read_parquet, read_table, write_parquet};
    use truecut_recording::{ChannelSpec, Header, Outcome, Recorder, Recording, Unit};

    fn csv(path: &Path, columns: &[Column]) {
        let names: Vec<_> = columns.iter().map(|column| column.name.as_str()).collect();
        let rows = (0..columns[0].values.len()).map(|row| {
            let cells = columns
                .iter()
                .map(|column| format!("{:?}", column.values[row]));
            cells.collect::<Vec<_>>().join(",")
        });
        let lines: Vec<_> = std::iter::once(names.join(",")).chain(rows).collect();
        std::fs::write(path, lines.join("\n")).expect("a file");
    }

    fn recording(
        columns: &[Column],
        sinks: Vec<Box<dyn truecut_recording::Sink + Send>>,
    ) -> Recording {
        let channels = columns[1..].iter();
        let header = Header {
            channels: channels
                .map(|c| ChannelSpec::new(&c.name, Unit::Newton, "made"))
                .collect(),
            ..Header::default()
        };
        let mut recorder = Recorder::new(header, sinks).expect("sinks");
        for (row, time_s) in columns[0].values.iter().enumerate() {
            let values: Vec<f64> = columns[1..].iter().map(|c| c.values[row]).collect();
            recorder.push_row(*time_s, &values).expect("a row");
        }
        let (recording, sinks) = recorder
            .finish(Vec::new(), Vec::new(), Outcome::Completed)
            .expect("the end");
        sinks.close(&recording, &[]).expect("closed files");
        recording
    }

    fn parquet(path: &Path, columns: &[Column]) {
        write_parquet(path, &recording(columns, Vec::new())).expect("a file");
    }

    fn stream(path: &Path, columns: &[Column]) {
        recording(columns, vec![Box::new(IpcSink::new(path))]);
    }

    fn table(path: &Path) -> Result<Table, String> {
        read_table(path, true).map_err(|error| error.to_string())
    }

    /// A recording's rows as a table.
    fn rows(read: Result<Recording, crate::FileError>) -> Result<Table, String> {
        let recording = read.map_err(|error| error.to_string())?;
        let names = recording
            .header
            .channels
            .iter()
            .map(|channel| channel.name.clone());
        let columns = std::iter::once("time".to_owned()).chain(names);
        let values = std::iter::once(recording.time_s).chain(recording.columns);
        Ok(Table {
            columns: columns
                .zip(values)
                .map(|(name, values)| Column { name, values })
                .collect(),
            ..Table::default()
        })
    }

    /// Within the last row: a cell is missing.
    fn in_the_last_row(bytes: &[u8]) -> usize {
        let last = bytes.iter().rposition(|byte| *byte == b',');
        last.expect("two columns")
    }

    fn half(bytes: &[u8]) -> usize {
        bytes.len() / 2
    }

    /// The stream is there for runs that were killed: it gives the chunks that are whole. Its head
    /// must be.
    fn in_the_head(_: &[u8]) -> usize {
        100
    }

    const CSV: Format = Format {
        ending: "csv",
        write: csv,
        read: table,
        cut: in_the_last_row,
    };
    const PARQUET_TABLE: Format = Format {
        ending: "parquet",
        write: parquet,
        read: table,
        cut: half,
    };
    const PARQUET_RECORDING: Format = Format {
        read: |path| rows(read_parquet(path)),
        ..PARQUET_TABLE
    };
    const ARROW_STREAM: Format = Format {
        ending: "arrows",
        write: stream,
        read: |path| rows(read_ipc_stream(path)),
        cut: in_the_head,
    };

    crate::reader_contract!(csv_table, super::CSV);
    crate::reader_contract!(parquet_table, super::PARQUET_TABLE);
    crate::reader_contract!(parquet_recording, super::PARQUET_RECORDING);
    crate::reader_contract!(arrow_stream, super::ARROW_STREAM);
}
