//! The path in short intervals, with the angles that suit each as a whole.

use nalgebra::Vector2;
use truecut_core::wheel::precession::AngleSet;

use super::error::PrecessionPlanError;
use super::task::PrecessionTask;

/// How often an interval is halved before its places count as having no angle in common.
const MOST_HALVINGS: usize = 10;

/// Stations of the path, and the intervals between them.
pub(super) struct Intervals {
    pub along_m: Vec<f64>,
    pub points_m: Vec<Vector2<f64>>,
    /// Angles that suit every point of the interval from each station to the next.
    sets: Vec<AngleSet>,
}

impl Intervals {
    /// # Errors
    /// If a place leaves no angle, or neighbouring places none in common.
    pub fn new(task: &PrecessionTask<'_>, longest_m: f64) -> Result<Self, PrecessionPlanError> {
        let mut intervals = Self {
            along_m: vec![0.0],
            points_m: vec![task.path_m[0]],
            sets: Vec::new(),
        };
        for leg in task.path_m.windows(2) {
            let count = ((leg[1] - leg[0]).norm() / longest_m - 1e-9)
                .ceil()
                .max(1.0);
            for k in 0..count as usize {
                let at = |k: usize| leg[0].lerp(&leg[1], k as f64 / count);
                intervals.extend(task, at(k), at(k + 1), MOST_HALVINGS)?;
            }
        }
        Ok(intervals)
    }

    fn extend(
        &mut self,
        task: &PrecessionTask<'_>,
        from_m: Vector2<f64>,
        to_m: Vector2<f64>,
        halvings: usize,
    ) -> Result<(), PrecessionPlanError> {
        let (middle, length_m) = (from_m.lerp(&to_m, 0.5), (to_m - from_m).norm());
        let begin_m = self.along_m[self.along_m.len() - 1];
        let reach_m = 0.5 * length_m;
        let set = (task.wheel).allowed_around(task.boundary, &middle, reach_m, task.rule);
        if !set.is_empty() {
            self.along_m.push(begin_m + length_m);
            self.points_m.push(to_m);
            self.sets.push(set);
            return Ok(());
        }
        for (point, along_m) in [(from_m, begin_m), (middle, begin_m + reach_m)] {
            let required = task.wheel.require_allowed(task.boundary, &point, task.rule);
            required.map_err(|source| PrecessionPlanError::Place { along_m, source })?;
        }
        if halvings == 0 {
            return Err(PrecessionPlanError::Abrupt {
                along_m: begin_m,
                stretch_m: length_m,
            });
        }
        self.extend(task, from_m, middle, halvings - 1)?;
        self.extend(task, middle, to_m, halvings - 1)
    }

    pub fn lengths_m(&self) -> Vec<f64> {
        self.along_m.windows(2).map(|w| w[1] - w[0]).collect()
    }

    /// For each knot (a station) the angles that suit all intervals met from half a window before
    /// it to half a window after the next.
    pub fn windows(&self, times_s: &[f64], knots: &[usize], window_s: f64) -> Vec<AngleSet> {
        let (last, half_s) = (times_s.len() - 1, 0.5 * window_s);
        let (mut first, mut end) = (0, 0);
        let at_knot = |k: usize| {
            let next = knots[(k + 1).min(knots.len() - 1)];
            let (from_s, to_s) = (times_s[knots[k]] - half_s, times_s[next] + half_s);
            while times_s[first + 1] < from_s {
                first += 1;
            }
            while end < last && times_s[end] <= to_s {
                end += 1;
            }
            let met = self.sets[first..end].iter();
            met.fold(AngleSet::Circle, |all, set| match set {
                AngleSet::Circle => all,
                set => all.intersection(set),
            })
        };
        (0..knots.len()).map(at_knot).collect()
    }
}

/// Stations at which the trajectory may bend: the first, the last, and between them each that is
/// `apart_s` or more after the one before.
pub(super) fn knots(times_s: &[f64], apart_s: f64) -> Vec<usize> {
    let last = times_s.len() - 1;
    let mut knots = vec![0];
    for k in 1..last {
        if times_s[k] - times_s[knots[knots.len() - 1]] >= apart_s {
            knots.push(k);
        }
    }
    knots.push(last);
    knots
}
