//! Triangles under a brush by layers across its axis.

use super::rows::{Corners, SLICES};

/// Which triangles reach into which layer of the brush: as many layers as there are triangles for,
/// so that few are looked at in vain.
pub(super) struct Layers {
    end_m: f64,
    per_m: f64,
    /// Where the triangles of each layer begin among `triangles`, and where the last one's end.
    starts: Vec<usize>,
    triangles: Vec<usize>,
}

impl Layers {
    pub fn new(triangles: &[Corners], width_m: f64) -> Self {
        let count = (triangles.len() / 2).clamp(1, SLICES);
        let mut layers = Self {
            end_m: 0.5 * width_m,
            per_m: count as f64 / width_m,
            starts: vec![0; count + 1],
            triangles: Vec::new(),
        };
        let reached = |layers: &Self, [a, b, c]: &Corners| {
            let (low_m, high_m) = (a.y.min(b.y).min(c.y), a.y.max(b.y).max(c.y));
            layers.at(low_m)..=layers.at(high_m)
        };
        for corners in triangles {
            for layer in reached(&layers, corners) {
                layers.starts[layer + 1] += 1;
            }
        }
        for layer in 0..count {
            layers.starts[layer + 1] += layers.starts[layer];
        }
        layers.triangles = vec![0; layers.starts[count]];
        let mut next = layers.starts.clone();
        for (index, corners) in triangles.iter().enumerate() {
            for layer in reached(&layers, corners) {
                layers.triangles[next[layer]] = index;
                next[layer] += 1;
            }
        }
        layers
    }

    /// The layer that holds a place along the axis; the first and the last one go on beyond the
    /// ends.
    fn at(&self, y_m: f64) -> usize {
        (((y_m + self.end_m) * self.per_m).max(0.0) as usize).min(self.starts.len() - 2)
    }

    /// Triangles that may be cut by the plane at a place along the axis, in their order.
    pub fn over(&self, y_m: f64) -> &[usize] {
        let layer = self.at(y_m);
        &self.triangles[self.starts[layer]..self.starts[layer + 1]]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Vector3;
    use proptest::prelude::*;

    proptest! {
        /// Every triangle that a plane cuts is found there, once and in order.
        #[test]
        fn verify_no_triangle_is_missing_in_its_layers(
            corners in prop::collection::vec([-20e-3..20e-3_f64, -20e-3..20e-3, -20e-3..20e-3], 1..300),
            places in prop::collection::vec(-10e-3..10e-3_f64, 50),
        ) {
            let triangle = |y: &[f64; 3]| y.map(|y| Vector3::new(0.0, y, 0.0));
            let triangles: Vec<Corners> = corners.iter().map(triangle).collect();
            let layers = Layers::new(&triangles, 20e-3);
            for y_m in places {
                let found = layers.over(y_m);
                prop_assert!(found.windows(2).all(|pair| pair[0] < pair[1]));
                for (index, corners) in triangles.iter().enumerate() {
                    let is_cut = corners.iter().any(|c| c.y <= y_m)
                        && corners.iter().any(|c| c.y >= y_m);
                    prop_assert!(!is_cut || found.contains(&index));
                }
            }
        }
    }
}
