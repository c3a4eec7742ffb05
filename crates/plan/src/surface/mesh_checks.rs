//! What a mesh must be before anything is asked of it.

use std::collections::{BTreeMap, HashMap};

use nalgebra::Vector3;

use super::error::{SurfaceFault, place};

use crate::bounds::OutOfBounds;

/// What a mesh is needed for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MeshUse {
    /// A skin; edges may belong to one triangle.
    Face,
    /// A body: closed, wound counter-clockwise seen from outside. Only bodies tell inside from
    /// outside.
    Body,
}

/// Least height of a triangle over its longest side.
const LEAST_SLENDERNESS: f64 = 1e-7;

pub(super) fn check_numbers(
    vertices_m: &[Vector3<f64>],
    triangles: &[[usize; 3]],
) -> Result<(), SurfaceFault> {
    if triangles.is_empty() {
        return Err(SurfaceFault::EmptyMesh);
    }
    let finite = |v: &Vector3<f64>| v.iter().all(|x| x.is_finite());
    if let Some(index) = vertices_m.iter().position(|v| !finite(v)) {
        return Err(SurfaceFault::NotFinite {
            what: "vertex",
            index: index + 1,
            value: place(&vertices_m[index]),
        });
    }
    for index in triangles.iter().flatten() {
        let (known, what) = (*index < vertices_m.len(), "a vertex index (from 0)");
        OutOfBounds::unless(known, what, index, "below the number of vertices")?;
    }
    Ok(())
}

/// Vertices at the same place made one.
pub(super) fn joined(
    vertices_m: &[Vector3<f64>],
    triangles: &[[usize; 3]],
) -> (Vec<Vector3<f64>>, Vec<[usize; 3]>) {
    let mut kept: Vec<Vector3<f64>> = Vec::new();
    let mut known = HashMap::new();
    let places: Vec<usize> = vertices_m
        .iter()
        .map(|vertex| {
            // Adding 0 makes −0 the same place as 0.
            let key = [vertex.x, vertex.y, vertex.z].map(|x| (x + 0.0).to_bits());
            *known.entry(key).or_insert_with(|| {
                kept.push(*vertex);
                kept.len() - 1
            })
        })
        .collect();
    let triangles = triangles.iter().map(|t| t.map(|i| places[i])).collect();
    (kept, triangles)
}

pub(super) fn check_triangles(
    vertices_m: &[Vector3<f64>],
    triangles: &[[usize; 3]],
) -> Result<(), SurfaceFault> {
    for (index, triangle) in triangles.iter().enumerate() {
        let [a, b, c] = triangle.map(|i| vertices_m[i]);
        let sides = [b - a, c - b, a - c].map(|side| side.norm());
        let longest = sides.into_iter().fold(0.0, f64::max);
        if (b - a).cross(&(c - a)).norm() <= LEAST_SLENDERNESS * longest * longest {
            return Err(SurfaceFault::FlatTriangle {
                index: index + 1,
                near: place(&a),
            });
        }
    }
    Ok(())
}

/// Every edge, as the smaller of its vertices and the larger, with the triangles that have it and
/// whether they go round it in that order; sorted.
pub(super) fn edges(triangles: &[[usize; 3]]) -> BTreeMap<[usize; 2], Vec<(usize, bool)>> {
    let mut edges: BTreeMap<[usize; 2], Vec<(usize, bool)>> = BTreeMap::new();
    for (index, [a, b, c]) in triangles.iter().enumerate() {
        for (from, to) in [(*a, *b), (*b, *c), (*c, *a)] {
            let key = [from.min(to), from.max(to)];
            edges.entry(key).or_default().push((index, from < to));
        }
    }
    edges
}

/// Edges shared by one or two triangles that run through them in opposite directions; for a body
/// all by two.
pub(super) fn check_edges(
    vertices_m: &[Vector3<f64>],
    triangles: &[[usize; 3]],
    mesh_use: MeshUse,
) -> Result<(), SurfaceFault> {
    let sorted = edges(triangles);
    let ends = |key: &[usize; 2]| key.map(|i| place(&vertices_m[i]));
    for (key, users) in &sorted {
        let [from, to] = ends(key);
        match users.as_slice() {
            [_] => {}
            [one, other] if one.1 != other.1 => {}
            [one, other] => {
                return Err(SurfaceFault::MixedWinding {
                    first: one.0 + 1,
                    second: other.0 + 1,
                    from,
                });
            }
            more => {
                let count = more.len();
                return Err(SurfaceFault::NonManifold { from, to, count });
            }
        }
    }
    if mesh_use == MeshUse::Face {
        return Ok(());
    }
    let open: Vec<_> = sorted
        .iter()
        .filter(|(_, users)| users.len() == 1)
        .collect();
    if let Some((key, _)) = open.first() {
        let [from, to] = ends(key);
        return Err(SurfaceFault::OpenMesh {
            from,
            to,
            open_edges: open.len(),
        });
    }
    let volume_m3 = volume_m3(vertices_m, triangles);
    if volume_m3 <= 0.0 {
        return Err(SurfaceFault::InsideOut { volume_m3 });
    }
    Ok(())
}

/// Sum of the tetrahedra from the first vertex, by the divergence theorem.
pub(super) fn volume_m3(vertices_m: &[Vector3<f64>], triangles: &[[usize; 3]]) -> f64 {
    let apex = vertices_m[0];
    let tetrahedra = triangles.iter().map(|triangle| {
        let [a, b, c] = triangle.map(|i| vertices_m[i] - apex);
        a.dot(&b.cross(&c)) / 6.0
    });
    tetrahedra.sum()
}
