//! Recordings in memory, each made once: several claims may refer to the same run.

use std::collections::HashMap;
use std::path::PathBuf;
use std::sync::{Arc, Mutex, PoisonError};

use truecut_recording::Recording;
use truecut_scenario::Scenario;

use super::error::RunError;
use crate::engine::Engine;

/// Recordings in memory, by scenario, overrides and engine. Threads may share them.
#[derive(Debug, Default)]
pub struct Runs {
    made: Mutex<HashMap<Key, Arc<Slot>>>,
}

/// Scenario file, effective text, engine.
type Key = (PathBuf, String, String);

/// Empty until the run has ended; locked while it goes on, so that a second asker waits for it.
type Slot = Mutex<Option<Arc<Recording>>>;

impl Runs {
    /// The recording of a scenario with an engine, made now if it has not been.
    pub(super) fn get(
        &self,
        scenario: &Scenario,
        engine: Engine,
        make: impl FnOnce() -> Result<Recording, RunError>,
    ) -> Result<Arc<Recording>, RunError> {
        let path = scenario.path();
        let path = path.canonicalize().unwrap_or_else(|_| path.to_owned());
        let key = (path, scenario.effective_text(), format!("{engine:?}"));
        let slot = {
            let mut made = self.made.lock().unwrap_or_else(PoisonError::into_inner);
            Arc::clone(made.entry(key).or_default())
        };
        let mut slot = slot.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(recording) = &*slot {
            return Ok(Arc::clone(recording));
        }
        let recording = Arc::new(make()?);
        *slot = Some(Arc::clone(&recording));
        Ok(recording)
    }
}
