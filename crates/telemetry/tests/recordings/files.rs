//! What is written can be read back, whole or torn.

use std::path::Path;

use crate::synthetic;
use truecut_recording::{Header, Outcome, Recording, Scalar, Sink, Unit};
use truecut_telemetry::{
    Background, IpcSink, ParquetSink, RrdSink, read_ipc_stream, read_parquet, read_recording,
    write_parquet,
};

fn recorded(sinks: Vec<Box<dyn Sink + Send>>) -> Recording {
    synthetic::run(3.4, 1e-3, sinks, || ())
        .expect("sinks that can write")
        .0
}

/// Files keep everything but the scene, which belongs to the `.rrd`.
fn without_scene(recording: &Recording) -> Recording {
    let header = Header {
        scene: Default::default(),
        ..recording.header.clone()
    };
    Recording {
        header,
        ..recording.clone()
    }
}

/// As written, for values that are not equal to themselves.
fn as_text(recording: &Recording) -> String {
    format!("{recording:?}")
}

#[test]
fn parquet_gives_back_what_went_in() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("recording.parquet");
    let mut recording = recorded(Vec::new());
    // What a text format could spoil: no number, the smallest, a sum that is not what it seems.
    recording.columns[0][7] = f64::NAN;
    recording.columns[0][8] = f64::NEG_INFINITY;
    recording
        .scalars
        .push(Scalar::new("smallest", Unit::One, f64::MIN_POSITIVE, ""));
    recording
        .scalars
        .push(Scalar::new("sum", Unit::One, 0.1 + 0.2, ""));
    recording
        .scalars
        .push(Scalar::new("none", Unit::One, f64::NAN, ""));
    recording.outcome = Outcome::Diverged {
        time_s: 3.4,
        quantity: "joint2.angle".into(),
        value: f64::INFINITY,
        limit: 1.4,
        rule: "within limits".into(),
    };
    write_parquet(&path, &recording).unwrap();
    assert_eq!(
        as_text(&read_parquet(&path).unwrap()),
        as_text(&without_scene(&recording))
    );
}

/// Steps short enough for several row groups.
#[test]
fn rows_give_the_same_parquet_one_by_one_and_all_at_once() {
    let folder = tempfile::tempdir().unwrap();
    let [streamed, at_once] = ["a.parquet", "b.parquet"].map(|name| folder.path().join(name));
    let (recording, _) = synthetic::run(
        3.4,
        1.5e-4,
        vec![Box::new(ParquetSink::new(&streamed))],
        || (),
    )
    .unwrap();
    write_parquet(&at_once, &recording).unwrap();
    assert!(std::fs::read(&streamed).unwrap() == std::fs::read(&at_once).unwrap());
    assert_eq!(read_parquet(&streamed).unwrap(), without_scene(&recording));
}

#[test]
fn a_run_that_fails_leaves_no_half_parquet() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("recording.parquet");
    let mut recorder = synthetic::recorder(vec![Box::new(ParquetSink::new(&path))]).unwrap();
    synthetic::push(&mut recorder, 0.0).unwrap();
    assert_eq!(
        std::fs::read_dir(folder.path()).unwrap().count(),
        1,
        "under way"
    );
    drop(recorder);
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
}

#[test]
fn equal_recordings_give_equal_bytes() {
    let folder = tempfile::tempdir().unwrap();
    let bytes = |name: &str| {
        let path = folder.path().join(name);
        recorded(vec![Box::new(ParquetSink::new(&path))]);
        std::fs::read(path).unwrap()
    };
    assert!(bytes("a.parquet") == bytes("b.parquet"));
}

#[test]
fn a_stream_that_ended_gives_back_what_went_in() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("recording.arrows");
    let recording = recorded(vec![Box::new(IpcSink::new(&path))]);
    assert_eq!(read_ipc_stream(&path).unwrap(), without_scene(&recording));
    assert_eq!(read_recording(&path).unwrap(), without_scene(&recording));
}

/// Cut anywhere, the stream still gives every chunk that is whole before the cut.
#[test]
fn a_torn_stream_gives_what_is_whole() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("recording.arrows");
    let recording = recorded(vec![Box::new(IpcSink::new(&path))]);
    let whole = std::fs::read(&path).unwrap();
    let torn = folder.path().join("torn.arrows");
    let mut rows_seen = Vec::new();
    for cut in (0..whole.len()).step_by(whole.len() / 97) {
        std::fs::write(&torn, &whole[..cut]).unwrap();
        let Ok(read) = read_ipc_stream(&torn) else {
            assert!(
                rows_seen.is_empty(),
                "only the stream's head may be beyond reading"
            );
            continue;
        };
        let rows = read.time_s.len();
        assert_eq!(read.outcome, Outcome::Interrupted);
        assert!(
            read.header
                .notes
                .last()
                .unwrap()
                .starts_with("the run was interrupted")
        );
        assert_eq!(read.time_s, recording.time_s[..rows]);
        for (found, expected) in read.columns.iter().zip(&recording.columns) {
            assert_eq!(found, &expected[..rows]);
        }
        rows_seen.push(rows);
    }
    rows_seen.dedup();
    assert_eq!(rows_seen, [0, 1000, 2000, 3000, 3401], "a chunk a second");
}

#[test]
fn sinks_in_the_background_write_the_same() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let direct = recorded(vec![
        Box::new(IpcSink::new(at("a.arrows"))),
        Box::new(ParquetSink::new(at("a.parquet"))),
    ]);
    let sinks: Vec<Box<dyn Sink + Send>> = vec![
        Box::new(IpcSink::new(at("b.arrows"))),
        Box::new(ParquetSink::new(at("b.parquet"))),
    ];
    let background = recorded(vec![Box::new(Background::new(sinks))]);
    assert_eq!(direct, background);
    for kind in ["arrows", "parquet"] {
        let bytes = |name: &str| std::fs::read(at(&format!("{name}.{kind}"))).unwrap();
        assert!(bytes("a") == bytes("b"), "{kind}");
    }
}

#[test]
fn a_folder_that_is_not_there_is_named() {
    let missing = Path::new("/nowhere/at/all");
    let sinks: [Box<dyn Sink + Send>; 3] = [
        Box::new(RrdSink::new(missing.join("recording.rrd"))),
        Box::new(IpcSink::new(missing.join("recording.arrows"))),
        Box::new(ParquetSink::new(missing.join("recording.parquet"))),
    ];
    for sink in sinks {
        let error = synthetic::run(
            0.1,
            1e-3,
            vec![Box::new(Background::new(vec![sink]))],
            || (),
        )
        .unwrap_err();
        assert!(
            error.to_string().starts_with("/nowhere/at/all/recording."),
            "{error}"
        );
    }
}

#[test]
fn what_is_no_recording_is_told_apart() {
    let folder = tempfile::tempdir().unwrap();
    let message = |name: &str, content: &[u8]| {
        let path = folder.path().join(name);
        std::fs::write(&path, content).unwrap();
        read_recording(&path).unwrap_err().to_string()
    };
    assert!(message("a.csv", b"1,2").ends_with("recordings end in .parquet or .arrows"));
    assert!(message("a.parquet", b"PAR1 no, it is not").contains("a.parquet: "));
    assert!(message("a.arrows", b"").contains("a.arrows: "));
    let missing = folder.path().join("missing.parquet");
    assert!(
        read_recording(&missing)
            .unwrap_err()
            .to_string()
            .contains("No such file")
    );
}
