//! Ways of a wheel that are solved as a whole before the run.

use crate::belt_path::BeltPath;
use crate::command::Samples;
use crate::error::SimError;
use crate::polish_path::PolishPath;
use crate::robots::Robots;
use truecut_arm::{Load, Robot};
use truecut_scenario::Scenario;

/// A way that leads the arm.
pub(crate) enum LedPath {
    Polish(PolishPath),
    Belt(BeltPath),
}

impl LedPath {
    /// The way of a scenario whose process has one; `posture` is where the arm comes from, or what the first posture is to be near.
    pub(crate) fn of(
        scenario: &Scenario,
        robot: &Robot,
        robots: &Robots,
        posture: &[f64],
    ) -> Result<Option<Self>, SimError> {
        if let Some(path) = PolishPath::of(scenario, robot, robots, posture)? {
            return Ok(Some(Self::Polish(path)));
        }
        Ok(BeltPath::of(scenario, robot, posture)?.map(Self::Belt))
    }

    pub(crate) fn duration_s(&self) -> f64 {
        match self {
            Self::Polish(path) => path.duration_s,
            Self::Belt(path) => path.duration_s(),
        }
    }

    /// Where the arm stands before the first step, without load.
    pub(crate) fn start(&self) -> &[f64] {
        match self {
            Self::Polish(path) => path.start(),
            Self::Belt(path) => path.start(),
        }
    }

    /// What there is to tell of it.
    pub(crate) fn note(&self) -> Option<String> {
        match self {
            Self::Polish(path) => path.note.clone(),
            Self::Belt(path) => Some(path.note()),
        }
    }

    /// The command that leads a nominal arm along, with the sag that it makes up for.
    pub(crate) fn command(self, robot: &Robot, sag: Option<&Load>) -> Result<Samples, SimError> {
        match self {
            Self::Polish(path) => path.command(robot, sag),
            Self::Belt(path) => path.command(robot, sag),
        }
    }
}
