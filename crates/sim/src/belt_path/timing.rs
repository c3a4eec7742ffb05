//! When the wheel is where: a course from rest to rest over a face, down onto a line, along it, up again.
//!
//! The course runs at the feed, lifts included, on a clock that starts and ends at rest; its rate rises as 3x² - 2x³. Corners between
//! descent, line and lift are rounded, and what a job's points leave of kinks is smoothed, by the filter of the polishing path (Hann's
//! window, `polish_path::timing`). It is taken of the parameters of the face, the lift and the axis' turn, not of joints: the wheel's height
//! over the face stays exact.

use crate::polish_path::timing::{WINDOW_S, window};
use nalgebra::SVector;

/// Time in which the feed comes up to speed, and in which it ends, s.
const RAMP_S: f64 = 0.3;

/// A place of the wheel: distance along the course (m), u, v, turn of the axis from r_u in the tangent plane (rad), lift (m).
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Place(SVector<f64, 5>);

impl Place {
    pub fn new(uv: [f64; 2], turn_rad: f64, lift_m: f64) -> Self {
        Self(SVector::from([0.0, uv[0], uv[1], turn_rad, lift_m]))
    }

    /// Distance from the course's start.
    pub fn along_m(&self) -> f64 {
        self.0[0]
    }

    pub fn uv(&self) -> [f64; 2] {
        [self.0[1], self.0[2]]
    }

    pub fn turn_rad(&self) -> f64 {
        self.0[3]
    }

    pub fn lift_m(&self) -> f64 {
        self.0[4]
    }
}

/// Places in order of time, from rest to rest.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Course {
    /// Time on the course's own clock, at the feed throughout.
    places: Vec<(f64, Place)>,
}

impl Course {
    /// Two places at least, each with its distance (m) from the one before; those at no distance are left out.
    pub fn new(places: impl Iterator<Item = (f64, Place)>, feed_m_per_s: f64) -> Self {
        let mut along_m = 0.0;
        let mut kept: Vec<(f64, Place)> = Vec::new();
        for (way_m, mut place) in places {
            if !kept.is_empty() && way_m <= 0.0 {
                continue;
            }
            along_m += way_m;
            place.0[0] = along_m;
            kept.push((along_m / feed_m_per_s, place));
        }
        Self { places: kept }
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
    fn at(&self, time_s: f64) -> SVector<f64, 5> {
        let own_s = self.clock_s(time_s);
        let after = self.places.partition_point(|(at_s, _)| *at_s <= own_s);
        let k = after.clamp(1, self.places.len() - 1);
        let ((from_s, from), (to_s, to)) = (self.places[k - 1], self.places[k]);
        let part = ((own_s - from_s) / (to_s - from_s)).clamp(0.0, 1.0);
        from.0 + (to.0 - from.0) * part
    }

    /// The filtered course at even times. The first is exactly the start, the last exactly the end: half a window is spent at rest
    /// at either.
    pub fn sampled(&self, interval_s: f64) -> Vec<Place> {
        let duration_s = self.unfiltered_s() + WINDOW_S;
        let count = (duration_s / interval_s - 1e-9).ceil() as usize;
        let weights = window();
        let mean = |time_s: f64| {
            let parts = weights
                .iter()
                .map(|(offset_s, weight)| *weight * self.at(time_s + offset_s));
            Place(parts.sum())
        };
        (0..=count)
            .map(|k| mean(k as f64 * interval_s - 0.5 * WINDOW_S))
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const FEED: f64 = 0.04;

    /// Down by 20 mm, along a line of 100 mm from u = 0 to 1, up again.
    fn course() -> Course {
        let places = [
            (0.0, Place::new([0.0, 0.5], 0.1, 0.02)),
            (0.02, Place::new([0.0, 0.5], 0.1, 0.0)),
            (0.1, Place::new([1.0, 0.5], 0.3, 0.0)),
            (0.0, Place::new([1.0, 0.5], 0.3, 0.0)),
            (0.02, Place::new([1.0, 0.5], 0.3, 0.02)),
        ];
        Course::new(places.into_iter(), FEED)
    }

    #[test]
    fn verify_course_rests_at_both_ends_and_runs_at_the_feed_between() {
        let h = 5e-3;
        let places = course().sampled(h);
        let (first, last) = (places[0], places[places.len() - 1]);
        assert!((first.lift_m() - 0.02).abs() < 1e-12 && first.uv()[0].abs() < 1e-12);
        assert!((last.lift_m() - 0.02).abs() < 1e-12 && (last.uv()[0] - 1.0).abs() < 1e-12);
        assert!((last.along_m() - 0.14).abs() < 1e-12);
        let moved = |a: &Place, b: &Place| (b.along_m() - a.along_m()) / h;
        let count = places.len();
        assert!(moved(&places[0], &places[1]) < 1e-3 * FEED);
        assert!(moved(&places[count - 2], &places[count - 1]) < 1e-3 * FEED);
        let fastest = places.windows(2).map(|w| moved(&w[0], &w[1]));
        assert!((fastest.fold(0.0, f64::max) / FEED - 1.0).abs() < 1e-9);
        let expected_s = 0.14 / FEED + RAMP_S + WINDOW_S;
        assert!(((count - 1) as f64 * h - expected_s).abs() < h);
    }

    /// On the line, away from its ends, the filter changes nothing: place and time are those of the feed.
    #[test]
    fn verify_line_is_followed_exactly() {
        let places = course().sampled(5e-3);
        let on_line: Vec<&Place> = (places.iter())
            .filter(|p| p.uv()[0] > 0.1 && p.uv()[0] < 0.9)
            .collect();
        assert!(on_line.len() > 300);
        for place in on_line {
            assert!(place.lift_m().abs() < 1e-15);
            assert!((place.along_m() - 0.02 - 0.1 * place.uv()[0]).abs() < 1e-12);
            assert!((place.turn_rad() - 0.1 - 0.2 * place.uv()[0]).abs() < 1e-12);
        }
    }

    /// A lift shorter than a ramp takes at the feed is left and reached within the ramps.
    #[test]
    fn a_short_course_is_all_ramps() {
        let places = [
            (0.0, Place::new([0.0, 0.0], 0.0, 1e-3)),
            (1e-3, Place::new([0.0, 0.0], 0.0, 0.0)),
        ];
        let places = Course::new(places.into_iter(), FEED).sampled(5e-3);
        let last = places[places.len() - 1];
        assert!(last.lift_m().abs() < 1e-15);
        assert!(places.windows(2).all(|w| w[1].lift_m() <= w[0].lift_m()));
    }
}
