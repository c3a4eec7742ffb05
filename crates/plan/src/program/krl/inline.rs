//! Parameters of inline forms: which frames a move has (FDAT), and how its tool turns (LDAT).

use std::collections::BTreeMap;

use super::read::KrlReader;
use crate::program::number::finite;
use crate::program::reading::Goal;
use crate::program::source::{LINE_END, Source};
use crate::program::{ProgramError, ProgramErrorKind};

/// A structure whose components are words: `{TOOL_NO 1,BASE_NO 0,IPO_FRAME #BASE}`.
pub(super) type Words = BTreeMap<String, String>;

/// Types of the structures that are read.
pub(super) const PARAMETERS: [&str; 2] = ["FDAT", "LDAT"];
/// Those that hold for the moves that follow; BAS takes them from here.
pub(super) const ACTUAL: [&str; 2] = ["FDAT_ACT", "LDAT_ACT"];
/// Largest turn of a tool that counts as none, rad.
const SAME_ATTITUDE_RAD: f64 = 1e-4;

/// After the brace, to the closing one; texts and what is nested are left out.
pub(super) fn words(source: &mut Source<'_>) -> Result<Words, ProgramError> {
    let mut all = Words::new();
    let (mut depth, mut name) = (1, None);
    loop {
        if source.take("}") {
            depth -= 1;
            if depth == 0 {
                return Ok(all);
            }
        } else if source.take("{") {
            depth += 1;
        } else if source.take(",") || source.take(":") {
            name = None;
        } else if let Some(word) = source.take_word() {
            match (depth, name.take()) {
                (1, None) => name = Some(word.to_uppercase()),
                (1, Some(name)) => drop(all.insert(name, word.to_uppercase())),
                _ => {}
            }
        } else if source.comes(LINE_END) {
            source.expect(&["}"])?;
        } else {
            source.skip_one("`}`")?;
        }
    }
}

impl KrlReader<'_> {
    /// `FDAT_ACT=FP1` or `FDAT_ACT={TOOL_NO 1,…}`.
    pub(super) fn actual(&mut self, name: &str, line: usize) -> Result<(), ProgramError> {
        self.source.expect(&["="])?;
        let given = if self.source.take("{") {
            Some(words(&mut self.source)?)
        } else {
            let other = self.source.word("parameters")?.to_uppercase();
            self.known(&other, line)
        };
        match given {
            Some(given) => self.declared.parameters.insert(name.to_owned(), given),
            None => self.declared.parameters.remove(name),
        };
        Ok(())
    }

    fn known(&mut self, name: &str, line: usize) -> Option<Words> {
        let known = self.declared.parameters.get(name).cloned();
        if known.is_none() {
            let text = format!("{name} is not in the files: frames stay as they are");
            self.notes.add(line, text);
        }
        known
    }

    /// What BAS takes from the parameters: the frames, and for lines how the tool turns and the
    /// zone.
    pub(super) fn take_actual(&mut self, lines: bool, line: usize) -> Result<(), ProgramError> {
        if let Some(frames) = self.declared.parameters.get("FDAT_ACT").cloned() {
            self.take_part(&frames, "IPO_FRAME", line)?;
            self.take_part(&frames, "TOOL_NO", line)?;
            self.take_part(&frames, "BASE_NO", line)?;
        }
        if let (true, Some(way)) = (lines, self.declared.parameters.get("LDAT_ACT").cloned()) {
            self.take_part(&way, "ORI_TYP", line)?;
            if let Some(distance) = way.get("APO_DIST") {
                let mm = finite(distance, "APO_DIST").map_err(|kind| self.fault(kind))?;
                self.zone_m = Some(mm.max(0.0) * 1e-3);
            }
        }
        Ok(())
    }

    /// One component, if the structure has it.
    fn take_part(&mut self, all: &Words, part: &str, line: usize) -> Result<(), ProgramError> {
        let Some(value) = all.get(part).cloned() else {
            return Ok(());
        };
        match part {
            "TOOL_NO" => self.select("$TOOL", &format!("TOOL_DATA[{value}]"), line),
            "BASE_NO" => self.select("$BASE", &format!("BASE_DATA[{value}]"), line),
            "ORI_TYP" => self.turns("ORI_TYP", &value, line),
            _ => self.guides("IPO_FRAME", &value, line),
        }
    }

    /// After WITH, the functions that take a part of the parameters: `STOOL2(FP1)`,
    /// `SBASE(FP1.BASE_NO)`. Whether the word is one of them.
    pub(super) fn with_part(&mut self, word: &str, line: usize) -> Result<bool, ProgramError> {
        let part = match word {
            "STOOL" | "STOOL2" => "TOOL_NO",
            "SBASE" => "BASE_NO",
            "SIPO_MODE" => "IPO_FRAME",
            "SORI_TYP" => "ORI_TYP",
            _ => return Ok(false),
        };
        self.source.expect(&["("])?;
        let name = self.source.word("parameters")?.to_uppercase();
        let name = name.split('.').next().unwrap_or_default();
        if let Some(all) = self.known(name, line) {
            self.take_part(&all, part, line)?;
        }
        self.source.expect(&[")"])?;
        Ok(true)
    }

    /// `$IPO_MODE` and what sets it: #BASE for a tool at the flange.
    pub(super) fn guides(
        &mut self,
        name: &str,
        value: &str,
        line: usize,
    ) -> Result<(), ProgramError> {
        if value == "#BASE" {
            return Ok(());
        }
        let why = "a tool that stands in the cell, with the workpiece at the flange";
        let kind = ProgramErrorKind::not_read(&format!("{name} {value}"), why);
        Err(self.source.error(line, kind))
    }

    /// `$ORI_TYPE` and what sets it: how the tool turns on a line.
    pub(super) fn turns(
        &mut self,
        name: &str,
        value: &str,
        line: usize,
    ) -> Result<(), ProgramError> {
        self.keeps_attitude = value == "#CONSTANT";
        if value == "#JOINT" {
            let text = format!(
                "{name} {value}: the wrist turns by its joints on lines; here the tool turns evenly"
            );
            self.notes.add(line, text);
        } else if !matches!(value, "#VAR" | "#CONSTANT") {
            self.notes
                .add(line, format!("{name} {value} is left aside"));
        }
        Ok(())
    }

    /// On a line with #CONSTANT the tool keeps the attitude that it has at the start: that of the
    /// end must be the same one.
    pub(super) fn check_attitude(&self, goal: &Goal, line: usize) -> Result<(), ProgramError> {
        let Goal::Pose(end, _) = goal else {
            return Ok(());
        };
        let start = self.steps.last().map(|step| &step.goal);
        let turn_rad = match start {
            Some(Goal::Pose(start, _)) => start.rotation.angle_to(&end.rotation),
            _ => f64::INFINITY,
        };
        if !self.keeps_attitude || turn_rad <= SAME_ATTITUDE_RAD {
            return Ok(());
        }
        let why = "a line on which the tool keeps its attitude, and its end has another";
        let kind = ProgramErrorKind::not_read("$ORI_TYPE #CONSTANT", why);
        Err(self.source.error(line, kind))
    }
}
