//! Triangle meshes of workpieces.

use nalgebra::{Unit, Vector3};
use parry3d_f64::bounding_volume::BoundingVolume;
use parry3d_f64::math::{Real, Vector as ParryVector};
use parry3d_f64::partitioning::BvhNode;
use parry3d_f64::query::{PointQueryWithLocation, Ray, RayCast};
use parry3d_f64::shape::TriMesh;

use super::error::SurfaceFault;
use super::mesh_checks::{self, MeshUse};

/// Directions of rays, along nothing that a part is likely to be made along; the next is taken
/// where one runs by an edge.
const RAYS: [[f64; 3]; 4] = [
    [0.267_949, 0.534_522, 0.801_784],
    [-0.618_034, 0.414_214, -0.668_179],
    [0.732_051, -0.646_447, -0.214_602],
    [-0.141_593, -0.718_282, 0.681_153],
];

/// Rays run by an edge where the sine of the angle that both span at the start is as small.
const BESIDE: f64 = 1e-9;

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
        let inside = self.is_body && self.holds(point_m);
        NearestPoint {
            point_m: nearest,
            normal,
            distance_m: if inside { -away_m } else { away_m },
            triangle,
        }
    }

    /// Whether a body holds a point: whether a ray from there leaves it more often than it enters
    /// it. Unlike the normal of the nearest triangle this does not err where that is an edge or a
    /// corner, or where closed skins lie in one another.
    fn holds(&self, point_m: &Vector3<f64>) -> bool {
        let clear = RAYS.iter().find_map(|way| self.crossings(point_m, way));
        clear.map_or_else(|| self.winding(point_m) > 0.5, |crossings| crossings > 0)
    }

    /// How often a ray crosses the mesh outwards, less how often inwards: how often the mesh winds
    /// about its start. `None` if the ray runs by an edge so near that rounding decides.
    fn crossings(&self, from_m: &Vector3<f64>, way: &[f64; 3]) -> Option<i32> {
        let way = Vector3::from(*way);
        let ray = Ray::new(to_parry(from_m), to_parry(&way));
        let far_m = self.shape.bvh().root_aabb().extents().length();
        let meets = |node: &BvhNode| {
            let loose = node.aabb().loosened(BESIDE * far_m);
            loose.cast_local_ray(&ray, Real::MAX, true).is_some()
        };
        let mut crossings = 0;
        for index in self.shape.bvh().leaves(meets) {
            let corners = self.triangles[index as usize].map(|i| self.vertices_m[i] - from_m);
            crossings += crossing(&corners, &way)?;
        }
        Some(crossings)
    }

    /// How often the mesh winds about a point: 1 inside a body, 0 outside (sum of solid angles,
    /// `oosterom1983`).
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

/// 1 where a ray from the origin leaves through a triangle, -1 where it enters, 0 where it misses
/// it; `None` where it runs by its border as near as [`BESIDE`].
fn crossing([a, b, c]: &[Vector3<f64>; 3], way: &Vector3<f64>) -> Option<i32> {
    // Sides on which the ray passes the triangle's, each positive where it leaves.
    let side = |from: &Vector3<f64>, to: &Vector3<f64>| {
        let passes = way.dot(&from.cross(to));
        match passes.abs() <= BESIDE * from.norm() * to.norm() {
            true => 0.0,
            false => passes.signum(),
        }
    };
    let sides = [side(a, b), side(b, c), side(c, a)];
    let (leaves, enters) = (sides.contains(&1.0), sides.contains(&-1.0));
    match (leaves, enters) {
        (true, true) => Some(0),
        _ if sides.contains(&0.0) => None,
        (leaves, _) => {
            let turn = if leaves { 1 } else { -1 };
            // Ahead of the origin, not behind it.
            let is_ahead = a.dot(&b.cross(c)) * f64::from(turn) > 0.0;
            Some(if is_ahead { turn } else { 0 })
        }
    }
}

pub(super) fn to_parry(p: &Vector3<f64>) -> ParryVector {
    ParryVector::new(p.x, p.y, p.z)
}

#[cfg(test)]
pub(crate) mod tests {
    use super::super::drawn::seeded;
    use super::*;
    use proptest::prelude::*;
    use std::f64::consts::PI;

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

    /// Points drawn in and about boxes drawn at random, many of them level with corners, edges and
    /// faces: the distance from a box is that of its closed form, and its sign.
    #[test]
    fn verify_signs_and_distances_of_drawn_points_about_drawn_boxes() {
        let (corners, triangles) = block();
        for seed in 0..20 {
            let sides = seeded(seed, &[0.01..0.2_f64, 0.01..0.2, 0.01..0.2]);
            let half = 0.5 * Vector3::from(sides);
            let place = |p: &Vector3<f64>| {
                let part = p.component_div(&Vector3::new(0.1, 0.06, 0.02));
                2.0 * part.component_mul(&half) - half
            };
            let vertices: Vec<_> = corners.iter().map(place).collect();
            let mesh = Mesh::new(&vertices, &triangles, MeshUse::Body).expect("a box");
            let places = prop::collection::vec([-6..7_i32, -6..7, -6..7], 200);
            for at in seeded(seed, &places) {
                let point_m = Vector3::from(at.map(|k| f64::from(k) / 4.0)).component_mul(&half);
                let beyond = point_m.abs() - half;
                let outside_m = beyond.map(|x| x.max(0.0)).norm();
                let expected_m = outside_m + beyond.max().min(0.0);
                let found_m = mesh.nearest(&point_m).distance_m;
                let off_m = (found_m - expected_m).abs();
                assert!(off_m < 1e-12, "seed {seed} {at:?}: {found_m} {expected_m}");
            }
        }
    }

    /// Two closed skins in one another, a hollow, a fine ball and an open face.
    #[test]
    fn verify_a_ray_winds_as_solid_angles_do() {
        let (vertices, triangles) = block();
        let ball = ball(24, 0.05);
        let joined = |(vertices, triangles): (&[Vector3<f64>], &[[usize; 3]]), inward: bool| {
            let (mut all, mut sides) = ball.clone();
            let first = all.len();
            all.extend(vertices.iter().map(|p| 0.2 * p));
            sides.extend(triangles.iter().map(|t| {
                let [a, b, c] = t.map(|i| i + first);
                if inward { [a, c, b] } else { [a, b, c] }
            }));
            Mesh::new(&all, &sides, MeshUse::Body).expect("a body")
        };
        let bodies = [
            Mesh::new(&ball.0, &ball.1, MeshUse::Body).expect("a ball"),
            joined((&vertices, &triangles), false),
            joined((&vertices, &triangles), true),
        ];
        for (k, mesh) in bodies.iter().enumerate() {
            let places = prop::collection::vec([-0.06..0.06_f64, -0.06..0.06, -0.06..0.06], 500);
            let mut held = 0;
            for at in seeded(k as u8, &places) {
                let point_m = Vector3::from(at);
                let winds = mesh.winding(&point_m);
                for way in &RAYS {
                    let crossings = mesh.crossings(&point_m, way).expect("clear of edges");
                    assert!(
                        (f64::from(crossings) - winds).abs() < 1e-6,
                        "{at:?}: {winds}"
                    );
                }
                held += usize::from(mesh.nearest(&point_m).distance_m < 0.0);
                // A ball's chords stand off by 0.05 m (1 - cos²(π/48)), once for each angle.
                if k == 0 {
                    let off_m = mesh.nearest(&point_m).distance_m - (point_m.norm() - 0.05);
                    assert!((-1e-9..0.5e-3).contains(&off_m), "{at:?}: {off_m}");
                }
            }
            assert!(held > 50 && held < 400, "{held}");
        }
        let open = Mesh::new(&vertices, &triangles[..11], MeshUse::Face).expect("a face");
        let inside = open.nearest(&Vector3::new(0.03, 0.02, 0.018));
        assert!(
            (inside.distance_m - 0.002).abs() < 1e-15,
            "nothing tells inside"
        );
    }

    /// A ball in rings, 2 n of them along each meridian and each circle of latitude.
    pub(crate) fn ball(n: usize, radius_m: f64) -> (Vec<Vector3<f64>>, Vec<[usize; 3]>) {
        let point = |i: usize, k: usize| {
            let (polar, turn) = [i, k].map(|k| PI * k as f64 / n as f64).into();
            let (sin, cos): (f64, f64) = f64::sin_cos(polar);
            radius_m * Vector3::new(sin * f64::cos(turn), sin * f64::sin(turn), cos)
        };
        let mut vertices = vec![point(0, 0)];
        for i in 1..n {
            vertices.extend((0..2 * n).map(|k| point(i, k)));
        }
        vertices.push(point(n, 0));
        let south = vertices.len() - 1;
        let at = |i: usize, k: usize| 1 + (i - 1) * 2 * n + k % (2 * n);
        let mut triangles = Vec::new();
        for k in 0..2 * n {
            triangles.push([0, at(1, k), at(1, k + 1)]);
            triangles.push([south, at(n - 1, k + 1), at(n - 1, k)]);
            for i in 1..n - 1 {
                let [a, b, c, d] = [at(i, k), at(i + 1, k), at(i + 1, k + 1), at(i, k + 1)];
                triangles.extend([[a, b, c], [a, c, d]]);
            }
        }
        (vertices, triangles)
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
