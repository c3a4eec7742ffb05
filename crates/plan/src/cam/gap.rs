//! Where a file does not say the way: moves in coordinates of a machine that the arm is not.
//!
//! Such a move leaves the tool at a place that is not known in the work frame, until later moves
//! say it. It is neither dropped, which would lead the tool straight through the part, nor guessed:
//! the tool leaves straight out along its axis until no point of the file lies further out, and
//! comes to the next point that is known from as far out. "Further out" is told by the box about
//! all points, in the work frame's axes; of an upright axis it is the greatest Z of the file.

use nalgebra::{UnitVector3, Vector3};

use super::{Attitude, CamPath, CamPoint};
use crate::program::ProgramErrorKind;
use crate::program::reading::Notes;

/// A move of the machine's own that no known point has followed yet.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct OpenGap {
    pub line: usize,
    /// The word that moves: G53, GOHOME.
    pub word: String,
}

/// The gaps of a path while it is read.
#[derive(Default)]
pub(super) struct Gaps {
    open: Option<OpenGap>,
    /// Points that are still to be moved out along their axes.
    out: Vec<usize>,
    /// Points before those that the tool comes back from, in the attitude that it left with.
    across: Vec<usize>,
    left: Vec<OpenGap>,
}

impl Gaps {
    pub fn open(&self) -> Option<&OpenGap> {
        self.open.as_ref()
    }

    /// The machine moves: the tool leaves the path, if it is on it.
    pub fn leave(&mut self, path: &mut CamPath, notes: &mut Notes, word: &str, line: usize) {
        let gap = OpenGap {
            line,
            word: word.to_owned(),
        };
        match path.points.last().filter(|_| self.open.is_none()) {
            Some(&last) => {
                self.out.push(path.points.len());
                path.points.push(CamPoint {
                    line,
                    feed_m_per_s: None,
                    ..last
                });
                self.left.push(gap.clone());
            }
            None => notes.add(
                line,
                format!(
                    "{word}: a move of the machine's own, which the arm does not have, is left \
                     aside"
                ),
            ),
        }
        self.open.get_or_insert(gap);
    }

    /// A point is known again, which comes next.
    pub fn come_back(&mut self, path: &mut CamPath, next: CamPoint) {
        if self.open.take().is_none() {
            return;
        }
        if let Some(&last) = path.points.last() {
            let count = path.points.len();
            let over = CamPoint {
                feed_m_per_s: None,
                ..next
            };
            self.across.push(count);
            self.out.push(count + 1);
            let attitude = last.attitude;
            path.points.extend([CamPoint { attitude, ..over }, over]);
        }
    }

    /// Moves the points of the gaps to their places, once all points are known.
    ///
    /// # Errors
    /// With the line, where the tool turns by more than a right angle in a gap.
    pub fn close(
        self,
        path: &mut CamPath,
        notes: &mut Notes,
    ) -> Result<(), (usize, ProgramErrorKind)> {
        if self.out.is_empty() {
            return Ok(());
        }
        let about = Box3::of(&path.points);
        for &k in &self.out {
            let point = &mut path.points[k];
            point.place_m = about.out(point.place_m, axis_of(point));
        }
        for &k in &self.across {
            let (from, to) = (axis_of(&path.points[k]), axis_of(&path.points[k + 1]));
            let line = path.points[k].line;
            // Up to a right angle, what lies out along both axes is out along either.
            let deg = from.angle(&to).to_degrees();
            let rule = "at most 90: write a rapid between";
            let what = "where the file does not say the way the tool's axis turns by deg";
            ProgramErrorKind::unless(deg <= 90.0 + 1e-9, what, format!("{deg:.3}"), rule)
                .map_err(|kind| (line, kind))?;
            path.points[k].place_m = about.out(path.points[k + 1].place_m, from);
        }
        for gap in &self.left {
            let text = format!(
                "{}: a move of the machine's own, whose end the file does not say: the tool leaves \
                 straight out along its axis until no point of the file lies further out (of an \
                 upright one Z {:.3} mm), and comes to the next point that the file says from as \
                 far out: look whether that clears the part and its fixtures",
                gap.word,
                about.high_m.z * 1e3
            );
            notes.add(gap.line, text);
        }
        let mut own = vec![false; path.points.len()];
        for &k in self.out.iter().chain(&self.across) {
            own[k] = true;
        }
        without_repeats(path, &own);
        Ok(())
    }
}

/// The box about the points, in the work frame's axes.
struct Box3 {
    low_m: Vector3<f64>,
    high_m: Vector3<f64>,
}

impl Box3 {
    fn of(points: &[CamPoint]) -> Self {
        let places = || points.iter().map(|point| point.place_m);
        Self {
            low_m: places().reduce(|a, b| a.inf(&b)).unwrap_or_default(),
            high_m: places().reduce(|a, b| a.sup(&b)).unwrap_or_default(),
        }
    }

    /// The place, moved along an axis until none of the box lies further out.
    fn out(&self, place_m: Vector3<f64>, axis: UnitVector3<f64>) -> Vector3<f64> {
        let low = axis.component_mul(&self.low_m);
        let furthest_m = low.sup(&axis.component_mul(&self.high_m)).sum();
        place_m + axis.into_inner() * (furthest_m - axis.dot(&place_m)).max(0.0)
    }
}

fn axis_of(point: &CamPoint) -> UnitVector3<f64> {
    match point.attitude {
        Attitude::Axis(axis) => axis,
        Attitude::Whole(turn) => -(turn * Vector3::z_axis()),
    }
}

/// Takes points of gaps away that repeat the one before or after: there the tool is out already.
fn without_repeats(path: &mut CamPath, own: &[bool]) {
    let points = std::mem::take(&mut path.points);
    let same = |a: &CamPoint, b: &CamPoint| {
        (a.place_m - b.place_m).norm() < 1e-12 && a.attitude == b.attitude
    };
    // How many points are left of those before each.
    let mut kept = Vec::with_capacity(points.len() + 1);
    for (k, point) in points.iter().enumerate() {
        kept.push(path.points.len());
        let before = path.points.last().is_some_and(|last| same(last, point));
        let after = points.get(k + 1).is_some_and(|next| same(next, point));
        if !(own[k] && (before || after)) {
            path.points.push(*point);
        }
    }
    kept.push(path.points.len());
    for word in &mut path.spindle {
        word.before = kept[word.before];
    }
}
