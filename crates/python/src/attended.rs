//! Work on a thread of its own, while this one listens to signals and tells of progress.

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::mpsc;
use std::thread;
use std::time::Duration;

use pyo3::prelude::*;

use crate::errors::bug;

/// How often signals are listened to, and progress is told.
const EVERY: Duration = Duration::from_millis(50);

/// What work is given: where to say how much is done, and what tells it to stop.
pub struct Attended {
    part: AtomicU64,
    stop: AtomicBool,
}

impl Attended {
    /// Says how much is done, from 0 to 1.
    pub fn tell(&self, part: f64) {
        self.part.store(part.to_bits(), Ordering::Relaxed);
    }

    /// Set once the work is to stop.
    pub fn stop(&self) -> &AtomicBool {
        &self.stop
    }
}

/// Does the work without the interpreter. Ctrl-C, or an exception of `progress`, stops it and is
/// what comes of it; a panic is an exception.
pub fn attended<T: Send>(
    py: Python<'_>,
    progress: Option<&Bound<'_, PyAny>>,
    work: impl FnOnce(&Attended) -> T + Send,
) -> PyResult<T> {
    let attended = Attended {
        part: AtomicU64::new(0.0_f64.to_bits()),
        stop: AtomicBool::new(false),
    };
    let (told_end, mut end) = mpsc::channel::<()>();
    thread::scope(|scope| {
        let shared = &attended;
        let worker = scope.spawn(move || {
            // Dropped at the end, also by a panic: then the other side hears of it at once.
            let _told_end = told_end;
            work(shared)
        });
        let mut told = f64::NAN;
        let mut ended = Ok(());
        loop {
            let listening = &mut end;
            let heard = py.detach(move || listening.recv_timeout(EVERY));
            if !matches!(heard, Err(mpsc::RecvTimeoutError::Timeout)) {
                break;
            }
            let part = f64::from_bits(attended.part.load(Ordering::Relaxed));
            ended = py.check_signals().and_then(|()| match progress {
                Some(progress) if part != told => progress.call1((part,)).map(|_| ()),
                _ => Ok(()),
            });
            told = part;
            if ended.is_err() {
                attended.stop.store(true, Ordering::Relaxed);
                break;
            }
        }
        let done = py.detach(move || worker.join());
        ended?;
        let done = done.map_err(|panic| bug(&*panic))?;
        if let Some(progress) = progress {
            progress.call1((1.0,))?;
        }
        Ok(done)
    })
}
