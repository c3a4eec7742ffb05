//! Tables of every kind, as other programs write them.

use super::*;
use arrow::array::{
    ArrayRef, Float32Array, Int16Array, RecordBatch, StringArray, TimestampNanosecondArray,
};
use parquet::arrow::ArrowWriter;
use parquet::basic::{Compression, GzipLevel, ZstdLevel};
use parquet::file::properties::WriterProperties;
use std::sync::Arc;

fn csv(text: &(impl AsRef<[u8]> + ?Sized), header: bool) -> Result<Table, FileError> {
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
    assert_eq!(csv(text, true).unwrap().units["t"], "s");
    assert!(!csv("t,q\n0.25,1\n", true).unwrap().units.contains_key("t"));
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
    // As spreadsheets write it, at the beginning of a line, too, where it is no comment.
    let table = csv("q;t\n#NV;0,0\n#N/A;0,1\n4;n/a\n", true).unwrap();
    let q = table.column("q").unwrap();
    assert!(q[..2].iter().all(|value| value.is_nan()) && q[2] == 4.0);
    assert!(table.column("t").unwrap()[2].is_nan());
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

#[test]
fn a_preamble_and_a_row_of_units_are_no_part_of_the_table() {
    let preambles = [
        "",
        "Bench4-run12\n",
        "Rate: 1000 Hz\nOperator: N. N.\n\n",
        "sep=|\n",
        "# comment\n\"Title, with a comma\"\n\n",
    ];
    for preamble in preambles {
        for units in ["", "s|N\n", "[s]|[N]\n", "(s)|-\n"] {
            for delimiter in [";", "\t", ",", "  "] {
                let text = format!("{preamble}t|force\n{units}0|1.5\n1|-2\n2|3\n");
                let table = csv(&text.replace('|', delimiter), true).unwrap();
                let what = format!("{preamble:?} {units:?} {delimiter:?}");
                assert_eq!(table.column("t").unwrap(), [0.0, 1.0, 2.0], "{what}");
                assert_eq!(table.column("force").unwrap(), [1.5, -2.0, 3.0], "{what}");
                let above = preamble.lines().count() + units.lines().count() + 2;
                assert_eq!(table.lines, [above, above + 1, above + 2], "{what}");
                let unit = table.units.get("force").map(String::as_str);
                let expected = match units {
                    "" => None,
                    units if units.contains('-') => Some("1"),
                    _ => Some("N"),
                };
                assert_eq!(unit, expected, "{what}");
            }
        }
    }
}

#[test]
fn a_text_in_utf_16_is_the_same_table() {
    let text = "Prüfstand\n\nt;Kraft [µm]\n0,0;1,5\n0,1;1,6\n0,2;1,7\n";
    let plain = csv(text, true).unwrap();
    for big in [false, true] {
        let units = std::iter::once(0xfeff).chain(text.encode_utf16());
        let bytes: Vec<u8> = units
            .flat_map(|unit: u16| match big {
                true => unit.to_be_bytes(),
                false => unit.to_le_bytes(),
            })
            .collect();
        let read = csv(&bytes, true).unwrap();
        assert_eq!(read.columns, plain.columns);
        assert_eq!(read.units, plain.units);
        assert!(read.notes.iter().any(|note| note.contains("UTF-16")));
        let cut = csv(&bytes[..bytes.len() - 1], true).unwrap_err();
        assert!(cut.to_string().contains("damaged"), "{cut}");
    }
}

#[test]
fn an_unknown_unit_in_a_row_of_units_is_named() {
    for (text, line, column, word, meant) in [
        (
            "t;a 1;b 2\ns;Grad;mm\n0,0;1,5;2,5\n",
            2,
            "a 1",
            "Grad",
            "deg",
        ),
        ("t;a;b\ns;N;kNn\n0,0;1,5;2,5\n", 2, "b", "kNn", "kN"),
        (
            "Messung;Labor\n\nt;a;b\ns;U/min;Grad\n0,0;1,5;2,5\n",
            4,
            "b",
            "Grad",
            "deg",
        ),
    ] {
        // The others are read, and it is told where it is asked for.
        let table = csv(text, true).unwrap();
        assert!(table.column("t").is_ok());
        let told = table.column(column).unwrap_err().to_string();
        assert!(table.notes.iter().any(|note| note.contains(word)));
        let wanted = format!(
            "line {line}, column \"{column}\": unknown unit \"{word}\"; did you mean \"{meant}\"?"
        );
        assert!(told.contains(&wanted), "{told}");
    }
    // Columns that are called like units, below what is no part of the table.
    for head in ["A;B\n\n", "Bench 4\n"] {
        let table = csv(&format!("{head}s;F\n0,0;1,5\n1,0;2\n"), true).unwrap();
        assert_eq!(table.column("F").unwrap(), [1.5, 2.0], "{head}");
    }
    // What other programs write, and can mean nothing else by.
    let table = csv("t;n;a;M [N·m]\ns;1/min;m/s²;\n0,0;1,5;2,5;3\n", true).unwrap();
    let units = ["n", "a"].map(|name| table.units[name].as_str());
    assert_eq!(units, ["rpm", "m/s^2"]);
    // In brackets a unit is said, whether it is known or not.
    let table = csv("t,q\n[s],[Inc]\n0,1\n", true).unwrap();
    assert_eq!(table.units["q"], "Inc");
}

#[test]
fn a_column_of_text_is_left_aside_until_it_is_asked_for() {
    let rows = "0,0;1,5;ok\n0,1;1,6;\n0,2;;\"Werkzeug heiß\"\n";
    for head in [
        "Zeit;Kraft;Bemerkung\n",
        "Zeit;Kraft;Bemerkung\ns;N;-\n",
        "Versuch 7\nPrüfer: Möller\n\nZeit;Kraft;Bemerkung\ns;N;\n",
    ] {
        let table = csv(&format!("{head}{rows}"), true).unwrap();
        assert_eq!(table.column("Zeit").unwrap(), [0.0, 0.1, 0.2], "{head}");
        assert_eq!(table.column("Kraft").unwrap()[..2], [1.5, 1.6], "{head}");
        let line = head.lines().count() + 1;
        let told = table.column("Bemerkung").unwrap_err().to_string();
        let wanted = format!("line {line}, column \"Bemerkung\": \"ok\" is not a number");
        assert!(told.contains(&wanted), "{told}");
        assert!(table.notes.iter().any(|note| note.contains("Bemerkung")));
    }
    // One cell among numbers is damaged, and where nothing is a number the file is no table.
    for text in ["t;F\n0,0;1,5\n0,1;l,6\n", "t;F\na;b\nc;d\n"] {
        let told = csv(text, true).unwrap_err().to_string();
        assert!(told.contains("is not a number"), "{told}");
    }
}

#[test]
fn a_delimiter_that_ends_the_rows_begins_no_column() {
    let rows = "0,0;1,5;2,5;\n0,1;1,6;;\n";
    for head in [
        "t;a;b;\n",
        "t;a;b\n",
        "t;a;b;\ns;mm;N;\n",
        "Bench 4\n\nt;a;b;\n",
    ] {
        let table = csv(&format!("{head}{rows}"), true).unwrap();
        assert_eq!(table.columns.len(), 3, "{head}");
        assert_eq!(table.column("a").unwrap(), [1.5, 1.6], "{head}");
        assert!(table.column("b").unwrap()[1].is_nan(), "{head}");
    }
    // Where one row does not end so, a cell may be lost.
    for text in ["t;a;b;\n0;1;2;\n1;2;\n", "t;a;b;\n0;1;2;\n1;2;3;4\n"] {
        assert!(csv(text, true).is_err(), "{text}");
    }
    let table = csv("t;a\n0;\n1;\n", true).unwrap();
    assert_eq!(
        table.columns.len(),
        2,
        "a column that has no value has a name"
    );
}

#[test]
fn quoted_decimal_commas_are_read_where_they_cannot_part_thousands() {
    let text = "\"t\",\"a\"\n\"0,0\",\"1,500\"\n\"0,1\",\"-1,6e2\"\n";
    let table = csv(text, true).unwrap();
    assert_eq!(table.column("t").unwrap(), [0.0, 0.1]);
    assert_eq!(table.column("a").unwrap(), [1.5, -160.0]);
    assert!(table.notes[0].contains("commas"), "{:?}", table.notes);
    for either in [
        "t,a\n\"1,500\",\"2,500\"\n",
        "t,a\n\"1,5\",2.5\n",
        "t,a\n\"1,5\",\"1,234,567\"\n",
    ] {
        assert!(csv(either, true).is_err(), "{either}");
    }
}

#[test]
fn a_number_that_is_too_large_is_no_missing_one() {
    for text in ["t;a\n0;1e400\n1;2\n", "t;a\n1;2\n0;-1,5e999\n"] {
        let told = csv(text, true).unwrap_err().to_string();
        let wanted = "is beyond the largest number that can be held, 1.8e308";
        assert!(
            told.contains("column \"a\"") && told.contains(wanted),
            "{told}"
        );
    }
    assert!(csv("t;a\n0;inf\n", true).unwrap().column("a").unwrap()[0].is_infinite());
}

#[test]
fn rows_of_words_are_not_taken_for_a_preamble() {
    for text in [
        "t,q\n0,abc\n1,2\n",
        "t,q\n--,--\n0,1\n",
        "a,b\nt,q\n0,1\n",
        "t,q\n1,2\n0,x\n",
    ] {
        assert!(csv(text, true).is_err(), "{text}");
    }
}

#[test]
fn latin_letters_units_in_names_and_commas_in_stamps_are_read() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("bench.csv");
    let text = b"Zeit;Weg [\xb5m];Kraft (kN)\n1970-01-01T00:00:01,250;1,5;2\n1970-01-01T00:00:02,250;2;3\n";
    std::fs::write(&path, text).unwrap();
    let table = read_table(&path, true).unwrap();
    assert_eq!(table.column("Zeit").unwrap(), [1.25, 2.25]);
    assert_eq!(table.column("Weg [µm]").unwrap(), [1.5, 2.0]);
    assert_eq!(table.units["Weg [µm]"], "µm");
    assert_eq!(table.units["Kraft (kN)"], "kN");
    assert!(table.notes[0].contains("Latin-1"), "{:?}", table.notes);
}

#[test]
fn arrow_files_and_streams_are_read() {
    use arrow::ipc::writer::{FileWriter, IpcWriteOptions, StreamWriter};
    let numbers = Arc::new(Int16Array::from(vec![Some(3), None, Some(-5)])) as ArrayRef;
    let batch = RecordBatch::try_from_iter_with_nullable([("q", numbers, true)]).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let of = |name: &str| folder.path().join(name);
    let create = |name: &str| std::fs::File::create(of(name)).unwrap();
    for compression in [
        None,
        Some(arrow::ipc::CompressionType::LZ4_FRAME),
        Some(arrow::ipc::CompressionType::ZSTD),
    ] {
        let options = IpcWriteOptions::default()
            .try_with_compression(compression)
            .unwrap();
        let mut file =
            FileWriter::try_new_with_options(create("a.arrow"), &batch.schema(), options.clone())
                .unwrap();
        file.write(&batch).unwrap();
        file.finish().unwrap();
        let mut stream =
            StreamWriter::try_new_with_options(create("a.arrows"), &batch.schema(), options)
                .unwrap();
        stream.write(&batch).unwrap();
        stream.finish().unwrap();
        for name in ["a.arrow", "a.arrows"] {
            let table = read_table(&of(name), true).unwrap();
            let q = table.column("q").unwrap();
            assert!(q[0] == 3.0 && q[1].is_nan() && q[2] == -5.0, "{name}");
        }
    }
}

/// The parser compares each attribute of an element with all before it.
#[test]
fn a_telegram_of_many_attributes_is_refused_before_it_is_parsed() {
    let attributes: String = (0..50_000).map(|i| format!(" a{i}=\"1\"")).collect();
    let text = format!("\n<Rob><R{attributes}/><IPOC>1</IPOC></Rob>\n");
    let told = super::telegrams::table(&text).unwrap_err().to_string();
    assert!(
        told.contains("more than 1024 attributes in one telegram"),
        "{told}"
    );
}
