//! What is left of layered stock: areas, volume, mesh.

use super::stock::LayeredStock;
use nalgebra::{Vector2, Vector3};

/// A corner of the outline within a cell: a node, or where the outline crosses the side between two
/// nodes.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Corner {
    place_m: Vector2<f64>,
    crosses: bool,
}

/// What is left in a cell, its corners anticlockwise.
type Piece = Vec<Corner>;

impl LayeredStock {
    /// Volume of what is left, m³.
    pub fn volume_m3(&self) -> f64 {
        let layers = 0..self.layers().len();
        let of = |layer: usize| self.area_m2(layer) * self.layers()[layer].height_m();
        layers.map(of).sum()
    }

    /// Area of what is left of a layer, m².
    pub fn area_m2(&self, layer: usize) -> f64 {
        let cells = 0..self.cell_count();
        cells.map(|cell| area_m2(&self.piece(layer, cell))).sum()
    }

    fn cell_count(&self) -> usize {
        (self.nodes()[0] - 1) * (self.nodes()[1] - 1)
    }

    /// Nodes of a cell, anticlockwise from the least.
    fn corners(&self, cell: usize) -> [usize; 4] {
        let [columns, _] = self.nodes();
        let first = cell / (columns - 1) * columns + cell % (columns - 1);
        [first, first + 1, first + columns + 1, first + columns]
    }

    fn piece(&self, layer: usize, cell: usize) -> Piece {
        let corners = self.corners(cell);
        let values = self.layers()[layer].values();
        let mut piece = Vec::with_capacity(6);
        for k in 0..4 {
            let (a, b) = (corners[k], corners[(k + 1) % 4]);
            if values[a] > 0.0 {
                piece.push(Corner {
                    place_m: self.place(a),
                    crosses: false,
                });
            }
            if (values[a] > 0.0) != (values[b] > 0.0) {
                // The same from either cell.
                let (low, high) = (a.min(b), a.max(b));
                let share = values[low] / (values[low] - values[high]);
                piece.push(Corner {
                    place_m: self.place(low).lerp(&self.place(high), share),
                    crosses: true,
                });
            }
        }
        piece
    }

    /// Triangles of the surface, m, seen from outside anticlockwise: closed, layer by layer.
    pub fn triangles_m(&self) -> Vec<[Vector3<f64>; 3]> {
        let mut all = Vec::new();
        let count = self.layers().len();
        for layer in 0..count {
            let [bottom_m, top_m] = {
                let one = &self.layers()[layer];
                [one.bottom_m, one.top_m]
            };
            for cell in 0..self.cell_count() {
                let piece = self.piece(layer, cell);
                if piece.len() < 3 {
                    continue;
                }
                let is_whole = |layer: usize| {
                    let values = self.layers()[layer].values();
                    self.corners(cell).iter().all(|node| values[*node] > 0.0)
                };
                let here = is_whole(layer);
                if !(here && layer + 1 < count && is_whole(layer + 1)) {
                    face(&mut all, &piece, top_m, true);
                }
                if !(here && layer > 0 && is_whole(layer - 1)) {
                    face(&mut all, &piece, bottom_m, false);
                }
                self.sides(&mut all, &piece, [bottom_m, top_m]);
            }
        }
        all
    }

    /// Walls of a piece: along the outline, and on the faces of the block.
    fn sides(&self, all: &mut Vec<[Vector3<f64>; 3]>, piece: &Piece, [low, high]: [f64; 2]) {
        let on_face = |a: &Corner, b: &Corner| {
            (0..2).any(|axis| {
                let (least, most) = (self.block.least_m[axis], self.block.most_m[axis]);
                let near = |x: f64, face: f64| (x - face).abs() < 1e-12;
                [least, most]
                    .iter()
                    .any(|face| near(a.place_m[axis], *face) && near(b.place_m[axis], *face))
            })
        };
        for (k, from) in piece.iter().enumerate() {
            let to = &piece[(k + 1) % piece.len()];
            let cut = from.crosses && to.crosses;
            if !cut && !on_face(from, to) {
                continue;
            }
            let at = |corner: &Corner, z: f64| Vector3::new(corner.place_m.x, corner.place_m.y, z);
            let [a, b, c, d] = [at(from, low), at(to, low), at(to, high), at(from, high)];
            all.push([a, b, c]);
            all.push([a, c, d]);
        }
    }
}

fn face(all: &mut Vec<[Vector3<f64>; 3]>, piece: &Piece, z: f64, up: bool) {
    let at = |k: usize| Vector3::new(piece[k].place_m.x, piece[k].place_m.y, z);
    for k in 1..piece.len() - 1 {
        all.push(match up {
            true => [at(0), at(k), at(k + 1)],
            false => [at(0), at(k + 1), at(k)],
        });
    }
}

fn area_m2(piece: &Piece) -> f64 {
    let next = |k: usize| piece[(k + 1) % piece.len()].place_m;
    let twice = (0..piece.len()).map(|k| piece[k].place_m.perp(&next(k)));
    0.5 * twice.sum::<f64>()
}
