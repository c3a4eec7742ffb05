//! The border to the libraries that read files.

use std::cell::Cell;
use std::panic::{AssertUnwindSafe, catch_unwind, set_hook, take_hook};
use std::sync::Once;

use crate::error::Reason;

thread_local! {
    /// Whether a library reads on this thread just now.
    static READS: Cell<bool> = const { Cell::new(false) };
}

/// Calls a library that may panic on a damaged file: the panic is an error, and nothing of it is
/// printed. Panics elsewhere go to the hook that was there before.
pub(crate) fn contained<T>(read: impl FnOnce() -> Result<T, Reason>) -> Result<T, Reason> {
    static QUIET: Once = Once::new();
    QUIET.call_once(|| {
        let before = take_hook();
        set_hook(Box::new(move |panic| {
            if !READS.get() {
                before(panic);
            }
        }));
    });
    let was = READS.replace(true);
    // What is read is dropped with the panic: nothing half-made is seen afterwards.
    let read = catch_unwind(AssertUnwindSafe(read));
    READS.set(was);
    read.unwrap_or_else(|panic| {
        let text = panic.downcast_ref::<String>().cloned();
        let text = text.or_else(|| panic.downcast_ref::<&str>().map(|text| (*text).to_owned()));
        let text = text.unwrap_or_else(|| "its reader gave up".to_owned());
        Err(Reason::Damaged(text))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_panic_of_a_reader_is_an_error_with_its_text() {
        let read: Result<(), Reason> = contained(|| panic!("no such {}", "offset"));
        let error = read.unwrap_err().to_string();
        assert_eq!(error, "the file is damaged: no such offset");
        assert!(contained(|| Ok(1)).is_ok());
    }
}
