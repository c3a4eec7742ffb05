//! What a file says of the spindle.

use super::CamPath;

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

impl CamPath {
    /// Switches of the spindle: before which point, and whether it is on.
    pub fn switches(&self) -> impl Iterator<Item = (usize, bool)> {
        let switch = |word: &SpindleWord| Some((word.before, word.turn? != SpindleTurn::Off));
        self.spindle.iter().filter_map(switch)
    }

    /// What is said of the spindle where moves with feed go.
    #[must_use]
    pub fn spindle_at_cuts(&self) -> SpindleAtCuts {
        let mut words = self.spindle.iter().peekable();
        let (mut turn, mut rpm) = (SpindleTurn::Off, None);
        let mut found = SpindleAtCuts::default();
        for (k, point) in self.points.iter().enumerate() {
            while let Some(word) = words.next_if(|word| word.before <= k) {
                turn = word.turn.unwrap_or(turn);
                rpm = word.rpm.or(rpm);
            }
            // The way to the first point is not one of the file.
            if k == 0 || point.feed_m_per_s.is_none() {
                continue;
            }
            match turn {
                SpindleTurn::Off => found.off = found.off.or(Some(point.line)),
                SpindleTurn::Counter => found.counter = found.counter.or(Some(point.line)),
                SpindleTurn::Clockwise => {}
            }
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
