//! The motion of a scenario's process, within the length of its run.

use super::PlannedMotion;
use crate::error::SimError;
use crate::robots::Robots;
use std::sync::Arc;
use truecut_scenario::{ProcessSpec, Scenario};

/// The motion of a scenario's process; `posture` is where the arm comes from, or what the first
/// posture is to be near. `is_same` says of another process whether it asks for the same motion,
/// which is solved if none of those known does.
pub(crate) fn solved(
    scenario: &Scenario,
    robots: &Robots,
    posture: &[f64],
    is_same: impl Fn(&ProcessSpec) -> bool,
    solve: impl FnOnce() -> Result<PlannedMotion, SimError>,
) -> Result<Arc<PlannedMotion>, SimError> {
    let motion = robots.motion(scenario, posture, is_same, solve)?;
    let (asked_s, taken_s) = (scenario.run.duration_s, motion.duration_s);
    if asked_s.is_finite() && asked_s > taken_s {
        return Err(SimError::scenario(
            "run.duration_s",
            format!(
                "{asked_s} s are longer than the path takes, {taken_s:.4} s: the tool has nowhere to go; leave the key out"
            ),
        ));
    }
    Ok(motion)
}
