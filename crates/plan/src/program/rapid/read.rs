//! From a module's text to its moves.

use std::collections::BTreeMap;
use std::path::Path;

use super::data::{Data, Datum, datum};
use super::module::RapidModule;
use super::run::Runner;
use super::{SYNTAX, check_name};
use crate::program::reading::Notes;
use crate::program::source::{Source, Value};
use crate::program::{ProgramError, ProgramErrorKind};

/// Instructions that move nothing; they are left aside with a note.
const IDLE: &[&str] = &[
    "accset",
    "actunit",
    "clkreset",
    "clkstart",
    "clkstop",
    "deactunit",
    "gripload",
    "invertdo",
    "pulsedo",
    "setao",
    "setgo",
    "singarea",
    "stop",
    "tperase",
    "tpwrite",
    "velset",
    "waitdi",
    "waitdo",
    "waitrob",
    "waittime",
    "waituntil",
];
/// What steers the program: what it leads to is not known before it runs.
const CONTROL: &[&str] = &[
    "if", "for", "while", "test", "goto", "error", "undo", "backward",
];
const WANTED: &str = "MoveJ, MoveL, MoveC, MoveAbsJ, ConfJ, ConfL, SetDO, a call or ENDPROC";

/// A place as a move names it.
pub(super) enum Place<'a> {
    Value(Value<'a>),
    /// In the work object: x, y, z.
    Offs(&'a str, Vec<Value<'a>>),
    /// In the tool: x, y, z, and turns about its axes.
    RelTool(&'a str, Vec<Value<'a>>, [Option<Value<'a>>; 3]),
}

pub(super) struct MoveText<'a> {
    pub verb: Verb,
    pub via: Option<Place<'a>>,
    pub to: Place<'a>,
    pub speed: Value<'a>,
    /// `\V`, mm/s.
    pub own_speed: Option<Value<'a>>,
    pub zone: Value<'a>,
    pub tool: &'a str,
    pub base: &'a str,
}

#[derive(Clone, Copy, PartialEq)]
pub(super) enum Verb {
    Joint,
    Linear,
    Circular,
    Absolute,
}

pub(super) enum Instruction<'a> {
    Move(Box<MoveText<'a>>),
    /// Whether lines and circles (else moves by joints) keep to configurations.
    Supervise {
        lines: bool,
        on: bool,
    },
    Output(&'a str, bool),
    Call(&'a str),
    /// To the procedure that called this one.
    Return,
    /// The end of the program.
    Exit,
}

pub(super) struct ModuleReader<'a> {
    source: Source<'a>,
    pub path: &'a Path,
    pub data: Data,
    targets: BTreeMap<String, usize>,
    /// How many moves all procedures hold.
    moves: usize,
    pub procedures: Vec<(&'a str, Vec<(Instruction<'a>, usize)>)>,
    notes: Notes,
}

impl RapidModule {
    /// Reads a module and runs it through from `main`, or from its first procedure.
    ///
    /// # Errors
    /// At the first piece that is not understood, and at data that are not there.
    pub fn parse(text: &str, path: &Path) -> Result<Self, ProgramError> {
        let text = &without_head(text);
        let mut reader = ModuleReader {
            source: Source::new(text, path, &SYNTAX),
            path,
            data: Data::default(),
            targets: BTreeMap::new(),
            moves: 0,
            procedures: Vec::new(),
            notes: Notes::default(),
        };
        let name = reader.module()?;
        let mut notes = std::mem::take(&mut reader.notes);
        let mut runner = Runner::new(&reader, name);
        let main = |(name, _): &&(&str, _)| name.eq_ignore_ascii_case("main");
        let procedures = &reader.procedures;
        if let Some((_, body)) = procedures.iter().find(main).or_else(|| procedures.first()) {
            runner.run(body, 0)?;
        }
        for (name, line) in &reader.targets {
            if !runner.used.contains(name) {
                notes.add(*line, "no move goes to a target that is declared");
            }
        }
        Ok(Self {
            notes: notes.texts(),
            ..runner.module
        })
    }
}

/// The text with the head of older controllers (`%%% VERSION … %%%`) blanked, its lines kept.
fn without_head(text: &str) -> String {
    let head = text.trim_start().strip_prefix("%%%");
    let end = head.and_then(|rest| Some(text.len() - rest.len() + rest.find("%%%")? + 3));
    let (head, rest) = text.split_at(end.unwrap_or(0));
    let blank: String = head.chars().filter(|c| *c == '\n').collect();
    blank + rest
}

impl<'a> ModuleReader<'a> {
    fn module(&mut self) -> Result<String, ProgramError> {
        self.source.expect(&["MODULE"])?;
        let name = self.source.word("the module's name")?.to_owned();
        let checked = check_name("the module's name", &name);
        checked.map_err(|kind| self.source.error(self.source.line(), kind))?;
        if self.source.take("(") {
            self.source.skip_past(")")?;
        }
        let wanted = "PERS, CONST, VAR, PROC or ENDMODULE";
        loop {
            let line = self.source.line();
            match self.source.word(wanted)?.to_uppercase().as_str() {
                "LOCAL" | "TASK" => {}
                "PERS" | "CONST" | "VAR" => self.declaration(line)?,
                "PROC" => self.procedure()?,
                "ENDMODULE" => break,
                _ => return Err(self.source.unexpected(wanted)),
            }
        }
        if !self.source.ended() {
            self.source.word("the end of the file")?;
            return Err(self
                .source
                .unexpected("the end of the file, after ENDMODULE,"));
        }
        Ok(name)
    }

    fn declaration(&mut self, line: usize) -> Result<(), ProgramError> {
        let kind = self.source.word("a type of data")?;
        let name = self.source.word("a name")?;
        let checked = check_name("the name", name);
        checked.map_err(|kind| self.source.error(line, kind))?;
        if !self.source.take(":=") {
            // Without a value, or an array.
            self.notes
                .add(line, format!("{kind} without a single value is left aside"));
            return self.source.skip_past(";");
        }
        let value = self.source.value()?;
        self.source.expect(&[";"])?;
        let read = datum(kind, name, &value).and_then(|datum| match datum {
            Some(datum) => {
                if let Datum::Target(_) = datum {
                    ProgramErrorKind::unless_too_many(self.targets.len() + 1)?;
                    self.targets.insert(name.to_lowercase(), line);
                }
                self.data.insert(name, datum, line)
            }
            None => {
                self.notes
                    .add(line, format!("data of the type {kind} are left aside"));
                Ok(())
            }
        });
        read.map_err(|kind| self.source.error(line, kind))
    }

    fn procedure(&mut self) -> Result<(), ProgramError> {
        let name = self.source.word("the procedure's name")?;
        self.source.expect(&["(", ")"])?;
        let mut body = Vec::new();
        loop {
            let line = self.source.line();
            let word = self.source.word(WANTED)?;
            let instruction = match word.to_lowercase().as_str() {
                "endproc" => break,
                "movej" => self.motion(Verb::Joint)?,
                "movel" => self.motion(Verb::Linear)?,
                "movec" => self.motion(Verb::Circular)?,
                "moveabsj" => self.motion(Verb::Absolute)?,
                verb @ ("confj" | "confl") => {
                    self.source.expect(&["\\"])?;
                    let on = self.source.word("On or Off")?;
                    let on = match on.to_lowercase().as_str() {
                        "on" => true,
                        "off" => false,
                        _ => return Err(self.source.unexpected("On or Off")),
                    };
                    self.source.expect(&[";"])?;
                    let lines = verb == "confl";
                    Instruction::Supervise { lines, on }
                }
                "setdo" => {
                    let signal = self.source.word("a signal")?;
                    self.source.expect(&[","])?;
                    let on = self.level()?;
                    self.source.expect(&[";"])?;
                    Instruction::Output(signal, on)
                }
                verb @ ("set" | "reset") => {
                    let signal = self.source.word("a signal")?;
                    self.source.expect(&[";"])?;
                    Instruction::Output(signal, verb == "set")
                }
                control if CONTROL.contains(&control) => {
                    let kind = ProgramErrorKind::not_read(word, "what branches or loops");
                    return Err(self.source.error(line, kind));
                }
                end @ ("return" | "exit") => {
                    self.source.expect(&[";"])?;
                    match end {
                        "return" => Instruction::Return,
                        _ => Instruction::Exit,
                    }
                }
                idle if IDLE.contains(&idle) => {
                    self.notes.add(line, format!("{word} is left aside"));
                    self.source.skip_past(";")?;
                    continue;
                }
                _ if self.source.take(";") => Instruction::Call(word),
                _ => return Err(self.source.unexpected(WANTED)),
            };
            self.moves += usize::from(matches!(instruction, Instruction::Move(_)));
            ProgramErrorKind::unless_too_many(self.moves)
                .map_err(|kind| self.source.error(line, kind))?;
            body.push((instruction, line));
        }
        self.procedures.push((name, body));
        Ok(())
    }

    /// What a signal is set to: a number, or one of the language's names for it.
    fn level(&mut self) -> Result<bool, ProgramError> {
        for (name, on) in [("high", true), ("low", false)] {
            if self.source.take(name) {
                return Ok(on);
            }
        }
        Ok(self.source.number("the signal's value, high or low")? != 0.0)
    }

    fn motion(&mut self, verb: Verb) -> Result<Instruction<'a>, ProgramError> {
        let via = match verb {
            Verb::Circular => {
                let via = self.place()?;
                self.source.expect(&[","])?;
                Some(via)
            }
            _ => None,
        };
        let to = self.place()?;
        if verb == Verb::Absolute && self.source.take("\\") {
            self.source.expect(&["NoEOffs"])?;
        }
        self.source.expect(&[","])?;
        let speed = self.source.value()?;
        let own_speed = match self.source.take("\\") {
            true => {
                self.source.expect(&["V", ":="])?;
                Some(self.source.value()?)
            }
            false => None,
        };
        self.source.expect(&[","])?;
        let zone = self.source.value()?;
        if self.source.take("\\") {
            // How near the axes must be where the arm stops.
            let line = self.source.line();
            self.source.expect(&["Inpos", ":="])?;
            self.source.value()?;
            self.notes.add(line, "\\Inpos is left aside");
        }
        self.source.expect(&[","])?;
        let tool = self.source.word("a tool")?;
        let mut base = "wobj0";
        // A comma may stand before an optional argument.
        while self.source.comes("\\") || self.source.comes(",") {
            self.source.take(",");
            self.source.expect(&["\\"])?;
            let line = self.source.line();
            let which = self.source.word("WObj or TLoad")?;
            self.source.expect(&[":="])?;
            let value = self.source.word("its name")?;
            match which.to_lowercase().as_str() {
                "wobj" => base = value,
                "tload" => self.notes.add(line, "\\TLoad is left aside"),
                _ => return Err(self.source.unexpected("WObj or TLoad")),
            }
        }
        self.source.expect(&[";"])?;
        Ok(Instruction::Move(Box::new(MoveText {
            verb,
            via,
            to,
            speed,
            own_speed,
            zone,
            tool,
            base,
        })))
    }

    fn place(&mut self) -> Result<Place<'a>, ProgramError> {
        let value = self.source.value()?;
        let Value::Word(function) = value else {
            return Ok(Place::Value(value));
        };
        if !self.source.take("(") {
            return Ok(Place::Value(value));
        }
        let relative = function.eq_ignore_ascii_case("RelTool");
        if !relative && !function.eq_ignore_ascii_case("Offs") {
            return Err(self.source.unexpected("`(` after Offs or RelTool"));
        }
        let name = self.source.word("a robtarget")?;
        let mut parts = Vec::new();
        for _ in 0..3 {
            self.source.expect(&[","])?;
            parts.push(self.source.value()?);
        }
        let mut turns = [None, None, None];
        while relative && self.source.take("\\") {
            let axis = self.source.word("Rx, Ry or Rz")?;
            let known = ["Rx", "Ry", "Rz"]
                .iter()
                .position(|n| n.eq_ignore_ascii_case(axis));
            let Some(k) = known else {
                return Err(self.source.unexpected("Rx, Ry or Rz"));
            };
            self.source.expect(&[":="])?;
            turns[k] = Some(self.source.value()?);
        }
        self.source.expect(&[")"])?;
        Ok(if relative {
            Place::RelTool(name, parts, turns)
        } else {
            Place::Offs(name, parts)
        })
    }
}
