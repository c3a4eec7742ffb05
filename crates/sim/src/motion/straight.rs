//! The straight path of a milling pass.

use crate::error::SimError;
use truecut_arm::Robot;
use truecut_plan::motion::straight::{SolvedPath, StraightPath, StraightPathError};

const PATH: &str = "process.milling.path";

/// The postures of a path, its faults at the keys that they are about.
pub(crate) fn solve(
    path: &StraightPath,
    robot: &Robot,
    posture: &[f64],
) -> Result<SolvedPath, SimError> {
    path.solve(robot, posture).map_err(|error| match error {
        StraightPathError::Arm(error) => error.into(),
        StraightPathError::Follow(error) => SimError::scenario(PATH, error.to_string()),
        StraightPathError::NoBranches { word, .. } => {
            let key = format!("{PATH}.{word}");
            let message = format!("`{key}` has no effect: {error}");
            SimError::scenario(key, message)
        }
    })
}
