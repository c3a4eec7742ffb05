//! Sharp edges of a mesh, and the triangles about a cylinder.

use nalgebra::{Isometry3, Unit, Vector3};
use parry3d_f64::partitioning::BvhNode;
use std::f64::consts::PI;

use super::mesh::Mesh;
use super::mesh_checks::edges;

/// Faces that turn by less meet in no edge: a curved face cut into triangles turns from one to the
/// next.
pub const LEAST_TURN_RAD: f64 = 10.0 * PI / 180.0;

/// Where two faces of a mesh meet in an edge that stands out.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SharpEdge {
    pub ends_m: [Vector3<f64>; 2],
    /// Outward normals of the two faces.
    pub normals: [Unit<Vector3<f64>>; 2],
}

impl SharpEdge {
    /// Angle between the faces, through the material, below π.
    #[must_use]
    pub fn wedge_rad(&self) -> f64 {
        PI - self.normals[0].angle(&self.normals[1])
    }

    /// Distance of a point.
    #[must_use]
    pub fn distance_m(&self, point_m: &Vector3<f64>) -> f64 {
        (self.nearest_m(point_m) - point_m).norm()
    }

    /// Its point that is nearest to another.
    #[must_use]
    pub fn nearest_m(&self, point_m: &Vector3<f64>) -> Vector3<f64> {
        let [from, to] = self.ends_m;
        from + (to - from) * self.share_of(point_m)
    }

    /// At which share of its way that is, from 0 to 1.
    pub(super) fn share_of(&self, point_m: &Vector3<f64>) -> f64 {
        let [from, to] = self.ends_m;
        let way = to - from;
        ((point_m - from).dot(&way) / way.norm_squared()).clamp(0.0, 1.0)
    }
}

impl Mesh {
    /// All edges that stand out by ten degrees or more, in the order of their vertices.
    #[must_use]
    pub fn sharp_edges(&self) -> Vec<SharpEdge> {
        let vertices = self.vertices_m();
        let sharp = edges(self.triangles())
            .into_iter()
            .filter_map(|(ends, users)| {
                let [one, other] = users.as_slice() else {
                    return None;
                };
                let (one, other) = (one.0, other.0);
                let normals = [one, other].map(|triangle| self.normal(triangle));
                let ends_m = ends.map(|i| vertices[i]);
                // The far corner of the other face lies below the first where the edge stands out.
                let far = (self.triangles()[other].iter()).find(|corner| !ends.contains(corner))?;
                let stands_out = (vertices[*far] - ends_m[0]).dot(&normals[0]) < 0.0;
                let edge = SharpEdge { ends_m, normals };
                (stands_out && PI - edge.wedge_rad() >= LEAST_TURN_RAD).then_some(edge)
            });
        sharp.collect()
    }

    /// Outward normal of a triangle.
    #[must_use]
    pub fn normal(&self, triangle: usize) -> Unit<Vector3<f64>> {
        let [a, b, c] = self.triangles()[triangle].map(|i| self.vertices_m()[i]);
        Unit::new_normalize((b - a).cross(&(c - a)))
    }

    /// Triangles that may reach into a cylinder whose axis is the y axis of its frame: those whose
    /// boxes come as near.
    pub fn triangles_about_cylinder(
        &self,
        mesh_from_cylinder: &Isometry3<f64>,
        radius_m: f64,
        width_m: f64,
    ) -> impl Iterator<Item = usize> {
        let middle_m = mesh_from_cylinder.translation.vector;
        let axis = mesh_from_cylinder.rotation * Vector3::y();
        let is_near = |node: &BvhNode| {
            let (low, high) = (node.mins(), node.maxs());
            let [low_m, high_m] = [low, high].map(|p| Vector3::new(p.x, p.y, p.z));
            let half_m = 0.5 * (high_m - low_m);
            let off_m = low_m + half_m - middle_m;
            let along_m = off_m.dot(&axis);
            let across_m = (off_m - axis * along_m).norm();
            along_m.abs() <= 0.5 * width_m + half_m.dot(&axis.abs())
                && across_m <= radius_m + half_m.norm()
        };
        let found: Vec<u32> = self.shape().bvh().leaves(is_near).collect();
        found.into_iter().map(|index| index as usize)
    }
}

#[cfg(test)]
mod tests {
    use super::super::drawn::seeded;
    use super::super::mesh::tests::{ball, block};
    use super::super::{MeshUse, mesh::Mesh};
    use super::*;
    use nalgebra::Point3;
    use std::f64::consts::FRAC_PI_2;

    #[test]
    fn verify_a_block_has_twelve_right_edges_and_a_notch_none_that_stand_out() {
        let (vertices, triangles) = block();
        let mesh = Mesh::new(&vertices, &triangles, MeshUse::Body).expect("a block");
        let edges = mesh.sharp_edges();
        assert_eq!(edges.len(), 12);
        for edge in &edges {
            assert!((edge.wedge_rad() - FRAC_PI_2).abs() < 1e-12);
            let along = edge.ends_m[1] - edge.ends_m[0];
            assert!(
                edge.normals
                    .iter()
                    .all(|n| n.dot(&along).abs() < 1e-15 && n.dot(&edge.ends_m[0]) >= 0.0)
            );
        }
        let near = |p: Vector3<f64>| {
            let distances = edges.iter().map(|e| e.distance_m(&p));
            distances.fold(f64::INFINITY, f64::min)
        };
        assert!((near(Vector3::new(0.05, -3e-3, 0.024)) - 5e-3).abs() < 1e-15);
        // Two faces of a corner seen from inside.
        let corner = [
            Vector3::zeros(),
            Vector3::x(),
            Vector3::y(),
            Vector3::new(0.0, 1.0, 1.0),
            Vector3::new(1.0, 1.0, 0.0),
            Vector3::new(1.0, 1.0, 1.0),
        ];
        let notch = [[0, 1, 4], [0, 4, 2], [2, 4, 5], [2, 5, 3]];
        let notch = Mesh::new(&corner, &notch, MeshUse::Face).expect("a skin");
        assert_eq!(notch.sharp_edges(), Vec::new());
    }

    /// Of a fine ball, in cylinders drawn at random: none that has a corner within is missing.
    #[test]
    fn verify_all_triangles_with_a_corner_in_a_drawn_cylinder_are_found() {
        let (vertices, triangles) = ball(24, 0.05);
        let mesh = Mesh::new(&vertices, &triangles, MeshUse::Body).expect("a ball");
        let mut within = 0;
        for seed in 0..40 {
            let numbers = [
                -1.0..1.0_f64,
                -1.0..1.0,
                -1.0..1.0,
                -1.0..1.0,
                -1.0..1.0,
                -1.0..1.0,
            ];
            let [x, y, z, a, b, c] = seeded(seed, &numbers);
            let (radius_m, width_m) = (0.01 + 0.005 * a, 0.02 + 0.01 * b);
            let pose = Isometry3::new(Vector3::new(x, y, z) * 0.06, Vector3::new(a, b, c) * 3.0);
            let found: Vec<usize> =
                (mesh.triangles_about_cylinder(&pose, radius_m, width_m)).collect();
            let holds = |corner: &usize| {
                let p = pose.inverse() * Point3::from(vertices[*corner]);
                p.x.hypot(p.z) < radius_m && p.y.abs() < 0.5 * width_m
            };
            for (index, triangle) in triangles.iter().enumerate() {
                if triangle.iter().any(holds) {
                    within += 1;
                    assert!(found.contains(&index), "seed {seed}: {index}");
                }
            }
            assert!(
                found.len() < triangles.len() / 4,
                "seed {seed}: {}",
                found.len()
            );
        }
        assert!(within > 100, "{within}");
    }
}
