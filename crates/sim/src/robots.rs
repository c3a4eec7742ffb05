//! Robots that are read once and used by many cells.

use crate::adjust::{adjusted, leaves_as_is};
use crate::error::SimError;
use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::{Arc, Mutex, PoisonError};
use truecut_arm::Robot;
use truecut_scenario::RobotSpec;

type Files = (PathBuf, Option<PathBuf>, Option<String>);

/// Robots by their files and tip, as read when they were first asked for. Give one to
/// [`Cell::build_reduced_from`](crate::Cell::build_reduced_from) where the same robot is built again and
/// again; files that change meanwhile are not read again. Threads may share it.
#[derive(Debug, Default)]
pub struct Robots {
    read: Mutex<BTreeMap<Files, Arc<Robot>>>,
}

impl Robots {
    /// None read yet.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// The robot of a scenario, as the scenario has it.
    pub(crate) fn robot(&self, spec: &RobotSpec) -> Result<Arc<Robot>, SimError> {
        let robot = self.unscaled(spec)?;
        if leaves_as_is(spec) {
            return Ok(robot);
        }
        Ok(Arc::new(adjusted(&robot, spec)?))
    }

    fn unscaled(&self, spec: &RobotSpec) -> Result<Arc<Robot>, SimError> {
        let files = (spec.urdf.clone(), spec.config.clone(), spec.tip.clone());
        // A map that another thread left while inserting is whole: the robot is read before.
        let found = |read: &BTreeMap<Files, Arc<Robot>>| read.get(&files).cloned();
        if let Some(robot) = found(&self.read.lock().unwrap_or_else(PoisonError::into_inner)) {
            return Ok(robot);
        }
        let robot = Robot::load(&spec.urdf, spec.config.as_deref(), spec.tip.as_deref())?;
        let mut read = self.read.lock().unwrap_or_else(PoisonError::into_inner);
        Ok(read.entry(files).or_insert_with(|| Arc::new(robot)).clone())
    }
}
