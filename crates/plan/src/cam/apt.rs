//! Cutter locations in APT (ISO 4343), as CAM systems write them.

use std::path::Path;

use nalgebra::{UnitVector3, Vector3};

use super::apt_words::{IDLE, REFUSED, System, UNIT_WITHIN, numbers};
use super::gap::Gaps;
use super::spindle::{SpindleTurn, SpindleWord};
use super::{
    Attitude, CamOptions, CamPath, CamPoint, INCH_M, checked_feed, direction, unit_without_effect,
};
use crate::arc::Arc;
use crate::program::number::finite;
use crate::program::reading::Notes;
use crate::program::{ProgramError, ProgramErrorKind};

/// By how much the end of an arc may miss its circle, m.
const ARC_CLOSES_M: f64 = 1e-5;

struct AptReader<'a> {
    options: &'a CamOptions,
    path: CamPath,
    notes: Notes,
    unit_m: f64,
    multiaxis: bool,
    feed_m_per_s: Option<f64>,
    /// The next move is one in rapid traverse.
    rapid: bool,
    axis: UnitVector3<f64>,
    tool: Option<f64>,
    /// Centre, axis and radius of the circle that the next point ends, m.
    circle: Option<(Vector3<f64>, UnitVector3<f64>, f64)>,
    ended: bool,
    gaps: Gaps,
    system: System,
}

/// Reads APT.
///
/// # Errors
/// At the first statement that is not understood or cannot be followed.
pub(super) fn read(text: &str, file: &Path, options: &CamOptions) -> Result<CamPath, ProgramError> {
    let mut reader = AptReader {
        options,
        path: CamPath::default(),
        notes: Notes::default(),
        unit_m: options.unit_m,
        multiaxis: false,
        feed_m_per_s: None,
        rapid: false,
        axis: Vector3::z_axis(),
        tool: None,
        circle: None,
        ended: false,
        gaps: Gaps::default(),
        system: System::default(),
    };
    let at = |line: usize, kind| ProgramError::in_file(file, line, kind);
    let mut open: Option<(usize, String)> = None;
    for (i, line) in text.lines().enumerate() {
        let line = line.split("$$").next().unwrap_or_default().trim();
        let (at, mut whole) = open.take().unwrap_or((i + 1, String::new()));
        // A statement goes on in the next line after `$`.
        if let Some(part) = line.strip_suffix('$') {
            whole.push_str(part.trim());
            open = Some((at, whole));
            continue;
        }
        whole.push_str(line);
        let done = reader.statement(whole.trim(), at);
        done.map_err(|kind| ProgramError::in_file(file, at, kind))?;
        if reader.ended {
            break;
        }
    }
    let truncated = |line: usize, missing: &str| {
        let missing = missing.to_owned();
        at(line, ProgramErrorKind::Truncated { missing })
    };
    if let Some((line, _)) = open {
        return Err(truncated(line, "the end of the statement"));
    }
    reader
        .end(text.lines().count().max(1))
        .map_err(|(line, fault)| match fault {
            EndFault::Missing(what) => truncated(line, what),
            EndFault::Other(kind) => at(line, kind),
        })
}

/// What is wrong with a path at its end.
enum EndFault {
    Missing(&'static str),
    Other(ProgramErrorKind),
}

impl AptReader<'_> {
    fn end(mut self, last: usize) -> Result<CamPath, (usize, EndFault)> {
        if self.circle.is_some() {
            return Err((last, EndFault::Missing("the GOTO that ends the CIRCLE")));
        }
        if !self.ended {
            let text = "the file ends without FINI: it may be cut short";
            self.notes.add(last, text);
        }
        let closed = self.gaps.close(&mut self.path, &mut self.notes);
        closed.map_err(|(line, kind)| (line, EndFault::Other(kind)))?;
        Ok(CamPath {
            notes: self.notes.texts(),
            ..self.path
        })
    }

    fn unit(&mut self, unit: &str, line: usize) -> Result<(), ProgramErrorKind> {
        self.unit_m = match unit {
            "MM" => 1e-3,
            "INCHES" | "INCH" | "IN" => INCH_M,
            "CM" => 1e-2,
            _ => return Err(ProgramErrorKind::unexpected(unit, "MM, CM or INCHES")),
        };
        if let Some(text) = unit_without_effect(self.options, self.unit_m, "UNITS") {
            self.notes.add(line, text);
        }
        Ok(())
    }

    fn statement(&mut self, text: &str, line: usize) -> Result<(), ProgramErrorKind> {
        if text.is_empty() {
            return Ok(());
        }
        let (word, rest) = text.split_once('/').unwrap_or((text, ""));
        let word = word.trim().to_uppercase();
        let parts: Vec<&str> = rest
            .split(',')
            .map(str::trim)
            .filter(|p| !p.is_empty())
            .collect();
        let first = parts
            .first()
            .map(|part| part.to_uppercase())
            .unwrap_or_default();
        match word.as_str() {
            "UNITS" => self.unit(&first, line)?,
            // The tool goes to a place that the file does not say.
            "GOHOME" | "RETRCT" => {
                self.gaps
                    .leave(&mut self.path, &mut self.notes, &word, line);
            }
            "MSYS" => {
                let has_points = !self.path.points.is_empty();
                self.system.take(&parts, line, has_points)?;
                self.notes
                    .add(line, "MSYS is left aside: it is the work frame");
            }
            "MULTAX" => self.multiaxis = first != "OFF",
            "FEDRAT" => self.feed(&parts)?,
            "RAPID" => self.rapid = true,
            "SPINDL" => self.spindle(&parts, line)?,
            "LOADTL" => self.tool(&parts, line)?,
            "FROM" | "GOTO" => self.goto(&word, &parts, line)?,
            "CIRCLE" => {
                let [x, y, z, i, j, k, radius] = numbers::<7>(&word, &parts)?;
                let radius_m = radius * self.unit_m;
                ProgramErrorKind::unless(
                    radius_m > 0.0,
                    "the radius of CIRCLE",
                    radius,
                    "above zero",
                )?;
                let centre = Vector3::new(x, y, z) * self.unit_m;
                ProgramErrorKind::unless_too_large(radius_m)?;
                self.circle = Some((centre, direction(Vector3::new(i, j, k))?, radius_m));
            }
            "GODLTA" => {
                let [x, y, z] = numbers::<3>(&word, &parts)?;
                let known = self
                    .path
                    .points
                    .last()
                    .filter(|_| self.gaps.open().is_none());
                let from = known.ok_or_else(|| {
                    ProgramErrorKind::unexpected("GODLTA", "FROM or GOTO, before it,")
                })?;
                let to = from.place_m + Vector3::new(x, y, z) * self.unit_m;
                self.travel(to, self.axis, line)?;
            }
            "FINI" | "END" => self.ended = true,
            "CUTCOM" if first == "OFF" => {}
            _ => {
                if let Some((_, what)) = REFUSED.iter().find(|(known, _)| *known == word) {
                    let wanted = format!("a statement without {what}, which are not read,");
                    return Err(ProgramErrorKind::unexpected(&word, &wanted));
                }
                if !IDLE.iter().any(|idle| word.starts_with(idle)) {
                    let wanted = "a word that is read: GOTO, FROM, GODLTA, CIRCLE, RAPID, FEDRAT, \
                                  SPINDL, LOADTL, MULTAX, UNITS, FINI";
                    return Err(ProgramErrorKind::unexpected(&word, wanted));
                }
                self.notes.add(line, format!("{word} is left aside"));
            }
        }
        Ok(())
    }

    fn feed(&mut self, parts: &[&str]) -> Result<(), ProgramErrorKind> {
        let mut unit = self.unit_m / 60.0;
        let mut feed = None;
        for part in parts {
            match part.to_uppercase().as_str() {
                "MMPM" => unit = 1e-3 / 60.0,
                "IPM" => unit = INCH_M / 60.0,
                "PERMIN" => unit = self.unit_m / 60.0,
                other @ ("MMPR" | "IPR" | "PERREV" | "INVERS") => {
                    let wanted = "a feed by the minute, MMPM, IPM or PERMIN,";
                    return Err(ProgramErrorKind::unexpected(other, wanted));
                }
                _ => feed = Some(finite(part, "FEDRAT")?),
            }
        }
        let feed =
            feed.ok_or_else(|| ProgramErrorKind::unexpected("FEDRAT", "FEDRAT/ with a feed"))?;
        self.feed_m_per_s = Some(checked_feed("FEDRAT", feed, feed * unit)?);
        self.rapid = false;
        Ok(())
    }

    fn spindle(&mut self, parts: &[&str], line: usize) -> Result<(), ProgramErrorKind> {
        let (mut turn, mut rpm) = (SpindleTurn::Clockwise, None);
        for part in parts {
            match part.to_uppercase().as_str() {
                "OFF" => turn = SpindleTurn::Off,
                "CCLW" => turn = SpindleTurn::Counter,
                "ON" | "CLW" | "RPM" | "REV" | "MAXRPM" => {}
                _ => {
                    let said = finite(part, "SPINDL")?;
                    ProgramErrorKind::unless(said >= 0.0, "SPINDL", said, "zero or above")?;
                    rpm = Some(said);
                }
            }
        }
        self.path.spindle.push(SpindleWord {
            before: self.path.points.len(),
            line,
            turn: Some(turn),
            rpm,
        });
        Ok(())
    }

    fn tool(&mut self, parts: &[&str], line: usize) -> Result<(), ProgramErrorKind> {
        let number = finite(parts.first().copied().unwrap_or_default(), "LOADTL")?;
        if self.tool.is_some_and(|known| known != number) && !self.path.points.is_empty() {
            let rule = "that of the moves before: one tool is read";
            return Err(ProgramErrorKind::value("LOADTL", number, rule));
        }
        self.tool = Some(number);
        self.notes.add(
            line,
            format!("LOADTL/{number}: the tool is that of the robot"),
        );
        Ok(())
    }

    fn goto(&mut self, word: &str, parts: &[&str], line: usize) -> Result<(), ProgramErrorKind> {
        let mut axis = self.axis;
        let place = match parts.len() {
            6 => {
                let [x, y, z, i, j, k] = numbers::<6>(word, parts)?;
                let vector = Vector3::new(i, j, k);
                axis = direction(vector)?;
                // ISO 4343 gives unit vectors.
                if (vector.norm() - 1.0).abs() > UNIT_WITHIN {
                    let text = "the tool's axis is not a unit vector: its direction counts";
                    self.notes.add(line, text);
                }
                [x, y, z]
            }
            _ if self.multiaxis && parts.len() == 3 => {
                let found = format!("{word} of three numbers");
                let wanted = "GOTO of six numbers, the tool's axis as well, as MULTAX/ON asks for,";
                return Err(ProgramErrorKind::unexpected(&found, wanted));
            }
            _ => numbers::<3>(word, parts)?,
        };
        let to = Vector3::from(place) * self.unit_m;
        if word == "FROM" {
            self.rapid = true;
        }
        self.travel(to, axis, line)
    }

    fn travel(
        &mut self,
        to: Vector3<f64>,
        axis: UnitVector3<f64>,
        line: usize,
    ) -> Result<(), ProgramErrorKind> {
        let rapid = std::mem::take(&mut self.rapid);
        let feed = match (rapid, self.feed_m_per_s) {
            (true, _) => None,
            (false, Some(feed)) => Some(feed),
            (false, None) => {
                let found = "a move with feed";
                return Err(ProgramErrorKind::unexpected(
                    found,
                    "FEDRAT or RAPID, before it,",
                ));
            }
        };
        if let Some(gap) = self.gaps.open().filter(|_| !self.path.points.is_empty())
            && (feed.is_some() || self.circle.is_some())
        {
            let wanted = format!(
                "RAPID before the first GOTO after {} in line {}, whose end the file does not say,",
                gap.word, gap.line
            );
            return Err(ProgramErrorKind::unexpected("a move with feed", &wanted));
        }
        let next = CamPoint {
            line,
            place_m: to,
            attitude: Attitude::Axis(axis),
            feed_m_per_s: feed,
            stops: false,
        };
        self.gaps.come_back(&mut self.path, next);
        let mut places = Vec::new();
        if let Some((centre, about, radius_m)) = self.circle.take() {
            places = self.arc(centre, about, radius_m, to)?;
        }
        ProgramErrorKind::unless_too_many(self.path.points.len() + places.len() + 1)?;
        let count = places.len() + 1;
        let from_axis = self.axis;
        for (k, place_m) in places.into_iter().chain([to]).enumerate() {
            let share = (k + 1) as f64 / count as f64;
            let between = direction(from_axis.into_inner().lerp(&axis, share))?;
            self.path.points.push(CamPoint {
                place_m,
                attitude: Attitude::Axis(if k + 1 == count { axis } else { between }),
                ..next
            });
        }
        self.axis = axis;
        Ok(())
    }

    /// Points on the circle between the last point and its end.
    fn arc(
        &self,
        centre: Vector3<f64>,
        about: UnitVector3<f64>,
        radius_m: f64,
        to: Vector3<f64>,
    ) -> Result<Vec<Vector3<f64>>, ProgramErrorKind> {
        let from =
            self.path.points.last().ok_or_else(|| {
                ProgramErrorKind::unexpected("CIRCLE", "FROM or GOTO, before it,")
            })?;
        let arc = Arc::about(&about, centre, from.place_m, to, true);
        let start_m = (arc.radius_m() - radius_m).abs();
        let end_m = (arc.radius_m() + arc.growth_m - radius_m).abs();
        let apart_m = start_m.max(end_m);
        ProgramErrorKind::unless(
            apart_m <= ARC_CLOSES_M,
            "the arc does not close: the distance of a point from its circle in mm",
            format!("{:.4}", apart_m * 1e3),
            format!("at most {} mm", ARC_CLOSES_M * 1e3),
        )?;
        let count = arc.chords(self.options.chord_m);
        ProgramErrorKind::unless_too_many(count)?;
        Ok((1..count)
            .map(|k| arc.at(k as f64 / count as f64))
            .collect())
    }
}
