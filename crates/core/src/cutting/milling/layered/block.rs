//! A block of stock, and holes through it.

use nalgebra::{SVector, Vector2, Vector3};

/// A box of stock, its faces along the axes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Block {
    pub least_m: Vector3<f64>,
    pub most_m: Vector3<f64>,
}

impl Block {
    /// Volume, m³.
    pub fn volume_m3(&self) -> f64 {
        (self.most_m - self.least_m).product()
    }

    /// Whether a place of the plane lies in it.
    pub fn contains(&self, place_m: &Vector2<f64>) -> bool {
        (self.least_m.x..=self.most_m.x).contains(&place_m.x)
            && (self.least_m.y..=self.most_m.y).contains(&place_m.y)
    }

    /// How far a place of the plane lies outside, m.
    pub fn outside_m(&self, place_m: &Vector2<f64>) -> f64 {
        let beyond = |at: f64, least: f64, most: f64| (least - at).max(at - most).max(0.0);
        let x = beyond(place_m.x, self.least_m.x, self.most_m.x);
        let y = beyond(place_m.y, self.least_m.y, self.most_m.y);
        x.hypot(y)
    }

    /// Length of the way between two places in space that lies in the block, m.
    pub(in crate::cutting::milling) fn length_m(
        &self,
        from_m: &Vector3<f64>,
        to_m: &Vector3<f64>,
    ) -> f64 {
        let along_m = to_m - from_m;
        let (low, high) = self.clip(from_m, &along_m);
        along_m.norm() * (high - low)
    }

    /// Shares of a way, in the plane or in space, within which it lies in the block.
    pub(in crate::cutting::milling) fn clip<const D: usize>(
        &self,
        from_m: &SVector<f64, D>,
        along_m: &SVector<f64, D>,
    ) -> (f64, f64) {
        let (mut low, mut high) = (0.0_f64, 1.0_f64);
        for axis in 0..D {
            let (start, rate) = (from_m[axis], along_m[axis]);
            let (least, most) = (self.least_m[axis], self.most_m[axis]);
            if rate == 0.0 {
                if start < least || start > most {
                    return (0.0, 0.0);
                }
                continue;
            }
            let (a, b) = ((least - start) / rate, (most - start) / rate);
            low = low.max(a.min(b));
            high = high.min(a.max(b));
        }
        (low, high.max(low))
    }
}

/// A round hole through the block, along z.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hole {
    pub centre_m: Vector2<f64>,
    pub radius_m: f64,
}
