//! A closed mesh as stock: the layers are filled by its sections.
//!
//! A layer has the section at half its height. Level faces bound layers, so that upright walls and
//! steps are exact but for the grid; a face that leans is cut into layers no higher than the grid,
//! of which each holds as much as the mesh does there, to second order. An upright cutter and the
//! layers know no undercuts: a mesh with a face that looks down, but for its underside, is refused.

use super::block::Block;
use super::stock::{FAR, LayeredStock};
use super::way::SAME_DEPTH_M;
use nalgebra::{Vector2, Vector3};

/// Faces with less of a normal along z are upright: meshes in single precision lean by some of it.
const UPRIGHT: f64 = 0.01;
/// The grid goes on beside the mesh, in spacings.
const MARGIN: f64 = 1.5;

/// A mesh that layers cannot hold.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum SolidFault {
    #[error(
        "a face looks down at ({:.3}, {:.3}, {:.3}) mm, but only the underside may: an upright cutter and layers of \
         stock know no undercuts",
        at_m.x * 1e3, at_m.y * 1e3, at_m.z * 1e3
    )]
    Undercut { at_m: Vector3<f64> },
}

/// A closed mesh without undercuts, in the frame of the stock.
#[derive(Debug, Clone, PartialEq)]
pub struct Solid {
    triangles_m: Vec<[Vector3<f64>; 3]>,
    least_m: Vector3<f64>,
    most_m: Vector3<f64>,
}

impl Solid {
    /// From the triangles of a closed mesh, wound anticlockwise seen from outside; neighbours share
    /// corners to the bit.
    ///
    /// # Errors
    /// If a face other than the underside looks down.
    pub fn new(triangles_m: Vec<[Vector3<f64>; 3]>) -> Result<Self, SolidFault> {
        let corners = || triangles_m.iter().flatten();
        let least_m = corners().fold(Vector3::repeat(f64::INFINITY), |a, b| a.inf(b));
        let most_m = corners().fold(Vector3::repeat(f64::NEG_INFINITY), |a, b| a.sup(b));
        for triangle in &triangles_m {
            let highest_m = heights(triangle)[1];
            if rise(triangle) < -UPRIGHT && highest_m > least_m.z + SAME_DEPTH_M {
                let at_m = triangle.iter().sum::<Vector3<f64>>() / 3.0;
                return Err(SolidFault::Undercut { at_m });
            }
        }
        Ok(Self {
            triangles_m,
            least_m,
            most_m,
        })
    }

    /// The box about it for a grid, wider to the sides by one and a half of its spacings: walls of
    /// bodies with round lengths then run midway between nodes.
    pub fn block(&self, grid_m: f64) -> Block {
        let margin = Vector3::new(MARGIN * grid_m, MARGIN * grid_m, 0.0);
        Block {
            least_m: self.least_m - margin,
            most_m: self.most_m + margin,
        }
    }

    pub fn triangles_m(&self) -> &[[Vector3<f64>; 3]] {
        &self.triangles_m
    }

    /// Heights that bound its layers: those of level faces, and steps no higher than `step_m` where
    /// faces lean.
    pub fn depths_m(&self, step_m: f64) -> Vec<f64> {
        let mut depths = Vec::new();
        let mut leaning: Vec<[f64; 2]> = Vec::new();
        for triangle in &self.triangles_m {
            let [low_m, high_m] = heights(triangle);
            if high_m - low_m <= SAME_DEPTH_M {
                depths.push(high_m);
            } else if rise(triangle).abs() > UPRIGHT {
                leaning.push([low_m, high_m]);
            }
        }
        leaning.sort_by(|a, b| a[0].total_cmp(&b[0]));
        let mut ranges: Vec<[f64; 2]> = Vec::new();
        for [low_m, high_m] in leaning {
            match ranges.last_mut() {
                Some(range) if low_m <= range[1] => range[1] = range[1].max(high_m),
                _ => ranges.push([low_m, high_m]),
            }
        }
        for [low_m, high_m] in ranges {
            let count = ((high_m - low_m) / step_m).ceil().max(1.0);
            let at = |k: usize| low_m + (high_m - low_m) * k as f64 / count;
            depths.extend((0..=count as usize).map(at));
        }
        depths.sort_by(f64::total_cmp);
        depths.dedup_by(|a, b| (*a - *b).abs() <= SAME_DEPTH_M);
        depths
    }

    /// The outline at a height, in pieces.
    fn section(&self, height_m: f64) -> Vec<[Vector2<f64>; 2]> {
        let mut pieces = Vec::new();
        for triangle in &self.triangles_m {
            let mut ends = Vec::new();
            for side in 0..3 {
                let (a, b) = (triangle[side], triangle[(side + 1) % 3]);
                // From below on, so that both triangles of an edge find the same place.
                let (low, high) = if a.z <= b.z { (a, b) } else { (b, a) };
                if low.z <= height_m && high.z > height_m {
                    let share = (height_m - low.z) / (high.z - low.z);
                    ends.push(low.xy() + (high - low).xy() * share);
                }
            }
            if let [from, to] = ends[..] {
                pieces.push([from, to]);
            }
        }
        pieces
    }
}

/// Lowest and highest corner, m.
fn heights(triangle: &[Vector3<f64>; 3]) -> [f64; 2] {
    let z = triangle.map(|corner| corner.z);
    [z[0].min(z[1]).min(z[2]), z[0].max(z[1]).max(z[2])]
}

/// The normal's part along z.
fn rise([a, b, c]: &[Vector3<f64>; 3]) -> f64 {
    (b - a).cross(&(c - a)).normalize().z
}

impl LayeredStock {
    /// Leaves of each layer what lies in a solid.
    pub(in crate::cutting::milling) fn keep_within(&mut self, solid: &Solid) {
        for layer in 0..self.layers().len() {
            let one = &self.layers()[layer];
            let pieces = solid.section(0.5 * (one.bottom_m + one.top_m));
            let within_m = self.within_m(&pieces);
            let values = self.layers_mut()[layer].values_mut();
            for (value, within_m) in values.iter_mut().zip(within_m) {
                *value = value.min(within_m);
            }
        }
    }

    /// By node, how far it lies within an outline, m, negative outside; no more than is asked for.
    fn within_m(&self, pieces: &[[Vector2<f64>; 2]]) -> Vec<f64> {
        let far_m = FAR * self.grid_m();
        let [columns, rows] = self.nodes();
        let mut distance_m = vec![far_m; columns * rows];
        for [from, to] in pieces {
            let reach = Vector2::repeat(far_m);
            let range = self.between([from.inf(to) - reach, from.sup(to) + reach]);
            for node in self.each(range) {
                let off_m = super::stock::off_line(&self.place(node), from, to);
                distance_m[node] = distance_m[node].min(off_m);
            }
        }
        let mut crossings = vec![Vec::new(); rows];
        for [from, to] in pieces {
            let (low, high) = if from.y <= to.y {
                (from, to)
            } else {
                (to, from)
            };
            // A row more on either side: which rows are crossed is asked of their own places.
            let reach = Vector2::repeat(self.grid_m());
            let [_, crossed] = self.between([from.inf(to) - reach, from.sup(to) + reach]);
            for row in crossed {
                let y = self.place(row * columns).y;
                if low.y <= y && high.y > y {
                    let share = (y - low.y) / (high.y - low.y);
                    crossings[row].push(low.x + (high.x - low.x) * share);
                }
            }
        }
        for (row, crossings) in crossings.iter_mut().enumerate() {
            crossings.sort_by(f64::total_cmp);
            let first = row * columns;
            let along = distance_m[first..first + columns].iter_mut().enumerate();
            for (column, distance_m) in along {
                let x = self.place(first + column).x;
                if crossings.partition_point(|crossing| *crossing <= x) % 2 == 0 {
                    *distance_m = -*distance_m;
                }
            }
        }
        distance_m
    }
}
