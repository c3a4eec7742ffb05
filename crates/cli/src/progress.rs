//! A progress bar for work that takes more than two seconds.

use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

/// No bar for shorter work.
const PATIENCE: Duration = Duration::from_secs(2);

/// Divisions of the bar per run.
const PARTS: f64 = 1000.0;

/// A bar on standard error that appears once the work takes more than two seconds.
pub struct PatientBar {
    bar: ProgressBar,
    started: Instant,
    shown: AtomicBool,
}

impl PatientBar {
    pub fn new(length: u64, template: &str) -> PatientBar {
        let bar = ProgressBar::with_draw_target(Some(length), ProgressDrawTarget::hidden());
        if let Ok(style) = ProgressStyle::with_template(template) {
            bar.set_style(style);
        }
        PatientBar {
            bar,
            started: Instant::now(),
            shown: AtomicBool::new(false),
        }
    }

    /// Changes the bar, from any thread.
    pub fn tell(&self, change: impl FnOnce(&ProgressBar)) {
        if self.started.elapsed() > PATIENCE && !self.shown.swap(true, Ordering::Relaxed) {
            self.bar.set_draw_target(ProgressDrawTarget::stderr());
        }
        change(&self.bar);
    }
}

impl Drop for PatientBar {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}

/// Progress over a number of runs, updated from any thread.
pub struct Progress(PatientBar);

/// Progress of one of the runs.
pub struct RunProgress<'a> {
    all: &'a Progress,
    done: Mutex<u64>,
}

impl Progress {
    pub fn new(runs: usize, what: &str) -> Progress {
        let template = "{msg} {wide_bar} {percent:>3} %  {eta} left";
        let bar = PatientBar::new(runs as u64 * PARTS as u64, template);
        bar.bar.set_message(what.to_owned());
        Progress(bar)
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
}

impl RunProgress<'_> {
    /// Sets the fraction done, 0 to 1.
    pub fn set(&self, part: f64) {
        let parts = (part.clamp(0.0, 1.0) * PARTS) as u64;
        if let Ok(mut done) = self.done.lock()
            && parts > *done
        {
            self.all.0.tell(|bar| bar.inc(parts - *done));
            *done = parts;
        }
    }
}

impl Drop for RunProgress<'_> {
    fn drop(&mut self) {
        self.set(1.0);
    }
}
