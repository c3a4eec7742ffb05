//! From measured inputs to the process that runs.

use crate::error::SimError;
use crate::process::setup::Motion;
use crate::process::{ProcessSetup, SetupContext};
use crate::replay::forward::ForwardInputs;
use truecut_scenario::ReplaySpec;

/// The forces of a scenario's data, on an arm that follows their commands.
pub(crate) fn setup(
    spec: &ReplaySpec,
    context: &SetupContext<'_>,
) -> Result<ProcessSetup, SimError> {
    let (scenario, robot) = (context.scenario, context.robot);
    let inputs = ForwardInputs::of(spec, scenario, context.measured, robot, context.kind)?;
    let given = context.posture()?;
    inputs.check_posture(&scenario.robot, robot, &given)?;
    let posture = inputs.posture(&given);
    Ok(ProcessSetup::new(inputs.process(), posture).led_by(Motion::Replay(inputs)))
}
