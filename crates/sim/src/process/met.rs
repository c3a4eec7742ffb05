//! What the loads of a step were computed from, kept for its end.
//!
//! [`Process::evaluate`](super::Process::evaluate) changes nothing that shows; what it found is what
//! [`Process::commit`](super::Process::commit) records and removes, and finding it twice would take twice the time.

use std::cell::RefCell;

/// The last finding, with its instant.
#[derive(Debug, Clone)]
pub(super) struct Met<T>(RefCell<Option<(f64, T)>>);

impl<T> Default for Met<T> {
    fn default() -> Self {
        Self(RefCell::new(None))
    }
}

impl<T> Met<T> {
    pub fn keep(&self, time_s: f64, found: T) {
        *self.0.borrow_mut() = Some((time_s, found));
    }

    /// The finding of this instant, if it is the last one.
    pub fn take(&mut self, time_s: f64) -> Option<T> {
        let (at_s, found) = self.0.get_mut().take()?;
        (at_s == time_s).then_some(found)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_finding_is_given_once_and_for_its_instant_only() {
        let mut met = Met::default();
        met.keep(0.1, "a");
        assert_eq!(met.take(0.1), Some("a"));
        assert_eq!(met.take(0.1), None);
        met.keep(0.2, "b");
        assert_eq!(met.take(0.3), None);
    }
}
