//! From a module's text to its data and moves.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use nalgebra::{Isometry3, Quaternion, Translation3, UnitQuaternion, Vector3};

use super::module::{RapidModule, RapidMove, RobTarget};
use super::text::{Source, Value};
use super::{Confdata, UNUSED_AXIS, check_name, check_zone};
use crate::program::{ProgramError, ProgramErrorKind};

/// By how much the squares of a quaternion's parts may miss 1: four decimals are enough.
const UNIT: f64 = 2e-4;

struct ModuleReader<'a> {
    source: Source<'a>,
    module: RapidModule,
    tool: Option<usize>,
    base: Option<usize>,
}

impl RapidModule {
    /// Reads a module.
    ///
    /// # Errors
    /// At the first piece that is none of those that [`write`](super::write) writes, with names and
    /// layout free, and if targets and moves do not belong together.
    pub fn parse(text: &str, path: &Path) -> Result<Self, ProgramError> {
        let mut reader = ModuleReader {
            source: Source::new(text, path)?,
            module: Self {
                path: path.to_owned(),
                name: String::new(),
                tool_name: String::new(),
                flange_from_tool: Isometry3::identity(),
                tool_mass_kg: 0.0,
                tool_centre_m: Vector3::zeros(),
                base_name: String::new(),
                world_from_base: Isometry3::identity(),
                speeds: BTreeMap::new(),
                targets: BTreeMap::new(),
                moves: Vec::new(),
            },
            tool: None,
            base: None,
        };
        reader.module()?;
        reader.whole()?;
        Ok(reader.module)
    }
}

impl<'a> ModuleReader<'a> {
    fn module(&mut self) -> Result<(), ProgramError> {
        self.source.expect(&["MODULE"])?;
        let name = self.source.word("the module's name")?;
        self.at_last(check_name("the module's name", name))?;
        name.clone_into(&mut self.module.name);
        loop {
            let line = self.source.line();
            match self.source.word("PERS, CONST, PROC or ENDMODULE")? {
                "PERS" | "CONST" => self.declaration(line)?,
                "PROC" => self.procedure()?,
                "ENDMODULE" => break,
                _ => return Err(self.source.unexpected("PERS, CONST, PROC or ENDMODULE")),
            }
        }
        if !self.source.ended() {
            self.source.word("the end of the file")?;
            return Err(self
                .source
                .unexpected("the end of the file, after ENDMODULE,"));
        }
        Ok(())
    }

    /// A fault of the token last taken gets its line.
    fn at_last<T>(&self, result: Result<T, ProgramErrorKind>) -> Result<T, ProgramError> {
        result.map_err(|kind| self.source.error(self.source.line(), kind))
    }

    fn declaration(&mut self, line: usize) -> Result<(), ProgramError> {
        let kind = self.source.word("a type of data")?;
        let kinds = "tooldata, wobjdata, speeddata or robtarget";
        if !["tooldata", "wobjdata", "speeddata", "robtarget"].contains(&kind) {
            return Err(self.source.unexpected(kinds));
        }
        let name = self.source.word("a name")?;
        check_name("the name", name).map_err(|kind| self.source.error(line, kind))?;
        self.source.expect(&[":="])?;
        let value = self.source.value()?;
        self.source.expect(&[";"])?;
        let known = self.known(name);
        let kept = match (known, kind) {
            (Some(first_line), _) => {
                let what = name.to_owned();
                Err(ProgramErrorKind::Twice { what, first_line })
            }
            (None, "tooldata") => self.tool(name, &value, line),
            (None, "wobjdata") => self.base(name, &value, line),
            (None, "speeddata") => self.speed(name, &value, line),
            (None, _) => self.target(name, &value, line),
        };
        kept.map_err(|kind| self.source.error(line, kind))
    }

    /// Line in which a name was declared.
    fn known(&self, name: &str) -> Option<usize> {
        let module = &self.module;
        let tool = self.tool.filter(|_| module.tool_name == name);
        let base = self.base.filter(|_| module.base_name == name);
        let speed = module.speeds.get(name).map(|(_, line)| *line);
        let target = module.targets.get(name).map(|target| target.line);
        tool.or(base).or(speed).or(target)
    }

    fn tool(&mut self, name: &str, value: &Value, line: usize) -> Result<(), ProgramErrorKind> {
        if let Some(first_line) = self.tool {
            let what = "tooldata".to_owned();
            return Err(ProgramErrorKind::Twice { what, first_line });
        }
        let parts = value.parts(name, 3)?;
        truth(name, &parts[0], "TRUE")?;
        let load = parts[2].parts("tload", 6)?;
        self.module.flange_from_tool = frame("tframe", &parts[1])?;
        self.module.tool_mass_kg = load[0].number("mass")?;
        self.module.tool_centre_m = Vector3::from(load[1].numbers::<3>("cog")?) * 1e-3;
        attitude("aom", &load[2])?;
        for moment in &load[3..] {
            moment.number("a moment of inertia")?;
        }
        name.clone_into(&mut self.module.tool_name);
        self.tool = Some(line);
        Ok(())
    }

    fn base(&mut self, name: &str, value: &Value, line: usize) -> Result<(), ProgramErrorKind> {
        if let Some(first_line) = self.base {
            let what = "wobjdata".to_owned();
            return Err(ProgramErrorKind::Twice { what, first_line });
        }
        let parts = value.parts(name, 5)?;
        truth("robhold", &parts[0], "FALSE")?;
        truth("ufprog", &parts[1], "TRUE")?;
        ProgramErrorKind::unless(parts[2] == Value::Text, "ufmec", "no text", "a text")?;
        self.module.world_from_base = frame("uframe", &parts[3])? * frame("oframe", &parts[4])?;
        name.clone_into(&mut self.module.base_name);
        self.base = Some(line);
        Ok(())
    }

    fn speed(&mut self, name: &str, value: &Value, line: usize) -> Result<(), ProgramErrorKind> {
        let [tcp, _, _, _] = value.numbers::<4>(name)?;
        ProgramErrorKind::unless(tcp > 0.0, "v_tcp", tcp, "above zero")?;
        let speed = (tcp * 1e-3, line);
        self.module.speeds.insert(name.to_owned(), speed);
        Ok(())
    }

    fn target(&mut self, name: &str, value: &Value, line: usize) -> Result<(), ProgramErrorKind> {
        let parts = value.parts(name, 4)?;
        let mut quadrants = [0; 4];
        for (quadrant, part) in quadrants.iter_mut().zip(parts[2].parts("robconf", 4)?) {
            let number = part.number("robconf")?;
            let fits = number.fract() == 0.0 && number.abs() <= 100.0;
            ProgramErrorKind::unless(fits, "robconf", number, "a whole number")?;
            *quadrant = number as i32;
        }
        let [cf1, cf4, cf6, cfx] = quadrants;
        let confdata = Confdata { cf1, cf4, cf6, cfx };
        confdata.check()?;
        let axes = parts[3].numbers::<6>("extax")?;
        if let Some(used) = axes[1..].iter().find(|axis| **axis != UNUSED_AXIS) {
            return Err(ProgramErrorKind::value(
                "an external axis after eax_a",
                used,
                "9E+09: a turntable on eax_a is all that is read",
            ));
        }
        let target = RobTarget {
            line,
            base_from_tool: Isometry3::from_parts(
                Translation3::from(Vector3::from(parts[0].numbers::<3>("trans")?) * 1e-3),
                attitude("rot", &parts[1])?,
            ),
            confdata,
            turntable_deg: (axes[0] != UNUSED_AXIS).then_some(axes[0]),
        };
        self.module.targets.insert(name.to_owned(), target);
        Ok(())
    }

    fn procedure(&mut self) -> Result<(), ProgramError> {
        self.source.word("the procedure's name")?;
        self.source.expect(&["(", ")"])?;
        loop {
            let line = self.source.line();
            match self.source.word("MoveJ, MoveL, ConfJ, ConfL or ENDPROC")? {
                "ENDPROC" => return Ok(()),
                "ConfJ" | "ConfL" => self.source.expect(&["\\", "On", ";"])?,
                "MoveL" => self.motion(true, line)?,
                "MoveJ" => self.motion(false, line)?,
                _ => {
                    let wanted = "MoveJ, MoveL, ConfJ, ConfL or ENDPROC";
                    return Err(self.source.unexpected(wanted));
                }
            }
        }
    }

    fn motion(&mut self, linear: bool, line: usize) -> Result<(), ProgramError> {
        let target = self.source.word("a robtarget")?.to_owned();
        self.source.expect(&[","])?;
        let speed = self.source.word("speed data")?.to_owned();
        self.source.expect(&[","])?;
        let zone = self.source.word("a zone")?.to_owned();
        self.source.expect(&[","])?;
        let tool = self.source.word("a tool")?;
        self.source.expect(&["\\", "WObj", ":="])?;
        let base = self.source.word("a work object")?;
        self.source.expect(&[";"])?;
        let module = &self.module;
        let declared = [
            (&*target, module.targets.contains_key(&target)),
            (&*speed, module.speeds.contains_key(&speed)),
            (tool, self.tool.is_some() && module.tool_name == tool),
            (base, self.base.is_some() && module.base_name == base),
        ];
        if let Some((name, _)) = declared.iter().find(|(_, known)| !known) {
            let name = (*name).to_owned();
            let kind = if *name == target {
                ProgramErrorKind::MissingPosition { name }
            } else {
                ProgramErrorKind::value("the name", format!("`{name}`"), "declared in the module")
            };
            return Err(self.source.error(line, kind));
        }
        check_zone(&zone).map_err(|kind| self.source.error(line, kind))?;
        self.module.moves.push(RapidMove {
            line,
            linear,
            target,
            speed,
            zone,
        });
        Ok(())
    }

    fn whole(&self) -> Result<(), ProgramError> {
        let moves = &self.module.moves;
        let used: BTreeSet<&str> = moves.iter().map(|step| step.target.as_str()).collect();
        let unused = |(name, _): &(&String, &RobTarget)| !used.contains(name.as_str());
        let mut targets: Vec<_> = self.module.targets.iter().filter(unused).collect();
        targets.sort_by_key(|(_, target)| target.line);
        targets.first().map_or(Ok(()), |(name, target)| {
            let name = (*name).clone();
            Err(self
                .source
                .error(target.line, ProgramErrorKind::UnusedPosition { name }))
        })
    }
}

fn truth(what: &str, value: &Value, wanted: &str) -> Result<(), ProgramErrorKind> {
    match value {
        Value::Word(word) if word.eq_ignore_ascii_case(wanted) => Ok(()),
        Value::Word(word) => Err(ProgramErrorKind::value(what, word, wanted)),
        _ => Err(ProgramErrorKind::value(what, "no word", wanted)),
    }
}

fn frame(what: &str, value: &Value) -> Result<Isometry3<f64>, ProgramErrorKind> {
    let parts = value.parts(what, 2)?;
    let mm = Vector3::from(parts[0].numbers::<3>(what)?);
    let rotation = attitude(what, &parts[1])?;
    Ok(Isometry3::from_parts(
        Translation3::from(mm * 1e-3),
        rotation,
    ))
}

fn attitude(what: &str, value: &Value) -> Result<UnitQuaternion<f64>, ProgramErrorKind> {
    let [w, x, y, z] = value.numbers::<4>(what)?;
    let quaternion = Quaternion::new(w, x, y, z);
    let square = quaternion.norm_squared();
    let what = format!("the sum of squares of {what}");
    ProgramErrorKind::unless((square - 1.0).abs() <= UNIT, what, square, "1, to 2e-4")?;
    Ok(UnitQuaternion::from_quaternion(quaternion))
}
