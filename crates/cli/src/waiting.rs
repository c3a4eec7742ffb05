//! Work that tells nothing of itself for long, told all the same.

use std::borrow::Cow;
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::time::Duration;

use indicatif::ProgressBar;

use crate::progress::PatientBar;

/// From one time that a bar is told to the next.
const EVERY: Duration = Duration::from_secs(1);

/// Does work of a name. The bar says every second how long it takes, whatever the work tells; where
/// there is no terminal, its lines come as they do of any work.
pub fn told<T>(
    bar: &PatientBar,
    what: impl Into<Cow<'static, str>>,
    work: impl FnOnce() -> T,
) -> T {
    bar.tell(|bar| bar.set_message(what));
    beside(EVERY, &|| bar.tell(ProgressBar::tick), work)
}

/// Does work, and calls `tell` again and again until it is done.
fn beside<T>(every: Duration, tell: &(dyn Fn() + Sync), work: impl FnOnce() -> T) -> T {
    let (done, is_done) = channel::<()>();
    std::thread::scope(|scope| {
        // It sleeps in between, and wakes as soon as the other end is gone, also by a panic.
        scope.spawn(move || {
            while is_done.recv_timeout(every) == Err(RecvTimeoutError::Timeout) {
                tell();
            }
        });
        let answer = work();
        drop(done);
        answer
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::atomic::{AtomicUsize, Ordering};
    use std::time::Instant;

    #[test]
    fn silent_work_is_told_of_until_it_is_done_and_waits_for_nothing() {
        let count = AtomicUsize::new(0);
        let tell = || {
            count.fetch_add(1, Ordering::Relaxed);
        };
        let answer = beside(Duration::from_millis(1), &tell, || {
            let begun = Instant::now();
            while count.load(Ordering::Relaxed) < 3 && begun.elapsed().as_secs() < 30 {
                std::thread::sleep(Duration::from_millis(1));
            }
            7
        });
        assert_eq!(answer, 7);
        assert!(count.load(Ordering::Relaxed) >= 3);
        // An hour, if it waited.
        beside(Duration::from_secs(3600), &tell, || ());
    }
}
