//! From the brush table and its solved way to the process that runs.

use crate::effect::WheelEffects;
use crate::error::SimError;
use crate::motion::{self, BrushWork, Target};
use crate::process::setup::{Departure, Motion};
use crate::process::{BrushProcess, BrushSetup, ProcessSetup, SetupContext};
use crate::scene::{Tooling, shapes};
use nalgebra::Vector3;
use truecut_arm::{FrameId, Robot};
use truecut_core::wheel::brush::Brush;
use truecut_scenario::{BrushSpec, ProcessSpec};

/// The process of a scenario along its way, and its workpiece.
pub(crate) fn setup(
    spec: &BrushSpec,
    context: &SetupContext<'_>,
) -> Result<ProcessSetup, SimError> {
    let robot = context.robot;
    let is_same = |other: &ProcessSpec| *other == context.scenario.process;
    let start = context.start_near()?;
    let solve = || motion::brush::solve(spec, robot, &start);
    let path = context.planned(&start.key(), is_same, solve)?;
    let Target::Edges(work) = &path.target else {
        return Err(SimError::scenario(
            "process.brush",
            "the motion is not solved",
        ));
    };
    let from = context.departure(&path);
    let process = BrushProcess::new(brush(spec, &context.effects.wheel, work, robot, &from));
    let process_from_mesh = from.world_from_process.inverse() * work.world_from_mesh;
    let mesh = work.mesh.clone();
    let (part, world_from_mesh) = (mesh.clone(), work.world_from_mesh);
    let tooling = Tooling::drum([spec.brush.radius_m, spec.brush.width_m]).named("brush");
    Ok(ProcessSetup::new(process, from.posture)
        .holding(tooling)
        .on(move || shapes::body(&process_from_mesh, &mesh))
        .working_on(move || Ok(vec![(part.clone(), world_from_mesh)]))
        .led_by(Motion::Planned(path)))
}

/// The process along a solved way.
fn brush(
    spec: &BrushSpec,
    effects: &WheelEffects,
    work: &BrushWork,
    robot: &Robot,
    from: &Departure,
) -> BrushSetup {
    let mut stations = work.stations.clone();
    for station in &mut stations {
        station.wear.preston_per_pa *= effects.removal_factor;
    }
    let world_from_tool = robot.world_from_frame(&from.posture, FrameId::Tool);
    let brush = Brush {
        youngs_modulus_pa: spec.brush.youngs_modulus_pa * effects.stiffness_factor,
        mu: spec.brush.mu * effects.friction_factor,
        ..spec.brush
    };
    BrushSetup {
        bristle: brush.bristle(),
        brush,
        eccentricity: effects.eccentricity(),
        spin_rad_s: spec.spin_rad_s,
        mesh: work.mesh.clone(),
        world_from_mesh: work.world_from_mesh,
        stations,
        process_from_world: from.process_from_world(),
        approach: world_from_tool.rotation * Vector3::z(),
    }
}
