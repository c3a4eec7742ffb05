//! Robots that are read once and used by many cells, and the ways of wheels that are solved once.

use crate::adjust::{adjusted, leaves_as_is};
use crate::error::SimError;
use crate::led_path::LedPath;
use std::collections::{BTreeMap, VecDeque};
use std::path::PathBuf;
use std::sync::{Arc, Mutex, PoisonError};
use truecut_arm::Robot;
use truecut_scenario::{ProcessSpec, RobotSpec};

type Files = (PathBuf, Option<PathBuf>, Option<String>);

/// What the way of a wheel depends on: the arm's geometry, the posture that chooses its branch, the process.
type PathOf = (Files, Vec<f64>, ProcessSpec);

/// Paths that are kept: a diagnosis comes back to those of a few values of each uncertain parameter.
const PATHS_KEPT: usize = 16;

/// Robots by their files and tip, as read when they were first asked for. Give one to
/// [`Cell::build_reduced_from`](crate::Cell::build_reduced_from) where the same robot is built again and
/// again; files that change meanwhile are not read again. Threads may share it.
#[derive(Debug, Default)]
pub struct Robots {
    read: Mutex<BTreeMap<Files, Arc<Robot>>>,
    paths: Mutex<VecDeque<(PathOf, Arc<LedPath>)>>,
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

    /// The way of a process that has one, solved unless it was lately.
    pub(crate) fn led_path(
        &self,
        robot: &RobotSpec,
        posture: &[f64],
        process: &ProcessSpec,
        solve: impl FnOnce() -> Result<Option<LedPath>, SimError>,
    ) -> Result<Option<Arc<LedPath>>, SimError> {
        let is_known = |((of, from, what), _): &&(PathOf, Arc<LedPath>)| {
            same_way(what, process) && from == posture && *of == files(robot)
        };
        let known = self.paths.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((_, path)) = known.iter().find(is_known) {
            return Ok(Some(path.clone()));
        }
        drop(known);
        let Some(path) = solve()?.map(Arc::new) else {
            return Ok(None);
        };
        let mut known = self.paths.lock().unwrap_or_else(PoisonError::into_inner);
        if known.len() == PATHS_KEPT {
            known.pop_front();
        }
        let key = (files(robot), posture.to_vec(), process.clone());
        known.push_back((key, path.clone()));
        Ok(Some(path))
    }

    fn unscaled(&self, spec: &RobotSpec) -> Result<Arc<Robot>, SimError> {
        let files = files(spec);
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

/// Whether two processes go the same way. What a belt does to the face along its job's lines does not change them.
fn same_way(one: &ProcessSpec, other: &ProcessSpec) -> bool {
    match (one, other) {
        (ProcessSpec::Belt(one), ProcessSpec::Belt(other)) => {
            one.job == other.job && one.copies == other.copies && one.cell_m == other.cell_m
        }
        (one, other) => one == other,
    }
}

fn files(spec: &RobotSpec) -> Files {
    (spec.urdf.clone(), spec.config.clone(), spec.tip.clone())
}
