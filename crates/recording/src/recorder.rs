//! Collects rows during a run and hands them on in chunks.

use std::time::{Duration, Instant};

use crate::claims::ClaimResult;
use crate::recording::{Header, Outcome, Profile, Recording, Scalar};
use crate::scene::Frame;
use crate::sink::{Chunk, Sink, SinkError};

/// When a chunk leaves and how many frames are kept.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pace {
    /// A chunk holds at most so much simulated time.
    pub chunk_simulated_s: f64,
    /// A row waits at most so long by the clock on the wall, as long as rows keep coming.
    pub chunk_wall: Duration,
    /// A chunk holds at most so many rows.
    pub chunk_rows: usize,
    /// Simulated time between frames.
    pub frame_interval_s: f64,
}

impl Default for Pace {
    /// A second of either time, 8192 rows, 100 frames a second: a vibration of 10 Hz still moves smoothly.
    fn default() -> Pace {
        Pace {
            chunk_simulated_s: 1.0,
            chunk_wall: Duration::from_secs(1),
            chunk_rows: 8192,
            frame_interval_s: 0.01,
        }
    }
}

/// Buffers rows, sends them to the sinks in chunks, and keeps them all for the metrics.
///
/// What it returns in the end does not depend on the pace, hence not on the speed of the machine.
pub struct Recorder {
    recording: Recording,
    frames: Vec<Frame>,
    sinks: Vec<Box<dyn Sink + Send>>,
    pace: Pace,
    sent_rows: usize,
    next_frame_s: f64,
    last_chunk: Instant,
}

impl Recorder {
    /// Opens every sink.
    ///
    /// # Errors
    /// A sink that cannot begin.
    pub fn new(header: Header, sinks: Vec<Box<dyn Sink + Send>>) -> Result<Recorder, SinkError> {
        Recorder::with_pace(header, sinks, Pace::default())
    }

    /// As [`Recorder::new`], with a pace of one's own.
    ///
    /// # Errors
    /// A sink that cannot begin.
    pub fn with_pace(
        header: Header,
        mut sinks: Vec<Box<dyn Sink + Send>>,
        pace: Pace,
    ) -> Result<Recorder, SinkError> {
        for sink in &mut sinks {
            sink.begin(&header)?;
        }
        let columns = vec![Vec::new(); header.channels.len()];
        Ok(Recorder {
            recording: Recording {
                header,
                columns,
                ..Recording::default()
            },
            frames: Vec::new(),
            sinks,
            pace,
            sent_rows: 0,
            next_frame_s: f64::NEG_INFINITY,
            last_chunk: Instant::now(),
        })
    }

    /// What was known before the first row.
    pub fn header(&self) -> &Header {
        &self.recording.header
    }

    /// Makes room for so many rows, to spare growing.
    pub fn reserve(&mut self, rows: usize) {
        self.recording.time_s.reserve(rows);
        for column in &mut self.recording.columns {
            column.reserve(rows);
        }
    }

    /// One row: a value for each channel, SI. Times ascend.
    ///
    /// # Panics
    /// If there are not as many values as channels: a fault of the caller's code, never of a user's input.
    ///
    /// # Errors
    /// A sink that cannot take the chunk that became due.
    pub fn push_row(&mut self, time_s: f64, values: &[f64]) -> Result<(), SinkError> {
        assert_eq!(
            values.len(),
            self.recording.columns.len(),
            "one value for each channel"
        );
        // The row that reaches the limit opens the next chunk, so that no chunk spans more than the limit.
        if self.chunk_is_due(time_s) {
            self.send_chunk()?;
        }
        self.recording.time_s.push(time_s);
        for (column, value) in self.recording.columns.iter_mut().zip(values) {
            column.push(*value);
        }
        Ok(())
    }

    fn chunk_is_due(&self, time_s: f64) -> bool {
        let waiting = self.recording.time_s.len() - self.sent_rows;
        waiting > 0
            && (waiting >= self.pace.chunk_rows
                || time_s - self.recording.time_s[self.sent_rows] >= self.pace.chunk_simulated_s
                || self.last_chunk.elapsed() >= self.pace.chunk_wall)
    }

    /// Whether a frame at this time would be kept; ask before computing one.
    pub fn frame_is_due(&self, time_s: f64) -> bool {
        // A hair before the due time counts, since times are sums of steps.
        !self.sinks.is_empty() && time_s >= self.next_frame_s - 1e-9
    }

    /// A frame; dropped if none is due yet.
    ///
    /// # Panics
    /// If it has not one pose for each body and one force for each arrow of the scene.
    pub fn push_frame(&mut self, frame: Frame) {
        let scene = &self.recording.header.scene;
        assert_eq!(
            frame.poses.len(),
            scene.bodies.len(),
            "one pose for each body"
        );
        assert_eq!(
            frame.arrows.len(),
            scene.arrows.len(),
            "one force for each arrow"
        );
        if !self.frame_is_due(frame.time_s) {
            return;
        }
        // Counted from the due time, not from the frame's, so that the rate does not drift with the step.
        let interval = self.pace.frame_interval_s;
        self.next_frame_s = (self.next_frame_s + interval).max(frame.time_s + 0.5 * interval);
        self.frames.push(frame);
    }

    fn send_chunk(&mut self) -> Result<(), SinkError> {
        let from = self.sent_rows;
        let chunk = Chunk {
            time_s: &self.recording.time_s[from..],
            columns: self
                .recording
                .columns
                .iter()
                .map(|column| &column[from..])
                .collect(),
            frames: &self.frames,
        };
        if !(chunk.time_s.is_empty() && chunk.frames.is_empty()) {
            for sink in &mut self.sinks {
                sink.chunk(&chunk)?;
            }
        }
        self.sent_rows = self.recording.time_s.len();
        self.frames.clear();
        self.last_chunk = Instant::now();
        Ok(())
    }

    /// Sends what is left and gives the recording, with the sinks still open: claims are evaluated on the recording,
    /// then given to [`OpenSinks::close`].
    ///
    /// # Errors
    /// A sink that cannot take the last chunk.
    pub fn finish(
        mut self,
        scalars: Vec<Scalar>,
        profiles: Vec<Profile>,
        outcome: Outcome,
    ) -> Result<(Recording, OpenSinks), SinkError> {
        self.send_chunk()?;
        let recording = Recording {
            scalars,
            profiles,
            outcome,
            ..self.recording
        };
        Ok((recording, OpenSinks { sinks: self.sinks }))
    }
}

/// The sinks of a run that has ended but is not judged yet.
#[must_use = "sinks write the claims and their last lines when they are closed"]
pub struct OpenSinks {
    sinks: Vec<Box<dyn Sink + Send>>,
}

impl OpenSinks {
    /// Gives every sink the whole recording and the claims.
    ///
    /// # Errors
    /// A sink that cannot finish; the others are finished all the same.
    pub fn close(self, recording: &Recording, claims: &[ClaimResult]) -> Result<(), SinkError> {
        let results: Vec<_> = self
            .sinks
            .into_iter()
            .map(|mut sink| sink.finish(recording, claims))
            .collect();
        results.into_iter().collect()
    }
}

#[cfg(test)]
mod tests {
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
        }
    }

    fn run(rows: usize, step_s: f64, pace: Pace) -> (Log, Recording) {
        let log = Log::default();
        let mut recorder =
            Recorder::with_pace(header(), vec![Box::new(log.clone())], pace).unwrap();
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
    fn verify_no_chunk_spans_more_than_a_simulated_second() {
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
    fn verify_the_clock_on_the_wall_also_sends() {
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
    fn verify_a_chunk_is_bounded_in_rows() {
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
    fn verify_frames_keep_their_rate_whatever_the_step() {
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
}
