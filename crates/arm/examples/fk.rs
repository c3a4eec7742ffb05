//! Prints what was understood of a URDF, or with a table of postures the flange poses.
//!
//!     cargo run -p truecut-arm --example fk -- ROBOT.urdf [--tip LINK] [--fk POSTURES.csv]

use std::path::PathBuf;
use std::process::ExitCode;

use truecut_arm::Robot;
use truecut_arm::report::fk_table;

fn main() -> ExitCode {
    match run() {
        Ok(text) => {
            print!("{text}");
            ExitCode::SUCCESS
        }
        Err(message) => {
            eprintln!("{message}");
            ExitCode::from(2)
        }
    }
}

fn run() -> Result<String, String> {
    let (mut urdf, mut tip, mut table) = (None, None, None);
    let mut arguments = std::env::args().skip(1);
    while let Some(argument) = arguments.next() {
        match argument.as_str() {
            "--tip" => tip = Some(arguments.next().ok_or("--tip needs a link")?),
            "--fk" => table = Some(PathBuf::from(arguments.next().ok_or("--fk needs a file")?)),
            // So that the example can stand in for `truecut robot ROBOT.urdf ...`.
            "robot" if urdf.is_none() => {}
            _ => urdf = Some(PathBuf::from(argument)),
        }
    }
    let urdf = urdf.ok_or("usage: fk ROBOT.urdf [--tip LINK] [--fk POSTURES.csv]")?;
    let robot = Robot::load(&urdf, None, tip.as_deref()).map_err(|e| e.to_string())?;
    let Some(path) = table else {
        let report = robot
            .report(&robot.default_posture())
            .map_err(|e| e.to_string())?;
        return Ok(report.to_text());
    };
    let postures =
        std::fs::read_to_string(&path).map_err(|e| format!("{}: {e}", path.display()))?;
    fk_table(&robot, &postures).map_err(|e| format!("{}: {e}", path.display()))
}
