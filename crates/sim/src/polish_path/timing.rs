//! When the wheel is where: a run-up from rest, and a filter that bounds what the arm is asked to do suddenly.
//!
//! Corners of the raster are arcs and feeds change by ramps, so that velocities are continuous but accelerations are not. A weighted mean over
//! [`WINDOW_S`] (Hann's window, as motion filters of controllers have) makes the acceleration continuous. It is taken of place and angle, not
//! of joints, so that the wheel's height over the face stays exact. On an arc of radius r it cuts the corner by 0.0163 (v T)²/r:
//! 0.03 mm at 20 mm/s and 2 mm.

use nalgebra::Vector2;
use std::f64::consts::TAU;

/// Time in which feed and turn come up to speed, s.
pub(super) const RUN_UP_S: f64 = 0.5;
/// Width of the filter, s.
pub(crate) const WINDOW_S: f64 = 0.1;
/// Samples of the filter's window.
const SAMPLES: usize = 20;

/// A place of the course.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Station {
    pub time_s: f64,
    /// Distance from the path's start.
    pub along_m: f64,
    pub point_m: Vector2<f64>,
    /// Precession angle, turns counted.
    pub angle_rad: f64,
}

impl Station {
    /// Between (or beyond) two stations, straight.
    fn between(&self, other: &Self, time_s: f64) -> Self {
        let part = (time_s - self.time_s) / (other.time_s - self.time_s);
        let mix = |a: f64, b: f64| a + part * (b - a);
        Self {
            time_s,
            along_m: mix(self.along_m, other.along_m),
            point_m: self.point_m + (other.point_m - self.point_m) * part,
            angle_rad: mix(self.angle_rad, other.angle_rad),
        }
    }
}

/// Samples of the filter: their times about the instant (s) and their weights.
pub(crate) fn window() -> Vec<(f64, f64)> {
    (0..SAMPLES)
        .map(|i| {
            let x = (i as f64 + 0.5) / SAMPLES as f64;
            let weight = (1.0 - (TAU * x).cos()) / SAMPLES as f64;
            ((x - 0.5) * WINDOW_S, weight)
        })
        .collect()
}

/// Places in order of time.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Course {
    stations: Vec<Station>,
}

impl Course {
    /// Two stations at least, times rising from 0.
    pub fn new(stations: Vec<Station>) -> Self {
        Self { stations }
    }

    /// Time from rest at the start to the end at full speed, s.
    pub fn duration_s(&self) -> f64 {
        self.stations[self.stations.len() - 1].time_s + 0.5 * RUN_UP_S
    }

    /// Time on the course's own clock: it starts at rest and is half a run-up late from then on.
    fn own_time_s(time_s: f64) -> f64 {
        // its rate rises as 3x² - 2x³
        let x = (time_s / RUN_UP_S).clamp(0.0, 1.0);
        RUN_UP_S * (x.powi(3) - 0.5 * x.powi(4)) + (time_s - RUN_UP_S).max(0.0)
    }

    /// Unfiltered; straight on beyond the end.
    fn at(&self, time_s: f64) -> Station {
        let own_s = Self::own_time_s(time_s);
        let after = self
            .stations
            .partition_point(|station| station.time_s <= own_s);
        let k = after.clamp(1, self.stations.len() - 1);
        self.stations[k - 1].between(&self.stations[k], own_s)
    }

    /// The filtered course at even times, from 0 to the first at or after the end.
    pub fn sampled(&self, interval_s: f64) -> Vec<Station> {
        let count = (self.duration_s() / interval_s - 1e-9).ceil() as usize;
        let weights = window();
        let mean = |time_s: f64| {
            let mut sum = Station {
                time_s,
                along_m: 0.0,
                point_m: Vector2::zeros(),
                angle_rad: 0.0,
            };
            for (offset_s, weight) in &weights {
                let one = self.at(time_s + offset_s);
                sum.along_m += weight * one.along_m;
                sum.point_m += *weight * one.point_m;
                sum.angle_rad += weight * one.angle_rad;
            }
            sum
        };
        (0..=count).map(|k| mean(k as f64 * interval_s)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A corner of a right angle at 20 mm/s.
    fn corner() -> Course {
        let station = |time_s: f64, x: f64, y: f64| Station {
            time_s,
            along_m: 0.02 * time_s,
            point_m: Vector2::new(x, y),
            angle_rad: 1.5 * time_s,
        };
        Course::new(vec![
            station(0.0, 0.0, 0.0),
            station(2.0, 0.04, 0.0),
            station(4.0, 0.04, 0.04),
        ])
    }

    /// The filter leaves straight stretches alone and bounds the acceleration at the corner: Hann's window is 2/T at its middle, so that
    /// a change of velocity Δv asks for 2 Δv/T at most.
    #[test]
    fn verify_filter_bounds_the_acceleration_at_a_corner() {
        let h = 5e-3;
        let stations = corner().sampled(h);
        let at = |t: f64| stations[(t / h).round() as usize];
        assert!((at(1.5).point_m - Vector2::new(0.025, 0.0)).norm() < 1e-12);
        assert!((at(1.5).angle_rad - 1.5 * 1.25).abs() < 1e-12);
        let hardest = stations
            .windows(3)
            .map(|w| (w[2].point_m - 2.0 * w[1].point_m + w[0].point_m).norm() / (h * h))
            .fold(0.0, f64::max);
        let bound = 2.0 * 0.02 * 2f64.sqrt() / WINDOW_S;
        assert!(
            hardest < 1.01 * bound && hardest > 0.9 * bound,
            "{hardest} {bound}"
        );
    }

    #[test]
    fn starts_at_rest_and_ends_where_the_path_does() {
        let course = corner();
        let stations = course.sampled(5e-3);
        assert!((stations[1].point_m - stations[0].point_m).norm() / 5e-3 < 2e-4);
        let end = stations[stations.len() - 1];
        assert!((end.time_s - course.duration_s()).abs() < 5e-3);
        assert!((end.point_m - Vector2::new(0.04, 0.04)).norm() < 1.1e-4);
    }
}
