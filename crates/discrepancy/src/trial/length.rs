//! How long data may be.

use truecut_recording::measured::Measured;
use truecut_scenario::{ProcessSpec, Scenario};
use truecut_sim::{Robots, SimError};

use super::reduced;

/// Most steps of one run: a diagnosis makes thousands of runs.
const MOST_STEPS: f64 = 1e6;

/// Refuses data so long that no diagnosis would end.
pub(super) fn check_length(
    scenario: &Scenario,
    measured: &Measured,
    robots: &Robots,
) -> Result<(), SimError> {
    let ProcessSpec::Replay(replay) = &scenario.process else {
        return Ok(());
    };
    let duration_s = measured.duration_s() / replay.speed_factor;
    let duration_s = duration_s.min(scenario.run.duration_s);
    let steps = duration_s / reduced(scenario, measured, robots).time_step_s()?;
    if steps <= MOST_STEPS {
        return Ok(());
    }
    let message = format!(
        "the data take {duration_s:.1} s, and one run of them {steps:.2e} steps; a diagnosis makes thousands of runs, of at most \
         {MOST_STEPS:.0e} steps each: if their times are milliseconds, say so, data.time_unit = \"ms\"; else thin the data \
         with data.resample_hz, or use a part, from data.from_s to data.to_s"
    );
    Err(SimError::scenario("data", message))
}
