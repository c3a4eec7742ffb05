//! From a program to `.src` and `.dat`.

use nalgebra::Isometry3;
use truecut_arm::{OpwGeometry, Robot};

use super::{NO_LOAD_KG, StatusTurn, check_name};
use crate::program::dialect::{NOT_LOADED, ProgramFile, Settings};
use crate::program::euler::texts;
use crate::program::number::fixed;
use crate::program::{Motion, Move, Program, ProgramError, ProgramErrorKind, Zone};

/// Zone of the points of which the program says nothing, between the first and the last.
const ZONE_M: f64 = 1e-3;

/// Writes a program.
///
/// # Errors
/// If the name or a speed is one that the language cannot hold, a joint stands beyond what turn
/// bits tell apart, or the program contradicts itself.
pub(super) fn write(
    program: &Program,
    robot: &Robot,
    settings: &Settings,
) -> Result<Vec<ProgramFile>, ProgramError> {
    check_name(&program.name)?;
    program.check(robot)?;
    let program = &program.without_standing_lines();
    let geometry =
        OpwGeometry::of(robot).ok_or_else(|| ProgramErrorKind::not_ortho_parallel(robot))?;
    let head = format!("DEFDAT {} PUBLIC", program.name);
    let mut data = vec![head, format!("; {NOT_LOADED}")];
    for step in &program.moves {
        check_turns(step, robot)?;
        data.push(position(step, &geometry));
    }
    data.push("ENDDAT".to_owned());
    Ok(vec![
        file(&program.name, "src", &moves(program, settings)?),
        file(&program.name, "dat", &data),
    ])
}

fn file(name: &str, ending: &str, lines: &[String]) -> ProgramFile {
    ProgramFile {
        name: format!("{name}.{ending}"),
        text: lines.join("\r\n") + "\r\n",
    }
}

/// Turn bits tell signs apart, whole turns up to one.
fn check_turns(step: &Move, robot: &Robot) -> Result<(), ProgramErrorKind> {
    let joints = robot.chain.joints.iter().zip(&step.posture);
    let beyond = joints
        .into_iter()
        .find(|(_, q)| q.to_degrees().abs() >= 360.0);
    beyond.map_or(Ok(()), |(joint, q)| {
        Err(ProgramErrorKind::Unspeakable {
            path_point: step.path_point,
            joint: joint.name.clone(),
            value_deg: q.to_degrees(),
            rule: "the turn bits tell angles between -360 and 360 deg apart",
        })
    })
}

fn frame(pose: &Isometry3<f64>) -> String {
    let ([x, y, z], [c, b, a]) = texts(pose, 3, 4);
    format!("X {x},Y {y},Z {z},A {a},B {b},C {c}")
}

fn position(step: &Move, geometry: &OpwGeometry) -> String {
    let flags = StatusTurn::of(geometry, &step.posture);
    let turntable = step.turntable_rad.map(|angle| fixed(angle.to_degrees(), 4));
    format!(
        "DECL E6POS XP{}={{{},S {},T {}{}}}",
        step.path_point,
        frame(&step.base_from_tool),
        flags.status,
        flags.turn.unwrap_or_default(),
        turntable.map_or_else(String::new, |deg| format!(",E1 {deg}")),
    )
}

fn moves(program: &Program, settings: &Settings) -> Result<Vec<String>, ProgramError> {
    let output = settings.spindle_number().map_err(ProgramErrorKind::from)?;
    let mut lines = vec![format!("DEF {} ( )", program.name)];
    lines.push(format!("; {NOT_LOADED}"));
    if !program.comment.is_empty() {
        let comment: Vec<&str> = program.comment.lines().collect();
        lines.push(format!("; {}", comment.join(" ")));
    }
    if program
        .moves
        .iter()
        .any(|step| step.turntable_rad.is_some())
    {
        lines.push("; E1 is the turntable".to_owned());
    }
    lines.push("BAS (#INITMOV,0)".to_owned());
    lines.push(load(program));
    lines.push(format!(
        "$TOOL={{{}}}",
        frame(&program.tool.flange_from_tool)
    ));
    lines.push(format!("$BASE={{{}}}", frame(&program.world_from_base)));
    let spindle = |before: usize| {
        program.switches(before).map(move |on| match output {
            Some(number) => format!("$OUT[{number}]={}", if on { "TRUE" } else { "FALSE" }),
            None => format!("; spindle {}", if on { "on" } else { "off" }),
        })
    };
    let (mut share, mut speed, mut zone) = (String::new(), String::new(), String::new());
    for (i, step) in program.moves.iter().enumerate() {
        lines.extend(spindle(i));
        let inner = i > 0 && i + 1 < program.moves.len();
        let zone_m = match step.zone {
            Zone::Within(zone_m) => Some(zone_m),
            Zone::Unstated => inner.then_some(ZONE_M),
            Zone::Stop => None,
        };
        if let Some(zone_m) = zone_m {
            let mm = fixed((zone_m * 1e3).max(1e-3), 3);
            set(&mut lines, &mut zone, format!("$APO.CDIS={mm}"));
        }
        let name = format!("XP{}", step.path_point);
        let text = match step.motion {
            Motion::Joint { share: part } => {
                let percent = (part * 100.0).round().max(1.0);
                set(&mut lines, &mut share, format!("BAS (#VEL_PTP,{percent})"));
                let pass = if zone_m.is_some() { " C_PTP C_DIS" } else { "" };
                format!("PTP {name}{pass}")
            }
            Motion::Linear { speed_m_per_s } => {
                let text = fixed(speed_m_per_s, 6);
                if text == "0.000000" {
                    let rule = "at least 0.001 mm/s, the last decimal that is printed";
                    let what = "speed in m/s";
                    let fault = ProgramErrorKind::at_point(step.path_point, what, 0.0, rule);
                    return Err(fault.into());
                }
                set(&mut lines, &mut speed, format!("$VEL.CP={text}"));
                let pass = if zone_m.is_some() { " C_DIS" } else { "" };
                format!("LIN {name}{pass}")
            }
        };
        lines.push(text);
    }
    lines.extend(spindle(program.moves.len()));
    lines.push("END".to_owned());
    Ok(lines)
}

/// Adds a setting if it is another than the last of its kind.
fn set(lines: &mut Vec<String>, last: &mut String, text: String) {
    if *last != text {
        lines.push(text.clone());
        *last = text;
    }
}

fn load(program: &Program) -> String {
    let (mass, centre) = match &program.tool.load {
        Some(load) => (fixed(load.mass_kg, 3), load.centre_m * 1e3),
        None => (fixed(NO_LOAD_KG, 0), nalgebra::Vector3::zeros()),
    };
    let [x, y, z]: [String; 3] = centre.map(|v| fixed(v, 3)).into();
    let frame = format!("{{X {x},Y {y},Z {z},A 0.0,B 0.0,C 0.0}}");
    format!("$LOAD={{M {mass},CM {frame},J {{X 0.0,Y 0.0,Z 0.0}}}}")
}
