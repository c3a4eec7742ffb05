//! What is left of stock on a grid in space: its surface as a closed solid, its volume.
//!
//! Cells are cut into six tetrahedra each along one diagonal, in which distances are linear, so
//! that neighbours agree on every side: every edge of the surface lies between two triangles. Faces
//! of the block are its own, edges in which two cuts meet are blunt by a part of the grid.

use super::field::DistanceField;
use nalgebra::Vector3;
use std::collections::HashMap;

/// Nodes nearer to the surface than this, in spacings, are told to lie so far beneath or above
/// it: thinner triangles count as faults of a mesh.
pub(super) const LEAST: f64 = 0.02;
/// Corners of a cell along x, y and z, from the least.
const CORNERS: [[usize; 3]; 8] = [
    [0, 0, 0],
    [1, 0, 0],
    [0, 1, 0],
    [1, 1, 0],
    [0, 0, 1],
    [1, 0, 1],
    [0, 1, 1],
    [1, 1, 1],
];
/// Tetrahedra of a cell, all about the diagonal from its least corner, each wound alike.
const TETRAHEDRA: [[usize; 4]; 6] = [
    [0, 1, 3, 7],
    [0, 3, 2, 7],
    [0, 2, 6, 7],
    [0, 6, 4, 7],
    [0, 4, 5, 7],
    [0, 5, 1, 7],
];
/// Triangles of a closed surface, anticlockwise seen from outside.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Surface {
    pub places_m: Vec<Vector3<f64>>,
    pub triangles: Vec<[usize; 3]>,
}

impl Surface {
    /// Volume within, m³.
    pub fn volume_m3(&self) -> f64 {
        // About a corner of the body: far from the origin digits would go.
        let about = self.places_m.first().copied().unwrap_or_default();
        let six = |[a, b, c]: &[usize; 3]| {
            let [a, b, c] = [a, b, c].map(|k| self.places_m[*k] - about);
            a.dot(&b.cross(&c))
        };
        self.triangles.iter().map(six).sum::<f64>() / 6.0
    }
}

/// A node of the grid with one more layer about it, in which there is nothing.
type Padded = [usize; 3];

struct Marching<'a> {
    field: &'a DistanceField,
    surface: Surface,
    known: HashMap<[usize; 2], usize>,
}

impl DistanceField {
    /// The surface of what is left.
    pub fn surface(&self) -> Surface {
        let mut marching = Marching {
            field: self,
            surface: Surface::default(),
            known: HashMap::new(),
        };
        let [columns, rows, levels] = self.nodes().map(|count| count + 1);
        for level in 0..levels {
            for row in 0..rows {
                for column in 0..columns {
                    marching.cell([column, row, level]);
                }
            }
        }
        marching.surface
    }
}

impl Marching<'_> {
    fn inner(&self, at: Padded) -> Option<[usize; 3]> {
        let nodes = self.field.nodes();
        let within = (0..3).all(|axis| (1..=nodes[axis]).contains(&at[axis]));
        within.then(|| at.map(|index| index - 1))
    }

    /// Distance beyond what is cut in a padded node; `None` where there is nothing.
    fn value(&self, at: Padded) -> Option<f64> {
        let inner = self.inner(at)?;
        let least_m = LEAST * self.field.grid_m();
        let value = self.field.value_m(self.field.node(inner));
        Some(match value > 0.0 {
            true => value.max(least_m),
            false => value.min(-least_m),
        })
    }

    fn cell(&mut self, first: Padded) {
        let at = CORNERS.map(|corner| std::array::from_fn(|axis| first[axis] + corner[axis]));
        let values = at.map(|node| self.value(node));
        let stands = values.map(|value| value.is_some_and(|value| value > 0.0));
        if stands.iter().all(|one| *one) || !stands.contains(&true) {
            return;
        }
        for tetrahedron in TETRAHEDRA {
            self.tetrahedron(
                tetrahedron.map(|corner| at[corner]),
                tetrahedron.map(|corner| stands[corner]),
            );
        }
    }

    fn tetrahedron(&mut self, at: [Padded; 4], stands: [bool; 4]) {
        let inside: Vec<usize> = (0..4).filter(|k| stands[*k]).collect();
        let outside: Vec<usize> = (0..4).filter(|k| !stands[*k]).collect();
        // Whether the corners, inside ones first, are wound as the tetrahedron is.
        let order: Vec<usize> = inside.iter().chain(&outside).copied().collect();
        let swaps = (0..4)
            .flat_map(|i| (i + 1..4).map(move |j| (i, j)))
            .filter(|(i, j)| order[*i] > order[*j])
            .count();
        let is_even = swaps % 2 == 0;
        let mut cross = |from: usize, to: usize| self.crossing(at[from], at[to]);
        let faces: Vec<[usize; 3]> = match (&inside[..], &outside[..]) {
            ([a], [b, c, d]) => vec![[cross(*a, *b), cross(*a, *c), cross(*a, *d)]],
            ([a, b, c], [d]) => vec![[cross(*a, *d), cross(*b, *d), cross(*c, *d)]],
            ([a, b], [c, d]) => {
                let ring = [cross(*a, *c), cross(*a, *d), cross(*b, *d), cross(*b, *c)];
                vec![[ring[0], ring[1], ring[2]], [ring[0], ring[2], ring[3]]]
            }
            _ => Vec::new(),
        };
        for [a, b, c] in faces {
            // Crossings that are one place.
            if a == b || b == c || c == a {
                continue;
            }
            self.surface.triangles.push(match is_even {
                true => [a, b, c],
                false => [a, c, b],
            });
        }
    }

    /// Where the surface crosses the way from a node in material to one without.
    fn crossing(&mut self, inside: Padded, outside: Padded) -> usize {
        let [columns, rows, _] = self.field.nodes().map(|count| count + 2);
        let number = |at: Padded| at[0] + columns * (at[1] + rows * at[2]);
        // What lies about the block has no place of its own: there its face is the surface.
        let is_face = self.inner(outside).is_none();
        let key = match is_face {
            true => [number(inside); 2],
            false => [number(inside), number(outside)],
        };
        if let Some(known) = self.known.get(&key) {
            return *known;
        }
        let place = |at: Padded| {
            let inner = at.map(|index| index.saturating_sub(1));
            self.field.place_at(inner)
        };
        let from_m = place(inside);
        let place_m = match (self.value(inside), self.value(outside)) {
            (Some(within), Some(without)) => {
                from_m.lerp(&place(outside), within / (within - without))
            }
            _ => from_m,
        };
        self.surface.places_m.push(place_m);
        let index = self.surface.places_m.len() - 1;
        self.known.insert(key, index);
        index
    }
}
