//! When the tool is where: a course from rest to rest along places with times of their own.
//!
//! Between places the course runs straight, on a clock that starts and ends at rest; the clock's rate rises as 3x² - 2x³. Corners are rounded, and
//! what the places leave of kinks is smoothed, by the filter of the polishing path (Hann's window, `polish_path::timing`).
//! What a place is made of, its user says: parameters of a face and a height over it, or joints.

use crate::polish_path::timing::{WINDOW_S, window};
use std::ops::{Add, Mul, Sub};

/// Time in which the clock comes up to speed, and in which it ends, s.
const RAMP_S: f64 = 0.3;

/// Places in order of time, from rest to rest.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Course<V> {
    /// Time on the course's own clock.
    places: Vec<(f64, V)>,
}

impl<V> Course<V>
where
    V: Clone + Add<Output = V> + Sub<Output = V> + Mul<f64, Output = V>,
{
    /// Two places at least, their times rising from 0.
    pub fn new(places: Vec<(f64, V)>) -> Self {
        debug_assert!(places.len() > 1 && places.windows(2).all(|pair| pair[0].0 < pair[1].0));
        Self { places }
    }

    fn own_s(&self) -> f64 {
        self.places[self.places.len() - 1].0
    }

    /// A course that is shorter than its ramps is all ramps.
    fn ramp_s(&self) -> f64 {
        RAMP_S.min(self.own_s())
    }

    /// Time from rest to rest without the filter, s: each ramp takes twice what it would at the feed.
    fn unfiltered_s(&self) -> f64 {
        self.own_s() + self.ramp_s()
    }

    /// Time from the first sample to the last, s.
    pub fn duration_s(&self) -> f64 {
        self.unfiltered_s() + WINDOW_S
    }

    /// Time on the own clock.
    fn clock_s(&self, time_s: f64) -> f64 {
        let ramp = self.ramp_s();
        let ramped = |t: f64| {
            let x = (t / ramp).clamp(0.0, 1.0);
            ramp * (x.powi(3) - 0.5 * x.powi(4)) + (t - ramp).max(0.0)
        };
        let left_s = self.unfiltered_s() - time_s;
        if time_s < left_s {
            ramped(time_s)
        } else {
            self.own_s() - ramped(left_s)
        }
    }

    /// Unfiltered; at rest before the start and after the end.
    fn at(&self, time_s: f64) -> V {
        let own_s = self.clock_s(time_s);
        let after = self.places.partition_point(|(at_s, _)| *at_s <= own_s);
        let k = after.clamp(1, self.places.len() - 1);
        let ((from_s, from), (to_s, to)) = (&self.places[k - 1], &self.places[k]);
        let part = ((own_s - from_s) / (to_s - from_s)).clamp(0.0, 1.0);
        from.clone() + (to.clone() - from.clone()) * part
    }

    /// The filtered course at even times. The first is exactly the start, the last exactly the end: half a window is spent at rest
    /// at either.
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
        (0..=count)
            .map(|k| mean(k as f64 * interval_s - 0.5 * WINDOW_S))
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{DVector, dvector};

    const OWN_S: f64 = 3.5;

    /// Down by 20 mm, along a line of 100 mm from 0 to 1, up again: at 40 mm/s. Height (m), parameter.
    fn course() -> Course<DVector<f64>> {
        Course::new(vec![
            (0.0, dvector![0.02, 0.0]),
            (0.5, dvector![0.0, 0.0]),
            (3.0, dvector![0.0, 1.0]),
            (OWN_S, dvector![0.02, 1.0]),
        ])
    }

    #[test]
    fn verify_course_rests_at_both_ends_and_runs_at_its_speed_between() {
        let h = 5e-3;
        let places = course().sampled(h);
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
        let places = course().sampled(5e-3);
        let on_line: Vec<_> = places.iter().filter(|p| p[1] > 0.1 && p[1] < 0.9).collect();
        assert!(on_line.len() > 300);
        assert!(on_line.iter().all(|place| place[0].abs() < 1e-15));
        let second = |w: &[&DVector<f64>]| (w[2][1] - 2.0 * w[1][1] + w[0][1]).abs();
        assert!(on_line.windows(3).all(|w| second(w) < 1e-12));
    }

    /// A way shorter than a ramp takes at full speed is left and reached within the ramps.
    #[test]
    fn a_short_course_is_all_ramps() {
        let places = vec![(0.0, dvector![1e-3]), (0.025, dvector![0.0])];
        let places = Course::new(places).sampled(5e-3);
        assert!(places[places.len() - 1].norm() < 1e-15);
        assert!(places.windows(2).all(|w| w[1][0] <= w[0][0]));
    }
}
