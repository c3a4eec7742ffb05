//! How deep a wheel lies in a mesh: the whole wheel against the whole face, not its curvature at
//! one place.

use nalgebra::{Isometry3, Vector3};
use parry3d_f64::math::{Pose, Rotation, Vector as ParryVector};
use parry3d_f64::query;
use parry3d_f64::shape::{Cylinder, Shape, Triangle};

use super::error::SurfaceFault;
use super::mesh::Mesh;
use super::mesh_checks::MeshUse;
use super::{Domain, Surface};

/// Triangles with no longer side are looked at in their corners and their middle: against a wheel
/// of radius R that misses s²/(8 R) at most, 7 µm for 40 mm.
const SMALL_M: f64 = 1.5e-3;

/// Sides of the cells into which a patch is cut, m.
const CELL_M: f64 = 1e-3;

/// Most cells along one parameter.
const MOST_CELLS: usize = 500;

impl Mesh {
    /// A patch cut into triangles with sides of 1 mm, at most 500 along each parameter.
    ///
    /// # Errors
    /// If triangles of the patch have no area.
    pub fn of_patch(surface: &dyn Surface) -> Result<Self, SurfaceFault> {
        let Domain { u, v } = surface.domain();
        let at = |range: [f64; 2], k: usize, of: usize| {
            range[0] + (range[1] - range[0]) * k as f64 / of as f64
        };
        // Lengths of the parameter lines through the middle and along the borders; the longest
        // decides.
        let length_m = |point: &dyn Fn(f64) -> Vector3<f64>| {
            let points: Vec<_> = (0..=64).map(|k| point(f64::from(k) / 64.0)).collect();
            points.windows(2).map(|w| (w[1] - w[0]).norm()).sum::<f64>()
        };
        let share = |range: [f64; 2], t: f64| range[0] + (range[1] - range[0]) * t;
        let longest = |along: &dyn Fn(f64, f64) -> Vector3<f64>| {
            let lines = [0.0, 0.5, 1.0].map(|s| length_m(&|t| along(t, s)));
            lines.into_iter().fold(0.0, f64::max)
        };
        let cells = |m: f64| ((m / CELL_M).ceil() as usize).clamp(1, MOST_CELLS);
        let nu = cells(longest(&|t, s| surface.point_m(share(u, t), share(v, s))));
        let nv = cells(longest(&|t, s| surface.point_m(share(u, s), share(v, t))));
        let mut vertices = Vec::with_capacity((nu + 1) * (nv + 1));
        for i in 0..=nu {
            vertices.extend((0..=nv).map(|j| surface.point_m(at(u, i, nu), at(v, j, nv))));
        }
        let mut triangles = Vec::with_capacity(2 * nu * nv);
        for i in 0..nu {
            for j in 0..nv {
                let [a, b] = [i * (nv + 1) + j, (i + 1) * (nv + 1) + j];
                triangles.extend([[a, b, b + 1], [a, b + 1, a + 1]]);
            }
        }
        Self::new(&vertices, &triangles, MeshUse::Face)
    }

    /// How deep a cylindrical wheel, its axis the y axis of its frame, lies in the mesh, m: how far
    /// its deepest point of contact is from the wheel's nearest outer face. 0 where it does not
    /// touch. A wheel whose middle is inside a body lies as deep as that is, and its radius more.
    #[must_use]
    pub fn wheel_depth_m(
        &self,
        mesh_from_wheel: &Isometry3<f64>,
        radius_m: f64,
        width_m: f64,
    ) -> f64 {
        let wheel = Cylinder::new(0.5 * width_m, radius_m);
        let pose = to_parry(mesh_from_wheel);
        let wheel_from_mesh = mesh_from_wheel.inverse();
        let depth_m = |p: Vector3<f64>| {
            let p = wheel_from_mesh * nalgebra::Point3::from(p);
            (radius_m - p.x.hypot(p.z)).min(0.5 * width_m - p.y.abs())
        };
        let mut deepest_m = 0.0_f64;
        let box_of_wheel = wheel.compute_aabb(&pose);
        for index in self.shape().bvh().intersect_aabb(&box_of_wheel) {
            let [a, b, c] = self.triangles()[index as usize].map(|i| self.vertices_m()[i]);
            let sides = [b - a, c - b, a - c].map(|s| s.norm());
            if sides.into_iter().fold(0.0, f64::max) <= SMALL_M {
                for point in [a, b, c, (a + b + c) / 3.0] {
                    deepest_m = deepest_m.max(depth_m(point));
                }
                continue;
            }
            let [a, b, c] = [a, b, c].map(|p| ParryVector::new(p.x, p.y, p.z));
            let triangle = Triangle::new(a, b, c);
            let found = query::contact(&Pose::identity(), &triangle, &pose, &wheel, 0.0);
            if let Ok(Some(contact)) = found {
                deepest_m = deepest_m.max(-contact.dist);
            }
        }
        if self.is_body() {
            let middle = self.nearest(&mesh_from_wheel.translation.vector);
            if middle.distance_m < 0.0 {
                deepest_m = deepest_m.max(radius_m - middle.distance_m);
            }
        }
        deepest_m
    }
}

pub(crate) fn to_parry(pose: &Isometry3<f64>) -> Pose {
    let (t, q) = (pose.translation.vector, pose.rotation);
    Pose::from_parts(
        ParryVector::new(t.x, t.y, t.z),
        Rotation::from_xyzw(q.i, q.j, q.k, q.w),
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::surface::PlanePatch;
    use crate::surface::cylinder::CylinderPatch;
    use nalgebra::{Translation3, Unit, UnitQuaternion};

    const RADIUS_M: f64 = 0.04;
    const WIDTH_M: f64 = 0.025;

    fn above(x: f64, y: f64, z: f64) -> Isometry3<f64> {
        Isometry3::from_parts(Translation3::new(x, y, z), UnitQuaternion::identity())
    }

    fn block() -> Mesh {
        let corner = |k: usize| {
            let bit = |b: usize| if k & b == 0 { 0.0 } else { 1.0 };
            Vector3::new(0.1 * bit(1), 0.06 * bit(2), 0.02 * bit(4))
        };
        let corners: Vec<_> = (0..8).map(corner).collect();
        let quads = [
            [0, 2, 3, 1],
            [4, 5, 7, 6],
            [0, 1, 5, 4],
            [2, 6, 7, 3],
            [0, 4, 6, 2],
            [1, 3, 7, 5],
        ];
        let triangles: Vec<_> = quads
            .iter()
            .flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]])
            .collect();
        Mesh::new(&corners, &triangles, MeshUse::Body).expect("a block")
    }

    /// On a plane the depth is what the wheel is pressed in by, on a patch of small triangles as on
    /// a block of large ones.
    #[test]
    fn verify_depth_on_a_plane_is_the_indentation() {
        let plane = PlanePatch::new(Vector3::z() * 0.02, Vector3::x() * 0.1, Vector3::y() * 0.06)
            .expect("a plane");
        let patch = Mesh::of_patch(&plane).expect("a mesh");
        for mesh in [patch, block()] {
            for pressed_m in [0.2e-3, 2e-3] {
                let pose = above(0.0505, 0.0302, 0.02 + RADIUS_M - pressed_m);
                let found_m = mesh.wheel_depth_m(&pose, RADIUS_M, WIDTH_M);
                // Corners of the patch's triangles stand up to half a cell from the lowest line:
                // s²/(8 R) with s 1 mm.
                assert!((found_m - pressed_m).abs() < 4e-6, "{found_m} {pressed_m}");
            }
            let clear = above(0.05, 0.03, 0.02 + RADIUS_M + 1e-4);
            assert_eq!(mesh.wheel_depth_m(&clear, RADIUS_M, WIDTH_M), 0.0);
        }
    }

    /// Within a bore narrower than the wheel, local curvature aside, the wheel's rim cuts by R + e
    /// − r at its side: here the wheel stands in a bore of radius 50 mm and its axis across, so
    /// that its corners reach √((R)² + (W/2)²).
    #[test]
    fn verify_the_corners_of_a_wheel_across_a_bore_cut_it() {
        let bore = CylinderPatch::new(
            Vector3::zeros(),
            Unit::new_normalize(Vector3::y()),
            Unit::new_normalize(-Vector3::z()),
            -0.05,
            [-1.2, 1.2],
            0.1,
        );
        let mesh = Mesh::of_patch(&bore).expect("a mesh");
        let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), std::f64::consts::FRAC_PI_2);
        // The lowest line of the wheel touches the bottom of the bore.
        let pose = Isometry3::from_parts(Translation3::new(0.0, 0.05, -0.05 + RADIUS_M), turn);
        let found_m = mesh.wheel_depth_m(&pose, RADIUS_M, WIDTH_M);
        let half_m = 0.5 * WIDTH_M;
        // At the wheel's rim the bore has risen by r − √(r² − W²/4); a point just inside the rim is
        // as deep as that or as near to the side.
        let rise_m = |y: f64| 0.05 - (0.05_f64 * 0.05 - y * y).sqrt();
        let mut expected_m = 0.0_f64;
        for k in 0..=10_000 {
            let y = half_m * f64::from(k) / 1e4;
            expected_m = expected_m.max(rise_m(y).min(half_m - y));
        }
        assert!(
            (found_m / expected_m - 1.0).abs() < 0.05,
            "{found_m} {expected_m}"
        );
    }

    #[test]
    fn a_wheel_inside_a_body_lies_deep() {
        let found_m = block().wheel_depth_m(&above(0.05, 0.03, 0.01), 0.004, 0.004);
        assert!((found_m - 0.014).abs() < 1e-9, "{found_m}");
    }
}
