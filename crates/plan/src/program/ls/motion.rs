//! Moves of an `.LS`.

use nalgebra::Isometry3;

use super::positions::Position;
use super::read::LsReader;
use crate::program::euler::pose_of;
use crate::program::flags::Flags;
use crate::program::number::{finite, whole};
use crate::program::reading::{Goal, Step};
use crate::program::{Motion, ProgramErrorKind, Zone};

/// Options of a move that change nothing of its way but its pace.
const PACE: &[&str] = &["ACC", "PTH", "BREAK"];
/// Options that make another way of it.
const WAYS: &[(&str, &str)] = &[
    ("RTCP", "a move about a tool that stands in the cell"),
    ("COORD", "a move along with another motion group"),
    ("WJNT", "a line on which the wrist turns by its joints"),
    (
        "MROT",
        "a move that turns the wrist otherwise than its position says",
    ),
    ("INC", "a move from where the arm stands"),
    ("OFFSET", "a move by a register that is not in the file"),
    (
        "TOOL_OFFSET",
        "a move by a register that is not in the file",
    ),
    ("VOFFSET", "a move by a register that is not in the file"),
    ("SKIP", "a move that may end on its way"),
];

impl LsReader {
    /// `P[3:name]` and what follows.
    fn position<'t>(&self, text: &'t str) -> Result<(u32, &Position, &'t str), ProgramErrorKind> {
        let wanted = "P[...]";
        let wrong = || ProgramErrorKind::unexpected(text, wanted);
        let rest = text.strip_prefix("P[").ok_or_else(wrong)?;
        let (number, rest) = rest.split_once(']').ok_or_else(wrong)?;
        let number = number.split(':').next().unwrap_or_default();
        let number: u32 = whole(number, "the position's number")?;
        let found = self.positions.get(&number);
        let found = found.ok_or_else(|| ProgramErrorKind::MissingPosition {
            name: format!("P[{number}]"),
        })?;
        Ok((number, found, rest.trim()))
    }

    pub(super) fn motion(
        &mut self,
        verb: &str,
        text: &str,
        line: usize,
    ) -> Result<(), ProgramErrorKind> {
        let (mut number, mut position, mut rest) = self.position(text)?;
        let mut via = None;
        if verb == "C" {
            self.check_frames(position)?;
            via = Some(self.pose(position)?);
            (number, position, rest) = self.position(rest)?;
        }
        let mut words = rest.split_whitespace();
        let speed = words.next().unwrap_or_default();
        let motion = speed_of(verb, speed)?;
        let end = words.next().unwrap_or_default();
        let zone = match end.strip_prefix("CNT") {
            Some(level) => {
                let level: u8 = whole(level, "CNT")?;
                ProgramErrorKind::unless(level <= 100, "CNT", level, "from 0 to 100")?;
                Zone::Unstated
            }
            None if end == "FINE" => Zone::Stop,
            None => return Err(ProgramErrorKind::unexpected(end, "FINE or CNT0 to CNT100")),
        };
        let mut idle = Vec::new();
        for word in words {
            if !PACE
                .iter()
                .any(|pace| word.to_uppercase().starts_with(pace))
            {
                let upper = word.to_uppercase();
                let name = upper.split([',', '[', ':']).next().unwrap_or_default();
                if let Some((_, why)) = WAYS.iter().find(|(known, _)| *known == name) {
                    return Err(ProgramErrorKind::not_read(word, why));
                }
                let wanted = "the end of the move, ACC or PTH";
                return Err(ProgramErrorKind::unexpected(word, wanted));
            }
            idle.push(word.to_owned());
        }
        self.check_frames(position)?;
        check_further_axes(position)?;
        let goal = self.goal(position)?;
        let frames = ["UT", "UF"].map(|part| position.numbers.get(part).copied());
        let turntable_rad = position.numbers.get("E1").map(|deg| deg.to_radians());
        for word in idle {
            self.notes
                .add(line, format!("{word} of a move is left aside"));
        }
        if let Goal::Pose(..) = goal {
            // Without UTOOL_NUM those of the first pose are the ones that must be selected.
            let [tool, frame] = frames.map(|found| found.map(|number| number as u8));
            self.number = self.number.or(tool);
            self.user_frame = self.user_frame.or(frame);
        }
        ProgramErrorKind::unless_too_many(self.steps.len() + 1)?;
        self.steps.push(Step {
            line,
            path_point: number.checked_sub(1).map(|number| number as usize),
            goal,
            via,
            with_tangent: false,
            motion,
            zone,
            turntable_rad,
        });
        Ok(())
    }

    /// As on the controller, a position is one of the frames that are selected.
    fn check_frames(&self, position: &Position) -> Result<(), ProgramErrorKind> {
        let selected = [
            ("UT", "UTOOL_NUM", self.number),
            ("UF", "UFRAME_NUM", self.user_frame),
        ];
        for (part, word, number) in selected {
            let (Some(found), Some(number)) = (position.numbers.get(part), number) else {
                continue;
            };
            let what = format!("{part} of the position in line {}", position.line);
            let rule = format!("{number}, by {word} or the moves before");
            ProgramErrorKind::unless(*found == f64::from(number), what, found, rule)?;
        }
        Ok(())
    }

    fn goal(&self, position: &Position) -> Result<Goal, ProgramErrorKind> {
        if position.numbers.contains_key("J1") {
            let is_joint = |key: &&String| key.starts_with('J');
            let found = position.numbers.keys().filter(is_joint).count();
            let joints = (1..=self.dof).map(|i| position.numbers.get(&format!("J{i}")).copied());
            let joints: Option<Vec<f64>> = joints.collect();
            let joints = joints.filter(|_| found == self.dof);
            let mut deg = joints.ok_or_else(|| ProgramErrorKind::JointCount {
                what: "a position in joints".to_owned(),
                found,
                wanted: self.dof,
            })?;
            if deg.len() > 2 {
                deg[2] += self.options.j23_factor * deg[1];
            }
            return Ok(Goal::Joints(deg.into_iter().map(f64::to_radians).collect()));
        }
        let flags = position
            .config
            .map(|config| Box::new(config) as Box<dyn Flags>);
        Ok(Goal::Pose(self.pose(position)?, flags))
    }

    fn pose(&self, position: &Position) -> Result<Isometry3<f64>, ProgramErrorKind> {
        let part = |name: &str| {
            let found = position.numbers.get(name).copied();
            found.ok_or_else(|| {
                ProgramErrorKind::unexpected("a position", &format!("one with {name}"))
            })
        };
        Ok(pose_of(
            [part("X")?, part("Y")?, part("Z")?],
            [part("W")?, part("P")?, part("R")?],
        ))
    }
}

/// Of the further axes E1 is read, as a turntable.
fn check_further_axes(position: &Position) -> Result<(), ProgramErrorKind> {
    let further =
        |(name, value): &(&String, &f64)| name.starts_with('E') && *name != "E1" && **value != 0.0;
    let rule = "0: of further axes a turntable is read, as E1";
    match position.numbers.iter().find(further) {
        None => Ok(()),
        Some((name, value)) => Err(ProgramErrorKind::value(name, value, rule)),
    }
}

fn speed_of(verb: &str, text: &str) -> Result<Motion, ProgramErrorKind> {
    let number = |unit: &str| {
        text.strip_suffix(unit)
            .map(|number| finite(number, "the speed"))
    };
    if verb == "J" {
        let percent = number("%")
            .unwrap_or_else(|| Err(ProgramErrorKind::unexpected(text, "a speed in percent")))?;
        let fits = percent > 0.0 && percent <= 100.0;
        ProgramErrorKind::unless(fits, "the speed", text, "above 0 to 100 %")?;
        return Ok(Motion::Joint {
            share: percent / 100.0,
        });
    }
    let units = [
        ("mm/sec", 1e-3),
        ("cm/min", 0.01 / 60.0),
        ("inch/min", 0.0254 / 60.0),
    ];
    let found = units
        .iter()
        .find_map(|(unit, m_per_s)| Some(number(unit)?.map(|v| v * m_per_s)));
    let wanted = "a speed in mm/sec, cm/min or inch/min";
    let speed_m_per_s = found.unwrap_or_else(|| Err(ProgramErrorKind::unexpected(text, wanted)))?;
    ProgramErrorKind::unless(speed_m_per_s > 0.0, "the speed", text, "above zero")?;
    Ok(Motion::Linear { speed_m_per_s })
}
