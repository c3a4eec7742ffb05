//! A module run through: calls followed, data looked up.

use std::collections::BTreeSet;

use nalgebra::{Isometry3, Translation3, UnitQuaternion};

use super::data::{Datum, Target, joints, speed, target, zone};
use super::module::{RapidGoal, RapidModule, RapidMove};
use super::read::{Instruction, ModuleReader, MoveText, Place, Verb};
use crate::program::source::Value;
use crate::program::{ProgramError, ProgramErrorKind};

/// How deep procedures may call one another.
const CALL_DEPTH: usize = 16;

/// The module while it is run through.
pub(super) struct Runner<'a> {
    reader: &'a ModuleReader<'a>,
    pub module: RapidModule,
    tool: Option<String>,
    base: Option<Isometry3<f64>>,
    pub used: BTreeSet<String>,
    /// Configurations are kept to: by joints, on lines.
    supervised: [bool; 2],
}

impl<'a> Runner<'a> {
    pub fn new(reader: &'a ModuleReader<'a>, name: String) -> Self {
        Self {
            reader,
            module: RapidModule {
                path: reader.path.to_owned(),
                name,
                tool_name: "tool0".to_owned(),
                flange_from_tool: Isometry3::identity(),
                tool_load: None,
                world_from_base: Isometry3::identity(),
                moves: Vec::new(),
                outputs: Vec::new(),
                notes: Vec::new(),
            },
            tool: None,
            base: None,
            used: BTreeSet::new(),
            supervised: [true, true],
        }
    }

    /// Whether the program goes on behind it.
    pub fn run(
        &mut self,
        body: &[(Instruction<'a>, usize)],
        depth: usize,
    ) -> Result<bool, ProgramError> {
        for (instruction, line) in body {
            let done = match instruction {
                Instruction::Move(text) => self.motion(text, *line),
                Instruction::Supervise { lines, on } => {
                    self.supervised[usize::from(*lines)] = *on;
                    Ok(())
                }
                Instruction::Output(signal, on) => {
                    let before = self.module.moves.len();
                    self.module
                        .outputs
                        .push((before, (*signal).to_owned(), *on));
                    Ok(())
                }
                Instruction::Return => return Ok(true),
                Instruction::Exit => return Ok(false),
                Instruction::Call(name) => {
                    let called = |(known, _): &&(&str, _)| known.eq_ignore_ascii_case(name);
                    match self.reader.procedures.iter().find(called) {
                        None => {
                            let why = "a procedure that is not in the module";
                            Err(ProgramErrorKind::not_read(name, why))
                        }
                        Some(_) if depth == CALL_DEPTH => {
                            let rule = format!("at most {CALL_DEPTH}");
                            Err(ProgramErrorKind::value(
                                "the depth of calls",
                                depth + 1,
                                rule,
                            ))
                        }
                        Some((_, body)) => {
                            if !self.run(body, depth + 1)? {
                                return Ok(false);
                            }
                            Ok(())
                        }
                    }
                }
            };
            done.map_err(|kind| ProgramError::in_file(self.reader.path, *line, kind))?;
        }
        Ok(true)
    }

    fn motion(&mut self, text: &MoveText<'a>, line: usize) -> Result<(), ProgramErrorKind> {
        ProgramErrorKind::unless_too_many(self.module.moves.len() + 1)?;
        self.take_tool(text.tool)?;
        let base_from_wobj = self.take_base(text.base)?;
        let data = &self.reader.data;
        let speed_m_per_s = match (&text.own_speed, &text.speed) {
            (Some(own), _) => {
                let mm_per_s = data.number(own, "V")?;
                ProgramErrorKind::unless(mm_per_s > 0.0, "V", mm_per_s, "above zero")?;
                mm_per_s * 1e-3
            }
            (None, Value::Word(name)) => match data.find(name) {
                Some(Datum::Speed(speed)) => speed,
                _ => return Err(undeclared(name)),
            },
            (None, value) => speed("speed data", value)?,
        };
        let zone = match &text.zone {
            Value::Word(name) => match data.find(name) {
                Some(Datum::Zone(zone)) => zone,
                _ => return Err(super::unknown_zone(name)),
            },
            value => zone("zone data", value)?,
        };
        let linear = matches!(text.verb, Verb::Linear | Verb::Circular);
        let mut step = RapidMove {
            line,
            target: String::new(),
            goal: RapidGoal::Joints([0.0; 6]),
            via: None,
            linear,
            speed_m_per_s,
            zone,
            turntable_deg: None,
        };
        if let (Verb::Absolute, Place::Value(value)) = (text.verb, &text.to) {
            let (joints, turntable) = match value {
                Value::Word(name) => match data.find(name) {
                    Some(Datum::Joints(joints, turntable)) => (joints, turntable),
                    _ => return Err(undeclared(name)),
                },
                value => joints("a jointtarget", value)?,
            };
            (step.goal, step.turntable_deg) = (RapidGoal::Joints(joints), turntable);
        } else {
            let (name, found) = self.target(&text.to)?;
            step.turntable_deg = found.turntable_deg;
            step.goal = RapidGoal::Target {
                base_from_tool: base_from_wobj * found.pose,
                confdata: self.supervised[usize::from(linear)].then_some(found.confdata),
            };
            step.target = name;
            if let Some(via) = &text.via {
                step.via = Some(base_from_wobj * self.target(via)?.1.pose);
            }
        }
        self.module.moves.push(step);
        Ok(())
    }

    fn target(&mut self, place: &Place<'a>) -> Result<(String, Target), ProgramErrorKind> {
        let data = &self.reader.data;
        let (name, shift, turn) = match place {
            Place::Value(Value::Word(name)) => (*name, None, None),
            Place::Value(value) => return Ok((String::new(), target("robtarget", value)?)),
            Place::Offs(name, parts) => (*name, Some(parts), None),
            Place::RelTool(name, parts, turns) => (*name, Some(parts), Some(turns)),
        };
        let Some(Datum::Target(mut found)) = data.find(name) else {
            let name = name.to_owned();
            return Err(ProgramErrorKind::MissingPosition { name });
        };
        self.used.insert(name.to_lowercase());
        let Some(parts) = shift else {
            return Ok((name.to_owned(), found));
        };
        let mut mm = [0.0; 3];
        for (mm, part) in mm.iter_mut().zip(parts) {
            *mm = data.number(part, "an offset")?;
        }
        let shift = Translation3::from(mm.map(|mm| mm * 1e-3));
        found.pose = match turn {
            None => shift * found.pose,
            Some(turns) => {
                let mut deg = [0.0; 3];
                for (deg, turn) in deg.iter_mut().zip(turns) {
                    if let Some(turn) = turn {
                        *deg = data.number(turn, "a turn")?;
                    }
                }
                let [rx, ry, rz] = deg.map(f64::to_radians);
                // About the axes as they have turned: x, then y, then z.
                let turn = |x, y, z| UnitQuaternion::from_euler_angles(x, y, z);
                let turn = turn(rx, 0.0, 0.0) * turn(0.0, ry, 0.0) * turn(0.0, 0.0, rz);
                found.pose * Isometry3::from_parts(shift, turn)
            }
        };
        Ok((String::new(), found))
    }

    /// The program's tool: one, since a program is run through with one.
    fn take_tool(&mut self, name: &str) -> Result<(), ProgramErrorKind> {
        if self
            .tool
            .as_deref()
            .is_some_and(|tool| tool.eq_ignore_ascii_case(name))
        {
            return Ok(());
        }
        let Some(Datum::Tool(found)) = self.reader.data.find(name) else {
            return Err(undeclared(name));
        };
        if let Some(first) = &self.tool {
            let rule = format!("`{first}`, as in the moves before: one tool is read");
            return Err(ProgramErrorKind::value(
                "the tool",
                format!("`{name}`"),
                rule,
            ));
        }
        self.tool = Some(name.to_owned());
        name.clone_into(&mut self.module.tool_name);
        self.module.flange_from_tool = found.flange_from_tool;
        self.module.tool_load = Some(found.load);
        Ok(())
    }

    /// From the work object of the first move to this one.
    fn take_base(&mut self, name: &str) -> Result<Isometry3<f64>, ProgramErrorKind> {
        let Some(Datum::Base(found)) = self.reader.data.find(name) else {
            return Err(undeclared(name));
        };
        let first = *self.base.get_or_insert(found);
        self.module.world_from_base = first;
        Ok(if first == found {
            Isometry3::identity()
        } else {
            first.inverse() * found
        })
    }
}

fn undeclared(name: &str) -> ProgramErrorKind {
    let rule = "declared in the module, as what stands here";
    ProgramErrorKind::value("the name", format!("`{name}`"), rule)
}
