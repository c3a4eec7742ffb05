//! From `.src` and `.dat` to a program.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use nalgebra::Isometry3;
use truecut_arm::Robot;

use super::inline::ACTUAL;
use super::structures::{Declared, Numbers, TYPES, declared, read_data, typed};
use super::{SYNTAX, check_name};
use crate::program::dialect::{Frames, ReadText, Settings};
use crate::program::reading::{Goal, Notes, Step, follow};
use crate::program::source::{LINE_END, Source};
use crate::program::{Program, ProgramError, ProgramErrorKind, Tool};

/// Statements that move nothing; they are left aside with a note. Every program declares the
/// interrupt of the stop message.
const IDLE: &[&str] = &[
    "WAIT",
    "HALT",
    "INI",
    "EXT",
    "CONTINUE",
    "GLOBAL",
    "INTERRUPT",
    "PULSE",
    "ANOUT",
    "DIGIN",
];
const WANTED: &str = "PTP, LIN, CIRC, a variable of the system, BAS, WAIT or END";
/// Statements that steer the program or lead to a place that it does not say: what they lead to is
/// not known before it runs.
const CONTROL: &[&str] = &[
    "IF", "ELSE", "ENDIF", "FOR", "ENDFOR", "WHILE", "ENDWHILE", "LOOP", "ENDLOOP", "REPEAT",
    "UNTIL", "SWITCH", "GOTO", "RETURN", "TRIGGER", "SPLINE", "PTP_REL", "CIRC_REL",
];

pub(super) struct KrlReader<'a> {
    pub source: Source<'a>,
    path: &'a Path,
    pub declared: Declared,
    /// The `.dat` that was looked for, if it is not there.
    pub missing_data: Option<PathBuf>,
    pub output: Option<u32>,
    pub dof: usize,
    pub notes: Notes,
    pub head: Program,
    pub steps: Vec<Step>,
    /// The position of the last move, whole.
    pub last: Option<Numbers>,
    /// Of tool and base, where the files do not hold them.
    pub given: [Isometry3<f64>; 2],
    /// Frames that are selected, by what they are for: the name, and whether the files hold it.
    pub selected: BTreeMap<String, (String, bool)>,
    pub speed_m_per_s: Option<f64>,
    pub share: Option<f64>,
    pub zone_m: Option<f64>,
    /// Whether lines keep the attitude of their start (`$ORI_TYPE=#CONSTANT`).
    pub keeps_attitude: bool,
}

/// Reads the `.src` beside the file, and the `.dat` beside it if there is one.
///
/// # Errors
/// At the first piece that is not understood, and at positions that are not there.
pub(super) fn read(
    file: &Path,
    text: &ReadText<'_>,
    robot: &Robot,
    frames: &Frames,
    settings: &Settings,
) -> Result<Program, ProgramError> {
    let is_data = file
        .extension()
        .is_some_and(|ending| ending.eq_ignore_ascii_case("dat"));
    let source_file = if is_data {
        beside(file, "src")
    } else {
        file.to_owned()
    };
    let source = text(&source_file)
        .map_err(|error| ProgramError::in_file(&source_file, None, error.into()))?;
    let source = without_heads(&source);
    let (known, missing_data) = data_beside(&source_file, text)?;
    let output = settings.spindle_number();
    let output = output.map_err(ProgramErrorKind::from)?;
    let mut reader = KrlReader {
        source: Source::new(&source, &source_file, &SYNTAX),
        path: &source_file,
        declared: known,
        missing_data,
        output,
        dof: robot.dof(),
        notes: Notes::default(),
        head: Program {
            name: String::new(),
            comment: String::new(),
            tool: Tool {
                load: None,
                ..frames.tool.clone()
            },
            world_from_base: frames.world_from_base,
            moves: Vec::new(),
            spindle: Vec::new(),
            notes: Vec::new(),
        },
        steps: Vec::new(),
        last: None,
        given: [frames.tool.flange_from_tool, frames.world_from_base],
        selected: BTreeMap::new(),
        speed_m_per_s: None,
        share: None,
        zone_m: None,
        keeps_attitude: false,
    };
    reader.program()?;
    reader.note_given();
    reader.head.notes = reader.notes.texts();
    follow(reader.head, reader.steps, robot, reader.path)
}

/// What the `.dat` beside the file declares; its path if it is not there, for a program may do
/// without.
fn data_beside(
    source_file: &Path,
    text: &ReadText<'_>,
) -> Result<(Declared, Option<PathBuf>), ProgramError> {
    let file = beside(source_file, "dat");
    let mut known = Declared::default();
    match text(&file) {
        Ok(data) => read_data(&without_heads(&data), &file, &mut known)?,
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => {
            return Ok((known, Some(file)));
        }
        Err(error) => return Err(ProgramError::in_file(&file, None, error.into())),
    }
    Ok((known, None))
}

/// The text with its lines for the editor (`&ACCESS`) emptied.
fn without_heads(text: &str) -> String {
    let line = |line: &str| match line.starts_with('&') {
        true => "\n".to_owned(),
        false => format!("{line}\n"),
    };
    text.lines().map(line).collect()
}

/// The file with another ending, in capitals if its own is.
fn beside(file: &Path, ending: &str) -> PathBuf {
    let own = file
        .extension()
        .and_then(|own| own.to_str())
        .unwrap_or_default();
    let capitals = own.chars().any(char::is_uppercase);
    file.with_extension(if capitals {
        ending.to_uppercase()
    } else {
        ending.to_owned()
    })
}

impl KrlReader<'_> {
    fn program(&mut self) -> Result<(), ProgramError> {
        loop {
            let word = self.source.word("DEF")?.to_uppercase();
            match word.as_str() {
                "DEF" => break,
                "GLOBAL" => {}
                _ => return Err(self.source.unexpected("DEF")),
            }
        }
        let name = self.source.word("the program's name")?.to_owned();
        check_name(&name).map_err(|kind| self.fault(kind))?;
        self.head.name = name;
        self.source.expect(&["(", ")", LINE_END])?;
        while self.statement()? {}
        Ok(())
    }

    /// Frames that no instruction selects.
    fn note_given(&mut self) {
        let is_pose = |step: &&Step| !matches!(step.goal, Goal::Joints(_));
        let Some(line) = self.steps.iter().find(is_pose).map(|step| step.line) else {
            return;
        };
        for (word, what) in [
            ("$TOOL", "the robot's own tool"),
            ("$BASE", "the base given"),
        ] {
            if !self.selected.contains_key(word) {
                self.notes
                    .add(line, format!("no {word} is selected; {what} is taken"));
            }
        }
    }

    pub(super) fn fault(&self, kind: ProgramErrorKind) -> ProgramError {
        self.source.error(self.source.last_line(), kind)
    }

    /// A fault of a place that no file declares.
    pub(super) fn unknown_place(&self, name: &str) -> ProgramError {
        let why = match &self.missing_data {
            Some(file) => format!(
                "a place that the .src does not hold, and {}, which would declare it, is not there: put it beside \
                 the .src, with what stands in $config.dat declared in it",
                file.display()
            ),
            None => "a place that neither the .src nor the .dat holds: what stands in $config.dat must be \
                     declared in the .dat"
                .to_owned(),
        };
        self.fault(ProgramErrorKind::not_read(name, &why))
    }

    /// Whether another one follows.
    fn statement(&mut self) -> Result<bool, ProgramError> {
        let line = self.source.line();
        let word = self.source.word(WANTED)?;
        let upper = word.to_uppercase();
        match upper.as_str() {
            "END" => return Ok(false),
            "PTP" | "LIN" | "CIRC" => self.motion(&upper, line)?,
            // Each alone a spline of one move: the same way.
            "SPTP" | "SLIN" | "SCIRC" => self.motion(&upper[1..], line)?,
            "LIN_REL" | "SLIN_REL" => self.relative(&upper, line)?,
            "BAS" => self.bas(line)?,
            "$VEL" | "$APO" | "$VEL.CP" | "$APO.CDIS" => self.setting(&upper, line)?,
            "$TOOL" | "$BASE" => self.frame(&upper, line)?,
            "$IPO_MODE" | "$ORI_TYPE" => {
                self.source.expect(&["="])?;
                let value = self.source.word("a word that begins by #")?.to_uppercase();
                match upper.as_str() {
                    "$IPO_MODE" => self.guides(&upper, &value, line)?,
                    _ => self.turns(&upper, &value, line)?,
                }
            }
            _ if upper.starts_with("$TOOL.") || upper.starts_with("$BASE.") => {
                let why = "a part of a frame: give the frame whole";
                return Err(self.fault(ProgramErrorKind::not_read(word, why)));
            }
            _ if ACTUAL.contains(&upper.as_str()) && self.source.comes("=") => {
                self.actual(&upper, line)?;
            }
            "$LOAD" => {
                self.source.expect(&["="])?;
                if self.source.comes("{") {
                    self.load()?;
                } else {
                    self.aside(line, "$LOAD")?;
                }
            }
            "$VEL_AXIS" => {
                self.source.expect(&["["])?;
                self.source.word("an axis")?;
                self.source.expect(&["]", "="])?;
                self.percent()?;
            }
            "$OUT" => self.output(line)?,
            "DECL" => return declared(&mut self.source, &mut self.declared).map(|()| true),
            "GLOBAL" if !self.source.comes("INTERRUPT") => {
                return declared(&mut self.source, &mut self.declared).map(|()| true);
            }
            _ if TYPES.contains(&upper.as_str()) => {
                return typed(&mut self.source, &upper, &mut self.declared).map(|()| true);
            }
            _ if IDLE.contains(&upper.as_str()) => self.aside(line, &upper)?,
            _ if CONTROL.contains(&upper.as_str()) => {
                let why = match upper.ends_with("_REL") {
                    true => "a move from where the arm stands",
                    false => "what branches, loops or interrupts",
                };
                return Err(self.fault(ProgramErrorKind::not_read(word, why)));
            }
            _ if self.source.comes("(") => {
                return Err(self.fault(ProgramErrorKind::not_read(word, "a subprogram")));
            }
            _ if self.source.comes("=") || self.source.comes("[") => {
                self.assignment(&upper, line)?;
            }
            _ => return Err(self.source.unexpected(WANTED)),
        }
        self.source.expect(&[LINE_END])?;
        Ok(true)
    }

    /// Leaves out the rest of the line.
    pub(super) fn aside(&mut self, line: usize, what: &str) -> Result<(), ProgramError> {
        self.notes.add(line, format!("{what} is left aside"));
        while !self.source.comes(LINE_END) {
            self.source.skip_one(LINE_END)?;
        }
        Ok(())
    }
}
