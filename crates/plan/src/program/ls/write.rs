//! From a program to an `.LS`.

use truecut_arm::{OpwGeometry, Robot};

use super::dialect::LsOptions;
use super::{Config, MM_PER_S, TURN_JOINTS, check_name};
use crate::program::dialect::{NOT_LOADED, ProgramFile};
use crate::program::euler::texts;
use crate::program::flags::Flags;
use crate::program::number::fixed;
use crate::program::{Motion, Move, Program, ProgramError, ProgramErrorKind, Zone};

/// Longest remark, characters.
const REMARK_CHARS: usize = 32;
/// Most characters of the comment in the head.
const COMMENT_CHARS: usize = 16;

/// A tool that stands nearer to the faceplate is the faceplate, m and rad.
const FACEPLATE: f64 = 1e-6;

/// Writes a program.
///
/// # Errors
/// If the name or a speed is one that the language cannot hold, a joint stands beyond what a
/// configuration tells apart, or the program contradicts itself.
pub(super) fn write(
    program: &Program,
    robot: &Robot,
    options: &LsOptions,
) -> Result<Vec<ProgramFile>, ProgramError> {
    check_name(&program.name)?;
    let plain = |c: char| (' '..='~').contains(&c) && c != '"';
    let fits = program.comment.chars().all(plain);
    let comment = format!("\"{}\"", program.comment);
    ProgramErrorKind::unless(
        fits,
        "the comment",
        comment,
        "printable ASCII without quotes",
    )?;
    program.check(robot)?;
    check_tool(program, options)?;
    let geometry =
        OpwGeometry::of(robot).ok_or_else(|| ProgramErrorKind::not_ortho_parallel(robot))?;
    let body = moves(program, options)?;
    let mut lines = head(program, body.len());
    let number = |(i, text): (usize, &String)| format!("{:>4}:{text} ;", i + 1);
    lines.extend(body.iter().enumerate().map(number));
    lines.push("/POS".to_owned());
    for step in &program.moves {
        check_turns(step, robot)?;
        lines.extend(position(program, step, &geometry, options));
    }
    lines.push("/END".to_owned());
    Ok(vec![ProgramFile {
        name: format!("{}.LS", program.name),
        text: lines.join("\r\n") + "\r\n",
    }])
}

/// Positions of tool frame 0 are the faceplate's: those of a tool would lead the faceplate to where
/// the tool shall be.
fn check_tool(program: &Program, options: &LsOptions) -> Result<(), ProgramErrorKind> {
    let tool = &program.tool;
    let away_m = tool.flange_from_tool.translation.vector.norm();
    let turned_rad = tool.flange_from_tool.rotation.angle();
    let is_faceplate = away_m.max(turned_rad) < FACEPLATE;
    let rule = format!(
        "1 or more: frame 0 is the faceplate, and the tool stands {:.3} mm and {:.3} deg from it",
        away_m * 1e3,
        turned_rad.to_degrees()
    );
    let holds = tool.number > 0 || is_faceplate || options.joint_positions;
    ProgramErrorKind::unless(holds, "the number of the tool frame", tool.number, rule)
}

fn head(program: &Program, count: usize) -> Vec<String> {
    let comment: String = program.comment.chars().take(COMMENT_CHARS).collect();
    [
        format!("/PROG  {}", program.name),
        "/ATTR".to_owned(),
        "OWNER           = MNEDITOR;".to_owned(),
        format!("COMMENT         = \"{comment}\";"),
        format!("LINE_COUNT      = {count};"),
        "PROTECT         = READ_WRITE;".to_owned(),
        "DEFAULT_GROUP   = 1,*,*,*,*;".to_owned(),
        "CONTROL_CODE    = 00000000 00000000;".to_owned(),
        "/MN".to_owned(),
    ]
    .into()
}

/// Instructions without numbers and ends.
fn moves(program: &Program, options: &LsOptions) -> Result<Vec<String>, ProgramErrorKind> {
    let remark: String = NOT_LOADED.chars().take(REMARK_CHARS).collect();
    let mut lines = vec![
        format!("  !{remark}"),
        format!("  UFRAME_NUM={}", options.user_frame),
        format!("  UTOOL_NUM={}", program.tool.number),
    ];
    let spindle = |before: usize| {
        program.switches(before).map(|on| {
            let state = if on { "ON" } else { "OFF" };
            match options.spindle_output {
                Some(number) => format!("  DO[{number}]={state}"),
                None => format!("  !spindle {state}"),
            }
        })
    };
    for (i, step) in program.moves.iter().enumerate() {
        lines.extend(spindle(i));
        let inner = i > 0 && i + 1 < program.moves.len();
        let passes = match step.zone {
            Zone::Within(_) => true,
            Zone::Unstated => inner,
            Zone::Stop => false,
        };
        let end = if passes { "CNT100" } else { "FINE" };
        let number = step.path_point + 1;
        lines.push(match step.motion {
            Motion::Joint { share } => {
                let percent = (share * 100.0).round().max(1.0);
                format!("J P[{number}] {percent}% {end}")
            }
            Motion::Linear { speed_m_per_s } => {
                let mm_per_s = speed_m_per_s * 1e3;
                let (low, high) = MM_PER_S;
                if !(low..=high).contains(&mm_per_s) {
                    let rule = format!("from {low} to {high} mm/s");
                    let what = "speed in mm/s";
                    return Err(ProgramErrorKind::at_point(
                        step.path_point,
                        what,
                        mm_per_s,
                        &rule,
                    ));
                }
                format!("L P[{number}] {}mm/sec {end}", fixed(mm_per_s, 1))
            }
        });
    }
    lines.extend(spindle(program.moves.len()));
    Ok(lines)
}

/// The configuration tells whole turns of the wrist apart, and none of axis 1.
fn check_turns(step: &Move, robot: &Robot) -> Result<(), ProgramErrorKind> {
    let beyond = (0..robot.dof()).find(|&joint| {
        let deg = step.posture[joint].to_degrees().abs();
        match TURN_JOINTS.contains(&joint) {
            true => deg >= 3420.0,
            false => joint == 0 && deg > 180.0,
        }
    });
    beyond.map_or(Ok(()), |joint| {
        Err(ProgramErrorKind::Unspeakable {
            path_point: step.path_point,
            joint: robot.chain.joints[joint].name.clone(),
            value_deg: step.posture[joint].to_degrees(),
            rule: "a configuration holds turns of axes 4 to 6 up to 9, and none of axis 1",
        })
    })
}

fn position(
    program: &Program,
    step: &Move,
    geometry: &OpwGeometry,
    options: &LsOptions,
) -> Vec<String> {
    let (frame, tool) = (options.user_frame, program.tool.number);
    let mut lines = vec![
        format!("P[{}]{{", step.path_point + 1),
        "   GP1:".to_owned(),
    ];
    let turntable = |last: &str| match step.turntable_rad {
        Some(angle) => format!("{last},\r\n\tE1= {} deg", fixed(angle.to_degrees(), 3)),
        None => last.to_owned(),
    };
    if options.joint_positions {
        lines.push(format!("\tUF : {frame}, UT : {tool},"));
        let joints = controller_deg(&step.posture, options.j23_factor);
        let texts = joints.iter().enumerate();
        let texts: Vec<String> = texts
            .map(|(i, deg)| format!("J{}= {} deg", i + 1, fixed(*deg, 3)))
            .collect();
        lines.push(turntable(&format!("\t{}", texts.join(",\t"))));
    } else {
        let config = Config::of(geometry, &step.posture).text();
        lines.push(format!("\tUF : {frame}, UT : {tool},\t\t{config},"));
        let ([x, y, z], [w, p, r]) = texts(&step.base_from_tool, 3, 3);
        lines.push(format!("\tX = {x} mm,\tY = {y} mm,\tZ = {z} mm,"));
        lines.push(turntable(&format!(
            "\tW = {w} deg,\tP = {p} deg,\tR = {r} deg"
        )));
    }
    lines.push("};".to_owned());
    lines
}

/// Joint angles as the controller counts them, deg: its J3 is measured against the horizontal,
/// a URDF's third joint against the upper arm.
pub(super) fn controller_deg(posture: &[f64], j23_factor: f64) -> Vec<f64> {
    let mut deg: Vec<f64> = posture.iter().map(|q| q.to_degrees()).collect();
    if deg.len() > 2 {
        deg[2] -= j23_factor * deg[1];
    }
    deg
}
