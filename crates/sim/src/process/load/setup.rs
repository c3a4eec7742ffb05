//! From a scenario's given forces to the process that runs.

use super::Load;
use crate::error::SimError;
use crate::motion::{PlannedMotion, path_file};
use crate::process::foot::setup::foot;
use crate::process::setup::Motion;
use crate::process::{ProcessSetup, SetupContext};
use nalgebra::Vector3;
use std::sync::Arc;
use truecut_plan::path_file::PathFile;
use truecut_scenario::{ForceSweep, LoadFrame, LoadSpec, ProcessSpec};

/// The process of a scenario.
pub(crate) fn setup(spec: &LoadSpec, context: &SetupContext<'_>) -> Result<ProcessSetup, SimError> {
    let way = (spec.path.as_ref())
        .map(|path| way(path, context))
        .transpose()?;
    let (posture, run_s) = match &way {
        Some(way) => {
            let from = context.departure(way);
            (from.posture, from.duration_s)
        }
        None => (context.posture()?, context.scenario.run.duration_s),
    };
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
        ..spec.clone()
    };
    let foot = match &spec.foot {
        Some(spec) => {
            let compliance = context.compliance(&posture)?;
            Some(foot(spec, &compliance, 1.0, &context.effects.foot))
        }
        None => None,
    };
    let setup = ProcessSetup::new(Load::new(forces, run_s, foot), posture);
    Ok(match way {
        Some(way) => setup.led_by(Motion::Planned(way)),
        None => setup,
    })
}

/// The motion along the path.
fn way(path: &PathFile, context: &SetupContext<'_>) -> Result<Arc<PlannedMotion>, SimError> {
    let start = context.start_near()?;
    let is_same = |other: &ProcessSpec| match other {
        ProcessSpec::Load(other) => other.path.as_ref() == Some(path),
        _ => false,
    };
    let solve = || path_file::solve(path, "process.load.path.file", context.robot, &start);
    context.planned(&start.key(), is_same, solve)
}
