//! Vertices that are one, though the file repeats them.

use std::collections::HashMap;

use nalgebra::Vector3;
use truecut_arm::MeshData;

use super::{Defects, extent};

/// Vertices and triangles of a part, m.
#[derive(Debug)]
pub(super) struct Welded {
    pub(super) vertices_m: Vec<Vector3<f64>>,
    pub(super) triangles: Vec<[u32; 3]>,
}

impl Welded {
    pub(super) fn corners(&self, triangle: usize) -> [Vector3<f64>; 3] {
        self.triangles[triangle].map(|i| self.vertices_m[i as usize])
    }

    pub(super) fn middle(&self, triangle: usize) -> Vector3<f64> {
        self.corners(triangle).iter().sum::<Vector3<f64>>() / 3.0
    }

    /// By the divergence theorem.
    pub(super) fn volume_m3(&self) -> f64 {
        let apex = self.vertices_m.first().copied().unwrap_or_default();
        let tetrahedra = (0..self.triangles.len()).map(|triangle| {
            let [a, b, c] = self.corners(triangle).map(|corner| corner - apex);
            a.dot(&b.cross(&c)) / 6.0
        });
        tetrahedra.sum()
    }
}

/// Each vertex becomes the first one within the distance. Triangles that lose a corner, and those
/// that stand there twice, are left out.
pub(super) fn weld(data: MeshData, unit_m: f64, weld_m: f64, defects: &mut Defects) -> Welded {
    let at_m = |index: u32| data.vertices[index as usize] * unit_m;
    let middle = |t: &[u32; 3]| t.map(at_m).iter().sum::<Vector3<f64>>() / 3.0;
    for index in &data.against_stated_normal {
        let triangle = &data.triangles[*index as usize];
        (defects.against_stated_normal).add(|| middle(triangle));
    }
    let (vertices_m, places) = places(&data.vertices, unit_m, weld_m, defects);
    let mut triangles = Vec::with_capacity(data.triangles.len());
    for triangle in &data.triangles {
        let [a, b, c] = triangle.map(|i| places[i as usize]);
        if a == b || b == c || c == a {
            (defects.degenerate_triangles).add(|| middle(triangle));
        } else {
            triangles.push([a, b, c]);
        }
    }
    // Duplicates, however their corners are turned: by their sorted corners.
    let mut order: Vec<u32> = (0..triangles.len() as u32).collect();
    let key = |index: u32| {
        let mut corners = triangles[index as usize];
        corners.sort_unstable();
        (corners, index)
    };
    order.sort_unstable_by_key(|index| key(*index));
    let mut twice: Vec<u32> = (order.windows(2))
        .filter(|pair| key(pair[0]).0 == key(pair[1]).0)
        .map(|pair| pair[1])
        .collect();
    drop(order);
    if !twice.is_empty() {
        twice.sort_unstable();
        for index in &twice {
            let corners = triangles[*index as usize].map(|i| vertices_m[i as usize]);
            (defects.duplicate_triangles).add(|| corners.iter().sum::<Vector3<f64>>() / 3.0);
        }
        let mut twice = twice.into_iter().peekable();
        let mut index = 0;
        triangles.retain(|_| {
            let keep = twice.next_if_eq(&index).is_none();
            index += 1;
            keep
        });
    }
    Welded {
        vertices_m,
        triangles,
    }
}

/// The vertices that stay, and for each of the file's which one it becomes.
fn places(
    vertices: &[Vector3<f64>],
    unit_m: f64,
    weld_m: f64,
    defects: &mut Defects,
) -> (Vec<Vector3<f64>>, Vec<u32>) {
    let low = extent(vertices)[0] * unit_m;
    let mut kept: Vec<Vector3<f64>> = Vec::new();
    // Where a kept vertex is looked for: itself, and by cells of a grid, chained.
    let mut exact: HashMap<[u64; 3], u32> = HashMap::new();
    let mut first_in: HashMap<[i64; 3], u32> = HashMap::new();
    let mut next_in: Vec<u32> = Vec::new();
    let cell_m = 4.0 * weld_m;
    let cell =
        |p: Vector3<f64>| -> [i64; 3] { ((p - low) / cell_m).map(|x| x.floor() as i64).into() };
    let mut place = |vertex: &Vector3<f64>| {
        // Adding 0 makes −0 the same place as 0.
        let bits = [vertex.x, vertex.y, vertex.z].map(|x| (x + 0.0).to_bits());
        if let Some(known) = exact.get(&bits) {
            return *known;
        }
        let at = vertex * unit_m;
        let near = (weld_m > 0.0).then(|| {
            let around = Vector3::repeat(weld_m);
            let (from, to) = (cell(at - around), cell(at + around));
            let mut cells = (from[0]..=to[0]).flat_map(|x| {
                (from[1]..=to[1]).flat_map(move |y| (from[2]..=to[2]).map(move |z| [x, y, z]))
            });
            cells.find_map(|cell| {
                let mut index = *first_in.get(&cell)?;
                while index != u32::MAX {
                    if (kept[index as usize] - at).norm() <= weld_m {
                        return Some(index);
                    }
                    index = next_in[index as usize];
                }
                None
            })
        });
        let index = match near.flatten() {
            Some(index) => {
                defects.welded_vertices.add(|| at);
                index
            }
            None => {
                let index = kept.len() as u32;
                kept.push(at);
                if weld_m > 0.0 {
                    let before = first_in.insert(cell(at), index);
                    next_in.push(before.unwrap_or(u32::MAX));
                }
                index
            }
        };
        exact.insert(bits, index);
        index
    };
    let places = vertices.iter().map(&mut place).collect();
    (kept, places)
}
