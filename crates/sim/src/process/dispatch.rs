//! From the process of a scenario to the room that sets it up.

use super::setup::{self, ProcessSetup, SetupContext};
use super::yielding::Yielding;
use super::{
    belt, brush, chamfer, custom, load, milling, path_milling, polish, replay, surface_polish,
    wheel,
};
use crate::error::SimError;
use truecut_scenario::ProcessSpec;

/// The process of a scenario, ready to run. The one place where the simulator tells processes
/// apart.
pub(crate) fn set_up(context: &SetupContext<'_>) -> Result<ProcessSetup, SimError> {
    setup::check_drive(&context.scenario.process, context.kind)?;
    let scenario = context.scenario;
    let mut setup = match &scenario.process {
        ProcessSpec::Belt(spec) => belt::setup::setup(spec, context),
        ProcessSpec::Brush(spec) => brush::setup::setup(spec, context),
        ProcessSpec::Custom(spec) => custom::setup(spec, context),
        ProcessSpec::Chamfer(spec) => chamfer::setup::setup(spec, context),
        ProcessSpec::Load(spec) => load::setup::setup(spec, context),
        ProcessSpec::Milling(spec) => milling::setup::setup(spec, context),
        ProcessSpec::PathMilling(spec) => path_milling::setup::setup(spec, context),
        ProcessSpec::Polish(spec) => polish::setup::setup(spec, context),
        ProcessSpec::Replay(spec) => replay::setup::setup(spec, context),
        ProcessSpec::SurfacePolish(spec) => surface_polish::setup::setup(spec, context),
        ProcessSpec::Wheel(spec) => wheel::setup::setup(spec, context),
    }?;
    if !scenario.attached.is_empty() {
        let named = (scenario.process.name(), setup.process);
        let yielding = Yielding::new(named, &scenario.attached, context.robot, &setup.posture)?;
        setup.process = Box::new(yielding);
    }
    Ok(setup)
}
