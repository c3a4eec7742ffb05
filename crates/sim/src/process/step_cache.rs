//! Cache of what the loads of a step were computed from.
//!
//! [`Process::commit`](super::Process::commit) records, and removes by, the same contact state that
//! [`Process::evaluate`](super::Process::evaluate) computed the loads from; the cache saves
//! computing it twice.

use std::cell::RefCell;

/// The value last computed, with its time.
#[derive(Debug, Clone)]
pub(super) struct StepCache<T>(RefCell<Option<(f64, T)>>);

impl<T> Default for StepCache<T> {
    fn default() -> Self {
        Self(RefCell::new(None))
    }
}

impl<T> StepCache<T> {
    pub fn set(&self, time_s: f64, value: T) {
        *self.0.borrow_mut() = Some((time_s, value));
    }

    /// The cached value if it is of this time; the cache is empty afterwards.
    pub fn take(&mut self, time_s: f64) -> Option<T> {
        let (at_s, value) = self.0.get_mut().take()?;
        (at_s == time_s).then_some(value)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_value_is_given_once_and_for_its_time_only() {
        let mut cache = StepCache::default();
        cache.set(0.1, "a");
        assert_eq!(cache.take(0.1), Some("a"));
        assert_eq!(cache.take(0.1), None);
        cache.set(0.2, "b");
        assert_eq!(cache.take(0.3), None);
    }
}
