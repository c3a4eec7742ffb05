//! Collects rows during a run and hands them on in chunks.

use std::time::{Duration, Instant};

use crate::claims::ClaimResult;
use crate::recording::{ChannelSpec, Header, Outcome, Profile, Recording, Scalar};
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
    /// A second of either time, 8192 rows, 50 frames a second: enough for a vibration of 10 Hz.
    fn default() -> Pace {
        Pace {
            chunk_simulated_s: 1.0,
            chunk_wall: Duration::from_secs(1),
            chunk_rows: 8192,
            frame_interval_s: 0.02,
        }
    }
}

/// Buffers rows, sends them to the sinks in chunks, and keeps them for the metrics: all channels,
/// or those of [`Recorder::keep_only`].
///
/// What it returns in the end does not depend on the pace, hence not on the speed of the machine.
pub struct Recorder {
    /// What the sinks were told; the header of `recording` has the channels that are kept.
    channels: Vec<ChannelSpec>,
    recording: Recording,
    /// For each column of the recording the channel that it is of.
    kept: Vec<usize>,
    /// Rows that have not left yet, of all channels.
    waiting_time_s: Vec<f64>,
    waiting: Vec<Vec<f64>>,
    frames: Vec<Frame>,
    sinks: Vec<Box<dyn Sink + Send>>,
    pace: Pace,
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
        let channels = header.channels.clone();
        let columns = vec![Vec::new(); channels.len()];
        Ok(Recorder {
            kept: (0..channels.len()).collect(),
            waiting_time_s: Vec::new(),
            waiting: columns.clone(),
            channels,
            recording: Recording {
                header,
                columns,
                ..Recording::default()
            },
            frames: Vec::new(),
            sinks,
            pace,
            next_frame_s: f64::NEG_INFINITY,
            last_chunk: Instant::now(),
        })
    }

    /// Keeps no other channels than these: the recording in the end has them alone, while the sinks
    /// take all. What is named and not there is left out. Before the first row.
    pub fn keep_only(&mut self, names: &[String]) {
        let is_kept = |channel: &usize| names.contains(&self.channels[*channel].name);
        self.kept = (0..self.channels.len()).filter(is_kept).collect();
        let specs = self.kept.iter().map(|at| self.channels[*at].clone());
        self.recording.header.channels = specs.collect();
        self.recording.columns = vec![Vec::new(); self.kept.len()];
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
    /// If there are not as many values as channels: a fault of the caller's code, never of a user's
    /// input.
    ///
    /// # Errors
    /// A sink that cannot take the chunk that became due.
    pub fn push_row(&mut self, time_s: f64, values: &[f64]) -> Result<(), SinkError> {
        assert_eq!(
            values.len(),
            self.waiting.len(),
            "one value for each channel"
        );
        // The row that reaches the limit opens the next chunk, so that no chunk spans more than the
        // limit.
        if self.chunk_is_due(time_s) {
            self.send_chunk()?;
        }
        self.waiting_time_s.push(time_s);
        for (column, value) in self.waiting.iter_mut().zip(values) {
            column.push(*value);
        }
        Ok(())
    }

    fn chunk_is_due(&self, time_s: f64) -> bool {
        self.waiting_time_s.first().is_some_and(|first_s| {
            self.waiting_time_s.len() >= self.pace.chunk_rows
                || time_s - first_s >= self.pace.chunk_simulated_s
                || self.last_chunk.elapsed() >= self.pace.chunk_wall
        })
    }

    /// Whether a frame at this time would be kept; ask before computing one.
    pub fn frame_is_due(&self, time_s: f64) -> bool {
        // A hair before the due time counts, since times are sums of steps.
        !self.sinks.is_empty() && time_s >= self.next_frame_s - 1e-9
    }

    /// Whether frames are of any use: what is seen is not kept without a sink.
    pub fn takes_frames(&self) -> bool {
        !self.sinks.is_empty()
    }

    /// A frame; dropped if none is due yet.
    ///
    /// # Panics
    /// If it has not one pose for each body, one force for each arrow and one set of values for
    /// each field of the scene.
    pub fn push_frame(&mut self, frame: Frame) {
        self.take_frame(frame, false);
    }

    /// The last frame of a run, whether one is due or not.
    ///
    /// # Panics
    /// As [`Recorder::push_frame`].
    pub fn push_last_frame(&mut self, frame: Frame) {
        self.take_frame(frame, true);
    }

    fn take_frame(&mut self, frame: Frame, is_last: bool) {
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
        assert_eq!(
            frame.fields.len(),
            scene.fields.len(),
            "one set of values for each field"
        );
        if !is_last && !self.frame_is_due(frame.time_s) {
            return;
        }
        // Counted from the due time, not from the frame's, so that the rate does not drift with the
        // step.
        let interval = self.pace.frame_interval_s;
        self.next_frame_s = (self.next_frame_s + interval).max(frame.time_s + 0.5 * interval);
        self.frames.push(frame);
    }

    fn send_chunk(&mut self) -> Result<(), SinkError> {
        let chunk = Chunk {
            time_s: &self.waiting_time_s,
            columns: self.waiting.iter().map(Vec::as_slice).collect(),
            frames: &self.frames,
        };
        if !(chunk.time_s.is_empty() && chunk.frames.is_empty()) {
            for sink in &mut self.sinks {
                sink.chunk(&chunk)?;
            }
        }
        self.recording
            .time_s
            .extend_from_slice(&self.waiting_time_s);
        for (column, from) in self.recording.columns.iter_mut().zip(&self.kept) {
            column.extend_from_slice(&self.waiting[*from]);
        }
        self.waiting_time_s.clear();
        self.waiting.iter_mut().for_each(Vec::clear);
        self.frames.clear();
        self.last_chunk = Instant::now();
        Ok(())
    }

    /// Sends what is left and gives the recording, with the sinks still open: claims are evaluated
    /// on the recording, then given to [`OpenSinks::close`].
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
mod tests;
