//! The step that modes ask for which a process steps itself.

use truecut_recording::significant;

use crate::error::SimError;
use crate::process::Process;

/// Default and fewest steps in one period of the fastest mode that a process steps itself: exactly,
/// but the force on it is known at the instants only.
const STEPS_PER_OWN_PERIOD: f64 = 40.0;
/// Part of the arm's mass at its tool point up to which a mode takes that step. Forces known at the
/// instants only, and an acceleration foreseen from places before, put the frequency of a mode with
/// a part μ wrong by (1/12 + μ/2) μ (ωh)²/(1 - μ): with more mass the step is shorter.
const LIGHT_SHARE: f64 = 0.02;
const FEWEST_PER_OWN_PERIOD: f64 = 8.0;

/// The step that modes of tool and workpiece ask for, s.
pub(super) fn step_s(process: &dyn Process) -> Option<f64> {
    let heavier = (process.mode_share() / LIGHT_SHARE).max(1.0).sqrt();
    (process.fastest_mode_hz()).map(|hz| 1.0 / (hz * STEPS_PER_OWN_PERIOD * heavier))
}

/// Refuses a step that is too long for the modes of tool and workpiece.
pub(super) fn check(asked_s: f64, process: &dyn Process) -> Result<(), SimError> {
    let Some(hz) = process.fastest_mode_hz() else {
        return Ok(());
    };
    let longest_s = 1.0 / (hz * FEWEST_PER_OWN_PERIOD);
    if asked_s <= longest_s {
        return Ok(());
    }
    Err(SimError::scenario(
        "run.time_step_ms",
        format!(
            "`run.time_step_ms` is {}, but must be at most {}: the fastest mode of tool and workpiece, at {hz:.1} Hz, needs at \
             least {FEWEST_PER_OWN_PERIOD} steps in a period",
            significant(asked_s * 1e3, 4),
            significant(longest_s * 1e3, 4)
        ),
    ))
}
