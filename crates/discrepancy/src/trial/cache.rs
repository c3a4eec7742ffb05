//! A cache of what was computed last: a search changes effects far more often than nominal
//! parameters, and sensors more cheaply than machines.

use std::collections::VecDeque;
use std::sync::{Arc, Mutex, PoisonError};

use truecut_scenario::effect::Effect;

use crate::model::PredictError;

/// What a run is made for.
#[derive(Debug, PartialEq)]
pub(super) struct RunKey {
    pub nominal: Vec<f64>,
    /// Effects on the machine.
    pub machine: Vec<Effect>,
    pub until_s: Option<f64>,
}

/// Values by what they are for.
#[derive(Debug)]
pub(crate) struct Cache<Key, Value> {
    known: Mutex<VecDeque<(Key, Arc<Value>)>>,
}

/// A Jacobian needs one more than there are nominal parameters; threads work on several.
const KEPT: usize = 64;

impl<Key, Value> Default for Cache<Key, Value> {
    fn default() -> Self {
        Cache {
            known: Mutex::default(),
        }
    }
}

impl<Key: PartialEq, Value> Cache<Key, Value> {
    /// The value for `key`, made by `make` if it is not known.
    pub(crate) fn get(
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
