//! The surface that earlier teeth left, kept as the motion that made it.
//!
//! A tooth leaves an arc about the point where the axis stood at the time. All teeth of an equally
//! pitched cutter, at all heights of a helical edge, pass a given angle one pitch of rotation after
//! another, so that one trace of the axis over the angle of rotation holds the surfaces of all of
//! them, to the accuracy of its interpolation and without a grid. What a tooth reads was left at
//! least half a pitch of rotation before.

use nalgebra::Vector3;
use std::collections::VecDeque;

/// Displacement of the tool from its nominal path, over the angle of rotation.
#[derive(Debug, Clone, PartialEq)]
pub struct Trace {
    span_rad: f64,
    before_m: Vector3<f64>,
    points: VecDeque<(f64, Vector3<f64>)>,
}

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
        }
    }

    /// The tool has come to `rotation_rad`, further than before, displaced by `displacement_m`.
    pub fn commit(&mut self, rotation_rad: f64, displacement_m: Vector3<f64>) {
        debug_assert!(self.points.back().is_none_or(|p| p.0 < rotation_rad));
        self.points.push_back((rotation_rad, displacement_m));
        // One point beyond the span on either side of the interpolation stays.
        while self.points.len() > 3 && self.points[2].0 < rotation_rad - self.span_rad {
            self.points.pop_front();
        }
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
        let after = self.points.partition_point(|p| p.0 <= rotation_rad);
        if after == 0 {
            return still(self.before_m);
        }
        if after == self.points.len() {
            return still(self.points[after - 1].1);
        }
        if after < 2 || after + 1 >= self.points.len() {
            return self.interpolate(after - 1, 2, rotation_rad);
        }
        self.interpolate(after - 2, 4, rotation_rad)
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
