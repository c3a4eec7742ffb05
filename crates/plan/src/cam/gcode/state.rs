//! The modal state of a control, block by block.

use std::collections::BTreeMap;

use nalgebra::{UnitVector3, Vector3};

use super::known::Unknown;
use super::words::Word;
use crate::cam::gap::Gaps;
use crate::cam::spindle::{SpindleTurn, SpindleWord};
use crate::cam::{CamOptions, CamPath, INCH_M, checked_feed, unit_without_effect};
use crate::program::ProgramErrorKind;
use crate::program::reading::Notes;

#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum MotionMode {
    None,
    Rapid,
    Feed,
    /// Seen against the plane's normal: clockwise.
    Clockwise,
    Counter,
}

impl MotionMode {
    pub fn code(self) -> &'static str {
        match self {
            Self::None => "a place",
            Self::Rapid => "G0",
            Self::Feed => "G1",
            Self::Clockwise => "G2",
            Self::Counter => "G3",
        }
    }
}

/// What a block says beside its modes.
#[derive(Default)]
struct Block {
    values: BTreeMap<char, f64>,
    motion: Option<MotionMode>,
    /// G53, G28 or G30: a move of the machine's own.
    machine: Option<f64>,
    dwell: bool,
    /// The program ends with the block.
    ends: bool,
    spindle: Option<SpindleTurn>,
}

/// The control's state.
pub(super) struct State<'a> {
    pub options: &'a CamOptions,
    pub path: CamPath,
    pub notes: Notes,
    pub motion: MotionMode,
    /// Number of the plane: 17, 18, 19.
    pub plane: u32,
    pub unit_m: f64,
    unit_is_said: bool,
    pub incremental: bool,
    pub absolute_centres: bool,
    pub feed_m_per_s: Option<f64>,
    pub exact_stop: bool,
    /// Of the axes that are not unknown.
    pub place_m: Vector3<f64>,
    pub unknown: Unknown,
    pub gaps: Gaps,
    /// The first line of moves that wait for a place of all axes.
    pub waits: Option<usize>,
    /// A, B, C, deg.
    pub turns_deg: [f64; 3],
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
            unit_is_said: false,
            incremental: false,
            absolute_centres: false,
            feed_m_per_s: None,
            exact_stop: false,
            place_m: Vector3::zeros(),
            unknown: Unknown::new(),
            gaps: Gaps::default(),
            waits: None,
            turns_deg: [0.0; 3],
            axis: Vector3::z_axis(),
            tool: None,
        }
    }

    pub fn note(&mut self, line: usize, text: &str) {
        self.notes.add(line, text);
    }

    /// # Errors
    /// With the line, where the file does not say a way.
    pub fn end(mut self) -> Result<CamPath, (usize, ProgramErrorKind)> {
        self.gaps.close(&mut self.path, &mut self.notes)?;
        if !self.unit_is_said {
            let text = format!(
                "neither G20 nor G21: lengths are taken in units of {} mm",
                self.unit_m * 1e3
            );
            self.notes.add(1, text);
        }
        Ok(CamPath {
            notes: self.notes.texts(),
            ..self.path
        })
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
        let rpm = block.values.get(&'S').copied();
        if block.spindle.is_some() || rpm.is_some() {
            self.path.spindle.push(SpindleWord {
                before: self.path.points.len(),
                line,
                turn: block.spindle,
                rpm,
            });
        }
        if let Some(code) = block.machine {
            self.machine_move(code, &block.values, line);
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
            0 => self.mode(MotionMode::Rapid, block)?,
            10 => self.mode(MotionMode::Feed, block)?,
            20 => self.mode(MotionMode::Clockwise, block)?,
            30 => self.mode(MotionMode::Counter, block)?,
            40 => {
                block.dwell = true;
                self.notes.add(line, "G4: a dwell is left aside");
            }
            170 | 180 | 190 => self.plane = code as u32,
            200 => self.unit(INCH_M, "G20", line),
            210 => self.unit(1e-3, "G21", line),
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

    fn mode(&mut self, mode: MotionMode, block: &mut Block) -> Result<(), ProgramErrorKind> {
        if let Some(other) = block.motion.replace(mode).filter(|other| *other != mode) {
            let rule = format!("that of the block, which says {} before", other.code());
            return Err(ProgramErrorKind::value("the move", mode.code(), rule));
        }
        self.motion = mode;
        Ok(())
    }

    fn unit(&mut self, unit_m: f64, code: &str, line: usize) {
        self.unit_m = unit_m;
        self.unit_is_said = true;
        if let Some(text) = unit_without_effect(self.options, unit_m, code) {
            self.notes.add(line, text);
        }
    }

    fn auxiliary(
        &mut self,
        code: f64,
        block: &mut Block,
        line: usize,
    ) -> Result<(), ProgramErrorKind> {
        match code as i64 {
            3 => block.spindle = Some(SpindleTurn::Clockwise),
            4 => block.spindle = Some(SpindleTurn::Counter),
            5 => block.spindle = Some(SpindleTurn::Off),
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
            let m_per_s = feed * self.unit_m / 60.0;
            self.feed_m_per_s = Some(checked_feed("the feed F", feed, m_per_s)?);
        }
        if let Some(rpm) = block.values.get(&'S') {
            ProgramErrorKind::unless(*rpm >= 0.0, "the speed S", rpm, "zero or above")?;
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
}
