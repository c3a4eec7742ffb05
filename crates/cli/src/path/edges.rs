//! `truecut path` of a scenario that lays its way on its part, along edges or over a face.

use truecut_arm::{Masses, Robot};
use truecut_plan::clearance::{Cell, Own, Tool};
use truecut_plan::program::Program;
use truecut_scenario::Scenario;
use truecut_sim::{LaidWay, laid_way};

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
    let robot = Robot::read(&arm.urdf, &arm.reading(Masses::NotNeeded));
    let robot = robot.map_err(|error| Failure::sim(&scenario, error.into()))?;
    let dialect = dialect(cam)?;
    let settings = settings(cam, dialect)?;
    let way = laid_way(&scenario, &robot).map_err(|error| Failure::sim(&scenario, error))?;
    let Some(mut way) = way else {
        let message = "it lays no way";
        return Err(scenario.problem("process", message).into());
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
    let cell = cell(&scenario, &robot, &head, &way)?;
    way.path.notes.extend(way.note.take());
    let way = BeforeArm {
        robot: &robot,
        read: &way.path,
        setup: way.setup,
        near: near.as_deref(),
        slides_m: way.slides_m,
        line_word: way.line_word,
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
    let text = "arm, posture, part, speeds and cell of a way on a part stand in its scenario: only \
                --dialect, --option, --name, --base-xyz-mm, --base-rpy-deg, --zone-mm, \
                --spindle-signal and --acceleration-m-per-s2 are given beside it";
    Err(Failure::at(&arguments.file, text))
}

/// The cell that the scenario names, with its part and its tool.
fn cell(
    scenario: &Scenario,
    robot: &Robot,
    head: &Program,
    way: &LaidWay,
) -> Result<Option<Cell>, Failure> {
    let Some(cell) = scenario.cell.as_deref() else {
        return Ok(None);
    };
    let tool = Tool {
        name: way.tool.name.to_owned(),
        solid: way.tool.solid.clone(),
        flange_from_solid: head.tool.flange_from_tool * way.tool.tool_from_solid,
    };
    let own = Own {
        part: vec![(way.part.as_ref(), way.world_from_part)],
        tools: vec![tool],
    };
    Checked::cell_of_job(robot, cell, &own, "the scenario").map(Some)
}
