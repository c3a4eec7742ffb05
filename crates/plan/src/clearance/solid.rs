//! Forms of what stands or is carried.

use std::collections::HashSet;

use nalgebra::{Isometry3, Point3, Vector3};
use parry3d_f64::math::Vector as ParryVector;
use parry3d_f64::shape::{SharedShape, TriMesh};

use super::error::CellFault;
use crate::surface::{Mesh, MeshFile, read_mesh};

/// A form as a file gives it, centred on its own frame unless it is a mesh.
#[derive(Debug, Clone, PartialEq)]
pub enum Form {
    /// Sides along the axes.
    Box {
        sides_m: Vector3<f64>,
    },
    /// Along z.
    Cylinder {
        radius_m: f64,
        length_m: f64,
    },
    Mesh(MeshFile),
}

/// A form with what its file holds.
#[derive(Debug, Clone, PartialEq)]
pub enum Solid {
    Box {
        sides_m: Vector3<f64>,
    },
    Cylinder {
        radius_m: f64,
        length_m: f64,
    },
    /// About its own frame's origin.
    Ball {
        radius_m: f64,
    },
    /// Triangles, wound either way; only a closed mesh has an inside.
    Mesh {
        vertices_m: Vec<Vector3<f64>>,
        triangles: Vec<[u32; 3]>,
    },
}

/// Corners of a cylinder's rims.
const RIM: usize = 16;

impl Form {
    /// Reads its file, if it has one.
    ///
    /// # Errors
    /// A mesh that cannot be read, or of which no triangle has an area.
    pub fn load(&self) -> Result<Solid, CellFault> {
        let file = match self {
            Self::Box { sides_m } => return Ok(Solid::Box { sides_m: *sides_m }),
            &Self::Cylinder { radius_m, length_m } => {
                return Ok(Solid::Cylinder { radius_m, length_m });
            }
            Self::Mesh(file) => file,
        };
        let data = read_mesh(&file.file, file.unit_m)?;
        let vertices_m: Vec<_> = data.vertices.iter().map(|v| v * file.unit_m).collect();
        let count = data.triangles.len();
        let has_area = |triangle: &[u32; 3]| {
            let [a, b, c] = triangle.map(|i| vertices_m[i as usize]);
            (b - a).cross(&(c - a)).norm() > 0.0
        };
        let triangles: Vec<_> = data.triangles.into_iter().filter(has_area).collect();
        if triangles.is_empty() {
            return Err(CellFault::NoSize { triangles: count });
        }
        Ok(Solid::Mesh {
            vertices_m,
            triangles,
        })
    }
}

/// How many edges have a triangle without another one: files may give each triangle corners of its
/// own, so edges are known by where they end.
fn open_edges(vertices_m: &[Vector3<f64>], triangles: &[[u32; 3]]) -> usize {
    let place = |index: u32| {
        let at = vertices_m[index as usize];
        // 0 and -0 are one place.
        [at.x, at.y, at.z].map(|m| (m + 0.0).to_bits())
    };
    let mut odd = HashSet::new();
    for [a, b, c] in triangles {
        for (from, to) in [(a, b), (b, c), (c, a)] {
            let mut edge = [place(*from), place(*to)];
            edge.sort_unstable();
            if !odd.remove(&edge) {
                odd.insert(edge);
            }
        }
    }
    odd.len()
}

/// Bodies of a cell are of this size, m; what is not may have been drawn in another unit.
const USUAL_SIZE_M: std::ops::RangeInclusive<f64> = 0.02..=5.0;

impl Solid {
    /// What a reader should know of a mesh that stands for the body of this name.
    pub(super) fn doubts(&self, name: &str) -> Vec<String> {
        let Self::Mesh {
            vertices_m,
            triangles,
        } = self
        else {
            return Vec::new();
        };
        let mut notes = Vec::new();
        let used = || triangles.iter().flatten().map(|i| vertices_m[*i as usize]);
        let low = used().fold(Vector3::repeat(f64::INFINITY), |a, b| a.inf(&b));
        let high = used().fold(Vector3::repeat(f64::NEG_INFINITY), |a, b| a.sup(&b));
        let size_m = high - low;
        if !USUAL_SIZE_M.contains(&size_m.max()) {
            let [x, y, z] = [size_m.x, size_m.y, size_m.z].map(|m| 1e3 * m);
            notes.push(format!(
                "\"{name}\" is {x:.3} x {y:.3} x {z:.3} mm large: is the unit of its mesh right (unit_mm is 1 for millimetres, \
                 25.4 for inches, 1000 for metres)?"
            ));
        }
        let open = open_edges(vertices_m, triangles);
        if open > 0 {
            notes.push(format!(
                "\"{name}\" has a mesh that is open at {open} edges, so it has no inside: its distances are to its \
                 triangles, and what lies within it does not touch it"
            ));
        }
        notes
    }

    /// The triangles of a mesh that was read.
    #[must_use]
    pub fn of_mesh(mesh: &Mesh) -> Self {
        Self::Mesh {
            vertices_m: mesh.vertices_m().to_vec(),
            triangles: (mesh.triangles().iter())
                .map(|t| t.map(|i| i as u32))
                .collect(),
        }
    }

    /// What parry asks distances of, and where it stands in the form's frame.
    pub(super) fn shape(&self) -> Option<(SharedShape, Isometry3<f64>)> {
        Some(match self {
            Self::Box { sides_m } => {
                let half = sides_m * 0.5;
                (
                    SharedShape::cuboid(half.x, half.y, half.z),
                    Isometry3::identity(),
                )
            }
            Self::Cylinder { radius_m, length_m } => {
                (SharedShape::cylinder(0.5 * length_m, *radius_m), y_to_z())
            }
            Self::Ball { radius_m } => (SharedShape::ball(*radius_m), Isometry3::identity()),
            Self::Mesh {
                vertices_m,
                triangles,
            } => {
                let points = vertices_m.iter().map(to_parry).collect();
                let shape = TriMesh::new(points, triangles.clone()).ok()?;
                (SharedShape::new(shape), Isometry3::identity())
            }
        })
    }

    /// Corners, in the form's frame.
    pub(super) fn corners_m(&self) -> Vec<Vector3<f64>> {
        match self {
            Self::Box { sides_m } => {
                let side = |k: usize, bit: usize| if k & bit == 0 { -0.5 } else { 0.5 };
                let corner = |k: usize| Vector3::new(side(k, 1), side(k, 2), side(k, 4));
                (0..8).map(|k| corner(k).component_mul(sides_m)).collect()
            }
            Self::Cylinder { radius_m, length_m } => {
                let rim = |k: usize| {
                    let (s, c) = (std::f64::consts::TAU * (k / 2) as f64 / RIM as f64).sin_cos();
                    let end = if k.is_multiple_of(2) { -0.5 } else { 0.5 };
                    Vector3::new(radius_m * c, radius_m * s, end * length_m)
                };
                (0..2 * RIM).map(rim).collect()
            }
            Self::Ball { radius_m } => {
                let axes = [Vector3::x(), Vector3::y(), Vector3::z()];
                (axes
                    .iter()
                    .flat_map(|axis| [axis * *radius_m, axis * -radius_m]))
                .collect()
            }
            Self::Mesh { vertices_m, .. } => vertices_m.clone(),
        }
    }

    /// Whether a point of the form's frame lies within it: of a mesh, whether it winds about the
    /// point more than half a time.
    pub(super) fn holds(&self, point_m: &Vector3<f64>) -> bool {
        match self {
            Self::Box { sides_m } => (0..3).all(|k| 2.0 * point_m[k].abs() < sides_m[k]),
            Self::Cylinder { radius_m, length_m } => {
                2.0 * point_m.z.abs() < *length_m && point_m.x.hypot(point_m.y) < *radius_m
            }
            Self::Ball { radius_m } => point_m.norm() < *radius_m,
            Self::Mesh {
                vertices_m,
                triangles,
            } => winding(vertices_m, triangles, point_m).abs() > 0.5,
        }
    }

    /// How many corners of another one were looked at, if all of them lie within this one.
    pub(super) fn holds_all(
        &self,
        at: &Isometry3<f64>,
        other: &Self,
        other_at: &Isometry3<f64>,
    ) -> Option<usize> {
        let corners = other.corners_m();
        let every = corners.len().div_ceil(MOST_CORNERS).max(1);
        let own_from_other = at.inverse() * other_at;
        let place = |corner: &Vector3<f64>| (own_from_other * Point3::from(*corner)).coords;
        let mut looked_at = corners.iter().step_by(every).map(place);
        let all = looked_at.all(|corner| self.holds(&corner));
        all.then(|| corners.len().div_ceil(every))
    }
}

/// Most corners that are looked at to tell whether one body lies within another.
const MOST_CORNERS: usize = 64;

/// How often triangles wind about a point: 1 within a closed mesh, 0 outside, in between where it
/// is open (sum of solid angles, `oosterom1983`).
fn winding(vertices_m: &[Vector3<f64>], triangles: &[[u32; 3]], point_m: &Vector3<f64>) -> f64 {
    let solid_angles = triangles.iter().map(|triangle| {
        let [a, b, c] = triangle.map(|i| vertices_m[i as usize] - point_m);
        let [la, lb, lc] = [a, b, c].map(|v| v.norm());
        let below = la * lb * lc + a.dot(&b) * lc + b.dot(&c) * la + c.dot(&a) * lb;
        2.0 * a.dot(&b.cross(&c)).atan2(below)
    });
    solid_angles.sum::<f64>() / (4.0 * std::f64::consts::PI)
}

/// A cylinder of parry stands along y, ours along z.
pub(super) fn y_to_z() -> Isometry3<f64> {
    Isometry3::rotation(Vector3::x() * std::f64::consts::FRAC_PI_2)
}

pub(super) fn to_parry(v: &Vector3<f64>) -> ParryVector {
    ParryVector::new(v.x, v.y, v.z)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A box of triangles that each have corners of their own, as in an STL, without its last
    /// `left_out` triangles.
    fn sheets(side_m: f64, left_out: usize) -> Solid {
        let corner = |k: u32| {
            let at = |bit: u32| if k & bit == 0 { -0.0 } else { side_m };
            Vector3::new(at(1), at(2), at(4))
        };
        let faces = [
            [0, 1, 3, 2],
            [4, 6, 7, 5],
            [0, 4, 5, 1],
            [2, 3, 7, 6],
            [0, 2, 6, 4],
            [1, 5, 7, 3],
        ];
        let halves = faces
            .iter()
            .flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]]);
        let kept: Vec<[u32; 3]> = halves.take(12 - left_out).collect();
        Solid::Mesh {
            vertices_m: kept.iter().flatten().map(|k| corner(*k)).collect(),
            triangles: (0..kept.len() as u32)
                .map(|n| [3 * n, 3 * n + 1, 3 * n + 2])
                .collect(),
        }
    }

    #[test]
    fn an_open_mesh_and_one_in_another_unit_are_told() {
        assert!(sheets(0.3, 0).doubts("vice").is_empty());
        let [open] = &sheets(0.3, 2).doubts("vice")[..] else {
            panic!("one note");
        };
        assert!(
            open.contains("\"vice\" has a mesh that is open at 4 edges"),
            "{open}"
        );
        for (side_m, told) in [(0.01, "10.000 x 10.000 x 10.000 mm"), (10.0, "10000.000 x")] {
            let [unit] = &sheets(side_m, 0).doubts("vice")[..] else {
                panic!("one note");
            };
            assert!(
                unit.contains(told) && unit.contains("25.4 for inches"),
                "{unit}"
            );
        }
    }
}
