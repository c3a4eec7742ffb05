//! A progress bar for work that takes more than two seconds; where standard error is no terminal, a
//! line every few seconds.

use std::io::IsTerminal;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

/// No bar for shorter work.
const PATIENCE: Duration = Duration::from_secs(2);

/// From one line to the next, where there is no terminal.
const BETWEEN_LINES: Duration = Duration::from_secs(5);

/// Part of the work below which no time is forecast: what is set up at first takes longer.
const FORECAST_FROM: f64 = 0.05;

/// And from which on none is.
const NO_FORECAST_FROM: f64 = 0.995;

/// Divisions of the bar per run.
const PARTS: f64 = 1000.0;

/// A bar on standard error that appears once the work takes more than two seconds.
pub struct PatientBar {
    bar: ProgressBar,
    started: Instant,
    shown: AtomicBool,
    /// In place of the bar.
    lines: Option<Mutex<Lines>>,
}

/// Lines that tell of progress, so seldom that they do not fill a log.
#[derive(Default)]
struct Lines {
    last: Duration,
}

impl Lines {
    /// The line that is due after a time, with a part of the work done.
    fn due(&mut self, elapsed: Duration, what: &str, part: f64) -> Option<String> {
        if elapsed < self.last + BETWEEN_LINES {
            return None;
        }
        self.last = elapsed;
        let spent_s = elapsed.as_secs_f64();
        // How long what comes beyond all that was foreseen takes is not known.
        let left = if (FORECAST_FROM..NO_FORECAST_FROM).contains(&part) {
            format!(", about {} left", time(spent_s * (1.0 - part) / part))
        } else {
            String::new()
        };
        let percent = 100.0 * part;
        Some(format!(
            "  {what}: {percent:.0} % after {}{left}",
            time(spent_s)
        ))
    }
}

/// A time as people say it.
fn time(seconds: f64) -> String {
    let whole = seconds.round() as u64;
    match whole {
        0..120 => format!("{whole} s"),
        120..7200 => format!("{} min", whole / 60),
        _ => format!("{} h {} min", whole / 3600, whole % 3600 / 60),
    }
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
            lines: (!std::io::stderr().is_terminal()).then(Mutex::default),
        }
    }

    /// So many runs were made, and this is what they are for now. A search may end beyond those
    /// that it was allowed: what it found is held against others, confirmed and drawn.
    pub fn made(&self, runs: usize, what: String) {
        self.tell(|bar| {
            let runs = runs as u64;
            if bar.length().is_some_and(|length| length <= runs) {
                bar.set_length(runs + 1);
            }
            bar.set_message(what);
            bar.set_position(runs);
        });
    }

    /// Changes the bar, from any thread.
    pub fn tell(&self, change: impl FnOnce(&ProgressBar)) {
        if self.started.elapsed() > PATIENCE && !self.shown.swap(true, Ordering::Relaxed) {
            self.bar.set_draw_target(ProgressDrawTarget::stderr());
        }
        change(&self.bar);
        let (at, of) = (self.bar.position(), self.bar.length().unwrap_or(0).max(1));
        if let Some(lines) = &self.lines
            && let Ok(mut lines) = lines.lock()
            && at < of
            && let Some(line) = lines.due(
                self.started.elapsed(),
                &self.bar.message(),
                at as f64 / of as f64,
            )
        {
            eprintln!("{line}");
        }
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_come_every_few_seconds_and_say_what_is_left() {
        let mut lines = Lines::default();
        let told: Vec<String> = (0..=240)
            .filter_map(|quarter| {
                let elapsed = Duration::from_millis(250 * quarter);
                lines.due(elapsed, "sweeping", quarter as f64 / 240.0)
            })
            .collect();
        assert_eq!(told.len(), 12, "one in five seconds of a minute: {told:?}");
        assert_eq!(told[0], "  sweeping: 8 % after 5 s, about 55 s left");
        let mut lines = Lines::default();
        assert_eq!(lines.due(Duration::from_secs(4), "x", 0.5), None);
        let long = lines.due(Duration::from_secs(7200), "x", 0.25);
        assert_eq!(
            long.as_deref(),
            Some("  x: 25 % after 2 h 0 min, about 6 h 0 min left")
        );
        let beyond = lines.due(Duration::from_secs(7300), "x", 0.999);
        assert_eq!(beyond.as_deref(), Some("  x: 100 % after 2 h 1 min"));
        let none = lines.due(Duration::from_secs(8000), "x", 0.049);
        assert_eq!(none.as_deref(), Some("  x: 5 % after 2 h 13 min"));
    }
}
