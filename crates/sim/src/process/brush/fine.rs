//! Rows over a mesh that has corners everywhere.

use super::rows::{BristleRow, EVEN, SLICES, Sections};
use super::section::Side;

/// Stretches in which it is looked at.
const STRETCHES: usize = 16;

impl Sections<'_> {
    /// By Simpson's rule where a stretch of slices presses at its ends and in its middle as if it
    /// changed evenly, else slice by slice.
    pub fn fine_rows(&mut self) -> Vec<BristleRow> {
        let (end_m, length_m) = (0.5 * self.width_m, self.width_m / STRETCHES as f64);
        let place_m = |half: usize| 0.5 * length_m * half as f64 - end_m;
        let pressed: Vec<f64> = (0..=2 * STRETCHES)
            .map(|half| self.pressed(place_m(half)))
            .collect();
        let most = pressed.iter().copied().fold(0.0, f64::max);
        let mut shares = vec![0.0; 2 * STRETCHES + 1];
        let (mut rows, slices) = (Vec::new(), SLICES / STRETCHES);
        for stretch in 0..STRETCHES {
            let [one, middle, other] = [0, 1, 2].map(|k| pressed[2 * stretch + k]);
            let bends = (one - 2.0 * middle + other).abs();
            // Where nothing is met at one place and something at another it ends in between.
            let ends = (one > 0.0) != (middle > 0.0) || (middle > 0.0) != (other > 0.0);
            if !ends && bends <= EVEN * most {
                for (k, weight) in [1.0, 4.0, 1.0].into_iter().enumerate() {
                    shares[2 * stretch + k] += weight / (6 * STRETCHES) as f64;
                }
                continue;
            }
            let row = |k: usize| BristleRow {
                y_m: place_m(2 * stretch) + length_m * (k as f64 + 0.5) / slices as f64,
                share: 1.0 / SLICES as f64,
            };
            rows.extend((0..slices).map(row));
        }
        let simple = shares
            .into_iter()
            .enumerate()
            .filter(|(_, share)| *share > 0.0);
        rows.extend(simple.map(|(half, share)| BristleRow {
            y_m: place_m(half),
            share,
        }));
        rows
    }

    /// How much bristles at a place along the axis are shortened, all together; keeps its section.
    fn pressed(&mut self, y_m: f64) -> f64 {
        let mut sides = Vec::new();
        self.nearest(y_m, &mut sides);
        let shortened = |side: &Side| {
            let middle = 0.5 * (side.from_rad + side.to_rad);
            (side.to_rad - side.from_rad) * (self.reach_m - side.along_bristle_m(middle))
        };
        let sum = sides.iter().map(shortened).sum();
        self.known.insert(y_m.to_bits(), sides);
        sum
    }
}
