//! From a scenario's given forces to the process that runs.

use super::Load;
use crate::error::SimError;
use crate::process::foot::setup::foot;
use crate::process::{ProcessSetup, SetupContext};
use nalgebra::Vector3;
use truecut_scenario::{ForceSweep, LoadFrame, LoadSpec};

/// The process of a scenario.
pub(crate) fn setup(spec: &LoadSpec, context: &SetupContext<'_>) -> Result<ProcessSetup, SimError> {
    let posture = context.posture()?;
    let world_from_process = context.robot.world_from_process(&posture);
    let axes = |force: Vector3<f64>| match spec.frame {
        LoadFrame::Process => force,
        LoadFrame::World => world_from_process.rotation.inverse() * force,
    };
    let forces = LoadSpec {
        frame: LoadFrame::Process,
        constant_n: axes(spec.constant_n),
        release_n: axes(spec.release_n),
        sweep: spec.sweep.map(|sweep| ForceSweep {
            amplitude_n: axes(sweep.amplitude_n),
            ..sweep
        }),
        ..*spec
    };
    let foot = match &spec.foot {
        Some(spec) => {
            let compliance = context.compliance(&posture)?;
            Some(foot(spec, &compliance, 1.0, &context.effects.foot))
        }
        None => None,
    };
    let process = Load::new(forces, context.scenario.run.duration_s, foot);
    Ok(ProcessSetup::new(process, posture))
}
