//! Surfaces with values at their corners, thinned for a page.

use std::collections::HashMap;

/// Triangles, and a value at each corner; no values: one colour.
#[derive(Debug, Clone, Default)]
pub struct Surface {
    pub corners_m: Vec<[f64; 3]>,
    /// Counter-clockwise seen from outside.
    pub triangles: Vec<[u32; 3]>,
    pub values: Vec<f64>,
}

/// Cells along the diagonal, the first that leaves few enough triangles.
const CELLS: [f64; 12] = [
    600.0, 400.0, 280.0, 200.0, 140.0, 100.0, 70.0, 50.0, 36.0, 24.0, 16.0, 10.0,
];
/// Corners closer than this part of the diagonal are one.
const SAME: f64 = 1e7;

impl Surface {
    /// Equal corners as one.
    pub fn joined(&self) -> Surface {
        self.on_grid(SAME)
    }

    /// At most so many triangles, or as few as a coarse grid leaves: corners in one cell become
    /// one at their mean, its value theirs (`rossignac1993`).
    pub fn thinned(&self, most: usize) -> Surface {
        let mut coarsest = self.joined();
        for cells in CELLS {
            if coarsest.triangles.len() <= most {
                break;
            }
            coarsest = self.on_grid(cells);
        }
        coarsest
    }

    fn on_grid(&self, cells: f64) -> Surface {
        let low = self.bound(f64::min, f64::INFINITY);
        let high = self.bound(f64::max, f64::NEG_INFINITY);
        let diagonal = (0..3)
            .map(|k| (high[k] - low[k]).powi(2))
            .sum::<f64>()
            .sqrt();
        let cell_m = (diagonal / cells).max(f64::MIN_POSITIVE);
        let mut known: HashMap<[i64; 3], u32> = HashMap::new();
        let mut means: Vec<Mean> = Vec::new();
        let mut corner_of = Vec::with_capacity(self.corners_m.len());
        for (k, corner) in self.corners_m.iter().enumerate() {
            let cell = std::array::from_fn(|axis| ((corner[axis] - low[axis]) / cell_m) as i64);
            let index = *known.entry(cell).or_insert_with(|| {
                means.push(Mean::default());
                means.len() as u32 - 1
            });
            means[index as usize].add(corner, self.values.get(k).copied());
            corner_of.push(index);
        }
        let triangles = self.triangles.iter();
        let triangles = triangles.map(|corners| corners.map(|k| corner_of[k as usize]));
        let is_flat = |[a, b, c]: &[u32; 3]| a == b || b == c || c == a;
        let mut triangles: Vec<[u32; 3]> = triangles.filter(|one| !is_flat(one)).collect();
        let mut seen = std::collections::HashSet::new();
        triangles.retain(|one| {
            // The smallest corner first: what is left says which way round it is.
            let first = (0..3).min_by_key(|k| one[*k]).unwrap_or(0);
            seen.insert([0, 1, 2].map(|k| one[(first + k) % 3]))
        });
        Surface {
            corners_m: means.iter().map(Mean::corner_m).collect(),
            triangles,
            values: match self.values.is_empty() {
                true => Vec::new(),
                false => means.iter().map(Mean::value).collect(),
            },
        }
    }

    fn bound(&self, pick: fn(f64, f64) -> f64, from: f64) -> [f64; 3] {
        let corners = self.corners_m.iter();
        corners.fold([from; 3], |end, corner| {
            std::array::from_fn(|axis| pick(end[axis], corner[axis]))
        })
    }
}

/// Of the corners in a cell.
#[derive(Default)]
struct Mean {
    count: f64,
    sum_m: [f64; 3],
    values: f64,
    sum: f64,
}

impl Mean {
    fn add(&mut self, corner: &[f64; 3], value: Option<f64>) {
        self.count += 1.0;
        for (sum, x) in self.sum_m.iter_mut().zip(corner) {
            *sum += x;
        }
        if let Some(value) = value.filter(|value| value.is_finite()) {
            self.values += 1.0;
            self.sum += value;
        }
    }

    fn corner_m(&self) -> [f64; 3] {
        self.sum_m.map(|sum| sum / self.count)
    }

    /// Not a number where no corner has one.
    fn value(&self) -> f64 {
        self.sum / self.values
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A plane of cells as single triangles, with the value x + 2 y, thinned: it stays a plane with
    /// these values, and there are as few triangles as asked for.
    #[test]
    fn a_plane_and_a_linear_value_survive_thinning() {
        let mut plane = Surface::default();
        for k in 0..100 * 100 {
            let (x, y) = (f64::from(k % 100), f64::from(k / 100));
            let (a, b, c, d) = ([x, y], [x + 1.0, y], [x + 1.0, y + 1.0], [x, y + 1.0]);
            for triangle in [[a, b, c], [a, c, d]] {
                let first = plane.corners_m.len() as u32;
                plane.triangles.push([first, first + 1, first + 2]);
                for [x, y] in triangle {
                    plane.corners_m.push([x, y, 3.0]);
                    plane.values.push(x + 2.0 * y);
                }
            }
        }
        let joined = plane.joined();
        assert_eq!(joined.corners_m.len(), 101 * 101);
        assert_eq!(joined.triangles.len(), plane.triangles.len());
        let thin = plane.thinned(3000);
        assert!(
            (500..=3000).contains(&thin.triangles.len()),
            "{}",
            thin.triangles.len()
        );
        for (corner, value) in thin.corners_m.iter().zip(&thin.values) {
            assert!((value - corner[0] - 2.0 * corner[1]).abs() < 1e-9);
            assert!((corner[2] - 3.0).abs() < 1e-12);
        }
        let up = |[a, b, c]: &[u32; 3]| {
            let at = |k: &u32| thin.corners_m[*k as usize];
            let (a, b, c) = (at(a), at(b), at(c));
            (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]) >= 0.0
        };
        assert!(thin.triangles.iter().all(up), "seen from above as before");
    }

    #[test]
    fn a_value_that_no_corner_has_stays_missing() {
        let surface = Surface {
            corners_m: vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
            triangles: vec![[0, 1, 2]],
            values: vec![f64::NAN, 1.0, f64::NAN],
        };
        let joined = surface.joined();
        assert!(joined.values[0].is_nan() && joined.values[1] == 1.0);
    }
}
