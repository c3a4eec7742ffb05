//! From a program to a module.

use nalgebra::{Isometry3, Vector3};
use truecut_arm::{OpwGeometry, Robot};

use super::{Confdata, RapidOptions, check_name, check_zone};
use crate::program::number::fixed;
use crate::program::{Motion, Move, Program, ProgramError, ProgramErrorKind};

/// Writes a program as one module with the procedure `main`, lines ended by CR LF.
///
/// # Errors
/// If the program's name, the tool's or the zone is none of the language, an option is out of its
/// range, the arm's branches are not those that the language names, or the program contradicts
/// itself.
pub fn write(
    program: &Program,
    robot: &Robot,
    options: &RapidOptions,
) -> Result<String, ProgramError> {
    check(program, options)?;
    program.check(robot)?;
    let geometry = OpwGeometry::of(robot).ok_or(ProgramErrorKind::NotOrthoParallel)?;
    let speeds = speeds(program, options)?;
    let mut lines = vec![format!("MODULE {}", program.name)];
    if !program.comment.is_empty() {
        lines.push(format!("  ! {}", program.comment));
    }
    lines.push(tool_line(program));
    lines.push(format!(
        "  PERS wobjdata base:=[FALSE,TRUE,\"\",{},[[0,0,0],[1,0,0,0]]];",
        pose(&program.world_from_base)
    ));
    for (i, speed) in speeds.iter().enumerate() {
        let ori = fixed(options.reorientation_deg_per_s, 3);
        lines.push(format!(
            "  CONST speeddata feed{}:=[{speed},{ori},5000,1000];",
            i + 1
        ));
    }
    for step in &program.moves {
        lines.push(target(step, &geometry));
    }
    lines.extend(["  PROC main()", "    ConfJ\\On;", "    ConfL\\On;"].map(str::to_owned));
    for (i, step) in program.moves.iter().enumerate() {
        let text = speed_text(step, options);
        let feed = 1 + speeds.iter().position(|s| *s == text).unwrap_or_default();
        let inner = i > 0 && i + 1 < program.moves.len();
        lines.push(format!(
            "    {} p{},feed{feed},{},{}\\WObj:=base;",
            verb(step),
            step.path_point,
            if inner { options.zone.as_str() } else { "fine" },
            program.tool.name
        ));
    }
    lines.extend(["  ENDPROC", "ENDMODULE"].map(str::to_owned));
    Ok(lines.join("\r\n") + "\r\n")
}

/// Names, zone, comment and what must be above zero.
fn check(program: &Program, options: &RapidOptions) -> Result<(), ProgramErrorKind> {
    check_name("the module's name", &program.name)?;
    check_name("the tool's name", &program.tool.name)?;
    check_zone(&options.zone)?;
    for (what, value) in [
        ("the tool's mass in kg", program.tool.mass_kg),
        (
            "the top speed of joint moves in m/s",
            options.joint_top_m_per_s,
        ),
        (
            "the speed of reorientation in deg/s",
            options.reorientation_deg_per_s,
        ),
    ] {
        let fits = value.is_finite() && value > 0.0;
        ProgramErrorKind::unless(fits, what, value, "above zero and finite")?;
    }
    let printable = program.comment.chars().all(|c| (' '..='~').contains(&c));
    let comment = format!("\"{}\"", program.comment);
    ProgramErrorKind::unless(printable, "the comment", comment, "printable ASCII")
}

fn verb(step: &Move) -> &'static str {
    match step.motion {
        Motion::Joint { .. } => "MoveJ",
        Motion::Linear { .. } => "MoveL",
    }
}

/// Speed of the tool point in mm/s, as printed.
fn speed_text(step: &Move, options: &RapidOptions) -> String {
    let m_per_s = match step.motion {
        Motion::Joint { share } => share * options.joint_top_m_per_s,
        Motion::Linear { speed_m_per_s } => speed_m_per_s,
    };
    fixed(m_per_s * 1e3, 3)
}

/// All speeds, each once, in the order of their first use.
fn speeds(program: &Program, options: &RapidOptions) -> Result<Vec<String>, ProgramErrorKind> {
    let mut speeds: Vec<String> = Vec::new();
    for step in &program.moves {
        let text = speed_text(step, options);
        if text == "0.000" {
            let rule = "at least 0.001 mm/s, the last decimal that is printed";
            return Err(ProgramErrorKind::at_point(
                step.path_point,
                "speed in mm/s",
                0.0,
                rule,
            ));
        }
        if !speeds.contains(&text) {
            speeds.push(text);
        }
    }
    Ok(speeds)
}

fn tool_line(program: &Program) -> String {
    let tool = &program.tool;
    format!(
        "  PERS tooldata {}:=[TRUE,{},[{},{},[1,0,0,0],0,0,0]];",
        tool.name,
        pose(&tool.flange_from_tool),
        fixed(tool.mass_kg, 3),
        place(&tool.centre_m)
    )
}

fn target(step: &Move, geometry: &OpwGeometry) -> String {
    let conf = Confdata::of(geometry, &step.posture);
    let turntable = step.turntable_rad.map(|angle| fixed(angle.to_degrees(), 4));
    format!(
        "  CONST robtarget p{}:=[{},[{},{},{},{}],[{},9E+09,9E+09,9E+09,9E+09,9E+09]];",
        step.path_point,
        trim(&pose(&step.base_from_tool)),
        conf.cf1,
        conf.cf4,
        conf.cf6,
        conf.cfx,
        turntable.as_deref().unwrap_or("9E+09")
    )
}

/// Place and attitude without the brackets around both: a robtarget goes on after them.
fn trim(pose: &str) -> &str {
    &pose[1..pose.len() - 1]
}

fn place(m: &Vector3<f64>) -> String {
    let mm = (m * 1e3).map(|v| fixed(v, 3));
    format!("[{},{},{}]", mm[0], mm[1], mm[2])
}

/// `[[x,y,z],[q1,q2,q3,q4]]`: mm, and the quaternion with its real part first, not negative.
fn pose(pose: &Isometry3<f64>) -> String {
    let q = pose.rotation;
    let sign = if q.w < 0.0 { -1.0 } else { 1.0 };
    let parts = [q.w, q.i, q.j, q.k].map(|part| fixed(sign * part, 9));
    format!(
        "[{},[{}]]",
        place(&pose.translation.vector),
        parts.join(",")
    )
}
