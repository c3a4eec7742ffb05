//! From an `.LS` to a program.

use std::collections::BTreeMap;
use std::path::Path;

use nalgebra::Isometry3;
use truecut_arm::Robot;

use super::check_name;
use super::dialect::LsOptions;
use super::positions::{self, Position};
use crate::program::dialect::{Frames, ReadText};
use crate::program::euler::pose_of;
use crate::program::flags::Flags;
use crate::program::number::{finite, whole};
use crate::program::reading::{Goal, Notes, Step, follow};
use crate::program::{Motion, Program, ProgramError, ProgramErrorKind, SpindleSwitch, Tool, Zone};

const WANTED: &str =
    "J, L, C, UFRAME_NUM, UTOOL_NUM, DO[...], a remark or an instruction that moves nothing";
/// Instructions that move nothing; they are left aside with a note.
const IDLE: &[&str] = &[
    "WAIT",
    "PAYLOAD",
    "OVERRIDE",
    "TIMER",
    "RO[",
    "GO[",
    "AO[",
    "MESSAGE",
    "TOOL_OFFSET CONDITION",
    "OFFSET CONDITION",
    "PAUSE",
    "R[",
    "F[",
    "COL DETECT",
    "JOINT_MAX_SPEED",
    "LINEAR_MAX_SPEED",
    "LBL[",
];
/// Options of a move that change nothing of its way but its pace.
const PACE: &[&str] = &["ACC", "PTH", "RTCP", "COORD", "WJNT", "MROT", "BREAK"];

struct LsReader {
    positions: BTreeMap<u32, Position>,
    options: LsOptions,
    dof: usize,
    notes: Notes,
    head: Program,
    steps: Vec<Step>,
    /// `UTOOL_NUM` and `UFRAME_NUM`, once they are given.
    number: Option<u8>,
    user_frame: Option<u8>,
}

/// Reads a program.
///
/// # Errors
/// At the first line that is not understood, and at positions that are not there.
pub(super) fn read(
    file: &Path,
    text: &ReadText<'_>,
    robot: &Robot,
    frames: &Frames,
    options: &LsOptions,
) -> Result<Program, ProgramError> {
    let text = text(file).map_err(|error| ProgramError::in_file(file, None, error.into()))?;
    let truncated = |missing: &str| {
        let missing = missing.to_owned();
        let last = text.lines().count().max(1);
        ProgramError::in_file(file, last, ProgramErrorKind::Truncated { missing })
    };
    let line_of = |wanted: &str| text.lines().position(|line| line.trim_end() == wanted);
    let main = line_of("/MN").ok_or_else(|| truncated("/MN"))?;
    let end = line_of("/POS").ok_or_else(|| truncated("/POS"))?;
    let mut reader = LsReader {
        positions: positions::read(&blanked(&text, end), file)?,
        options: *options,
        dof: robot.dof(),
        notes: Notes::default(),
        head: Program {
            name: name(&text, file)?,
            comment: String::new(),
            tool: frames.tool.clone(),
            world_from_base: frames.world_from_base,
            moves: Vec::new(),
            spindle: Vec::new(),
            notes: Vec::new(),
        },
        steps: Vec::new(),
        number: None,
        user_frame: None,
    };
    for (line, text) in instructions(&text, main, end) {
        let done = reader.instruction(&text, line);
        done.map_err(|kind| ProgramError::in_file(file, line, kind))?;
    }
    if let Some((_, one)) = reader
        .positions
        .iter()
        .find(|(_, one)| one.user_frame != 0.0)
    {
        let text = "positions stand in a user frame: the base given is taken for it";
        reader.notes.add(one.line, text);
    }
    reader.head.tool = Tool {
        number: reader.number.unwrap_or(reader.head.tool.number),
        ..reader.head.tool
    };
    if reader.number == Some(0) && !options.joint_positions {
        reader.head.tool.flange_from_tool = Isometry3::identity();
    }
    reader.head.notes = reader.notes.texts();
    follow(reader.head, reader.steps, robot, file)
}

/// The text with its first lines empty, and the one of `/POS` too.
fn blanked(text: &str, last: usize) -> String {
    let mut blank = "\n".repeat(last + 1);
    for line in text.lines().skip(last + 1) {
        blank.push_str(line);
        blank.push('\n');
    }
    blank
}

fn name(text: &str, file: &Path) -> Result<String, ProgramError> {
    let first = text.lines().next().unwrap_or_default();
    let at = |kind| ProgramError::in_file(file, 1, kind);
    let rest = first.strip_prefix("/PROG");
    let rest = rest.ok_or_else(|| at(ProgramErrorKind::unexpected(first, "/PROG")))?;
    let name = rest
        .split_whitespace()
        .next()
        .unwrap_or_default()
        .to_owned();
    check_name(&name).map_err(at)?;
    Ok(name)
}

/// Instructions with their lines, numbers and ends taken off; those of more than one line in one.
fn instructions(text: &str, main: usize, end: usize) -> Vec<(usize, String)> {
    let mut all: Vec<(usize, String)> = Vec::new();
    let mut open: Option<(usize, String)> = None;
    for (i, line) in text.lines().enumerate().take(end).skip(main + 1) {
        let line = line.trim();
        if line.is_empty() {
            continue;
        }
        let after = line.split_once(':').filter(|(number, _)| {
            number.trim().is_empty() || number.trim().bytes().all(|b| b.is_ascii_digit())
        });
        let body = after.map_or(line, |(_, rest)| rest).trim();
        let (at, mut whole) = open.take().unwrap_or((i + 1, String::new()));
        whole.push(' ');
        match body.strip_suffix(';') {
            Some(body) => {
                whole.push_str(body.trim());
                all.push((at, whole.trim().to_owned()));
            }
            None => {
                whole.push_str(body);
                open = Some((at, whole));
            }
        }
    }
    // An instruction that does not end is one that is not understood.
    all.extend(open.map(|(at, text)| (at, format!("{} without `;`", text.trim()))));
    all
}

/// `!`, `--eg:`, or an instruction that is remarked out (`//`).
fn is_remark(text: &str) -> bool {
    ["!", "--eg:", "//"]
        .iter()
        .any(|mark| text.starts_with(mark))
}

impl LsReader {
    fn instruction(&mut self, text: &str, line: usize) -> Result<(), ProgramErrorKind> {
        let unexpected = || ProgramErrorKind::unexpected(text, WANTED);
        if text.is_empty() || is_remark(text) {
            return Ok(());
        }
        if text.ends_with(" without `;`") {
            return Err(unexpected());
        }
        if let Some(number) = text.strip_prefix("UTOOL_NUM=") {
            let number = whole(number, "UTOOL_NUM")?;
            if self.number.is_some_and(|known| known != number) {
                let rule = "that of the moves before: one tool is read";
                return Err(ProgramErrorKind::value("UTOOL_NUM", number, rule));
            }
            self.number = Some(number);
            return Ok(());
        }
        if let Some(number) = text.strip_prefix("UFRAME_NUM=") {
            let number: u8 = whole(number, "UFRAME_NUM")?;
            let moves = !self.steps.is_empty();
            let before = self.user_frame.replace(number);
            if let Some(before) = before.filter(|before| moves && *before != number) {
                let rule = format!("{before}, as in the moves before: one frame is read");
                return Err(ProgramErrorKind::value("UFRAME_NUM", number, rule));
            }
            if number != 0 {
                self.notes.add(
                    line,
                    format!("UFRAME_NUM={number}: the base given is taken for it"),
                );
            }
            return Ok(());
        }
        if let Some(output) = text.strip_prefix("DO[") {
            return self.output(output, line);
        }
        if let Some(idle) = IDLE.iter().find(|idle| text.starts_with(**idle)) {
            self.notes.add(
                line,
                format!("{} is left aside", idle.trim_end_matches('[')),
            );
            return Ok(());
        }
        let (verb, rest) = text.split_once(' ').unwrap_or((text, ""));
        match verb {
            "J" | "L" | "C" => self.motion(verb, rest.trim(), line),
            _ => Err(unexpected()),
        }
    }

    fn output(&mut self, text: &str, line: usize) -> Result<(), ProgramErrorKind> {
        let wanted = "DO[number]=ON or OFF";
        let wrong = || ProgramErrorKind::unexpected(text, wanted);
        let (number, state) = text.split_once("]=").ok_or_else(wrong)?;
        let number = number.split(':').next().unwrap_or_default();
        let number: u32 = whole(number, "the number of an output")?;
        let on = match state.trim().trim_matches(['(', ')']) {
            "ON" => true,
            "OFF" => false,
            _ => return Err(wrong()),
        };
        if Some(number) == self.options.spindle_output {
            let before = self.steps.len();
            self.head.spindle.push(SpindleSwitch { before, on });
        } else {
            self.notes.add(line, format!("DO[{number}] is left aside"));
        }
        Ok(())
    }

    /// `P[3:name]` and what follows.
    fn position<'t>(&self, text: &'t str) -> Result<(u32, &Position, &'t str), ProgramErrorKind> {
        let wanted = "P[...]";
        let wrong = || ProgramErrorKind::unexpected(text, wanted);
        let rest = text.strip_prefix("P[").ok_or_else(wrong)?;
        let (number, rest) = rest.split_once(']').ok_or_else(wrong)?;
        let number = number.split(':').next().unwrap_or_default();
        let number: u32 = whole(number, "the position's number")?;
        let found = self.positions.get(&number);
        let found = found.ok_or_else(|| ProgramErrorKind::MissingPosition {
            name: format!("P[{number}]"),
        })?;
        Ok((number, found, rest.trim()))
    }

    fn motion(&mut self, verb: &str, text: &str, line: usize) -> Result<(), ProgramErrorKind> {
        let (mut number, mut position, mut rest) = self.position(text)?;
        let mut via = None;
        if verb == "C" {
            via = Some(self.pose(position)?);
            (number, position, rest) = self.position(rest)?;
        }
        let mut words = rest.split_whitespace();
        let speed = words.next().unwrap_or_default();
        let motion = speed_of(verb, speed)?;
        let end = words.next().unwrap_or_default();
        let zone = match end.strip_prefix("CNT") {
            Some(level) => {
                let level: u8 = whole(level, "CNT")?;
                ProgramErrorKind::unless(level <= 100, "CNT", level, "from 0 to 100")?;
                Zone::Unstated
            }
            None if end == "FINE" => Zone::Stop,
            None => return Err(ProgramErrorKind::unexpected(end, "FINE or CNT0 to CNT100")),
        };
        let mut idle = Vec::new();
        for word in words {
            if !PACE
                .iter()
                .any(|pace| word.to_uppercase().starts_with(pace))
            {
                let wanted = "the end of the move, ACC, PTH or COORD";
                return Err(ProgramErrorKind::unexpected(word, wanted));
            }
            idle.push(word.to_owned());
        }
        self.check_frames(position)?;
        let goal = self.goal(position)?;
        let turntable_rad = position.numbers.get("E1").map(|deg| deg.to_radians());
        for word in idle {
            self.notes
                .add(line, format!("{word} of a move is left aside"));
        }
        ProgramErrorKind::unless_too_many(self.steps.len() + 1)?;
        self.steps.push(Step {
            line,
            path_point: number.checked_sub(1).map(|number| number as usize),
            goal,
            via,
            motion,
            zone,
            turntable_rad,
        });
        Ok(())
    }

    /// As on the controller, a position is one of the frames that are selected.
    fn check_frames(&self, position: &Position) -> Result<(), ProgramErrorKind> {
        let selected = [
            ("UT", "UTOOL_NUM", self.number),
            ("UF", "UFRAME_NUM", self.user_frame),
        ];
        for (part, word, number) in selected {
            let (Some(found), Some(number)) = (position.numbers.get(part), number) else {
                continue;
            };
            let what = format!("{part} of the position in line {}", position.line);
            let rule = format!("{number}, by {word}");
            ProgramErrorKind::unless(*found == f64::from(number), what, found, rule)?;
        }
        Ok(())
    }

    fn goal(&self, position: &Position) -> Result<Goal, ProgramErrorKind> {
        if position.numbers.contains_key("J1") {
            let joints = (1..=self.dof).map(|i| position.numbers.get(&format!("J{i}")).copied());
            let joints: Option<Vec<f64>> = joints.collect();
            let mut deg = joints.ok_or_else(|| ProgramErrorKind::JointCount {
                what: "a position in joints".to_owned(),
                found: position
                    .numbers
                    .keys()
                    .filter(|key| key.starts_with('J'))
                    .count(),
                wanted: self.dof,
            })?;
            if deg.len() > 2 {
                deg[2] += self.options.j23_factor * deg[1];
            }
            return Ok(Goal::Joints(deg.into_iter().map(f64::to_radians).collect()));
        }
        let flags = position
            .config
            .map(|config| Box::new(config) as Box<dyn Flags>);
        Ok(Goal::Pose(self.pose(position)?, flags))
    }

    fn pose(&self, position: &Position) -> Result<Isometry3<f64>, ProgramErrorKind> {
        let part = |name: &str| {
            let found = position.numbers.get(name).copied();
            found.ok_or_else(|| {
                ProgramErrorKind::unexpected("a position", &format!("one with {name}"))
            })
        };
        Ok(pose_of(
            [part("X")?, part("Y")?, part("Z")?],
            [part("W")?, part("P")?, part("R")?],
        ))
    }
}

fn speed_of(verb: &str, text: &str) -> Result<Motion, ProgramErrorKind> {
    let number = |unit: &str| {
        text.strip_suffix(unit)
            .map(|number| finite(number, "the speed"))
    };
    if verb == "J" {
        let percent = number("%")
            .unwrap_or_else(|| Err(ProgramErrorKind::unexpected(text, "a speed in percent")))?;
        let fits = percent > 0.0 && percent <= 100.0;
        ProgramErrorKind::unless(fits, "the speed", text, "above 0 to 100 %")?;
        return Ok(Motion::Joint {
            share: percent / 100.0,
        });
    }
    let units = [
        ("mm/sec", 1e-3),
        ("cm/min", 0.01 / 60.0),
        ("inch/min", 0.0254 / 60.0),
    ];
    let found = units
        .iter()
        .find_map(|(unit, m_per_s)| Some(number(unit)?.map(|v| v * m_per_s)));
    let wanted = "a speed in mm/sec, cm/min or inch/min";
    let speed_m_per_s = found.unwrap_or_else(|| Err(ProgramErrorKind::unexpected(text, wanted)))?;
    ProgramErrorKind::unless(speed_m_per_s > 0.0, "the speed", text, "above zero")?;
    Ok(Motion::Linear { speed_m_per_s })
}
