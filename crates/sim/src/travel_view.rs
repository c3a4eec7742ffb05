//! An arm led along postures, as it is seen.

use truecut_arm::Robot;
use truecut_recording::{Frame, Scene};

use crate::scene::{Surroundings, Tooling, arm_view};

/// The arm in the first posture, and a frame for each time and posture. Empty without postures.
#[must_use]
pub fn travel_view(
    robot: &Robot,
    postures: &[(f64, &[f64])],
    about: Surroundings,
) -> (Scene, Vec<Frame>) {
    let stops = postures.iter().copied();
    arm_view(robot, &Tooling::default(), stops, about)
}
