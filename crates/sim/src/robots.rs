//! Robots that are read once and used by many cells, and a cache of solved motions.

use crate::adjust::{adjusted, leaves_as_is};
use crate::error::SimError;
use crate::motion::PlannedMotion;
use std::collections::{BTreeMap, VecDeque};
use std::path::PathBuf;
use std::sync::{Arc, Mutex, PoisonError};
use truecut_arm::{Masses, Robot};
use truecut_scenario::{ProcessSpec, RobotSpec, Scenario};

/// What a robot is read from: URDF, transmission data, tip, arguments.
type Files = (
    PathBuf,
    Option<PathBuf>,
    Option<String>,
    BTreeMap<String, String>,
);

/// What a motion depends on: the arm's geometry, the posture that chooses its branch, the process.
type MotionOf = (Files, Vec<f64>, ProcessSpec);

/// Motions in the cache: a diagnosis comes back to those of a few values of each uncertain
/// parameter.
const MOTIONS_KEPT: usize = 16;

/// Robots by their files, tip and arguments, as read when they were first asked for. Give one to
/// [`Run`](crate::run::Run) where the same robot runs again and again; files that change meanwhile
/// are not read again. Threads may share it.
#[derive(Debug, Default)]
pub struct Robots {
    read: Mutex<BTreeMap<Files, Arc<Robot>>>,
    motions: Mutex<VecDeque<(MotionOf, Arc<PlannedMotion>)>>,
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

    /// The motion of a scenario's process, solved unless that of a process which `is_same` is in
    /// the cache.
    pub(crate) fn motion(
        &self,
        scenario: &Scenario,
        posture: &[f64],
        is_same: impl Fn(&ProcessSpec) -> bool,
        solve: impl FnOnce() -> Result<PlannedMotion, SimError>,
    ) -> Result<Arc<PlannedMotion>, SimError> {
        let robot = &scenario.robot;
        let is_known = |((of, from, what), _): &&(MotionOf, Arc<PlannedMotion>)| {
            is_same(what) && from == posture && *of == files(robot)
        };
        let known = self.motions.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((_, motion)) = known.iter().find(is_known) {
            return Ok(motion.clone());
        }
        drop(known);
        let motion = Arc::new(solve()?);
        let mut known = self.motions.lock().unwrap_or_else(PoisonError::into_inner);
        if known.len() == MOTIONS_KEPT {
            known.pop_front();
        }
        let key = (files(robot), posture.to_vec(), scenario.process.clone());
        known.push_back((key, motion.clone()));
        Ok(motion)
    }

    fn unscaled(&self, spec: &RobotSpec) -> Result<Arc<Robot>, SimError> {
        let files = files(spec);
        // A map that another thread left while inserting is whole: the robot is read before.
        let found = |read: &BTreeMap<Files, Arc<Robot>>| read.get(&files).cloned();
        if let Some(robot) = found(&self.read.lock().unwrap_or_else(PoisonError::into_inner)) {
            return Ok(robot);
        }
        let robot = Robot::read(&spec.urdf, &spec.reading(Masses::Needed))?;
        let mut read = self.read.lock().unwrap_or_else(PoisonError::into_inner);
        Ok(read.entry(files).or_insert_with(|| Arc::new(robot)).clone())
    }
}

fn files(spec: &RobotSpec) -> Files {
    (
        spec.urdf.clone(),
        spec.config.clone(),
        spec.tip.clone(),
        spec.arguments.clone(),
    )
}
