//! From `.src` and `.dat` to a program.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use nalgebra::{Isometry3, Vector3};
use truecut_arm::{Robot, ToolLoad};

use super::structures::{Numbers, declared, numbers, pose, read_data};
use super::{SYNTAX, check_name};
use crate::program::dialect::{Frames, ReadText, Settings};
use crate::program::number::whole;
use crate::program::reading::{Notes, Step, follow};
use crate::program::source::{LINE_END, Source};
use crate::program::{Program, ProgramError, ProgramErrorKind, SpindleSwitch, Tool};

const WANTED: &str = "PTP, LIN, CIRC, a variable of the system, BAS, WAIT or END";
/// Statements that steer the program: what they lead to is not known before it runs.
const CONTROL: &[&str] = &[
    "IF",
    "ELSE",
    "ENDIF",
    "FOR",
    "ENDFOR",
    "WHILE",
    "ENDWHILE",
    "LOOP",
    "ENDLOOP",
    "REPEAT",
    "UNTIL",
    "SWITCH",
    "GOTO",
    "RETURN",
    "INTERRUPT",
    "TRIGGER",
    "SPLINE",
    "PTP_REL",
    "LIN_REL",
    "CIRC_REL",
];

pub(super) struct KrlReader<'a> {
    pub source: Source<'a>,
    path: &'a Path,
    pub positions: BTreeMap<String, Numbers>,
    output: Option<u32>,
    pub dof: usize,
    notes: Notes,
    head: Program,
    pub steps: Vec<Step>,
    pub speed_m_per_s: Option<f64>,
    pub share: Option<f64>,
    pub zone_m: Option<f64>,
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
    let data_file = beside(&source_file, "dat");
    let mut positions = BTreeMap::new();
    match text(&data_file) {
        Ok(data) => read_data(&without_heads(&data), &data_file, &mut positions)?,
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => {}
        Err(error) => return Err(ProgramError::in_file(&data_file, None, error.into())),
    }
    let output = settings.spindle_number();
    let output = output.map_err(ProgramErrorKind::from)?;
    let mut reader = KrlReader {
        source: Source::new(&source, &source_file, &SYNTAX),
        path: &source_file,
        positions,
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
        speed_m_per_s: None,
        share: None,
        zone_m: None,
    };
    reader.program()?;
    reader.head.notes = reader.notes.texts();
    follow(reader.head, reader.steps, robot, reader.path)
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

    pub(super) fn fault(&self, kind: ProgramErrorKind) -> ProgramError {
        self.source.error(self.source.last_line(), kind)
    }

    /// Whether another one follows.
    fn statement(&mut self) -> Result<bool, ProgramError> {
        let line = self.source.line();
        let word = self.source.word(WANTED)?;
        let upper = word.to_uppercase();
        match upper.as_str() {
            "END" => return Ok(false),
            "PTP" | "LIN" | "CIRC" => self.motion(&upper, line)?,
            "BAS" => self.bas(line)?,
            "$VEL" | "$APO" | "$VEL.CP" | "$APO.CDIS" => self.setting(&upper, line)?,
            "$TOOL" | "$BASE" => self.frame(&upper, line)?,
            "$LOAD" => {
                self.source.expect(&["="])?;
                if self.source.comes("{") {
                    self.load()?;
                } else {
                    self.source.word("load data")?;
                }
            }
            "$VEL_AXIS" => {
                self.source.expect(&["["])?;
                self.source.word("an axis")?;
                self.source.expect(&["]", "="])?;
                self.percent()?;
            }
            "$OUT" => self.output(line)?,
            "DECL" => return declared(&mut self.source, &mut self.positions).map(|()| true),
            "WAIT" | "HALT" | "INI" | "EXT" | "CONTINUE" => self.aside(line, &upper)?,
            _ if CONTROL.contains(&upper.as_str()) => {
                let wanted = "a move: what branches, loops or interrupts is not read; it";
                return Err(self.source.unexpected(wanted));
            }
            _ if self.source.comes("(") => {
                return Err(self
                    .source
                    .unexpected("a move: subprograms are not read; it"));
            }
            // Of inline forms: PDAT_ACT, FDAT_ACT, LDAT_ACT and the like.
            _ if self.source.comes("=") || self.source.comes("[") => self.aside(line, &upper)?,
            _ => return Err(self.source.unexpected(WANTED)),
        }
        self.source.expect(&[LINE_END])?;
        Ok(true)
    }

    /// Leaves out the rest of the line.
    fn aside(&mut self, line: usize, what: &str) -> Result<(), ProgramError> {
        self.notes.add(line, format!("{what} is left aside"));
        while !self.source.comes(LINE_END) {
            self.source.skip_one(LINE_END)?;
        }
        Ok(())
    }

    fn bas(&mut self, line: usize) -> Result<(), ProgramError> {
        self.source.expect(&["("])?;
        let what = self.source.word("a command of BAS")?.to_uppercase();
        self.source.expect(&[","])?;
        match what.as_str() {
            "#VEL_PTP" | "#PTP_VEL" => self.percent()?,
            "#VEL_CP" => self.speed()?,
            _ => {
                self.notes.add(line, format!("BAS({what}) is left aside"));
                self.source.word("its argument")?;
            }
        }
        self.source.expect(&[")"])
    }

    fn percent(&mut self) -> Result<(), ProgramError> {
        let percent = self.source.number("a speed in percent")?;
        let fits = percent > 0.0 && percent <= 100.0;
        let rule = "above 0 to 100 percent";
        ProgramErrorKind::unless(fits, "the speed", percent, rule).map_err(|k| self.fault(k))?;
        self.share = Some(percent / 100.0);
        Ok(())
    }

    fn speed(&mut self) -> Result<(), ProgramError> {
        let speed = self.source.number("a speed in m/s")?;
        let rule = "above zero, in m/s";
        ProgramErrorKind::unless(speed > 0.0, "the speed", speed, rule)
            .map_err(|k| self.fault(k))?;
        self.speed_m_per_s = Some(speed);
        Ok(())
    }

    fn setting(&mut self, word: &str, line: usize) -> Result<(), ProgramError> {
        self.source.expect(&["="])?;
        match word {
            "$VEL.CP" => self.speed(),
            "$APO.CDIS" => {
                let mm = self.source.number("a distance in mm")?;
                ProgramErrorKind::unless(mm >= 0.0, "$APO.CDIS", mm, "zero or above")
                    .map_err(|k| self.fault(k))?;
                self.zone_m = Some(mm * 1e-3);
                Ok(())
            }
            _ => {
                let all = numbers(&mut self.source)?;
                if let (Some(speed), "$VEL") = (all.get("CP"), word) {
                    self.speed_m_per_s = Some(*speed).filter(|speed| *speed > 0.0);
                } else if let Some(mm) = all.get("CDIS") {
                    self.zone_m = Some(mm * 1e-3);
                } else {
                    self.notes.add(line, format!("{word} is left aside"));
                }
                Ok(())
            }
        }
    }

    fn frame(&mut self, word: &str, line: usize) -> Result<(), ProgramError> {
        self.source.expect(&["="])?;
        let value = if self.source.comes("{") {
            let all = numbers(&mut self.source)?;
            pose(&all).map_err(|kind| self.fault(kind))?
        } else {
            let name = self.source.word("a frame")?.to_uppercase();
            let mut whole = name.clone();
            if self.source.take("[") {
                whole = format!("{name}[{}]", self.source.word("its number")?);
                self.source.expect(&["]"])?;
            }
            match (name.as_str(), self.positions.get(&name)) {
                ("$NULLFRAME", _) => Isometry3::identity(),
                (_, Some(known)) => pose(known).map_err(|kind| self.fault(kind))?,
                _ => {
                    let what = if word == "$TOOL" {
                        "the robot's own tool"
                    } else {
                        "the base given"
                    };
                    self.notes.add(
                        line,
                        format!("{whole} is not in the files; {what} is taken"),
                    );
                    return Ok(());
                }
            }
        };
        let (place, moved) = match word {
            "$TOOL" => (&mut self.head.tool.flange_from_tool, "tool"),
            _ => (&mut self.head.world_from_base, "base"),
        };
        if !self.steps.is_empty() && *place != value {
            let kind = ProgramErrorKind::value(
                format!("the {moved}"),
                "another",
                "that of the moves before: one is read",
            );
            return Err(self.source.error(line, kind));
        }
        *place = value;
        Ok(())
    }

    fn load(&mut self) -> Result<(), ProgramError> {
        let all = numbers(&mut self.source)?;
        let part = |name: &str| all.get(name).copied().unwrap_or_default() * 1e-3;
        let mass_kg = all.get("M").copied().filter(|mass| *mass > 0.0);
        self.head.tool.load = mass_kg.map(|mass_kg| ToolLoad {
            mass_kg,
            centre_m: Vector3::new(part("CM.X"), part("CM.Y"), part("CM.Z")),
        });
        Ok(())
    }

    fn output(&mut self, line: usize) -> Result<(), ProgramError> {
        self.source.expect(&["["])?;
        let number = self.source.word("the output's number")?;
        let number: u32 = whole(number, "the output").map_err(|kind| self.fault(kind))?;
        self.source.expect(&["]", "="])?;
        let on = match self.source.word("TRUE or FALSE")?.to_uppercase().as_str() {
            "TRUE" => true,
            "FALSE" => false,
            _ => return Err(self.source.unexpected("TRUE or FALSE")),
        };
        if Some(number) == self.output {
            let before = self.steps.len();
            self.head.spindle.push(SpindleSwitch { before, on });
        } else {
            self.notes
                .add(line, format!("$OUT[{number}] is left aside"));
        }
        Ok(())
    }
}
