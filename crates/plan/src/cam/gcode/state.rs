//! The modal state of a control, block by block.

use std::collections::BTreeMap;

use nalgebra::{Rotation3, Unit, UnitVector3, Vector3};

use super::words::Word;
use crate::cam::{Attitude, CamOptions, CamPath, CamPoint, direction};
use crate::program::ProgramErrorKind;
use crate::program::reading::Notes;

const INCH_M: f64 = 0.0254;

#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum MotionMode {
    None,
    Rapid,
    Feed,
    /// Seen against the plane's normal: clockwise.
    Clockwise,
    Counter,
}

/// What a block says beside its modes.
#[derive(Default)]
struct Block {
    values: BTreeMap<char, f64>,
    /// G53, G28 or G30: a move of the machine's own.
    machine: Option<f64>,
    dwell: bool,
    /// The program ends with the block.
    ends: bool,
    spindle: Option<bool>,
}

/// The control's state.
pub(super) struct State<'a> {
    pub options: &'a CamOptions,
    pub path: CamPath,
    notes: Notes,
    pub motion: MotionMode,
    /// Number of the plane: 17, 18, 19.
    pub plane: u32,
    pub unit_m: f64,
    incremental: bool,
    pub absolute_centres: bool,
    feed_m_per_s: Option<f64>,
    exact_stop: bool,
    /// Axes that have a place; the others stand at 0 as far as is known.
    pub place_m: Vector3<f64>,
    /// A, B, C, deg.
    turns_deg: [f64; 3],
    pub axis: UnitVector3<f64>,
    tool: Option<f64>,
}

impl<'a> State<'a> {
    pub fn new(options: &'a CamOptions) -> Self {
        Self {
            options,
            path: CamPath::default(),
            notes: Notes::default(),
            motion: MotionMode::None,
            plane: 17,
            unit_m: options.unit_m,
            incremental: false,
            absolute_centres: false,
            feed_m_per_s: None,
            exact_stop: false,
            place_m: Vector3::zeros(),
            turns_deg: [0.0; 3],
            axis: Vector3::z_axis(),
            tool: None,
        }
    }

    pub fn note(&mut self, line: usize, text: &str) {
        self.notes.add(line, text);
    }

    pub fn end(self) -> CamPath {
        CamPath {
            notes: self.notes.texts(),
            ..self.path
        }
    }

    /// Takes a block in the order in which controls do: modes, feed, spindle, then the move.
    /// Whether the program goes on.
    pub fn block(&mut self, words: &[Word], line: usize) -> Result<bool, ProgramErrorKind> {
        let mut block = Block::default();
        for (letter, number) in words {
            match letter {
                'G' => self.preparatory(*number, &mut block, line)?,
                'M' => self.auxiliary(*number, &mut block, line)?,
                'N' | 'O' => {}
                'F' | 'S' | 'T' | 'H' | 'D' | 'P' | 'X' | 'Y' | 'Z' | 'A' | 'B' | 'C' | 'I'
                | 'J' | 'K' | 'R' => {
                    if block.values.insert(*letter, *number).is_some() {
                        let rule = "given once in a block";
                        return Err(ProgramErrorKind::value(
                            format!("the word {letter}"),
                            number,
                            rule,
                        ));
                    }
                }
                _ => {
                    let word = format!("{letter}{number}");
                    let wanted = "one of X Y Z A B C I J K R F S T H D P G M N O";
                    return Err(ProgramErrorKind::unexpected(&word, wanted));
                }
            }
        }
        self.settings(&block, line)?;
        if let Some(on) = block.spindle {
            self.path.spindle.push((self.path.points.len(), on));
        }
        if let Some(code) = block.machine {
            let text = format!(
                "G{code}: a move of the machine's own, which the arm does not have, is left aside"
            );
            self.notes.add(line, text);
        } else if !block.dwell {
            self.travel(&block.values, line)?;
        }
        Ok(!block.ends)
    }

    fn preparatory(
        &mut self,
        code: f64,
        block: &mut Block,
        line: usize,
    ) -> Result<(), ProgramErrorKind> {
        let refused = |what: &str| {
            let wanted = format!("a move without {what}, which is not read,");
            Err(ProgramErrorKind::unexpected(&format!("G{code}"), &wanted))
        };
        match (code * 10.0).round() as i64 {
            0 => self.motion = MotionMode::Rapid,
            10 => self.motion = MotionMode::Feed,
            20 => self.motion = MotionMode::Clockwise,
            30 => self.motion = MotionMode::Counter,
            40 => {
                block.dwell = true;
                self.notes.add(line, "G4: a dwell is left aside");
            }
            170 | 180 | 190 => self.plane = code as u32,
            200 => self.unit_m = INCH_M,
            210 => self.unit_m = 1e-3,
            280 | 300 | 530 => block.machine = Some(code),
            // What is off, or is so here at all times.
            400 | 490 | 500 | 800 | 940 | 150 | 690 | 434 | 435 => {}
            // The tip is what is led: its length stands in the tool frame.
            430 | 431 => self
                .notes
                .add(line, "G43: the tool's length is that of the tool frame"),
            540 => {}
            550 | 560 | 570 | 580 | 590 => {
                let rule = "54: one work frame is read";
                return Err(ProgramErrorKind::value("the work offset G", code, rule));
            }
            610 | 611 => self.exact_stop = true,
            640 => self.exact_stop = false,
            900 => self.incremental = false,
            910 => self.incremental = true,
            901 => self.absolute_centres = true,
            911 => self.absolute_centres = false,
            980 | 990 => {}
            410..=429 => return refused("compensation of the cutter's radius"),
            730 | 740 | 760 | 810..=899 => return refused("canned cycles"),
            650 | 660 | 670 => return refused("subprograms"),
            _ => {
                let wanted = "a code that is read: G0 to G4, G17 to G21, G28, G43, G53, G54, G61, \
                              G64, G90, G91, G94";
                return Err(ProgramErrorKind::unexpected(&format!("G{code}"), wanted));
            }
        }
        Ok(())
    }

    fn auxiliary(
        &mut self,
        code: f64,
        block: &mut Block,
        line: usize,
    ) -> Result<(), ProgramErrorKind> {
        match code as i64 {
            3 | 4 => block.spindle = Some(true),
            5 => block.spindle = Some(false),
            2 | 30 => block.ends = true,
            97..=99 => {
                let wanted = "a move without subprograms, which are not read,";
                return Err(ProgramErrorKind::unexpected(&format!("M{code}"), wanted));
            }
            0 | 1 | 6..=9 => self.notes.add(line, format!("M{code} is left aside")),
            _ => {
                let wanted = "a code that is read: M0 to M9 and M30";
                return Err(ProgramErrorKind::unexpected(&format!("M{code}"), wanted));
            }
        }
        Ok(())
    }

    fn settings(&mut self, block: &Block, line: usize) -> Result<(), ProgramErrorKind> {
        if let Some(feed) = block.values.get(&'F') {
            ProgramErrorKind::unless(*feed > 0.0, "the feed F", feed, "above zero")?;
            self.feed_m_per_s = Some(feed * self.unit_m / 60.0);
        }
        if let Some(rpm) = block.values.get(&'S') {
            ProgramErrorKind::unless(*rpm >= 0.0, "the speed S", rpm, "zero or above")?;
            let most = self.path.spindle_rpm.unwrap_or(0.0).max(*rpm);
            self.path.spindle_rpm = Some(most);
        }
        if let Some(tool) = block.values.get(&'T') {
            if self.tool.is_some_and(|known| known != *tool) && !self.path.points.is_empty() {
                let rule = "that of the moves before: one tool is read";
                return Err(ProgramErrorKind::value("the tool T", tool, rule));
            }
            self.tool = Some(*tool);
            self.notes
                .add(line, format!("T{tool}: the tool is that of the robot"));
        }
        Ok(())
    }

    fn travel(
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
        if arc {
            self.arc(values, to, from_axis, feed, line)?;
        } else {
            self.push(to, self.axis, feed, line);
        }
        self.place_m = to;
        ProgramErrorKind::unless_too_many(self.path.points.len())
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
        self.path.points.push(CamPoint {
            line,
            place_m,
            attitude: Attitude::Axis(axis),
            feed_m_per_s: feed,
            stops: self.exact_stop,
        });
    }
}
