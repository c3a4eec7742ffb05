//! Moves of G-code: where they lead, and where that is not known.

use std::collections::BTreeMap;

use nalgebra::{Rotation3, Unit, UnitVector3, Vector3};

use super::state::{MotionMode, State};
use crate::cam::{Attitude, CamPoint, direction};
use crate::program::ProgramErrorKind;

impl State<'_> {
    pub(super) fn travel(
        &mut self,
        values: &BTreeMap<char, f64>,
        line: usize,
    ) -> Result<(), ProgramErrorKind> {
        let moved = |letters: &str| letters.chars().any(|letter| values.contains_key(&letter));
        let arc = matches!(self.motion, MotionMode::Clockwise | MotionMode::Counter);
        let aims = !arc && moved("IJK");
        if !(moved("XYZABC") || aims || arc && moved("IJKR")) {
            return Ok(());
        }
        if !arc && values.contains_key(&'R') {
            return Err(ProgramErrorKind::unexpected(
                "R",
                "G2 or G3, before a radius,",
            ));
        }
        let from_axis = self.axis;
        self.aim(values, aims, moved("ABC"))?;
        let to = self.target(values);
        let feed = match self.motion {
            MotionMode::None => {
                return Err(ProgramErrorKind::unexpected(
                    "a place",
                    "G0, G1, G2 or G3, before it,",
                ));
            }
            MotionMode::Rapid => None,
            _ => Some(self.feed_m_per_s.ok_or_else(|| {
                ProgramErrorKind::unexpected("a move with feed", "F, before it,")
            })?),
        };
        let known = self.begins_known(values, aims, feed.is_some(), line)?;
        if known {
            if arc {
                self.arc(values, to, from_axis, feed, line)?;
            } else {
                let next = self.point(to, self.axis, feed, line);
                self.gaps.come_back(&mut self.path, next);
                self.push(to, self.axis, feed, line);
            }
        }
        self.place_m = to;
        ProgramErrorKind::unless_too_many(self.path.points.len())
    }

    /// Takes what a block says of the axes: whether all have a place after it.
    ///
    /// # Errors
    /// If a cut begins where it is not known, but for the end of a line that the path begins with.
    fn begins_known(
        &mut self,
        values: &BTreeMap<char, f64>,
        aims: bool,
        cuts: bool,
        line: usize,
    ) -> Result<bool, ProgramErrorKind> {
        let (open, names) = (!self.unknown.is_empty(), self.unknown.names());
        self.unknown.say(values, self.incremental, aims);
        let known = self.unknown.is_empty();
        if !open {
            return Ok(true);
        }
        let first = self.path.points.is_empty() && self.waits.is_none() && known;
        if cuts && !(first && self.motion == MotionMode::Feed) {
            let found = format!("{} with {names} unknown", self.motion.code());
            let cause = match self.gaps.open() {
                Some(gap) => format!("{} in line {} leaves unknown", gap.word, gap.line),
                None => "no line before it says".to_owned(),
            };
            let wanted = format!("a rapid in G90 to a place of {names}, which {cause},");
            return Err(ProgramErrorKind::unexpected(&found, &wanted));
        }
        if !known {
            self.waits.get_or_insert(line);
        } else if self.path.points.is_empty() {
            self.note_start(&names, cuts, line);
        }
        Ok(known)
    }

    fn note_start(&mut self, names: &str, cuts: bool, line: usize) {
        let text = match self.waits {
            Some(since) => format!(
                "the path begins here, after the first line with a place of all axes: the moves \
                 from line {since} on leave {names} unknown"
            ),
            None if cuts => "the path begins at the end of this line: where the line begins the \
                             file does not say"
                .to_owned(),
            None => return,
        };
        self.notes.add(line, text);
    }

    /// G28 and G30 go by way of the point that they give; where all of them end is not known.
    pub(super) fn machine_move(&mut self, code: f64, values: &BTreeMap<char, f64>, line: usize) {
        let by_way = code != 53.0 && self.unknown.is_empty();
        let way = self.target(values);
        if by_way && way != self.place_m {
            self.push(way, self.axis, None, line);
            self.place_m = way;
        }
        let word = format!("G{code}");
        self.unknown.lose(values);
        self.gaps
            .leave(&mut self.path, &mut self.notes, &word, line);
    }

    /// The tool's axis: by I, J, K on a line, or turned by A about x, B about y, C about z.
    fn aim(
        &mut self,
        values: &BTreeMap<char, f64>,
        aims: bool,
        turns: bool,
    ) -> Result<(), ProgramErrorKind> {
        if aims && turns {
            return Err(ProgramErrorKind::unexpected(
                "I, J, K",
                "either A, B, C or I, J, K; it",
            ));
        }
        if aims {
            let part = |letter| values.get(&letter).copied().unwrap_or(0.0);
            self.axis = direction(Vector3::new(part('I'), part('J'), part('K')))?;
        }
        if turns {
            for (turn, letter) in self.turns_deg.iter_mut().zip(['A', 'B', 'C']) {
                match (values.get(&letter), self.incremental) {
                    (Some(value), true) => *turn += value,
                    (Some(value), false) => *turn = *value,
                    (None, _) => {}
                }
            }
            let [a, b, c] = self.turns_deg.map(f64::to_radians);
            let turn = Rotation3::from_axis_angle(&Vector3::z_axis(), c)
                * Rotation3::from_axis_angle(&Vector3::y_axis(), b)
                * Rotation3::from_axis_angle(&Vector3::x_axis(), a);
            self.axis = Unit::new_unchecked(turn * Vector3::z());
        }
        Ok(())
    }

    fn target(&self, values: &BTreeMap<char, f64>) -> Vector3<f64> {
        let mut to = self.place_m;
        for (part, letter) in to.iter_mut().zip(['X', 'Y', 'Z']) {
            if let Some(value) = values.get(&letter) {
                let value = value * self.unit_m;
                *part = if self.incremental {
                    *part + value
                } else {
                    value
                };
            }
        }
        to
    }

    pub(super) fn push(
        &mut self,
        place_m: Vector3<f64>,
        axis: UnitVector3<f64>,
        feed: Option<f64>,
        line: usize,
    ) {
        let point = self.point(place_m, axis, feed, line);
        self.path.points.push(point);
    }

    pub(super) fn point(
        &self,
        place_m: Vector3<f64>,
        axis: UnitVector3<f64>,
        feed_m_per_s: Option<f64>,
        line: usize,
    ) -> CamPoint {
        CamPoint {
            line,
            place_m,
            attitude: Attitude::Axis(axis),
            feed_m_per_s,
            stops: self.exact_stop,
        }
    }
}
