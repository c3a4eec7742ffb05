//! What a file says of the spindle.

use super::{CamPath, CamPoint};
use crate::program::ProgramErrorKind;

/// How a spindle turns, seen from it towards the work.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SpindleTurn {
    Off,
    /// M3, CLW: the sense of usual cutters.
    Clockwise,
    /// M4, CCLW.
    Counter,
}

/// A statement on the spindle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SpindleWord {
    /// Before which point of the path.
    pub before: usize,
    pub line: usize,
    /// `None` leaves it as it is.
    pub turn: Option<SpindleTurn>,
    /// Speed in 1/min; `None` leaves it as it is.
    pub rpm: Option<f64>,
}

/// A speed of the spindle, and where it comes on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SpindleSpeed {
    /// Line of the word that gives it.
    pub line: usize,
    /// Point of the path at which it comes on; the first one is there from the start on.
    pub from: usize,
    /// Speed in 1/min, above zero.
    pub rpm: f64,
}

/// The spindle's state, word by word.
struct State<'a> {
    words: std::iter::Peekable<std::slice::Iter<'a, SpindleWord>>,
    turn: SpindleTurn,
    /// Speed in 1/min with the word that gives it.
    speed: Option<(SpindleWord, f64)>,
}

impl<'a> State<'a> {
    fn new(words: &'a [SpindleWord]) -> Self {
        Self {
            words: words.iter().peekable(),
            turn: SpindleTurn::Off,
            speed: None,
        }
    }

    /// Takes what is said before a point.
    fn come_to(&mut self, point: usize) {
        while let Some(word) = self.words.next_if(|word| word.before <= point) {
            self.turn = word.turn.unwrap_or(self.turn);
            let is_new = |rpm: &f64| self.speed.is_none_or(|(_, known)| known != *rpm);
            if let Some(rpm) = word.rpm.filter(is_new) {
                self.speed = Some((*word, rpm));
            }
        }
    }
}

impl CamPath {
    /// Moves with feed: indices of the points that they lead to. The way to the first point is not
    /// one of the file.
    fn cuts(&self) -> impl Iterator<Item = (usize, &CamPoint)> {
        let all = self.points.iter().enumerate().skip(1);
        all.filter(|(_, point)| point.feed_m_per_s.is_some())
    }

    /// Speeds of a spindle that turns clockwise wherever moves with feed go, in their order. Each
    /// comes on at the point at which the file gives it.
    ///
    /// # Errors
    /// At the line of the first move with feed before which the file does not start the spindle,
    /// starts it counter-clockwise or gives no speed; without a line where it says nothing of it.
    pub fn spindle_speeds(&self) -> Result<Vec<SpindleSpeed>, (Option<usize>, ProgramErrorKind)> {
        let unexpected = ProgramErrorKind::unexpected;
        if self.spindle.is_empty() {
            let found = "a path without a word on the spindle";
            return Err((None, unexpected(found, "a path with speeds, S or SPINDL,")));
        }
        let mut state = State::new(&self.spindle);
        let mut speeds: Vec<SpindleSpeed> = Vec::new();
        for (k, point) in self.cuts() {
            state.come_to(k);
            let found = "a move with feed";
            let speed = state.speed.filter(|(_, rpm)| *rpm > 0.0);
            let wanted = match (state.turn, speed) {
                (SpindleTurn::Off, _) => "M3 or SPINDL, which starts the spindle, before it,",
                (SpindleTurn::Counter, _) => {
                    "M3 or CLW before it, by which the spindle turns clockwise as the cutter does,"
                }
                (SpindleTurn::Clockwise, None) => "a speed above zero, S or SPINDL, before it,",
                (SpindleTurn::Clockwise, Some((word, rpm))) => {
                    if speeds.last().is_none_or(|last| last.rpm != rpm) {
                        let at = word.before.saturating_sub(1);
                        speeds.push(SpindleSpeed {
                            line: word.line,
                            from: if speeds.is_empty() { 0 } else { at },
                            rpm,
                        });
                    }
                    continue;
                }
            };
            return Err((Some(point.line), unexpected(found, wanted)));
        }
        Ok(speeds)
    }

    /// Switches of the spindle: before which point, and whether it is on.
    pub fn switches(&self) -> impl Iterator<Item = (usize, bool)> {
        let switch = |word: &SpindleWord| Some((word.before, word.turn? != SpindleTurn::Off));
        self.spindle.iter().filter_map(switch)
    }

    /// What is said of the spindle where moves with feed go.
    #[must_use]
    pub fn spindle_at_cuts(&self) -> SpindleAtCuts {
        let mut state = State::new(&self.spindle);
        let mut found = SpindleAtCuts::default();
        for (k, point) in self.cuts() {
            state.come_to(k);
            match state.turn {
                SpindleTurn::Off => found.off = found.off.or(Some(point.line)),
                SpindleTurn::Counter => found.counter = found.counter.or(Some(point.line)),
                SpindleTurn::Clockwise => {}
            }
            let rpm = state.speed.map(|(_, rpm)| rpm);
            let new = rpm.filter(|rpm| found.rpm.iter().all(|(_, known)| known != rpm));
            found.rpm.extend(new.map(|rpm| (point.line, rpm)));
        }
        found
    }
}

/// The spindle where moves with feed go, as a file has it: lines of the first such moves.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct SpindleAtCuts {
    /// Where it does not turn.
    pub off: Option<usize>,
    /// Where it turns counter-clockwise.
    pub counter: Option<usize>,
    /// Its speeds in 1/min, each once.
    pub rpm: Vec<(usize, f64)>,
}

impl SpindleAtCuts {
    /// What contradicts a spindle that turns clockwise all the time at a speed.
    #[must_use]
    pub fn contradictions(&self, rpm: f64) -> Vec<String> {
        let off = self.off.map(|line| {
            format!(
                "line {line}: a move with feed, before which the file does not start the spindle \
                 (M3, SPINDL); here it turns all the time"
            )
        });
        let counter = self.counter.map(|line| {
            format!(
                "line {line}: the file turns the spindle counter-clockwise (M4, CCLW); the cutter \
                 here turns clockwise"
            )
        });
        let differs = |(_, said): &&(usize, f64)| (said - rpm).abs() > 1e-6 * rpm.abs();
        let other = self.rpm.iter().find(differs).map(|(line, said)| {
            format!(
                "line {line}: the file turns the spindle at {said} 1/min, the scenario at \
                 {rpm} 1/min, which counts"
            )
        });
        [off, counter, other].into_iter().flatten().collect()
    }
}
