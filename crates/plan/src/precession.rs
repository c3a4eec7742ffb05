//! The precession angle of a wheel along a path on a flat face: as near to a steady turn as edges
//! and rates allow.
//!
//! A steady turn α = ω2 t would rub inward over every edge that it passes; clamping it point by
//! point makes it jump. Here the angle looks ahead:
//!
//! 1. The path is cut into short intervals. For each the allowed angles are those that suit *every*
//!    point of it (`PrecessionWheel::allowed_around`); an interval is halved where that leaves
//!    none though each point has some.
//! 2. They are narrowed to the angles that suit all intervals within half a window T = 2 ω̂/α̂ of
//!    time, ω̂ and α̂ being the largest rate and acceleration.
//! 3. Dynamic programming over a grid of angles finds the trajectory that stays within, turns by ω̂
//!    at most, never crosses a gap, and lies nearest to the steady turn (least integral of the
//!    squared deviation, whole turns not counted).
//! 4. A moving mean over T smooths it. A mean of a trajectory of rate ω̂ has a rate of ω̂ and an
//!    acceleration of 2 ω̂/T = α̂ at most; and since all that is averaged suits the place, so does
//!    the mean. No check by sampling is needed.
//! 5. Where 2 leaves nothing or 3 does not get through, the feed is lowered, by steps and with its
//!    own acceleration, and all is done again. Where a joint of the arm would be too fast, the
//!    angle is slowed there to what it can follow, and the feed where that is what the joint cannot
//!    follow.
//!
//! The steady turn goes by the clock: where the feed is lower it makes more turns on the way.

mod arm;
mod error;
mod feed;
mod search;
mod stations;
mod task;

use nalgebra::Vector2;
use truecut_core::wheel::precession::wrapped;

pub use arm::{ArmOnFace, ArmPlan};
pub use error::PrecessionPlanError;
pub use feed::FeedReduction;
pub use task::{PrecessionLimits, PrecessionOptions, PrecessionTask};

use feed::FeedPace;
use stations::Intervals;

/// Knots of the trajectory in a window of the mean. Fewer would widen the stretch that a knot's
/// angles must suit, more would make steps that the grid of angles renders badly.
const KNOTS_PER_WINDOW: f64 = 8.0;

/// A place of the plan. Between two of them the angle goes straight.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PrecessionPoint {
    /// Distance from the path's start.
    pub along_m: f64,
    pub point_m: Vector2<f64>,
    pub time_s: f64,
    /// Precession angle, turns counted.
    pub angle_rad: f64,
    /// How far it is from the steady turn, −π to π.
    pub deviation_rad: f64,
}

/// The angle along the path.
#[derive(Debug, Clone, PartialEq)]
pub struct PrecessionPlan {
    pub points: Vec<PrecessionPoint>,
    /// Where the feed had to be lowered, in order along the path.
    pub reductions: Vec<FeedReduction>,
    /// Time that the path takes at the feed asked for.
    pub asked_s: f64,
}

impl PrecessionPlan {
    /// Time that the path takes, s.
    pub fn duration_s(&self) -> f64 {
        self.points.last().map_or(0.0, |point| point.time_s)
    }

    /// Root of the mean squared deviation from the steady turn over time, rad.
    pub fn deviation_rms_rad(&self) -> f64 {
        let square = |p: &PrecessionPoint| p.deviation_rad.powi(2);
        let pairs = self.points.windows(2);
        let sum: f64 = pairs
            .map(|w| 0.5 * (square(&w[0]) + square(&w[1])) * (w[1].time_s - w[0].time_s))
            .sum();
        (sum / self.duration_s()).sqrt()
    }
}

impl PrecessionTask<'_> {
    /// The angle along the path, the arm not asked.
    ///
    /// # Errors
    /// If the path has fewer than two points, repeated or non-finite ones; a number is out of its
    /// range; a place leaves no angle; or the feed would have to fall below its least share.
    pub fn plan(
        &self,
        limits: &PrecessionLimits,
        options: &PrecessionOptions,
    ) -> Result<PrecessionPlan, PrecessionPlanError> {
        let (intervals, mut pace) = self.prepared(limits, options)?;
        self.planned(&intervals, &mut pace, limits, options)
    }

    fn prepared(
        &self,
        limits: &PrecessionLimits,
        options: &PrecessionOptions,
    ) -> Result<(Intervals, FeedPace), PrecessionPlanError> {
        error::check(self, limits, options)?;
        let intervals = Intervals::new(self, options.interval_m)?;
        let least = options.least_feed_share * self.feed_m_per_s;
        let pace = FeedPace::new(intervals.lengths_m(), self.feed_m_per_s, least, limits);
        Ok((intervals, pace))
    }

    /// The plan at a pace, whose feed is lowered until there is one.
    fn planned(
        &self,
        intervals: &Intervals,
        pace: &mut FeedPace,
        limits: &PrecessionLimits,
        options: &PrecessionOptions,
    ) -> Result<PrecessionPlan, PrecessionPlanError> {
        let window_s = limits.window_s();
        let grid = search::Grid {
            angles: options.angles,
        };
        loop {
            let times = pace.times_s();
            let nominal = |t: &f64| self.start_rad + self.turn_rad_s * t;
            let knots = stations::knots(&times, window_s / KNOTS_PER_WINDOW);
            let windows = intervals.windows(&times, &knots, window_s);
            let knot_times: Vec<f64> = knots.iter().map(|k| times[*k]).collect();
            let steady: Vec<f64> = knot_times.iter().map(nominal).collect();
            let rates = pace.least_rates_rad_s(&knots);
            let stuck = match grid.trajectory(&windows, &knot_times, &steady, &rates) {
                Ok(trajectory) => {
                    let angles = search::moving_mean(&knot_times, &trajectory, window_s, &times);
                    return Ok(self.finished(intervals, pace, &times, &angles));
                }
                Err(stuck) => stuck,
            };
            for knot in stuck.stations {
                let station = knots[knot];
                let begin_s = match stuck.narrow {
                    true => times[station],
                    false => pace.turned_before_s(station, &times),
                };
                let end_s = times[knots[(knot + 1).min(knots.len() - 1)]];
                let slowed = pace.slow(begin_s - window_s, end_s + window_s, &times);
                slowed.map_err(|least_m_per_s| PrecessionPlanError::TooNarrow {
                    along_m: intervals.along_m[station],
                    least_m_per_s,
                })?;
            }
            pace.settle();
        }
    }

    fn finished(
        &self,
        intervals: &Intervals,
        pace: &FeedPace,
        times: &[f64],
        angles: &[f64],
    ) -> PrecessionPlan {
        let points = (0..times.len()).map(|k| PrecessionPoint {
            along_m: intervals.along_m[k],
            point_m: intervals.points_m[k],
            time_s: times[k],
            angle_rad: angles[k],
            deviation_rad: wrapped(angles[k] - self.start_rad - self.turn_rad_s * times[k]),
        });
        PrecessionPlan {
            points: points.collect(),
            reductions: pace.reductions(&intervals.along_m),
            asked_s: intervals.along_m[times.len() - 1] / self.feed_m_per_s,
        }
    }
}
