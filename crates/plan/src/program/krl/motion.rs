//! Moves of KRL.

use super::StatusTurn;
use super::read::KrlReader;
use super::structures::{Numbers, bits, numbers, pose};
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
            via = Some(pose(&numbers).map_err(|kind| self.fault(kind))?);
            self.source.expect(&[","])?;
        }
        let (name, target) = self.target()?;
        if self.source.comes(",") {
            return Err(self.source.error(
                line,
                ProgramErrorKind::unexpected("an angle CA", "the end of the circle"),
            ));
        }
        let Endings {
            passes,
            speed_m_per_s,
            share,
        } = self.endings(line)?;
        let share = share.or(self.share);
        let speed_m_per_s = speed_m_per_s.or(self.speed_m_per_s);
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
        let goal = self.goal(&target).map_err(|kind| self.fault(kind))?;
        if verb != "PTP" {
            self.check_attitude(&goal, line)?;
        }
        self.further_axes(&target, line)?;
        ProgramErrorKind::unless_too_many(self.steps.len() + 1)
            .map_err(|kind| self.source.error(line, kind))?;
        self.steps.push(Step {
            line,
            path_point: name.strip_prefix("XP").and_then(|n| n.parse().ok()),
            goal,
            via,
            with_tangent: false,
            motion,
            zone: match (passes, self.zone_m) {
                (false, _) => Zone::Stop,
                (true, Some(zone_m)) if zone_m > 0.0 => Zone::Within(zone_m),
                (true, _) => Zone::Unstated,
            },
            turntable_rad: target.get("E1").map(|deg| deg.to_radians()),
        });
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
    fn endings(&mut self, line: usize) -> Result<Endings, ProgramError> {
        let wanted = "C_DIS, C_PTP, WITH or the end of the line";
        let mut found = Endings::default();
        while !self.source.comes(LINE_END) {
            match self.source.word(wanted)?.to_uppercase().as_str() {
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
        if target.contains_key("A1") {
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
