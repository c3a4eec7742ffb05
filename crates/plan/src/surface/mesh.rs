//! Triangle meshes of workpieces.

use nalgebra::{Unit, Vector3};
use parry3d_f64::math::Vector as ParryVector;
use parry3d_f64::query::PointQueryWithLocation;
use parry3d_f64::shape::TriMesh;

use super::error::SurfaceFault;
use super::mesh_checks::{self, MeshUse};

/// The point of a mesh that is nearest to another.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NearestPoint {
    pub point_m: Vector3<f64>,
    /// Outward normal of the triangle that holds it.
    pub normal: Unit<Vector3<f64>>,
    /// Distance from the mesh, negative inside a body, m.
    pub distance_m: f64,
    /// Index of that triangle from 0.
    pub triangle: usize,
}

/// A checked triangle mesh.
#[derive(Debug, Clone)]
pub struct Mesh {
    vertices_m: Vec<Vector3<f64>>,
    triangles: Vec<[usize; 3]>,
    shape: TriMesh,
    is_body: bool,
}

impl Mesh {
    /// A mesh from vertices (those at the same place count as one) and triangles wound
    /// counter-clockwise seen from outside.
    ///
    /// # Errors
    /// If a vertex is not finite, a triangle has no area, an edge belongs to more than two
    /// triangles or two neighbours are wound against each other; for a body also if it is open or
    /// inside out.
    pub fn new(
        vertices_m: &[Vector3<f64>],
        triangles: &[[usize; 3]],
        mesh_use: MeshUse,
    ) -> Result<Self, SurfaceFault> {
        mesh_checks::check_numbers(vertices_m, triangles)?;
        let (vertices_m, triangles) = mesh_checks::joined(vertices_m, triangles);
        mesh_checks::check_triangles(&vertices_m, &triangles)?;
        mesh_checks::check_edges(&vertices_m, &triangles, mesh_use)?;
        let points = vertices_m.iter().map(to_parry).collect();
        let indices = triangles.iter().map(|t| t.map(|i| i as u32)).collect();
        let shape = TriMesh::new(points, indices).map_err(|_| SurfaceFault::EmptyMesh)?;
        Ok(Self {
            vertices_m,
            triangles,
            shape,
            is_body: mesh_use == MeshUse::Body,
        })
    }

    #[must_use]
    pub fn vertices_m(&self) -> &[Vector3<f64>] {
        &self.vertices_m
    }

    /// Vertex indices of the triangles.
    #[must_use]
    pub fn triangles(&self) -> &[[usize; 3]] {
        &self.triangles
    }

    /// For queries of other files.
    pub(super) fn shape(&self) -> &TriMesh {
        &self.shape
    }

    pub(super) fn is_body(&self) -> bool {
        self.is_body
    }

    /// Volume that a body encloses, m³ (of a face: that of the cone over it from its first vertex).
    #[must_use]
    pub fn volume_m3(&self) -> f64 {
        mesh_checks::volume_m3(&self.vertices_m, &self.triangles)
    }

    /// The point of the mesh nearest to a point.
    #[must_use]
    pub fn nearest(&self, point_m: &Vector3<f64>) -> NearestPoint {
        let (found, triangle) = self
            .shape
            .project_local_point_and_get_location(to_parry(point_m), false);
        let nearest = Vector3::new(found.point.x, found.point.y, found.point.z);
        let triangle = triangle.0 as usize;
        let normal = self.normal(triangle);
        let away_m = (point_m - nearest).norm();
        let inside = self.is_body && self.winding(point_m) > 0.5;
        NearestPoint {
            point_m: nearest,
            normal,
            distance_m: if inside { -away_m } else { away_m },
            triangle,
        }
    }

    /// How often the mesh winds about a point: 1 inside a body, 0 outside (sum of solid angles,
    /// `oosterom1983`). Unlike the normal of the nearest triangle it does not err where that is an
    /// edge or a corner.
    fn winding(&self, point_m: &Vector3<f64>) -> f64 {
        let solid_angles = self.triangles.iter().map(|triangle| {
            let [a, b, c] = triangle.map(|i| self.vertices_m[i] - point_m);
            let [la, lb, lc] = [a, b, c].map(|v| v.norm());
            let below = la * lb * lc + a.dot(&b) * lc + b.dot(&c) * la + c.dot(&a) * lb;
            2.0 * a.dot(&b.cross(&c)).atan2(below)
        });
        solid_angles.sum::<f64>() / (4.0 * std::f64::consts::PI)
    }
}

fn to_parry(p: &Vector3<f64>) -> ParryVector {
    ParryVector::new(p.x, p.y, p.z)
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    /// The mould block, 100 × 60 × 20 mm, from the origin.
    pub(crate) fn block() -> (Vec<Vector3<f64>>, Vec<[usize; 3]>) {
        let corner = |i: usize| {
            let side = |bit: usize, length: f64| if i >> bit & 1 == 1 { length } else { 0.0 };
            Vector3::new(side(0, 0.1), side(1, 0.06), side(2, 0.02))
        };
        let quads = [
            [0, 2, 3, 1],
            [4, 5, 7, 6],
            [0, 1, 5, 4],
            [2, 6, 7, 3],
            [0, 4, 6, 2],
            [1, 3, 7, 5],
        ];
        let halves = |q: [usize; 4]| [[q[0], q[1], q[2]], [q[0], q[2], q[3]]];
        (
            (0..8).map(corner).collect(),
            quads.into_iter().flat_map(halves).collect(),
        )
    }

    #[test]
    fn verify_nearest_points_and_volume_of_a_block() {
        let (vertices, triangles) = block();
        let mesh = Mesh::new(&vertices, &triangles, MeshUse::Body).expect("a block");
        assert!((mesh.volume_m3() - 1.2e-4).abs() < 1e-18);
        let above = mesh.nearest(&Vector3::new(0.03, 0.02, 0.05));
        assert!((above.distance_m - 0.03).abs() < 1e-15);
        assert!((above.normal.into_inner() - Vector3::z()).norm() < 1e-15);
        let inside = mesh.nearest(&Vector3::new(0.03, 0.02, 0.018));
        assert!((inside.distance_m + 0.002).abs() < 1e-15);
        // Beyond a corner the nearest triangle's own normal would not tell.
        let corner = mesh.nearest(&Vector3::new(0.103, 0.064, 0.02));
        assert!((corner.distance_m - 0.005).abs() < 1e-15);
    }

    #[test]
    fn bad_meshes_are_refused_with_their_place() {
        let refuse = |vertices: &[Vector3<f64>], triangles: &[[usize; 3]], mesh_use| {
            let refused = Mesh::new(vertices, triangles, mesh_use);
            refused.expect_err("no mesh").to_string()
        };
        let (vertices, triangles) = block();
        assert!(refuse(&vertices, &[], MeshUse::Face).contains("no triangles"));
        let mut bad = vertices.clone();
        bad[2].y = f64::NAN;
        assert!(refuse(&bad, &triangles, MeshUse::Face).contains("vertex 3 is not finite"));
        let open = refuse(&vertices, &triangles[..11], MeshUse::Body);
        assert!(
            open.contains("is open") && open.contains("3 such edges"),
            "{open}"
        );
        assert!(Mesh::new(&vertices, &triangles[..11], MeshUse::Face).is_ok());
        let mut turned = triangles.clone();
        turned[4].swap(0, 1);
        assert!(refuse(&vertices, &turned, MeshUse::Face).contains("wound against each other"));
        let inside_out: Vec<_> = triangles.iter().map(|t| [t[1], t[0], t[2]]).collect();
        assert!(refuse(&vertices, &inside_out, MeshUse::Body).contains("encloses -1.2000e-4 m3"));
        let mut fin = triangles.clone();
        fin.push([0, 1, 7]);
        assert!(refuse(&vertices, &fin, MeshUse::Face).contains("belongs to 3 triangles"));
        let mut flat = triangles.clone();
        flat[0] = [0, 0, 1];
        assert!(refuse(&vertices, &flat, MeshUse::Face).contains("triangle 1 "));
        assert!(refuse(&vertices, &[[0, 1, 9]], MeshUse::Face).contains("vertex index"));
    }
}
