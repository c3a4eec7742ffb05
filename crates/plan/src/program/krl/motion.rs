//! Moves of KRL.

use nalgebra::{Isometry3, Vector3};

use super::StatusTurn;
use super::read::KrlReader;
use super::structures::{Numbers, bits, numbers, place, pose};
use crate::program::flags::Flags;
use crate::program::reading::{Goal, Step};
use crate::program::source::LINE_END;
use crate::program::{Motion, ProgramError, ProgramErrorKind, Zone};

/// What stands behind the target of a move.
#[derive(Default)]
struct Endings {
    passes: bool,
    /// Of this move alone.
    speed_m_per_s: Option<f64>,
    share: Option<f64>,
    /// Whether a move by so much is one along the tool's axes.
    in_tool: bool,
}

/// Where a move goes.
struct Target {
    name: String,
    numbers: Numbers,
    /// A place that a circle goes through.
    via: Option<Isometry3<f64>>,
}

/// What positions are given in.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Kind {
    Axes,
    Pose,
}

const AXES: [&str; 6] = ["A1", "A2", "A3", "A4", "A5", "A6"];
const POSE: [&str; 6] = ["X", "Y", "Z", "A", "B", "C"];

/// `None` of a position that holds further axes alone.
fn kind_of(numbers: &Numbers) -> Option<Kind> {
    let holds = |names: &[&str]| names.iter().any(|name| numbers.contains_key(*name));
    if holds(&AXES) {
        return Some(Kind::Axes);
    }
    holds(&POSE).then_some(Kind::Pose)
}

impl KrlReader<'_> {
    fn target(&mut self) -> Result<(String, Numbers), ProgramError> {
        if self.source.comes("{") {
            return Ok((String::new(), numbers(&mut self.source)?));
        }
        let name = self.source.word("a position")?.to_uppercase();
        match self.declared.places.get(&name) {
            Some(known) => Ok((name, known.clone())),
            None => Err(self.unknown_place(&name)),
        }
    }

    pub(super) fn motion(&mut self, verb: &str, line: usize) -> Result<(), ProgramError> {
        let actual = ["$POS_ACT", "$AXIS_ACT"];
        if let Some(here) = actual.into_iter().find(|name| self.source.comes(name)) {
            // To where the arm stands: so programs begin, to be carried there slowly.
            return self.aside(line, &format!("{verb} {here}"));
        }
        let mut via = None;
        if verb == "CIRC" {
            let (_, numbers) = self.target()?;
            let numbers = self.completed(numbers);
            via = Some(place(&numbers).map_err(|kind| self.fault(kind))?);
            self.source.expect(&[","])?;
        }
        let (name, numbers) = self.target()?;
        let numbers = self.completed(numbers);
        if self.source.comes(",") {
            return Err(self.source.error(
                line,
                ProgramErrorKind::unexpected("an angle CA", "the end of the circle"),
            ));
        }
        let endings = self.endings(line, false)?;
        let target = Target { name, numbers, via };
        self.step(verb, line, target, &endings)
    }

    /// `LIN_REL {Z 20}`: along a line, by so much in the base frame, or with #TOOL in the tool's.
    pub(super) fn relative(&mut self, verb: &str, line: usize) -> Result<(), ProgramError> {
        let (_, by) = self.target()?;
        let turned = by
            .iter()
            .find(|(part, by)| !"XYZ".contains(part.as_str()) && **by != 0.0);
        if let Some((part, _)) = turned {
            let why = "a turn, or a further axis, from where the arm stands";
            let kind = ProgramErrorKind::not_read(&format!("{part} of {verb}"), why);
            return Err(self.source.error(line, kind));
        }
        let known = self
            .last
            .clone()
            .filter(|last| kind_of(last) == Some(Kind::Pose));
        let Some(mut numbers) = known else {
            let why =
                "a move from where the arm stands, and no position in X to C stands before it";
            return Err(self
                .source
                .error(line, ProgramErrorKind::not_read(verb, why)));
        };
        let endings = self.endings(line, true)?;
        let part = |name: &str| by.get(name).copied().unwrap_or_default();
        let mut by = Vector3::new(part("X"), part("Y"), part("Z"));
        if endings.in_tool {
            by = pose(&numbers).map_err(|kind| self.fault(kind))?.rotation * by;
        }
        for (part, by) in ["X", "Y", "Z"].into_iter().zip(by.iter()) {
            *numbers.entry(part.to_owned()).or_default() += by;
        }
        // It turns no joint the long way round: the posture is the one next to that before.
        numbers.remove("S");
        let target = Target {
            name: String::new(),
            numbers,
            via: None,
        };
        self.step("LIN", line, target, &endings)
    }

    /// What a position leaves out is that of the point before.
    fn completed(&self, mut target: Numbers) -> Numbers {
        let Some(last) = &self.last else {
            return target;
        };
        let kind = kind_of(last);
        if kind_of(&target).is_some_and(|own| kind != Some(own)) {
            return target;
        }
        let parts = match kind {
            Some(Kind::Axes) => &AXES,
            _ => &POSE,
        };
        for part in parts {
            if let Some(value) = last.get(*part) {
                target.entry((*part).to_owned()).or_insert(*value);
            }
        }
        target
    }

    fn step(
        &mut self,
        verb: &str,
        line: usize,
        target: Target,
        endings: &Endings,
    ) -> Result<(), ProgramError> {
        let share = endings.share.or(self.share);
        let speed_m_per_s = endings.speed_m_per_s.or(self.speed_m_per_s);
        let motion = match (verb, share, speed_m_per_s) {
            // What BAS sets when a program starts.
            ("PTP", share, _) => Motion::Joint {
                share: share.unwrap_or(1.0),
            },
            (_, _, Some(speed_m_per_s)) => Motion::Linear { speed_m_per_s },
            _ => {
                let kind = ProgramErrorKind::unexpected(verb, "$VEL.CP, before any line,");
                return Err(self.source.error(line, kind));
            }
        };
        let Target { name, numbers, via } = target;
        let goal = self.goal(&numbers).map_err(|kind| self.fault(kind))?;
        if verb != "PTP" {
            self.check_attitude(&goal, line)?;
        }
        self.further_axes(&numbers, line)?;
        ProgramErrorKind::unless_too_many(self.steps.len() + 1)
            .map_err(|kind| self.source.error(line, kind))?;
        self.steps.push(Step {
            line,
            path_point: name.strip_prefix("XP").and_then(|n| n.parse().ok()),
            goal,
            via,
            with_tangent: false,
            motion,
            zone: match (endings.passes, self.zone_m) {
                (false, _) => Zone::Stop,
                (true, Some(zone_m)) if zone_m > 0.0 => Zone::Within(zone_m),
                (true, _) => Zone::Unstated,
            },
            turntable_rad: numbers.get("E1").map(|deg| deg.to_radians()),
        });
        self.last = Some(numbers);
        Ok(())
    }

    /// Of the further axes E1 is read, as a turntable.
    fn further_axes(&mut self, target: &Numbers, line: usize) -> Result<(), ProgramError> {
        for axis in ["E2", "E3", "E4", "E5", "E6"] {
            let value = target.get(axis).copied().unwrap_or_default();
            let rule = "0: of further axes a turntable is read, as E1";
            ProgramErrorKind::unless(value == 0.0, axis, value, rule)
                .map_err(|kind| self.source.error(line, kind))?;
        }
        if target.get("E1").is_some_and(|value| *value != 0.0) {
            let text = "E1 is read as a turntable in degrees; a track in mm is not read";
            self.notes.add(line, text);
        }
        Ok(())
    }

    /// What stands behind the target, to the end of the line.
    fn endings(&mut self, line: usize, is_relative: bool) -> Result<Endings, ProgramError> {
        let wanted = "C_DIS, C_PTP, WITH or the end of the line";
        let mut found = Endings::default();
        while !self.source.comes(LINE_END) {
            match self.source.word(wanted)?.to_uppercase().as_str() {
                "#BASE" if is_relative => found.in_tool = false,
                "#TOOL" if is_relative => found.in_tool = true,
                "C_DIS" | "C_PTP" | "C_VEL" | "C_ORI" | "C_SPL" => found.passes = true,
                "WITH" => self.with(&mut found, line)?,
                _ => return Err(self.source.unexpected(wanted)),
            }
        }
        Ok(found)
    }

    /// What a spline's move sets for itself, up to its zone: of that the speed, the frames and how
    /// the tool turns are read.
    fn with(&mut self, found: &mut Endings, line: usize) -> Result<(), ProgramError> {
        self.notes.add(
            line,
            "WITH is left aside but for its speed, frames and attitude",
        );
        while !(self.source.comes("C_SPL") || self.source.comes(LINE_END)) {
            let word = self.source.take_word().unwrap_or_default().to_uppercase();
            if self.with_part(&word, line)? || self.with_frame(&word, line)? {
                continue;
            }
            let is_named = match word.as_str() {
                "SVEL_CP" | "SVEL_JOINT" => self.source.take("("),
                "$VEL.CP" => self.source.take("="),
                "" => {
                    self.source.skip_one(LINE_END)?;
                    false
                }
                _ => false,
            };
            if is_named && word == "SVEL_JOINT" {
                found.share = Some(self.percentage()?);
            } else if is_named && !self.source.comes("SVEL_CP") {
                found.speed_m_per_s = Some(self.pace()?);
            }
        }
        Ok(())
    }

    /// A frame or a mode that WITH gives by itself; what functions give comes after.
    fn with_frame(&mut self, word: &str, line: usize) -> Result<bool, ProgramError> {
        if !matches!(word, "$TOOL" | "$BASE" | "$IPO_MODE" | "$ORI_TYPE") {
            return Ok(false);
        }
        self.source.expect(&["="])?;
        let functions = ["STOOL", "STOOL2", "SBASE", "SIPO_MODE", "SORI_TYP"];
        if functions.iter().any(|name| self.source.comes(name)) {
            return Ok(true);
        }
        if matches!(word, "$TOOL" | "$BASE") {
            if self.source.comes("EK") {
                let why = "a base that another kinematic system moves";
                return Err(self.fault(ProgramErrorKind::not_read("EK", why)));
            }
            self.frame_value(word, line)?;
            return Ok(true);
        }
        let value = self.source.word("a word that begins by #")?.to_uppercase();
        match word {
            "$IPO_MODE" => self.guides(word, &value, line)?,
            _ => self.turns(word, &value, line)?,
        }
        Ok(true)
    }

    fn goal(&self, target: &Numbers) -> Result<Goal, ProgramErrorKind> {
        if kind_of(target) == Some(Kind::Axes) {
            let joints = (1..=self.dof).map(|i| {
                let deg = target.get(&format!("A{i}"));
                let missing = || ProgramErrorKind::Fields {
                    what: "a position in axes".to_owned(),
                    found: target.keys().filter(|key| key.starts_with('A')).count(),
                    wanted: self.dof.to_string(),
                };
                deg.map(|deg| deg.to_radians()).ok_or_else(missing)
            });
            return Ok(Goal::Joints(joints.collect::<Result<_, _>>()?));
        }
        let flags = match target.get("S") {
            None => None,
            Some(status) => Some(Box::new(StatusTurn {
                status: bits(*status, "S")? & 7,
                turn: target.get("T").map(|turn| bits(*turn, "T")).transpose()?,
            }) as Box<dyn Flags>),
        };
        Ok(Goal::Pose(pose(target)?, flags))
    }
}
