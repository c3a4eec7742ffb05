//! Forms of what stands or is carried.

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
        let data = read_mesh(&file.file)?;
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

impl Solid {
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
