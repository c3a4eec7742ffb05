//! `truecut path` of a scenario that lays its way along edges of its part.

use std::sync::Arc;

use nalgebra::{Isometry3, Vector3};
use truecut_arm::Robot;
use truecut_plan::clearance::{Cell, Own, Solid, Tool};
use truecut_plan::program::Program;
use truecut_plan::surface::Mesh;
use truecut_scenario::{BrushSpec, ProcessSpec, Scenario};
use truecut_sim::laid_way;

use super::cam::{BeforeArm, dialect, head, settings};
use crate::args::{CamArguments, PathArguments};
use crate::clearance::Checked;
use crate::exit_status::ExitStatus;
use crate::failure::Failure;

/// Reads, lays, plans, runs through, prints and writes.
pub fn path(arguments: &PathArguments) -> Result<ExitStatus, Failure> {
    let (file, cam) = (&arguments.file, &arguments.cam);
    check_arguments(arguments)?;
    let scenario = Scenario::load(file, &[])?;
    let arm = &scenario.robot;
    let robot = Robot::load_kinematics(&arm.urdf, arm.config.as_deref(), arm.tip.as_deref());
    let robot = robot.map_err(|error| Failure::sim(&scenario, error.into()))?;
    let dialect = dialect(cam)?;
    let settings = settings(cam, dialect)?;
    let way = laid_way(&scenario, &robot).map_err(|error| Failure::sim(&scenario, error))?;
    let (Some(mut way), ProcessSpec::Brush(spec)) = (way, &scenario.process) else {
        let message = "`process.brush` lays no way";
        return Err(scenario.problem("process.brush", message).into());
    };
    let slides: Vec<usize> = robot.slides().collect();
    let robot = match slides.is_empty() {
        true => robot,
        false => (robot.with_slides_at(&way.slides_m))
            .map_err(|error| scenario.problem("robot.posture_mm", error.message()))?,
    };
    // A program moves the joints that turn, alone.
    let turning = |near: Vec<f64>| {
        let joints = near.into_iter().enumerate();
        let turning = joints.filter(|(at, _)| !slides.contains(at));
        turning.map(|(_, value)| value).collect::<Vec<f64>>()
    };
    let near = way.near.take().map(turning);
    way.setup.zone_m = cam.zone_mm.map(|mm| mm * 1e-3);
    let head = head(cam, dialect, &settings, &robot, file)?;
    let cell = cell(&scenario, spec, &robot, &head, &way.part)?;
    way.path.notes.extend(way.note.take());
    let way = BeforeArm {
        robot: &robot,
        read: &way.path,
        setup: way.setup,
        near: near.as_deref(),
        slides_m: way.slides_m,
        line_word: "edge",
        help: None,
    };
    way.planned(arguments, cell, dialect, &settings, head)
}

/// Refuses arguments of what the scenario says itself.
fn check_arguments(arguments: &PathArguments) -> Result<(), Failure> {
    let cam = &arguments.cam;
    // Those that are of the program alone.
    let of_the_program = CamArguments {
        dialect: cam.dialect.clone(),
        option: cam.option.clone(),
        name: cam.name.clone(),
        base_xyz_mm: cam.base_xyz_mm,
        base_rpy_deg: cam.base_rpy_deg,
        zone_mm: cam.zone_mm,
        spindle_signal: cam.spindle_signal.clone(),
        acceleration_m_per_s2: cam.acceleration_m_per_s2,
        ..CamArguments::default()
    };
    if of_the_program == *cam {
        return Ok(());
    }
    let text = "arm, posture, part, speeds and cell of a way along edges stand in its scenario: only \
                --dialect, --option, --name, --base-xyz-mm, --base-rpy-deg, --zone-mm, \
                --spindle-signal and --acceleration-m-per-s2 are given beside it";
    Err(Failure::at(&arguments.file, text))
}

/// The cell that the scenario names, with its part and the brush.
fn cell(
    scenario: &Scenario,
    spec: &BrushSpec,
    robot: &Robot,
    head: &Program,
    part: &Arc<Mesh>,
) -> Result<Option<Cell>, Failure> {
    let Some(cell) = scenario.cell.as_deref() else {
        return Ok(None);
    };
    // A cylinder's axis is its z, the brush's is the tool's y.
    let about_y = Isometry3::rotation(Vector3::x() * std::f64::consts::FRAC_PI_2);
    let brush = Tool {
        name: "brush".to_owned(),
        solid: Solid::Cylinder {
            radius_m: spec.brush.radius_m,
            length_m: spec.brush.width_m,
        },
        flange_from_solid: head.tool.flange_from_tool * about_y,
    };
    let own = Own {
        part: vec![(part.as_ref(), spec.world_from_mesh)],
        tools: vec![brush],
    };
    Checked::cell_of_job(robot, cell, &own, "the scenario").map(Some)
}
