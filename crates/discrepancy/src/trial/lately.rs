//! What was computed lately: a search changes effects far more often than nominal parameters, and sensors more cheaply than machines.

use std::collections::VecDeque;
use std::sync::{Arc, Mutex, PoisonError};

use crate::model::PredictError;

/// Values by what they are for.
#[derive(Debug)]
pub(super) struct Lately<Key, Value> {
    known: Mutex<VecDeque<(Key, Arc<Value>)>>,
}

/// A Jacobian needs one more than there are nominal parameters; threads work on several.
const KEPT: usize = 64;

impl<Key, Value> Default for Lately<Key, Value> {
    fn default() -> Self {
        Lately {
            known: Mutex::default(),
        }
    }
}

impl<Key: PartialEq, Value> Lately<Key, Value> {
    /// The value for `key`, made by `make` if it is not known.
    pub(super) fn get(
        &self,
        key: Key,
        make: impl FnOnce() -> Result<Value, PredictError>,
    ) -> Result<Arc<Value>, PredictError> {
        let locked = || self.known.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((_, value)) = locked().iter().find(|(of, _)| *of == key) {
            return Ok(Arc::clone(value));
        }
        let value = Arc::new(make()?);
        let mut known = locked();
        if known.len() == KEPT {
            known.pop_front();
        }
        known.push_back((key, Arc::clone(&value)));
        Ok(value)
    }
}
