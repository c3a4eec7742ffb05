//! The way of a tooth's tip.

use nalgebra::Vector2;

/// A part of the way of a tooth's tip: an arc about an axis that moves.
#[derive(Debug, Clone, Copy)]
pub(super) struct ToothArc {
    turned_rad: f64,
    /// Directions from the axis to the tooth at both ends.
    outward: [Vector2<f64>; 2],
    axis_m: [Vector2<f64>; 2],
    pub radius_m: f64,
}

impl ToothArc {
    /// Between two angles, of which the latter is the larger by far less than a turn.
    pub fn new(angles_rad: [f64; 2], axis_m: [Vector2<f64>; 2], radius_m: f64) -> Self {
        let outward = angles_rad.map(|angle| {
            let (sin, cos) = angle.sin_cos();
            Vector2::new(sin, cos)
        });
        Self {
            turned_rad: angles_rad[1] - angles_rad[0],
            outward,
            axis_m,
            radius_m,
        }
    }

    /// Where on the arc a tooth points at a place: the share of the way, a little beyond its ends
    /// included, and the axis then.
    pub fn at(&self, place_m: &Vector2<f64>) -> Option<(f64, Vector2<f64>)> {
        const BEYOND: f64 = 0.05;
        let d = place_m - 0.5 * (self.axis_m[0] + self.axis_m[1]);
        let [from, to] = &self.outward;
        if d.dot(&(from + to)) <= 0.0 {
            return None;
        }
        // A tooth moves along (cos, -sin).
        let ahead = d.x * from.y - d.y * from.x;
        let behind = d.x * to.y - d.y * to.x;
        let share = ahead / (ahead - behind);
        if !(-BEYOND..=1.0 + BEYOND).contains(&share) {
            return None;
        }
        let axis_m = self.axis_m[0].lerp(&self.axis_m[1], share.clamp(0.0, 1.0));
        Some((share, axis_m))
    }

    /// Least and greatest places that a ring between two radii reaches.
    pub fn bounds(&self, [inner_m, outer_m]: [f64; 2]) -> [Vector2<f64>; 2] {
        let way_m = (self.axis_m[1] - self.axis_m[0]).norm();
        let margin_m = outer_m * self.turned_rad * self.turned_rad / 8.0 + way_m;
        let none = Vector2::repeat(f64::INFINITY);
        let mut bounds = [none, -none];
        for outward in self.outward {
            for radius in [inner_m, outer_m] {
                let place = self.axis_m[0] + radius * outward;
                bounds = [bounds[0].inf(&place), bounds[1].sup(&place)];
            }
        }
        [
            bounds[0].add_scalar(-margin_m),
            bounds[1].add_scalar(margin_m),
        ]
    }
}
