//! A progress bar for work that takes more than two seconds.

use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

/// No bar for shorter work.
const PATIENCE: Duration = Duration::from_secs(2);

/// Divisions of the bar per run.
const PARTS: f64 = 1000.0;

/// Progress over a number of runs, updated from any thread.
pub struct Progress {
    bar: ProgressBar,
    started: Instant,
    shown: AtomicBool,
}

/// Progress of one of the runs.
pub struct RunProgress<'a> {
    all: &'a Progress,
    done: Mutex<u64>,
}

impl Progress {
    pub fn new(runs: usize, what: &str) -> Progress {
        let bar = ProgressBar::with_draw_target(
            Some(runs as u64 * PARTS as u64),
            ProgressDrawTarget::hidden(),
        );
        let style = ProgressStyle::with_template("{msg} {wide_bar} {percent:>3} %  {eta} left");
        if let Ok(style) = style {
            bar.set_style(style);
        }
        bar.set_message(what.to_owned());
        Progress {
            bar,
            started: Instant::now(),
            shown: AtomicBool::new(false),
        }
    }

    /// Does work that tells of its progress, 0 to 1.
    pub fn of_one<T>(what: &str, work: impl FnOnce(&(dyn Fn(f64) + Sync)) -> T) -> T {
        let progress = Progress::new(1, what);
        let run = progress.run();
        work(&|part| run.set(part))
    }

    /// Starts the progress of a run.
    pub fn run(&self) -> RunProgress<'_> {
        RunProgress {
            all: self,
            done: Mutex::new(0),
        }
    }

    fn advance(&self, parts: u64) {
        if self.started.elapsed() > PATIENCE && !self.shown.swap(true, Ordering::Relaxed) {
            self.bar.set_draw_target(ProgressDrawTarget::stderr());
        }
        self.bar.inc(parts);
    }
}

impl RunProgress<'_> {
    /// Sets the fraction done, 0 to 1.
    pub fn set(&self, part: f64) {
        let parts = (part.clamp(0.0, 1.0) * PARTS) as u64;
        if let Ok(mut done) = self.done.lock()
            && parts > *done
        {
            self.all.advance(parts - *done);
            *done = parts;
        }
    }
}

impl Drop for RunProgress<'_> {
    fn drop(&mut self) {
        self.set(1.0);
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}
