//! Robot programs from their files.

use std::path::Path;

use nalgebra::Isometry3;
use truecut_arm::Robot;
use truecut_plan::program::{Program, ProgramError, Tool, jbi, rapid};

use crate::args::ProgramArguments;
use crate::failure::Failure;

/// Reads a job with those that it calls, or a module; the ending tells which.
pub fn read(
    arguments: &ProgramArguments,
    robot: &Robot,
    base: &Isometry3<f64>,
) -> Result<Program, Failure> {
    let path = &arguments.file;
    let ending = path.extension().map(|e| e.to_string_lossy().to_lowercase());
    let program = match ending.as_deref() {
        Some("jbi") => {
            // The date is written only, never read.
            let date = jbi::JobDate::new(2000, 1, 1, 0, 0).map_err(refused)?;
            let mut options = jbi::JbiOptions::new(date);
            options.station_pulses_per_deg = arguments.pulses_per_deg;
            job(path, robot, base, &options)?
        }
        Some("mod") => {
            if arguments.base_xyz_mm.is_some() || arguments.base_rpy_deg.is_some() {
                return Err(Failure::message(
                    "--base-xyz-mm and --base-rpy-deg have no effect on a module: it says where its base frame stands",
                ));
            }
            if arguments.pulses_per_deg.is_some() {
                return Err(Failure::message(
                    "--pulses-per-deg has no effect on a module: it holds the turntable in degrees",
                ));
            }
            let module = rapid::RapidModule::parse(&text(path)?, path).map_err(refused)?;
            let options = rapid::RapidOptions::default();
            module.program(robot, &options).map_err(refused)?
        }
        _ => {
            return Err(Failure::message(format!(
                "{}: unknown ending; robot programs are read from .JBI and .mod",
                path.display()
            )));
        }
    };
    if program.moves.is_empty() {
        let message = format!("{}: the program has no move", path.display());
        return Err(Failure::message(message));
    }
    Ok(program)
}

/// A job, or those that it calls one after another. Jobs that call call nothing else.
fn job(
    path: &Path,
    robot: &Robot,
    base: &Isometry3<f64>,
    options: &jbi::JbiOptions,
) -> Result<Program, Failure> {
    let tool = Tool::of(robot, "wheel", 0);
    let load = |path: &Path| jbi::JbiJob::parse(&text(path)?, path).map_err(refused);
    let head = load(path)?;
    let mut program = head.program(robot, &tool, base, options).map_err(refused)?;
    for name in &head.calls {
        let called = path.with_file_name(format!("{name}.JBI"));
        let part = load(&called)?.program(robot, &tool, base, options);
        let part = part.map_err(refused)?;
        program.tool.number = part.tool.number;
        program.moves.extend(part.moves);
    }
    Ok(program)
}

fn text(path: &Path) -> Result<String, Failure> {
    std::fs::read_to_string(path)
        .map_err(|error| Failure::message(format!("{}: {error}", path.display())))
}

fn refused(error: ProgramError) -> Failure {
    let help = "it is a robot program".to_owned();
    match error.line() {
        Some(line) => Failure::in_file(error.path(), Some(line), error.message(), help),
        None => Failure::message(error.to_string()),
    }
}
