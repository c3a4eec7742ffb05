//! Trajectories: knots with times, run through by a timing law and smoothed by a filter.
//!
//! Between knots a trajectory runs straight, so that corners are kinks of the velocity. A weighted
//! mean over [`WINDOW_S`] (Hann's window, as motion filters of controllers have) blends them: the
//! acceleration becomes continuous. It is taken of what the knots are made of; where that is place
//! and height over a face and not joints, the height stays exact. On an arc of radius r it cuts the
//! corner by 0.0163 (v T)²/r: 0.03 mm at 20 mm/s and 2 mm.

use std::f64::consts::TAU;
use std::ops::{Add, Mul, Sub};

use super::timing::TimingLaw;

/// Width of the filter, s.
pub const WINDOW_S: f64 = 0.1;
/// Samples of the filter's window.
const SAMPLES: usize = 20;

/// Knots in order of time.
#[derive(Debug, Clone, PartialEq)]
pub struct Trajectory<V> {
    /// With their times on the path's own clock, from 0, s.
    knots: Vec<(f64, V)>,
    law: TimingLaw,
}

impl<V> Trajectory<V>
where
    V: Clone + Add<Output = V> + Sub<Output = V> + Mul<f64, Output = V>,
{
    /// Two knots at least, their times rising from 0.
    #[must_use]
    pub fn new(knots: Vec<(f64, V)>, law: TimingLaw) -> Self {
        debug_assert!(knots.len() > 1);
        Self { knots, law }
    }

    fn own_s(&self) -> f64 {
        self.knots[self.knots.len() - 1].0
    }

    /// Time from the first sample to the last, s. From rest to rest half a window is spent at rest
    /// at either end.
    #[must_use]
    pub fn duration_s(&self) -> f64 {
        let unfiltered_s = self.law.duration_s(self.own_s());
        match self.law {
            TimingLaw::FromRest(_) => unfiltered_s,
            TimingLaw::RestToRest(_) => unfiltered_s + WINDOW_S,
        }
    }

    /// Unfiltered: at rest before the start; after the end at rest, or straight on.
    fn at(&self, time_s: f64) -> V {
        let own_s = self.law.own_s(time_s, self.own_s());
        let after = self.knots.partition_point(|(at_s, _)| *at_s <= own_s);
        let k = after.clamp(1, self.knots.len() - 1);
        let ((from_s, from), (to_s, to)) = (&self.knots[k - 1], &self.knots[k]);
        let part = (own_s - from_s) / (to_s - from_s);
        let part = match self.law {
            TimingLaw::FromRest(_) => part,
            TimingLaw::RestToRest(_) => part.clamp(0.0, 1.0),
        };
        from.clone() + (to.clone() - from.clone()) * part
    }

    /// The filtered trajectory at even times, from 0 to the first at or after the end. From rest to
    /// rest the first is exactly the first knot and the last exactly the last.
    ///
    /// # Panics
    /// Never: the window has samples.
    #[must_use]
    pub fn sampled(&self, interval_s: f64) -> Vec<V> {
        let count = (self.duration_s() / interval_s - 1e-9).ceil() as usize;
        let weights = window();
        let mean = |time_s: f64| {
            let parts = weights
                .iter()
                .map(|(offset_s, weight)| self.at(time_s + offset_s) * *weight);
            parts
                .reduce(|sum, part| sum + part)
                .expect("a window has weights")
        };
        let begin_s = match self.law {
            TimingLaw::FromRest(_) => 0.0,
            TimingLaw::RestToRest(_) => 0.5 * WINDOW_S,
        };
        (0..=count)
            .map(|k| mean(k as f64 * interval_s - begin_s))
            .collect()
    }
}

/// Samples of the filter: their times about the instant (s) and their weights.
fn window() -> Vec<(f64, f64)> {
    (0..SAMPLES)
        .map(|i| {
            let x = (i as f64 + 0.5) / SAMPLES as f64;
            let weight = (1.0 - (TAU * x).cos()) / SAMPLES as f64;
            ((x - 0.5) * WINDOW_S, weight)
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::motion::timing::LeadIn;
    use nalgebra::{DVector, Vector2, dvector};

    const OWN_S: f64 = 3.5;
    const RAMP_S: f64 = 0.3;
    const RUN_UP_S: f64 = 0.5;

    fn rest_to_rest(knots: Vec<(f64, DVector<f64>)>) -> Trajectory<DVector<f64>> {
        let law = TimingLaw::RestToRest(LeadIn { duration_s: RAMP_S });
        Trajectory::new(knots, law)
    }

    /// Down by 20 mm, along a line of 100 mm from 0 to 1, up again: at 40 mm/s. Height (m),
    /// parameter.
    fn line() -> Trajectory<DVector<f64>> {
        rest_to_rest(vec![
            (0.0, dvector![0.02, 0.0]),
            (0.5, dvector![0.0, 0.0]),
            (3.0, dvector![0.0, 1.0]),
            (OWN_S, dvector![0.02, 1.0]),
        ])
    }

    /// A corner of a right angle at 20 mm/s.
    fn corner() -> Trajectory<Vector2<f64>> {
        let knots = vec![
            (0.0, Vector2::new(0.0, 0.0)),
            (2.0, Vector2::new(0.04, 0.0)),
            (4.0, Vector2::new(0.04, 0.04)),
        ];
        let lead_in = LeadIn {
            duration_s: RUN_UP_S,
        };
        Trajectory::new(knots, TimingLaw::FromRest(lead_in))
    }

    #[test]
    fn verify_it_rests_at_both_ends_and_runs_at_its_speed_between() {
        let h = 5e-3;
        let places = line().sampled(h);
        let count = places.len();
        assert!((&places[0] - dvector![0.02, 0.0]).norm() < 1e-12);
        assert!((&places[count - 1] - dvector![0.02, 1.0]).norm() < 1e-12);
        let rate = |k: usize| (places[k + 1][1] - places[k][1]) / h;
        let lift = |k: usize| (places[k + 1][0] - places[k][0]) / h;
        assert!(lift(0).abs() < 4e-5 && lift(count - 2).abs() < 4e-5);
        let fastest = (0..count - 1).map(rate).fold(0.0, f64::max);
        assert!((fastest / 0.4 - 1.0).abs() < 1e-9);
        let expected_s = OWN_S + RAMP_S + WINDOW_S;
        assert!(((count - 1) as f64 * h - expected_s).abs() < h);
    }

    /// On the line, away from its ends, the filter changes nothing.
    #[test]
    fn verify_line_is_followed_exactly() {
        let places = line().sampled(5e-3);
        let on_line: Vec<_> = places.iter().filter(|p| p[1] > 0.1 && p[1] < 0.9).collect();
        assert!(on_line.len() > 300);
        assert!(on_line.iter().all(|place| place[0].abs() < 1e-15));
        let second = |w: &[&DVector<f64>]| (w[2][1] - 2.0 * w[1][1] + w[0][1]).abs();
        assert!(on_line.windows(3).all(|w| second(w) < 1e-12));
    }

    /// A way shorter than a ramp takes at full speed is left and reached within the ramps.
    #[test]
    fn a_short_way_is_all_ramps() {
        let places = vec![(0.0, dvector![1e-3]), (0.025, dvector![0.0])];
        let places = rest_to_rest(places).sampled(5e-3);
        assert!(places[places.len() - 1].norm() < 1e-15);
        assert!(places.windows(2).all(|w| w[1][0] <= w[0][0]));
    }

    /// The filter leaves straight stretches alone and bounds the acceleration at the corner: Hann's
    /// window is 2/T at its middle, so that a change of velocity Δv asks for 2 Δv/T at most.
    #[test]
    fn verify_filter_bounds_the_acceleration_at_a_corner() {
        let h = 5e-3;
        let places = corner().sampled(h);
        let at = |t: f64| places[(t / h).round() as usize];
        assert!((at(1.5) - Vector2::new(0.025, 0.0)).norm() < 1e-12);
        let hardest = places
            .windows(3)
            .map(|w| (w[2] - 2.0 * w[1] + w[0]).norm() / (h * h))
            .fold(0.0, f64::max);
        let bound = 2.0 * 0.02 * 2f64.sqrt() / WINDOW_S;
        assert!(
            hardest < 1.01 * bound && hardest > 0.9 * bound,
            "{hardest} {bound}"
        );
    }

    #[test]
    fn from_rest_it_ends_where_the_last_knot_is() {
        let corner = corner();
        let places = corner.sampled(5e-3);
        assert!((places[1] - places[0]).norm() / 5e-3 < 2e-4);
        let end_s = (places.len() - 1) as f64 * 5e-3;
        assert!((end_s - corner.duration_s()).abs() < 5e-3);
        let end = places[places.len() - 1];
        assert!((end - Vector2::new(0.04, 0.04)).norm() < 1.1e-4);
    }
}
