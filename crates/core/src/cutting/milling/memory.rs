//! The surface that earlier teeth left, kept as the motion that made it.
//!
//! A tooth leaves an arc about the point where the axis stood at the time. All teeth of an equally
//! pitched cutter, at all heights of a helical edge, pass a given angle one pitch of rotation after
//! another, so that one trace of the axis over the angle of rotation holds the surfaces of all of
//! them, to the accuracy of its interpolation and without a grid. What a tooth reads was left at
//! least half a pitch of rotation before.

use nalgebra::{Vector2, Vector3};
use std::collections::VecDeque;

/// Displacement of the tool from its nominal path, over the angle of rotation.
#[derive(Debug, Clone, PartialEq)]
pub struct Trace {
    span_rad: f64,
    before_m: Vector3<f64>,
    points: VecDeque<(f64, Vector3<f64>)>,
    /// Least and greatest x and y of all places so far, m.
    box_m: [Vector2<f64>; 2],
}

/// A cubic through four equally spaced points lies, between the middle two, within 5/4 of half
/// their range about its middle: its weights sum to 5/4 in size at most.
const BEYOND_POINTS: f64 = 1.25;
/// Spacings that differ by no more than this part of them are equal.
const STEADY: f64 = 1e-9;

/// A displacement and how it changes with rotation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Passed {
    pub displacement_m: Vector3<f64>,
    pub displacement_m_per_rad: Vector3<f64>,
}

impl Trace {
    /// Remembers rotation by `span_rad`. Before its first point the tool ran displaced by
    /// `before_m`.
    pub fn new(span_rad: f64, before_m: Vector3<f64>) -> Self {
        Self {
            span_rad,
            before_m,
            points: VecDeque::new(),
            box_m: [before_m.xy(); 2],
        }
    }

    /// The tool has come to `rotation_rad`, further than before, displaced by `displacement_m`.
    pub fn commit(&mut self, rotation_rad: f64, displacement_m: Vector3<f64>) {
        debug_assert!(self.points.back().is_none_or(|p| p.0 < rotation_rad));
        self.points.push_back((rotation_rad, displacement_m));
        let [least_m, most_m] = self.box_m;
        let place_m = displacement_m.xy();
        self.box_m = [least_m.inf(&place_m), most_m.sup(&place_m)];
        // One point beyond the span on either side of the interpolation stays.
        while self.points.len() > 3 && self.points[2].0 < rotation_rad - self.span_rad {
            self.points.pop_front();
        }
    }

    /// How far along a direction, of length 1, the tool has been at most, m. Cubics between points
    /// leave their range by a part of it.
    pub fn furthest_m(&self, direction: Vector2<f64>) -> f64 {
        let [least_m, most_m] = self.box_m;
        let (middle_m, half_m) = (0.5 * (least_m + most_m), 0.5 * (most_m - least_m));
        middle_m.dot(&direction) + BEYOND_POINTS * half_m.dot(&direction.abs())
    }

    /// How far from a place it has been at most, m.
    pub fn furthest_from_m(&self, place_m: Vector2<f64>) -> f64 {
        let [least_m, most_m] = self.box_m;
        let (middle_m, half_m) = (0.5 * (least_m + most_m), 0.5 * (most_m - least_m));
        ((middle_m - place_m).abs() + BEYOND_POINTS * half_m).norm()
    }

    /// Where the tool last was.
    pub fn last(&self) -> Option<(f64, Vector3<f64>)> {
        self.points.back().copied()
    }

    /// Half of the way between the extremes of what is remembered, in the direction of the plane
    /// across the tool in which that is longest (of sixteen: to 0.5 %), m.
    pub fn amplitude_m(&self) -> f64 {
        let along = |k: usize| {
            let (y, x) = (std::f64::consts::PI * k as f64 / 16.0).sin_cos();
            let places = self
                .points
                .iter()
                .map(|point| x * point.1.x + y * point.1.y);
            let (low, high) = places.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), at| {
                (low.min(at), high.max(at))
            });
            0.5 * (high - low).max(0.0)
        };
        (0..16).map(along).fold(0.0, f64::max)
    }

    /// Where the tool was at `rotation_rad`: cubic through the two points on either side
    /// (Lagrange), straight at the ends; what was before the first point, the last point after it.
    pub fn at(&self, rotation_rad: f64) -> Passed {
        let still = |displacement_m| Passed {
            displacement_m,
            displacement_m_per_rad: Vector3::zeros(),
        };
        let after = self.after(rotation_rad);
        if after == 0 {
            return still(self.before_m);
        }
        if after == self.points.len() {
            return still(self.points[after - 1].1);
        }
        if after < 2 || after + 1 >= self.points.len() {
            return self.interpolate(after - 1, 2, rotation_rad);
        }
        self.cubic(after - 2, rotation_rad)
    }

    /// Number of points up to a rotation. Where the spindle has turned steadily it is told by the
    /// last spacing; elsewhere it is searched for.
    fn after(&self, rotation_rad: f64) -> usize {
        let count = self.points.len();
        let guess = match count {
            0 | 1 => 0,
            _ => {
                let last_rad = self.points[count - 1].0;
                let spacing_rad = last_rad - self.points[count - 2].0;
                let back = ((last_rad - rotation_rad) / spacing_rad).max(-1.0).floor() as isize;
                (count as isize - 1 - back).clamp(0, count as isize) as usize
            }
        };
        let before_it = |after: usize| after == 0 || self.points[after - 1].0 <= rotation_rad;
        let beyond_it = |after: usize| after == count || self.points[after].0 > rotation_rad;
        if before_it(guess) && beyond_it(guess) {
            return guess;
        }
        self.points.partition_point(|p| p.0 <= rotation_rad)
    }

    /// The cubic through four points from `first`.
    fn cubic(&self, first: usize, at: f64) -> Passed {
        let [a, b, c, d] = [0, 1, 2, 3].map(|i| self.points[first + i]);
        let spacing = c.0 - b.0;
        let unequal = |from: f64, to: f64| (to - from - spacing).abs() > STEADY * spacing;
        if unequal(a.0, b.0) || unequal(c.0, d.0) {
            return self.interpolate(first, 4, at);
        }
        let t = (at - b.0) / spacing;
        let (p, q, r) = (t + 1.0, t - 1.0, t - 2.0);
        let weights = [
            -t * q * r / 6.0,
            p * q * r / 2.0,
            -p * t * r / 2.0,
            p * t * q / 6.0,
        ];
        let slopes = [
            -(q * r + t * r + t * q) / 6.0,
            (q * r + p * r + p * q) / 2.0,
            -(t * r + p * r + p * t) / 2.0,
            (t * q + p * q + p * t) / 6.0,
        ];
        let sum = |w: [f64; 4]| a.1 * w[0] + b.1 * w[1] + c.1 * w[2] + d.1 * w[3];
        Passed {
            displacement_m: sum(weights),
            displacement_m_per_rad: sum(slopes.map(|slope| slope / spacing)),
        }
    }

    /// Lagrange's polynomial through `count` points from `first`, and its derivative.
    fn interpolate(&self, first: usize, count: usize, at: f64) -> Passed {
        let mut passed = Passed {
            displacement_m: Vector3::zeros(),
            displacement_m_per_rad: Vector3::zeros(),
        };
        let points = self.points.range(first..first + count);
        for (i, &(own, value)) in points.clone().enumerate() {
            let (mut weight, mut slope) = (1.0, 0.0);
            for (j, &(other, _)) in points.clone().enumerate() {
                if i != j {
                    let width = own - other;
                    slope = (slope * (at - other) + weight) / width;
                    weight *= (at - other) / width;
                }
            }
            passed.displacement_m += value * weight;
            passed.displacement_m_per_rad += value * slope;
        }
        passed
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn wave(rotation: f64) -> Vector3<f64> {
        Vector3::new(
            rotation.sin(),
            (2.0 * rotation).cos(),
            0.3 * rotation * rotation,
        )
    }

    /// Cubic interpolation of a wave of unit curvature at 40 points a turn is off by 3/128 (2π/40)⁴
    /// at most, times 16 for the wave of double frequency; the derivative loses one order.
    #[test]
    fn verify_trace_interpolates_to_fourth_order() {
        let step = std::f64::consts::TAU / 40.0;
        let mut trace = Trace::new(7.0, Vector3::zeros());
        for i in 0..200 {
            trace.commit(f64::from(i) * step, wave(f64::from(i) * step));
        }
        let bound = 3.0 / 128.0 * step.powi(4) * 16.0;
        for i in 0..500 {
            let at = 199.0 * step - 6.5 + 0.012 * f64::from(i);
            let passed = trace.at(at);
            assert!((passed.displacement_m - wave(at)).amax() <= bound, "{at}");
            let slope = (wave(at + 1e-5) - wave(at - 1e-5)) / 2e-5;
            assert!((passed.displacement_m_per_rad - slope).amax() <= 16.0 * step.powi(3));
        }
    }

    /// Steps need not be equal: what is left of a cubic is rounding.
    #[test]
    fn verify_a_cubic_is_met_exactly_over_unequal_and_equal_steps() {
        let cubic = |t: f64| Vector3::new(t.powi(3), 1.0 - t * t, t);
        for uneven in [0.0, 0.03] {
            let mut trace = Trace::new(7.0, Vector3::zeros());
            let place = |i: i32| 0.1 * f64::from(i) + uneven * f64::from(i % 3);
            for i in 0..60 {
                trace.commit(place(i), cubic(place(i)));
            }
            for i in 0..300 {
                let at = 0.3 + 0.017 * f64::from(i);
                let passed = trace.at(at);
                assert!((passed.displacement_m - cubic(at)).amax() < 1e-10, "{at}");
                let slope = Vector3::new(3.0 * at * at, -2.0 * at, 1.0);
                assert!(
                    (passed.displacement_m_per_rad - slope).amax() < 1e-9,
                    "{at}"
                );
            }
        }
    }

    /// What lies between points stays within the box that bounds it.
    #[test]
    fn verify_no_place_lies_beyond_the_furthest() {
        let mut trace = Trace::new(50.0, Vector3::zeros());
        for i in 0..400 {
            let place = Vector3::new(f64::from(i * i % 17), f64::from(i * 7 % 5), 0.0);
            trace.commit(0.1 * f64::from(i), place);
        }
        for i in 0..3000 {
            let place = trace.at(0.2 + 0.013 * f64::from(i)).displacement_m.xy();
            let turn = 0.7 * f64::from(i);
            let direction = Vector2::new(turn.sin(), turn.cos());
            assert!(place.dot(&direction) <= trace.furthest_m(direction) + 1e-12);
            let from = 10.0 * direction;
            assert!((place - from).norm() <= trace.furthest_from_m(from) + 1e-12);
        }
    }

    #[test]
    fn before_the_first_point_the_tool_was_where_it_was_said_to_be() {
        let mut trace = Trace::new(1.0, Vector3::y());
        assert_eq!(trace.at(0.3).displacement_m, Vector3::y());
        trace.commit(1.0, Vector3::x());
        assert_eq!(trace.at(0.9).displacement_m, Vector3::y());
        assert_eq!(trace.at(1.5).displacement_m, Vector3::x());
        trace.commit(2.0, Vector3::zeros());
        assert_eq!(trace.at(1.5).displacement_m, Vector3::x() * 0.5);
    }

    #[test]
    fn amplitude_is_half_the_way_between_extremes() {
        let mut trace = Trace::new(7.0, Vector3::repeat(1.0));
        assert_eq!(trace.amplitude_m(), 0.0);
        for i in 0..200 {
            let angle = f64::from(i) * 0.1;
            trace.commit(
                angle,
                Vector3::new(2.0, 1.0, 0.0) + 0.3 * angle.sin() * Vector3::y(),
            );
        }
        assert!((trace.amplitude_m() - 0.3).abs() < 1e-3);
    }

    #[test]
    fn the_trace_stays_short() {
        let mut trace = Trace::new(0.5, Vector3::zeros());
        for i in 0..10_000 {
            trace.commit(0.01 * f64::from(i), Vector3::zeros());
        }
        assert!(trace.points.len() < 60, "{}", trace.points.len());
    }
}
