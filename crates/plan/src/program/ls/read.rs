//! From an `.LS` to a program.

use std::collections::BTreeMap;
use std::path::Path;

use nalgebra::Isometry3;
use truecut_arm::Robot;

use super::check_name;
use super::dialect::LsOptions;
use super::positions::{self, Position};
use crate::program::dialect::{Frames, ReadText};
use crate::program::number::whole;
use crate::program::reading::{Notes, Step, follow};
use crate::program::{Program, ProgramError, ProgramErrorKind, SpindleSwitch, Tool};

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
    "SR[",
    // Moves by registers, and frames of them, are refused.
    "PR[",
    "F[",
    "COL DETECT",
    "JOINT_MAX_SPEED",
    "LINEAR_MAX_SPEED",
    "LBL[",
];
pub(super) struct LsReader {
    pub positions: BTreeMap<u32, Position>,
    pub options: LsOptions,
    pub dof: usize,
    pub notes: Notes,
    head: Program,
    pub steps: Vec<Step>,
    /// `UTOOL_NUM` and `UFRAME_NUM`, once they are given.
    pub number: Option<u8>,
    pub user_frame: Option<u8>,
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
    /// Refuses what leads elsewhere, and frames that the file does not hold.
    fn is_within(text: &str) -> Result<(), ProgramErrorKind> {
        let first = text.split([' ', '[', '=', '(']).next().unwrap_or_default();
        let why = match first {
            "IF" | "ELSE" | "ENDIF" | "JMP" | "SELECT" | "FOR" | "ENDFOR" => {
                "what branches or loops"
            }
            "CALL" | "RUN" => "another program",
            "UTOOL" | "UFRAME" => {
                "a frame of a register: give it as the tool or the base, and leave the line out"
            }
            _ => return Ok(()),
        };
        Err(ProgramErrorKind::not_read(text, why))
    }

    fn instruction(&mut self, text: &str, line: usize) -> Result<(), ProgramErrorKind> {
        let unexpected = || ProgramErrorKind::unexpected(text, WANTED);
        if text.is_empty() || is_remark(text) {
            return Ok(());
        }
        if text.ends_with(" without `;`") {
            return Err(unexpected());
        }
        Self::is_within(text)?;
        let set = text
            .split_once('=')
            .map(|(name, value)| (name.trim(), value));
        if let Some(("UTOOL_NUM", number)) = set {
            let number = whole(number, "UTOOL_NUM")?;
            if self.number.is_some_and(|known| known != number) {
                let rule = "that of the moves before: one tool is read";
                return Err(ProgramErrorKind::value("UTOOL_NUM", number, rule));
            }
            self.number = Some(number);
            return Ok(());
        }
        if let Some(("UFRAME_NUM", number)) = set {
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
            // It ends by itself.
            pulse if pulse.starts_with("PULSE") && Some(number) != self.options.spindle_output => {
                self.notes.add(line, format!("DO[{number}] is left aside"));
                return Ok(());
            }
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
}
