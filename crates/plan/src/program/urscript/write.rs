//! From a program to a script.

use nalgebra::Isometry3;
use truecut_arm::{BranchOptions, Robot};

use super::{
    JOINT_RAD_PER_S2, JOINT_TOP_RAD_PER_S, LINE_M_PER_S2, POINT, SAME_POSTURE_RAD, check_name,
};
use crate::program::dialect::{NOT_LOADED, ProgramFile, Settings};
use crate::program::number::fixed;
use crate::program::reading::nearest;
use crate::program::{Motion, Move, Program, ProgramError, ProgramErrorKind, Zone};

/// Blend of the points of which the program says nothing, between the first and the last.
const BLEND_M: f64 = 1e-3;
/// A blend is written to so much.
const LEAST_BLEND_M: f64 = 1e-6;
/// Share of the way between two points that a blend takes at most where it meets another: less than
/// half of it, so that rounded places do not make them meet.
const HALFWAY: f64 = 0.49;

/// Writes a program as one function.
///
/// # Errors
/// If the name is none of the language, the program moves a turntable, or contradicts itself.
pub(super) fn write(
    program: &Program,
    robot: &Robot,
    settings: &Settings,
) -> Result<Vec<ProgramFile>, ProgramError> {
    check_name(&program.name)?;
    program.check(robot)?;
    let output = settings.spindle_number().map_err(ProgramErrorKind::from)?;
    let spindle = |before: usize| {
        program.switches(before).map(move |on| match output {
            Some(number) => {
                let state = if on { "True" } else { "False" };
                format!("  set_standard_digital_out({number}, {state})")
            }
            None => format!("  # spindle {}", if on { "on" } else { "off" }),
        })
    };
    let mut lines = head(program);
    let blends = blends_m(program);
    let solver = robot.ik_solver(&BranchOptions::default());
    let mut before: Option<&[f64]> = None;
    let mut expected = 0;
    for (i, step) in program.moves.iter().enumerate() {
        if step.turntable_rad.is_some() {
            let rule = "none: a script moves the arm alone";
            let what = format!("path point {}: the turntable", step.path_point);
            return Err(ProgramErrorKind::value(what, "given", rule).into());
        }
        lines.extend(spindle(i));
        if step.path_point != expected {
            lines.push(format!("  {POINT}{}", step.path_point));
        }
        expected = step.path_point + 1;
        let blend = match blends[i] > 0.0 {
            true => format!(", r={}", fixed(blends[i], 6)),
            false => String::new(),
        };
        // A line leads to the posture of its pose that is nearest: where another one is meant the
        // joints are written.
        let leads = |before: &[f64]| {
            let flange = program.world_from_flange(&rounded(&step.base_from_tool));
            let found = nearest(robot, &solver, &flange, before, step.path_point);
            let same = |(a, b): (&f64, &f64)| (a - b).abs() <= SAME_POSTURE_RAD;
            found.is_ok_and(|q| q.iter().zip(&step.posture).all(same))
        };
        let joints = || list("", &step.posture, 8);
        lines.push(match step.motion {
            Motion::Joint { share } => format!(
                "  movej({}, a={JOINT_RAD_PER_S2}, v={}{blend})",
                joints(),
                fixed((share * JOINT_TOP_RAD_PER_S).max(1e-6), 6)
            ),
            Motion::Linear { speed_m_per_s } => {
                let to = match before.is_some_and(leads) {
                    true => pose(&step.base_from_tool),
                    false => joints(),
                };
                let speed = fixed(speed_m_per_s.max(1e-6), 6);
                format!("  movel({to}, a={LINE_M_PER_S2}, v={speed}{blend})")
            }
        });
        before = Some(&step.posture);
    }
    lines.extend(spindle(program.moves.len()));
    lines.push("end".to_owned());
    Ok(vec![ProgramFile {
        name: format!("{}.script", program.name),
        text: lines.join("\n") + "\n",
    }])
}

/// Blend radius of each move, in whole micrometres. The controller skips a move whose blend
/// overlaps with that of the move before or after: where they would, both reach no further than
/// halfway.
fn blends_m(program: &Program) -> Vec<f64> {
    let moves = &program.moves;
    let asked = |(i, step): (usize, &Move)| match step.zone {
        Zone::Within(zone_m) => zone_m.max(LEAST_BLEND_M),
        Zone::Unstated if i > 0 && i + 1 < moves.len() => BLEND_M,
        _ => 0.0,
    };
    let asked: Vec<f64> = moves.iter().enumerate().map(asked).collect();
    let mut blends = asked.clone();
    for (i, pair) in moves.windows(2).enumerate() {
        let [from, to] = [0, 1].map(|k| pair[k].base_from_tool.translation.vector);
        let way_m = (to - from).norm();
        if asked[i] + asked[i + 1] + 2.0 * LEAST_BLEND_M >= way_m {
            let most_m = (HALFWAY * way_m / LEAST_BLEND_M).floor() * LEAST_BLEND_M;
            for blend in &mut blends[i..i + 2] {
                *blend = blend.min(most_m);
            }
        }
    }
    blends
}

fn head(program: &Program) -> Vec<String> {
    let mut lines = vec![format!("def {}():", program.name)];
    lines.push(format!("  # {NOT_LOADED}"));
    if !program.comment.is_empty() {
        let comment: Vec<&str> = program.comment.lines().collect();
        lines.push(format!("  # {}", comment.join(" ")));
    }
    lines.push(format!(
        "  set_tcp({})",
        pose(&program.tool.flange_from_tool)
    ));
    lines.push(match &program.tool.load {
        Some(load) => {
            let centre = list("", load.centre_m.as_slice(), 6);
            format!("  set_payload({}, {centre})", fixed(load.mass_kg, 3))
        }
        None => "  # the tool's load is not known: that of the installation counts".to_owned(),
    });
    lines
}

fn list(before: &str, numbers: &[f64], decimals: usize) -> String {
    let texts: Vec<String> = numbers.iter().map(|v| fixed(*v, decimals)).collect();
    format!("{before}[{}]", texts.join(", "))
}

/// `p[x, y, z, rx, ry, rz]`: m, and the rotation vector.
fn pose(pose: &Isometry3<f64>) -> String {
    let turn = pose.rotation.scaled_axis();
    let place: Vec<String> = pose
        .translation
        .vector
        .iter()
        .map(|v| fixed(*v, 7))
        .collect();
    let turn: Vec<String> = turn.iter().map(|v| fixed(*v, 8)).collect();
    format!("p[{}, {}]", place.join(", "), turn.join(", "))
}

/// The pose as its text gives it back.
fn rounded(pose: &Isometry3<f64>) -> Isometry3<f64> {
    let place = pose.translation.vector.map(|v| (v * 1e7).round() * 1e-7);
    let turn = pose
        .rotation
        .scaled_axis()
        .map(|v| (v * 1e8).round() * 1e-8);
    Isometry3::new(place, turn)
}
