//! What was seen of a run, kept in bounded memory for its page.

use std::sync::{Arc, Mutex, PoisonError};

use truecut_recording::{Chunk, ClaimResult, Frame, Header, Recording, Scene, Sink, SinkError};

/// Most moments that are kept, and the last one: what a slider has room for.
const MOMENTS: usize = 80;

/// A run's scene at some moments, and its fields as they are left.
#[derive(Debug, Clone, Default)]
pub struct Shown {
    /// What can be seen.
    pub scene: Scene,
    /// Moments at about even distances, the last one of the run among them; without fields.
    pub frames: Vec<Frame>,
    /// The last values of each of the scene's fields; empty of one that never had any.
    pub fields: Vec<Vec<f32>>,
}

/// Keeps what the page of a run shows.
#[derive(Debug, Default)]
pub(crate) struct ShownSink {
    kept: Arc<Mutex<Shown>>,
    thinned: Thinned,
    fields: Vec<Vec<f32>>,
}

/// Every so many of the frames that came, and the last.
#[derive(Debug)]
struct Thinned {
    every: usize,
    came: usize,
    frames: Vec<Frame>,
    last: Option<Frame>,
}

impl Default for Thinned {
    fn default() -> Self {
        Self {
            every: 1,
            came: 0,
            frames: Vec::new(),
            last: None,
        }
    }
}

impl Thinned {
    fn add(&mut self, frame: Frame) {
        self.last = Some(frame.clone());
        if self.came.is_multiple_of(self.every) {
            self.frames.push(frame);
        }
        self.came += 1;
        if self.frames.len() > MOMENTS {
            // How many will come is not known: every second one goes whenever there are too many.
            let mut at = 0;
            self.frames.retain(|_| {
                at += 1;
                at % 2 == 1
            });
            self.every *= 2;
        }
    }

    fn take(&mut self) -> Vec<Frame> {
        let mut frames = std::mem::take(&mut self.frames);
        let kept_s = frames.last().map(|frame| frame.time_s);
        frames.extend(
            self.last
                .take()
                .filter(|last| kept_s.is_none_or(|kept| last.time_s > kept)),
        );
        frames
    }
}

impl ShownSink {
    /// Fills what is given at the end of the run.
    pub fn new(kept: Arc<Mutex<Shown>>) -> Self {
        Self {
            kept,
            ..Self::default()
        }
    }
}

impl Sink for ShownSink {
    fn begin(&mut self, header: &Header) -> Result<(), SinkError> {
        let mut kept = self.kept.lock().unwrap_or_else(PoisonError::into_inner);
        kept.scene.clone_from(&header.scene);
        self.fields = vec![Vec::new(); header.scene.fields.len()];
        Ok(())
    }

    fn chunk(&mut self, chunk: &Chunk<'_>) -> Result<(), SinkError> {
        for frame in chunk.frames {
            for (kept, values) in self.fields.iter_mut().zip(&frame.fields) {
                if !values.is_empty() {
                    kept.clone_from(values);
                }
            }
            self.thinned.add(Frame {
                time_s: frame.time_s,
                poses: frame.poses.clone(),
                arrows: frame.arrows.clone(),
                fields: Vec::new(),
            });
        }
        Ok(())
    }

    fn finish(&mut self, _: &Recording, _: &[ClaimResult]) -> Result<(), SinkError> {
        let mut kept = self.kept.lock().unwrap_or_else(PoisonError::into_inner);
        kept.frames = self.thinned.take();
        kept.fields = std::mem::take(&mut self.fields);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn frame(k: usize) -> Frame {
        Frame {
            time_s: k as f64,
            poses: Vec::new(),
            arrows: Vec::new(),
            fields: Vec::new(),
        }
    }

    /// However many frames come, few are kept, evenly, the first and the last among them.
    #[test]
    fn frames_are_thinned_evenly_and_the_last_is_kept() {
        for count in [1, 2, 79, 80, 81, 82, 500, 12_345] {
            let mut thinned = Thinned::default();
            (0..count).for_each(|k| thinned.add(frame(k)));
            let times: Vec<f64> = thinned.take().iter().map(|frame| frame.time_s).collect();
            assert!(times.len() <= MOMENTS + 1, "{count}: {}", times.len());
            assert!(
                times.len() >= count.min(MOMENTS / 2),
                "{count}: {}",
                times.len()
            );
            assert_eq!(
                (times[0], times[times.len() - 1]),
                (0.0, (count - 1) as f64)
            );
            let steps: Vec<f64> = times.windows(2).map(|pair| pair[1] - pair[0]).collect();
            let (last, even) = steps.split_last().map_or((0.0, &[][..]), |(l, e)| (*l, e));
            assert!(even.windows(2).all(|pair| pair[0] == pair[1]), "{steps:?}");
            assert!(even.first().is_none_or(|step| last <= *step), "{steps:?}");
        }
    }
}
