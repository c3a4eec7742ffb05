//! The same bytes, but for times: over threads, jobs, repeats and working folders.

use super::*;

use std::collections::BTreeMap;

use truecut_scenario::Scenario;

/// How many threads the environment asks for, and how many jobs the call does.
const WAYS: [(&str, Option<&str>); 5] = [
    ("1", None),
    ("2", None),
    ("7", None),
    ("1", Some("7")),
    ("7", Some("1")),
];

/// Calls the program in a desk of its own, in one of the ways, and gives what it left, by name.
fn left(
    desk: &Desk,
    arguments: &[&str],
    (threads, jobs): (&str, Option<&str>),
) -> BTreeMap<PathBuf, Vec<u8>> {
    let mut command = desk.command(arguments);
    command.env("RAYON_NUM_THREADS", threads);
    if let Some(jobs) = jobs {
        command.args(["--jobs", jobs]);
    }
    let output = command.output().unwrap();
    let err = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{arguments:?}: {err}");
    let mut found = BTreeMap::new();
    let out = desk.path("out");
    for folder in std::fs::read_dir(&out).unwrap() {
        for file in std::fs::read_dir(folder.unwrap().path()).unwrap() {
            let path = file.unwrap().path();
            let bytes = std::fs::read(&path).unwrap();
            found.insert(path.strip_prefix(&out).unwrap().to_owned(), bytes);
        }
    }
    found
}

fn assert_same(first: &BTreeMap<PathBuf, Vec<u8>>, other: &BTreeMap<PathBuf, Vec<u8>>, way: &str) {
    assert!(first.keys().eq(other.keys()), "{way}: other files");
    for (name, bytes) in first {
        // A `.rrd` holds when it was written.
        let is_timed = name.extension().is_some_and(|it| it == "rrd");
        assert!(
            is_timed || *bytes == other[name],
            "{way}: {}",
            name.display()
        );
    }
}

#[test]
fn runs_and_sweeps_are_the_same_bytes_over_threads_jobs_and_folders() {
    let all = WAYS.map(|way| {
        let desk = Desk::new();
        let values = (1..=20).map(|n| format!("{}", 7 * n)).collect::<Vec<_>>();
        let rest = sweep("process.load.release_n.0", &values.join(", "));
        desk.scenario("swing", "duration_s = 0.3", &claim("swings", "min = 1"));
        desk.scenario("wave", "duration_s = 0.2", "");
        desk.scenario("swept", "duration_s = 0.05", &rest);
        let calls = ["run", "swing.toml", "wave.toml", "swept.toml"];
        (format!("{way:?}"), left(&desk, &calls, way))
    });
    let [(_, first), others @ ..] = &all;
    let has = |name: &str| assert!(first.contains_key(Path::new(name)), "{:?}", first.keys());
    has("swing/recording.parquet");
    has("wave/summary.json");
    has("swept/sweep.parquet");
    for (way, other) in others {
        assert_same(first, other, way);
    }
}

/// What a diagnosis leaves, without the time that it took.
fn untimed(mut files: BTreeMap<PathBuf, Vec<u8>>) -> BTreeMap<PathBuf, Vec<u8>> {
    let json = files.get_mut(Path::new("elbow/diagnosis.json")).unwrap();
    let mut answer: serde_json::Value = serde_json::from_slice(json).unwrap();
    assert!(answer["work"]["seconds"].take().is_f64());
    *json = serde_json::to_vec(&answer).unwrap();
    let report = files.get_mut(Path::new("elbow/report.html")).unwrap();
    let text = String::from_utf8(std::mem::take(report)).unwrap();
    let (before, after) = text.split_once(" simulations in ").unwrap();
    let (_, after) = after.split_once(" s.").unwrap();
    *report = format!("{before}{after}").into_bytes();
    files
}

#[test]
fn a_diagnosis_is_the_same_bytes_over_threads_jobs_and_folders() {
    let made = |way| {
        untimed(left(
            &super::diagnose::desk(),
            &["diagnose", "elbow.toml"],
            way,
        ))
    };
    let first = made(WAYS[0]);
    for way in [WAYS[2], WAYS[3]] {
        assert_same(&first, &made(way), &format!("{way:?}"));
    }
}

#[test]
fn the_stream_of_a_run_is_the_same_bytes() {
    let stream = || {
        let desk = Desk::new();
        desk.scenario("swing", "duration_s = 0.3", "");
        let scenario = Scenario::load(&desk.path("swing.toml"), &[]).unwrap();
        let outputs = truecut::Outputs::prepare(&desk.path("out"), &scenario, false).unwrap();
        let mut run = truecut::Run::of(&scenario);
        run.sinks = outputs.sinks();
        run.execute().unwrap();
        std::fs::read(outputs.path("recording.arrows")).unwrap()
    };
    let first = stream();
    assert!(!first.is_empty());
    assert!(first == stream());
}
