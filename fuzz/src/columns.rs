//! Tables in Arrow's and Parquet's formats, as the program and as others write them.

use std::path::PathBuf;
use std::sync::Arc;

use arrow::array::{ArrayRef, Float64Array, Int16Array, RecordBatch, TimestampNanosecondArray};
use arrow::ipc::CompressionType;
use arrow::ipc::writer::{FileWriter, IpcWriteOptions, StreamWriter};
use parquet::arrow::ArrowWriter;
use parquet::basic::{Compression, ZstdLevel};
use parquet::file::properties::WriterProperties;
use tempfile::TempDir;
use truecut::{Run, Scenario};

use crate::seeds::{Seed, root};

const ROWS: i16 = 300;

/// One table in each format and compression.
pub(crate) fn columns() -> Vec<Seed> {
    let lz4 = Some(CompressionType::LZ4_FRAME);
    let zstd = Some(CompressionType::ZSTD);
    let arrow = [None, lz4, zstd].map(|how| ("columns.arrow", file(how)));
    let streams = [None, lz4, zstd].map(|how| ("columns.arrows", stream(how)));
    let parquet = [
        Compression::UNCOMPRESSED,
        Compression::SNAPPY,
        Compression::LZ4_RAW,
        Compression::ZSTD(ZstdLevel::default()),
    ]
    .map(|how| ("columns.parquet", parquet(how)));
    let all = arrow.into_iter().chain(streams).chain(parquet);
    all.map(|(name, bytes)| Seed {
        path: PathBuf::from(name),
        bytes,
    })
    .collect()
}

/// Recordings of a short run, as the program writes them.
pub(crate) fn recordings() -> Vec<Seed> {
    let folder = TempDir::new().expect("a folder");
    let text = "name = \"fuzz\"\n\n[robot]\nurdf = \"assets/robots/rig_planar/robot.urdf\"\ngravity = false\n\n\
                [run]\nduration_s = 0.2\n\n[process.load]\nrelease_n = [100, 0, 0]\n";
    let scenario = Scenario::from_str(&root().join("fuzz.toml"), text, &[]).expect("a scenario");
    let outputs = truecut::Outputs::prepare(folder.path(), &scenario, false).expect("a folder");
    let mut run = Run::of(&scenario);
    run.sinks = outputs.sinks();
    let finished = run.execute().expect("a run");
    let recording = finished.recording;
    let arrows = outputs.path("recording.arrows");
    let arrows = Seed {
        bytes: std::fs::read(&arrows).expect("a stream"),
        path: arrows,
    };
    outputs.finish(&recording, &finished.claims).expect("files");
    let parquet = outputs.recording();
    let parquet = Seed {
        bytes: std::fs::read(&parquet).expect("a file"),
        path: parquet,
    };
    vec![parquet, arrows]
}

fn batch() -> RecordBatch {
    let rows = 0..ROWS;
    let stamps = rows.clone().map(|row| 2_000_000 * i64::from(row));
    let forces = rows.clone().map(|row| 40.0 + (f64::from(row) / 7.0).sin());
    let counts = rows.map(|row| (row % 5 != 0).then_some(row));
    let columns: [(&str, ArrayRef); 3] = [
        (
            "time",
            Arc::new(TimestampNanosecondArray::from_iter_values(stamps)),
        ),
        ("force", Arc::new(Float64Array::from_iter_values(forces))),
        ("count", Arc::new(Int16Array::from_iter(counts))),
    ];
    RecordBatch::try_from_iter(columns).expect("a batch")
}

fn options(how: Option<CompressionType>) -> IpcWriteOptions {
    let options = IpcWriteOptions::default().try_with_compression(how);
    options.expect("a compression that is built in")
}

fn file(how: Option<CompressionType>) -> Vec<u8> {
    let batch = batch();
    let writer = FileWriter::try_new_with_options(Vec::new(), &batch.schema(), options(how));
    let mut writer = writer.expect("a file");
    writer.write(&batch).expect("a row group");
    writer.into_inner().expect("a file")
}

fn stream(how: Option<CompressionType>) -> Vec<u8> {
    let batch = batch();
    let writer = StreamWriter::try_new_with_options(Vec::new(), &batch.schema(), options(how));
    let mut writer = writer.expect("a stream");
    writer.write(&batch).expect("a message");
    writer.into_inner().expect("a stream")
}

fn parquet(how: Compression) -> Vec<u8> {
    let batch = batch();
    let properties = WriterProperties::builder().set_compression(how).build();
    let writer = ArrowWriter::try_new(Vec::new(), batch.schema(), Some(properties));
    let mut writer = writer.expect("a file");
    writer.write(&batch).expect("a row group");
    writer.into_inner().expect("a file")
}
