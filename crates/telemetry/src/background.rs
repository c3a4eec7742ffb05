//! Sinks that work beside the run instead of holding it up.

use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::thread::{JoinHandle, ScopedJoinHandle};

use truecut_recording::{Chunk, ClaimResult, Frame, Header, Recording, Sink, SinkError};

/// Chunks that may wait. A run that outpaces its sinks by more than this waits for them, so that
/// memory stays bounded and little is lost when the program is killed.
const WAITING_CHUNKS: usize = 2;

type Sinks = Vec<Box<dyn Sink + Send>>;

/// Lets other sinks work on a thread of its own. An error there comes back from a later call.
pub struct Background {
    /// The sinks while there is no thread: before the run begins, and after it.
    idle: Sinks,
    worker: Option<Worker>,
}

struct Worker {
    /// Dropped to let the thread end.
    chunks: SyncSender<OwnedChunk>,
    thread: JoinHandle<(Sinks, Result<(), SinkError>)>,
}

/// A chunk that outlives the recorder's buffers.
struct OwnedChunk {
    time_s: Vec<f64>,
    columns: Vec<Vec<f64>>,
    frames: Vec<Frame>,
}

impl Background {
    /// Sinks that are to work in the background.
    pub fn new(sinks: Vec<Box<dyn Sink + Send>>) -> Background {
        Background {
            idle: sinks,
            worker: None,
        }
    }

    /// Waits until everything that was handed over is written.
    fn join(&mut self) -> Result<(), SinkError> {
        let Some(Worker { chunks, thread }) = self.worker.take() else {
            return Ok(());
        };
        drop(chunks);
        match thread.join() {
            Ok((sinks, result)) => {
                self.idle = sinks;
                result
            }
            Err(panic) => std::panic::resume_unwind(panic),
        }
    }
}

fn work(
    mut sinks: Sinks,
    header: &Header,
    chunks: &Receiver<OwnedChunk>,
) -> (Sinks, Result<(), SinkError>) {
    for sink in &mut sinks {
        if let Err(error) = sink.begin(header) {
            return (sinks, Err(error));
        }
    }
    for owned in chunks {
        let chunk = Chunk {
            time_s: &owned.time_s,
            columns: owned.columns.iter().map(Vec::as_slice).collect(),
            frames: &owned.frames,
        };
        for sink in &mut sinks {
            if let Err(error) = sink.chunk(&chunk) {
                return (sinks, Err(error));
            }
        }
    }
    (sinks, Ok(()))
}

impl Sink for Background {
    fn begin(&mut self, header: &Header) -> Result<(), SinkError> {
        let sinks = std::mem::take(&mut self.idle);
        let header = header.clone();
        let (chunks, receiver) = sync_channel(WAITING_CHUNKS);
        let thread = std::thread::spawn(move || work(sinks, &header, &receiver));
        self.worker = Some(Worker { chunks, thread });
        Ok(())
    }

    fn chunk(&mut self, chunk: &Chunk<'_>) -> Result<(), SinkError> {
        let owned = OwnedChunk {
            time_s: chunk.time_s.to_vec(),
            columns: chunk.columns.iter().map(|column| column.to_vec()).collect(),
            frames: chunk.frames.to_vec(),
        };
        // The thread hangs up only after an error, which joining it brings to light.
        match &self.worker {
            Some(worker) if worker.chunks.send(owned).is_ok() => Ok(()),
            _ => self.join(),
        }
    }

    fn finish(&mut self, recording: &Recording, claims: &[ClaimResult]) -> Result<(), SinkError> {
        self.join()?;
        // Side by side: each writes a file of its own.
        let finished: Vec<_> = std::thread::scope(|scope| {
            let sinks = self.idle.iter_mut();
            let threads: Vec<_> = sinks
                .map(|sink| scope.spawn(|| sink.finish(recording, claims)))
                .collect();
            threads.into_iter().map(ScopedJoinHandle::join).collect()
        });
        finished
            .into_iter()
            .try_for_each(|result| result.unwrap_or_else(|panic| std::panic::resume_unwind(panic)))
    }
}

impl Drop for Background {
    /// A run that ends in an error still leaves behind what it had handed over.
    fn drop(&mut self) {
        if let Some(Worker { chunks, thread }) = self.worker.take() {
            drop(chunks);
            // An error was reported before or cannot be reported any more; a panic is the thread's
            // own.
            thread.join().ok();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::{Arc, Mutex};

    #[derive(Clone, Default)]
    struct Counting {
        rows: Arc<Mutex<usize>>,
        fails_after: Option<usize>,
        finished: Arc<Mutex<bool>>,
    }

    impl Sink for Counting {
        fn begin(&mut self, _: &Header) -> Result<(), SinkError> {
            Ok(())
        }

        fn chunk(&mut self, chunk: &Chunk<'_>) -> Result<(), SinkError> {
            let mut rows = self.rows.lock().unwrap();
            *rows += chunk.time_s.len();
            match self.fails_after {
                Some(limit) if *rows > limit => Err(SinkError::new("disk", "write rows", "full")),
                _ => Ok(()),
            }
        }

        fn finish(&mut self, recording: &Recording, _: &[ClaimResult]) -> Result<(), SinkError> {
            assert_eq!(
                *self.rows.lock().unwrap(),
                recording.time_s.len(),
                "finish comes last"
            );
            *self.finished.lock().unwrap() = true;
            Ok(())
        }
    }

    fn send(background: &mut Background, chunks: usize) -> Result<(), SinkError> {
        background.begin(&Header::default())?;
        (0..chunks).try_for_each(|_| {
            background.chunk(&Chunk {
                time_s: &[0.0, 1.0],
                columns: Vec::new(),
                frames: &[],
            })
        })
    }

    #[test]
    fn every_chunk_arrives_before_the_end() {
        let counting = Counting::default();
        let mut background = Background::new(vec![Box::new(counting.clone())]);
        send(&mut background, 50).unwrap();
        let recording = Recording {
            time_s: vec![0.0; 100],
            ..Recording::default()
        };
        background.finish(&recording, &[]).unwrap();
        assert_eq!(*counting.rows.lock().unwrap(), 100);
        assert!(*counting.finished.lock().unwrap());
    }

    #[test]
    fn every_chunk_arrives_though_the_run_fails() {
        let counting = Counting::default();
        let mut background = Background::new(vec![Box::new(counting.clone())]);
        send(&mut background, 50).unwrap();
        drop(background);
        assert_eq!(*counting.rows.lock().unwrap(), 100);
    }

    #[test]
    fn an_error_comes_back() {
        let counting = Counting {
            fails_after: Some(10),
            ..Counting::default()
        };
        let mut background = Background::new(vec![Box::new(counting)]);
        let error = send(&mut background, 50).unwrap_err();
        assert_eq!(error.to_string(), "disk: cannot write rows: full");
    }
}
