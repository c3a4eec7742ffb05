//! Robot programs from their files.

use nalgebra::Isometry3;
use truecut_arm::Robot;
use truecut_plan::program::{
    DIALECTS, Dialect, Frames, Program, ProgramError, Settings, Tool, TurntableUnit, dialect_of,
    maker_note, read_text,
};

use crate::args::ProgramArguments;
use crate::failure::Failure;

/// Reads a program in the dialect of the file's extension.
pub fn read(
    arguments: &ProgramArguments,
    robot: &Robot,
    base: &Isometry3<f64>,
) -> Result<Program, Failure> {
    let path = &arguments.file;
    let dialect = dialect_of(path).ok_or_else(|| {
        let known = DIALECTS.iter().flat_map(|one| one.extensions());
        let known: Vec<String> = known.map(|ending| format!(".{ending}")).collect();
        Failure::message(format!(
            "{}: unknown ending; robot programs are read from {}",
            path.display(),
            known.join(" and ")
        ))
    })?;
    check_arguments(arguments, dialect)?;
    let frames = Frames {
        tool: Tool::of(robot, crate::path::TOOL, 0),
        world_from_base: *base,
    };
    let settings = Settings {
        pulses_per_deg: arguments.pulses_per_deg,
        spindle_signal: arguments.spindle_signal.clone(),
        ..Settings::default()
    };
    let text = |path: &std::path::Path| read_text(path);
    let program = dialect.read(path, &text, robot, &frames, &settings);
    let mut program = program.map_err(refused)?;
    if let Some(note) = maker_note(dialect, robot) {
        program.notes.push(note);
    }
    let limits = dialect.limits_note().map(str::to_owned);
    program.notes.extend(limits);
    if program.moves.is_empty() {
        return Err(Failure::at(path, "the program has no move"));
    }
    Ok(program)
}

/// Refuses arguments that repeat what the files of a dialect contain.
fn check_arguments(arguments: &ProgramArguments, dialect: &dyn Dialect) -> Result<(), Failure> {
    let noun = dialect.noun();
    let base = arguments.base_xyz_mm.is_some() || arguments.base_rpy_deg.is_some();
    if base && dialect.holds_base() {
        return Err(Failure::message(format!(
            "--base-xyz-mm and --base-rpy-deg have no effect on a {noun}: it says where its base \
             frame stands",
        )));
    }
    let why = match dialect.turntable() {
        TurntableUnit::Pulses => return Ok(()),
        TurntableUnit::Degrees => "holds the turntable in degrees",
        TurntableUnit::None => "moves no turntable",
    };
    if arguments.pulses_per_deg.is_some() {
        return Err(Failure::message(format!(
            "--pulses-per-deg has no effect on a {noun}: it {why}",
        )));
    }
    Ok(())
}

fn refused(error: ProgramError) -> Failure {
    match error.line() {
        Some(line) => Failure::in_file(error.path(), Some(line), error.message(), None),
        None => Failure::message(error.to_string()),
    }
}
