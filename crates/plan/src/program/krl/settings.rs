//! What KRL sets beside moves: speeds, zones, frames, loads, outputs, places.

use nalgebra::{Isometry3, Vector3};
use truecut_arm::ToolLoad;

use super::inline::ACTUAL;
use super::read::KrlReader;
use super::structures::{numbers, place_inside, pose};
use crate::program::number::{finite, whole};
use crate::program::reading::{Goal, Step};
use crate::program::source::LINE_END;
use crate::program::{ProgramError, ProgramErrorKind, SpindleSwitch};

impl KrlReader<'_> {
    pub(super) fn bas(&mut self, line: usize) -> Result<(), ProgramError> {
        self.source.expect(&["("])?;
        let what = self.source.word("a command of BAS")?.to_uppercase();
        let given = self.source.take(",");
        match what.as_str() {
            "#VEL_PTP" | "#PTP_VEL" if given => self.percent()?,
            "#PTP_PARAMS" if given => {
                self.take_actual(false, line)?;
                self.percent()?;
            }
            "#VEL_CP" if given => self.speed()?,
            "#CP_PARAMS" if given => {
                self.take_actual(true, line)?;
                self.speed()?;
            }
            "#FRAMES" => {
                self.take_actual(false, line)?;
                if given {
                    self.source.word("its argument")?;
                }
            }
            "#TOOL" | "#BASE" if given => {
                let number = self.source.word("the frame's number")?.to_owned();
                let name = format!("{}_DATA[{number}]", &what[1..]);
                self.select(&format!("${}", &what[1..]), &name, line)?;
            }
            _ => {
                self.notes.add(line, format!("BAS({what}) is left aside"));
                if given {
                    self.source.word("its argument")?;
                }
            }
        }
        self.source.expect(&[")"])
    }

    pub(super) fn percent(&mut self) -> Result<(), ProgramError> {
        self.share = Some(self.percentage()?);
        Ok(())
    }

    /// A share of the top speed, in percent.
    pub(super) fn percentage(&mut self) -> Result<f64, ProgramError> {
        let percent = self.source.number("a speed in percent")?;
        let fits = percent > 0.0 && percent <= 100.0;
        let rule = "above 0 to 100 percent";
        ProgramErrorKind::unless(fits, "the speed", percent, rule).map_err(|k| self.fault(k))?;
        Ok(percent / 100.0)
    }

    fn speed(&mut self) -> Result<(), ProgramError> {
        self.speed_m_per_s = Some(self.pace()?);
        Ok(())
    }

    /// A speed on a line, m/s.
    pub(super) fn pace(&mut self) -> Result<f64, ProgramError> {
        let speed = self.source.number("a speed in m/s")?;
        let rule = "above zero, in m/s";
        ProgramErrorKind::unless(speed > 0.0, "the speed", speed, rule)
            .map_err(|k| self.fault(k))?;
        Ok(speed)
    }

    pub(super) fn setting(&mut self, word: &str, line: usize) -> Result<(), ProgramError> {
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

    pub(super) fn frame(&mut self, word: &str, line: usize) -> Result<(), ProgramError> {
        self.source.expect(&["="])?;
        self.frame_value(word, line)
    }

    /// A frame in place or by its name.
    pub(super) fn frame_value(&mut self, word: &str, line: usize) -> Result<(), ProgramError> {
        if self.source.comes("{") {
            let all = numbers(&mut self.source)?;
            let value = pose(&all).map_err(|kind| self.fault(kind))?;
            let here = ("a frame in place".to_owned(), true);
            self.selected.insert(word.to_owned(), here);
            return self.set_frame(word, value, line);
        }
        let name = self.source.word("a frame")?.to_uppercase();
        let name = self.indexed(name)?;
        self.select(word, &name, line)
    }

    /// A frame by its name: `$NULLFRAME`, which tool and base 0 are, or one that the files give.
    pub(super) fn select(
        &mut self,
        word: &str,
        name: &str,
        line: usize,
    ) -> Result<(), ProgramError> {
        let found = match self.declared.places.get(name) {
            Some(known) => Some(pose(known).map_err(|kind| self.fault(kind))?),
            None if name == "$NULLFRAME" || name.ends_with("_DATA[0]") => {
                Some(Isometry3::identity())
            }
            None => None,
        };
        let now = (name.to_owned(), found.is_some());
        let before = self.selected.insert(word.to_owned(), now);
        // One given frame would stand for two.
        let other = before.filter(|(other, known)| other != name && !(*known && found.is_some()));
        if let (true, Some((other, _))) = (self.has_poses(), other) {
            let rule =
                format!("{other}, as before: one frame is given for what is not in the files");
            let kind = ProgramErrorKind::value(word, name, rule);
            return Err(self.source.error(line, kind));
        }
        let value = found.unwrap_or_else(|| {
            let ([tool, base], what) = (self.given, ["the robot's own tool", "the base given"]);
            let (what, given) = match word {
                "$TOOL" => (what[0], tool),
                _ => (what[1], base),
            };
            let text = format!("{name} is not in the files; {what} is taken");
            self.notes.add(line, text);
            given
        });
        self.set_frame(word, value, line)
    }

    fn set_frame(
        &mut self,
        word: &str,
        value: Isometry3<f64>,
        line: usize,
    ) -> Result<(), ProgramError> {
        let has_poses = self.has_poses();
        let (place, moved) = match word {
            "$TOOL" => (&mut self.head.tool.flange_from_tool, "tool"),
            _ => (&mut self.head.world_from_base, "base"),
        };
        if has_poses && *place != value {
            let rule = "that of the moves before: one is read";
            let kind = ProgramErrorKind::value(format!("the {moved}"), "another", rule);
            return Err(self.source.error(line, kind));
        }
        *place = value;
        Ok(())
    }

    /// Whether a move before goes to a pose: axes stand where they stand in any frame.
    fn has_poses(&self) -> bool {
        let is_pose = |step: &Step| !matches!(step.goal, Goal::Joints(_));
        self.steps.iter().any(is_pose)
    }

    /// `NAME`, or `NAME[3]`.
    pub(super) fn indexed(&mut self, name: String) -> Result<String, ProgramError> {
        if !self.source.take("[") {
            return Ok(name);
        }
        // The whole of an array: a text, say.
        if self.source.take("]") {
            return Ok(name + "[]");
        }
        let whole = format!("{name}[{}]", self.source.word("its number")?.to_uppercase());
        self.source.expect(&["]"])?;
        Ok(whole)
    }

    /// A position or frame given anew; anything else moves nothing, and is left aside.
    pub(super) fn assignment(&mut self, name: &str, line: usize) -> Result<(), ProgramError> {
        let mut name = self.indexed(name.to_owned())?;
        if let (false, Some(part)) = (self.source.comes("="), self.source.take_word()) {
            // `BASE_DATA[1].X`.
            name.push_str(&part.to_uppercase());
        }
        let owner = name.split('.').next().unwrap_or_default().to_owned();
        if !self.source.take("=") {
            return self.aside(line, &name);
        }
        let known = self.declared.places.contains_key(&owner);
        let frames = ["BASE_DATA[", "TOOL_DATA["];
        let is_frame = frames.iter().any(|begin| owner.starts_with(begin));
        let is_parameter =
            ACTUAL.contains(&owner.as_str()) || self.declared.parameters.contains_key(&owner);
        if owner != name && (is_parameter || is_frame && !known) {
            let why = "a part of what is not in the files whole";
            return Err(self.fault(ProgramErrorKind::not_read(&name, why)));
        }
        if self.source.take("{") {
            match place_inside(&mut self.source)? {
                Some(place) => drop(self.declared.places.insert(name, place)),
                None if known => return Err(self.source.unexpected("a place")),
                // Of inline forms: PDAT_ACT, FDAT_ACT, LDAT_ACT and the like.
                None => self.aside(line, &name)?,
            }
            return Ok(());
        }
        let calculated = |name: &str| ProgramErrorKind::not_read(name, "a calculated place");
        let Some(word) = self.source.take_word().map(str::to_uppercase) else {
            return match known {
                true => Err(self.fault(calculated(&name))),
                false => self.aside(line, &name),
            };
        };
        let source = self.indexed(word.clone())?;
        if !self.source.comes(LINE_END) {
            return match known {
                true => Err(self.fault(calculated(&name))),
                false => self.aside(line, &name),
            };
        }
        if let (Some(other), true) = (self.declared.places.get(&source).cloned(), owner == name) {
            self.declared.places.insert(name, other);
            return Ok(());
        }
        match (known, name.split_once('.')) {
            (true, Some((_, part))) => {
                let Ok(value) = finite(&word, part) else {
                    return Err(self.fault(calculated(&name)));
                };
                let place = self.declared.places.entry(owner).or_default();
                place.insert(part.to_owned(), value);
            }
            (true, None) => return Err(self.unknown_place(&word)),
            (false, _) => self.notes.add(line, format!("{name} is left aside")),
        }
        Ok(())
    }

    pub(super) fn load(&mut self) -> Result<(), ProgramError> {
        let all = numbers(&mut self.source)?;
        let part = |name: &str| all.get(name).copied().unwrap_or_default() * 1e-3;
        let mass_kg = all.get("M").copied().filter(|mass| *mass > 0.0);
        self.head.tool.load = mass_kg.map(|mass_kg| ToolLoad {
            mass_kg,
            centre_m: Vector3::new(part("CM.X"), part("CM.Y"), part("CM.Z")),
        });
        Ok(())
    }

    pub(super) fn output(&mut self, line: usize) -> Result<(), ProgramError> {
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
