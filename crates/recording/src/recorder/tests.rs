use std::sync::{Arc, Mutex};

use super::*;
use crate::recording::ChannelSpec;
use crate::scene::{Body, Pose, Scene};
use crate::unit::Unit;

/// What a sink was told, readable after the run.
#[derive(Clone, Default)]
struct Log(Arc<Mutex<Vec<Entry>>>);

#[derive(Clone, Debug, PartialEq)]
enum Entry {
    Begin(String),
    Chunk {
        time_s: Vec<f64>,
        values: Vec<f64>,
        frames_s: Vec<f64>,
    },
    Finish {
        rows: usize,
        outcome: Outcome,
    },
}

impl Log {
    fn add(&self, entry: Entry) -> Result<(), SinkError> {
        self.0.lock().unwrap().push(entry);
        Ok(())
    }

    fn chunks(&self) -> Vec<(Vec<f64>, Vec<f64>, Vec<f64>)> {
        let entries = self.0.lock().unwrap().clone();
        let chunk = |entry| match entry {
            Entry::Chunk {
                time_s,
                values,
                frames_s,
            } => Some((time_s, values, frames_s)),
            Entry::Begin(_) | Entry::Finish { .. } => None,
        };
        entries.into_iter().filter_map(chunk).collect()
    }
}

impl Sink for Log {
    fn begin(&mut self, header: &Header) -> Result<(), SinkError> {
        self.add(Entry::Begin(header.scenario_name.clone()))
    }

    fn chunk(&mut self, chunk: &Chunk<'_>) -> Result<(), SinkError> {
        self.add(Entry::Chunk {
            time_s: chunk.time_s.to_vec(),
            values: chunk.columns[0].to_vec(),
            frames_s: chunk.frames.iter().map(|frame| frame.time_s).collect(),
        })
    }

    fn finish(&mut self, recording: &Recording, _: &[ClaimResult]) -> Result<(), SinkError> {
        self.add(Entry::Finish {
            rows: recording.time_s.len(),
            outcome: recording.outcome.clone(),
        })
    }
}

fn header() -> Header {
    let body = Body {
        path: "tool".into(),
        shapes: Vec::new(),
        initial_pose: Pose::IDENTITY,
    };
    Header {
        scenario_name: "test".into(),
        channels: vec![ChannelSpec::new("tool.position_x", Unit::Metre, "")],
        scene: Scene {
            bodies: vec![body],
            ..Scene::default()
        },
        ..Header::default()
    }
}

fn frame(time_s: f64) -> Frame {
    Frame {
        time_s,
        poses: vec![Pose::IDENTITY],
        arrows: Vec::new(),
        fields: Vec::new(),
    }
}

fn run(rows: usize, step_s: f64, pace: Pace) -> (Log, Recording) {
    let log = Log::default();
    let mut recorder = Recorder::with_pace(header(), vec![Box::new(log.clone())], pace).unwrap();
    for row in 0..rows {
        let time_s = row as f64 * step_s;
        recorder.push_row(time_s, &[row as f64]).unwrap();
        if recorder.frame_is_due(time_s) {
            recorder.push_frame(frame(time_s));
        }
    }
    let (recording, sinks) = recorder
        .finish(Vec::new(), Vec::new(), Outcome::Completed)
        .unwrap();
    sinks.close(&recording, &[]).unwrap();
    (log, recording)
}

/// Never by the clock on the wall, so that a busy machine cannot disturb what is tested.
const PATIENT: Pace = Pace {
    chunk_simulated_s: 1.0,
    chunk_wall: Duration::MAX,
    chunk_rows: usize::MAX,
    frame_interval_s: 0.02,
};

#[test]
fn no_chunk_spans_more_than_a_simulated_second() {
    let (log, recording) = run(4400, 1e-3, PATIENT);
    let chunks = log.chunks();
    assert_eq!(chunks.len(), 5);
    assert!(
        chunks
            .iter()
            .all(|(time_s, ..)| time_s[time_s.len() - 1] - time_s[0] <= 1.0)
    );
    let joined: Vec<f64> = chunks
        .iter()
        .flat_map(|(_, values, _)| values.clone())
        .collect();
    assert_eq!(joined, recording.columns[0], "nothing lost, nothing twice");
    let entries = log.0.lock().unwrap();
    assert_eq!(entries[0], Entry::Begin("test".into()));
    assert_eq!(
        entries[6],
        Entry::Finish {
            rows: 4400,
            outcome: Outcome::Completed
        }
    );
}

#[test]
fn the_clock_on_the_wall_also_sends() {
    let (log, _) = run(
        10,
        1e-6,
        Pace {
            chunk_wall: Duration::ZERO,
            ..PATIENT
        },
    );
    assert_eq!(
        log.chunks().len(),
        10,
        "every row finds the one before it overdue"
    );
}

#[test]
fn a_chunk_is_bounded_in_rows() {
    let (log, _) = run(
        1000,
        1e-6,
        Pace {
            chunk_rows: 300,
            ..PATIENT
        },
    );
    let rows: Vec<usize> = log
        .chunks()
        .iter()
        .map(|(time_s, ..)| time_s.len())
        .collect();
    assert_eq!(rows, [300, 300, 300, 100]);
}

#[test]
fn frames_keep_their_rate_whatever_the_step() {
    for step_s in [1e-3, 2.5e-4, 7.3e-4, 3.1e-3] {
        let rows = (2.0 / step_s) as usize;
        let (log, _) = run(rows, step_s, PATIENT);
        let frames: usize = log
            .chunks()
            .iter()
            .map(|(.., frames_s)| frames_s.len())
            .sum();
        assert!(
            (100..=101).contains(&frames),
            "{frames} frames in 2 s at steps of {step_s}"
        );
    }
    let (log, _) = run(50, 0.1, PATIENT);
    let frames: usize = log
        .chunks()
        .iter()
        .map(|(.., frames_s)| frames_s.len())
        .sum();
    assert_eq!(frames, 50, "rows that are rarer than frames all have one");
}

#[test]
fn the_recording_does_not_depend_on_the_pace() {
    let hasty = Pace {
        chunk_wall: Duration::ZERO,
        chunk_rows: 7,
        ..PATIENT
    };
    assert_eq!(run(500, 1e-3, hasty).1, run(500, 1e-3, PATIENT).1);
}

#[test]
fn a_run_without_sinks_asks_for_no_frames() {
    let recorder = Recorder::new(header(), Vec::new()).unwrap();
    assert!(!recorder.frame_is_due(0.0));
}

/// Sinks have every channel of every row, the recording those that are kept.
#[test]
fn channels_that_are_not_kept_leave_with_their_chunk() {
    let mut header = header();
    (header.channels).push(ChannelSpec::new("tool.position_y", Unit::Metre, ""));
    let log = Log::default();
    let mut recorder = Recorder::with_pace(header, vec![Box::new(log.clone())], PATIENT).unwrap();
    recorder.keep_only(&["tool.position_y".to_owned(), "not.there".to_owned()]);
    recorder.reserve(2500);
    for row in 0..2500 {
        let value = f64::from(row);
        recorder.push_row(1e-3 * value, &[value, -value]).unwrap();
    }
    let (recording, sinks) = recorder
        .finish(Vec::new(), Vec::new(), Outcome::Completed)
        .unwrap();
    sinks.close(&recording, &[]).unwrap();
    let left: Vec<f64> = (log.chunks().into_iter())
        .flat_map(|(_, values, _)| values)
        .collect();
    let expected: Vec<f64> = (0..2500).map(f64::from).collect();
    assert_eq!(left, expected);
    assert_eq!(recording.time_s.len(), 2500);
    assert_eq!(recording.header.channels.len(), 1);
    let kept: Vec<f64> = expected.iter().map(|value| -value).collect();
    assert_eq!(recording.channel("tool.position_y").unwrap(), kept);
    assert!(recording.channel("tool.position_x").is_err());
}
