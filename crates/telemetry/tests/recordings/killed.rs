//! A program that is killed leaves behind every chunk that it had written.

use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use crate::synthetic;
use truecut_recording::{Outcome, Recorder, Sink};
use truecut_telemetry::{IpcSink, RrdSink, read_ipc_stream};

/// Set for the run that is to be killed: the folder into which it writes.
const FOLDER: &str = "TRUECUT_TEST_FOLDER";
const STEP_S: f64 = 1e-3;

fn sinks(folder: &Path) -> Vec<Box<dyn Sink + Send>> {
    vec![
        Box::new(RrdSink::new(folder.join("recording.rrd"))),
        Box::new(IpcSink::new(folder.join("recording.arrows"))),
    ]
}

/// Rows of 3.5 s: three chunks are written, half a second still waits.
fn record(folder: &Path) -> Recorder {
    let mut recorder = synthetic::recorder(sinks(folder)).unwrap();
    for step in 0..3500 {
        synthetic::push(&mut recorder, f64::from(step) * STEP_S).unwrap();
    }
    recorder
}

#[test]
fn a_run_that_is_left_alone_is_complete() {
    let to_be_killed = std::env::var_os(FOLDER).map(PathBuf::from);
    let folder = tempfile::tempdir().unwrap();
    let recorder = record(to_be_killed.as_deref().unwrap_or(folder.path()));
    if to_be_killed.is_some() {
        println!("\nrecorded");
        // The killer does not take this long.
        std::thread::sleep(std::time::Duration::from_secs(60));
        return;
    }
    let (recording, sinks) = recorder
        .finish(Vec::new(), Vec::new(), Outcome::Completed)
        .unwrap();
    sinks.close(&recording, &[]).unwrap();
    let read = read_ipc_stream(&folder.path().join("recording.arrows")).unwrap();
    assert_eq!(
        (read.time_s.len(), read.outcome),
        (3500, Outcome::Completed)
    );
    let messages = rrd_messages(&folder.path().join("recording.rrd"));
    assert!(messages.whole, "nothing torn at the end");
    // A viewer shows a file while it loads: the layout of the end, and so the claims that stand
    // before it, come before all rows, and no other layout is in the file.
    let file = folder.path().join("recording.rrd");
    let activations = kinds(&file)
        .into_iter()
        .enumerate()
        .filter(|(_, kind)| *kind == ACTIVATE);
    let activations: Vec<usize> = activations.map(|(at, _)| at).collect();
    assert_eq!(activations.len(), 1, "{activations:?}");
    let curves = 3 * 30;
    assert!(
        activations[0] + curves < messages.count,
        "{activations:?} of {}",
        messages.count
    );
}

#[test]
fn a_run_that_is_killed_leaves_what_it_had_written() {
    let folder = tempfile::tempdir().unwrap();
    let mut child = Command::new(std::env::current_exe().unwrap())
        .args([
            "--exact",
            "killed::a_run_that_is_left_alone_is_complete",
            "--nocapture",
        ])
        .env(FOLDER, folder.path())
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    let lines = BufReader::new(child.stdout.take().unwrap()).lines();
    let recorded = lines.map_while(Result::ok).any(|line| line == "recorded");
    child.kill().unwrap(); // SIGKILL: no handler, no destructor
    child.wait().unwrap();
    assert!(recorded, "the run came to where it was to be killed");

    let read = read_ipc_stream(&folder.path().join("recording.arrows")).unwrap();
    assert_eq!(
        (read.time_s.len(), read.outcome),
        (3000, Outcome::Interrupted),
        "three whole chunks"
    );

    // The same rows make a complete file when they are all there is.
    let reference = tempfile::tempdir().unwrap();
    let mut recorder = synthetic::recorder(sinks(reference.path())).unwrap();
    let before_rows = rrd_messages(&reference.path().join("recording.rrd")).count;
    for step in 0..3000 {
        synthetic::push(&mut recorder, f64::from(step) * STEP_S).unwrap();
    }
    // The row after the third second sends its chunk.
    synthetic::push(&mut recorder, 3.0).unwrap();
    let expected = rrd_messages(&reference.path().join("recording.rrd")).count;
    let killed = rrd_messages(&folder.path().join("recording.rrd"));
    assert!(
        expected > before_rows + 3 * 30,
        "a message for each curve and chunk: {expected}"
    );
    assert_eq!(killed.count, expected);
}

/// Kind of a message that makes a layout the one that is shown.
const ACTIVATE: u64 = 3;

/// Kinds of the messages of an `.rrd`, in their order.
fn kinds(path: &Path) -> Vec<u64> {
    let bytes = std::fs::read(path).unwrap();
    let number = |at: usize| {
        let eight = bytes.get(at..at + 8)?;
        Some(u64::from_le_bytes(eight.try_into().unwrap()))
    };
    let mut kinds = Vec::new();
    let mut at = 12;
    while let (Some(kind), Some(length)) = (number(at), number(at + 8)) {
        kinds.push(kind);
        at += 16 + usize::try_from(length).unwrap();
    }
    kinds
}

struct Messages {
    count: usize,
    /// The file ends where a message ends.
    whole: bool,
}

/// Walks over the frames of an `.rrd`: twelve bytes of header, then for each message its kind and
/// its length, each of 64 bits, and as many bytes.
fn rrd_messages(path: &Path) -> Messages {
    let bytes = std::fs::read(path).unwrap();
    assert_eq!(&bytes[..4], b"RRF2");
    let number = |at: usize| {
        bytes
            .get(at..at + 8)
            .map(|b| u64::from_le_bytes(b.try_into().unwrap()))
    };
    let mut at = 12;
    let mut count = 0;
    while let (Some(_kind), Some(length)) = (number(at), number(at + 8)) {
        let next = at + 16 + usize::try_from(length).unwrap();
        if next > bytes.len() {
            break;
        }
        at = next;
        count += 1;
    }
    // A file that was ended has its own closing bytes after the last message.
    Messages {
        count,
        whole: bytes.len() - at < 64,
    }
}
