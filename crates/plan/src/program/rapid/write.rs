//! From a program to a module.

use nalgebra::{Isometry3, Vector3};
use truecut_arm::{OpwGeometry, Robot, ToolLoad};

use super::{Confdata, NO_LOAD_KG, RapidOptions, ZONES, check_name, check_zone, zone_radius_m};
use crate::program::dialect::NOT_LOADED;
use crate::program::number::fixed;
use crate::program::{Motion, Move, Program, ProgramError, ProgramErrorKind, Zone};

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
    let geometry =
        OpwGeometry::of(robot).ok_or_else(|| ProgramErrorKind::not_ortho_parallel(robot))?;
    let speeds = speeds(program, options)?;
    let mut lines = vec![format!("MODULE {}", program.name)];
    if !program.comment.is_empty() {
        lines.push(format!("  ! {}", program.comment));
    }
    lines.push(format!("  ! {NOT_LOADED}"));
    if program.tool.load.is_none() {
        lines.push("  ! the tool's load is not known: load0, to be identified".to_owned());
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
    let zones = own_zones(program);
    for (i, mm) in zones.iter().enumerate() {
        // Attitude and external axes as in the zones that have names: half as wide again, and a
        // hundredth of it in degrees.
        let (other, turn) = (fixed(1.5 * mm, 3), fixed(0.15 * mm, 4));
        lines.push(format!(
            "  CONST zonedata zone{}:=[FALSE,{},{other},{other},{turn},{other},{turn}];",
            i + 1,
            fixed(*mm, 3)
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
        lines.extend(spindle(program, i, options));
        let zone = match step.zone {
            Zone::Stop => "fine".to_owned(),
            Zone::Unstated if inner => options.zone.clone(),
            Zone::Unstated => "fine".to_owned(),
            Zone::Within(zone_m) => zone_name(zone_m, &zones),
        };
        lines.push(format!(
            "    {} p{},feed{feed},{zone},{}\\WObj:=base;",
            verb(step),
            step.path_point,
            program.tool.name
        ));
    }
    lines.extend(spindle(program, program.moves.len(), options));
    lines.extend(["  ENDPROC", "ENDMODULE"].map(str::to_owned));
    Ok(lines.join("\r\n") + "\r\n")
}

/// Names, zone, comment and what must be above zero.
fn check(program: &Program, options: &RapidOptions) -> Result<(), ProgramErrorKind> {
    check_name("the module's name", &program.name)?;
    check_name("the tool's name", &program.tool.name)?;
    check_zone(&options.zone)?;
    if let Some(signal) = options
        .spindle_signal
        .as_ref()
        .filter(|_| !program.spindle.is_empty())
    {
        check_name("the spindle's signal", signal)?;
    }
    for (what, value) in [
        (
            "the tool's mass in kg",
            program.tool.load.map_or(NO_LOAD_KG, |load| load.mass_kg),
        ),
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

/// Instructions that switch the spindle before a move; comments where no signal is named.
fn spindle(program: &Program, before: usize, options: &RapidOptions) -> Vec<String> {
    let each = program.switches(before);
    each.map(|on| match &options.spindle_signal {
        Some(signal) => format!("    SetDO {signal},{};", u8::from(on)),
        None => format!("    ! spindle {}", if on { "on" } else { "off" }),
    })
    .collect()
}

/// Zones that the controller does not know by name, mm, each once.
fn own_zones(program: &Program) -> Vec<f64> {
    let mut zones: Vec<f64> = Vec::new();
    for step in &program.moves {
        if let Zone::Within(zone_m) = step.zone {
            let mm = rounded_mm(zone_m);
            if known_zone(mm).is_none() && !zones.contains(&mm) {
                zones.push(mm);
            }
        }
    }
    zones
}

/// To the decimals that are printed, and not nothing.
fn rounded_mm(zone_m: f64) -> f64 {
    ((zone_m * 1e6).round() * 1e-3).max(1e-3)
}

fn known_zone(mm: f64) -> Option<String> {
    let names = ZONES.iter().map(|zone| format!("z{zone}"));
    names
        .into_iter()
        .find(|name| zone_radius_m(name).is_some_and(|m| (m * 1e3 - mm).abs() < 1e-6))
}

fn zone_name(zone_m: f64, own: &[f64]) -> String {
    let mm = rounded_mm(zone_m);
    let place = || own.iter().position(|one| *one == mm).unwrap_or_default();
    known_zone(mm).unwrap_or_else(|| format!("zone{}", place() + 1))
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
    let none = ToolLoad {
        mass_kg: NO_LOAD_KG,
        centre_m: Vector3::new(0.0, 0.0, 1e-3),
    };
    let load = tool.load.unwrap_or(none);
    format!(
        "  PERS tooldata {}:=[TRUE,{},[{},{},[1,0,0,0],0,0,0]];",
        tool.name,
        pose(&tool.flange_from_tool),
        fixed(load.mass_kg, 3),
        place(&load.centre_m)
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
