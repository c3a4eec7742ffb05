//! Distances of two bodies.

use nalgebra::{Isometry3, Point3, Vector3};
use parry3d_f64::math::Pose as ParryPose;
use parry3d_f64::partitioning::BvhNode;
use parry3d_f64::query;
use parry3d_f64::shape::{Cuboid, Shape, SharedShape, TriMesh};

use super::body::Piece;
use super::cell::{Cell, Pair};
use crate::surface::to_parry_pose;

/// How far a pair is apart.
#[derive(Clone, Copy)]
pub(super) struct Apart {
    /// Distance of what was looked at closely, 0 where it touches; exact if below the bar.
    pub least_m: f64,
    /// No point of one is nearer to the other than this.
    pub bound_m: f64,
}

/// Bodies whose balls are further beyond a bar than this are not looked at, m.
const FAR_M: f64 = 0.1;

/// Distance of a convex body from the triangles of a mesh, m; `None` if it is not below `far_m`.
/// A box of the tree counts by its distance from the body: boxes about the body, by which parry
/// orders triangles, leave thousands of them beside a long link.
fn from_mesh(
    mesh: &TriMesh,
    mesh_from_other: &ParryPose,
    other: &dyn Shape,
    far_m: f64,
) -> Option<f64> {
    let of_box = |node: &BvhNode, _| {
        let about = node.aabb();
        let at = ParryPose::from_translation(about.center());
        let own = Cuboid::new(about.half_extents());
        // What parry cannot tell is looked into.
        query::distance(&at, &own, mesh_from_other, other).map_or(0.0, |found| found.distance)
    };
    let of_triangle = |index: u32, _| {
        let own = mesh.triangle(index);
        let found = query::distance(&ParryPose::identity(), &own, mesh_from_other, other);
        Some(found.map_or(0.0, |found| found.distance))
    };
    let nearest = mesh
        .bvh()
        .find_best(far_m.min(f64::MAX), of_box, of_triangle);
    nearest.map(|(_, found_m)| found_m)
}

impl Cell {
    /// How far a pair is apart. What is known to be further than `bar_m` is not looked at closely.
    pub(super) fn apart(&self, pair: &Pair, frames: &[Isometry3<f64>], bar_m: f64) -> Apart {
        let [a, b] = pair.bodies.map(|index| &self.bodies[index]);
        let [at_a, at_b] = [&frames[a.frame], &frames[b.frame]];
        let mut apart = Apart {
            least_m: f64::INFINITY,
            bound_m: f64::INFINITY,
        };
        for one in &a.pieces {
            for other in &b.pieces {
                // What is no nearer than another piece does not matter, either.
                let bar_m = bar_m.min(apart.least_m);
                let way = at_a * Point3::from(one.centre_m) - at_b * Point3::from(other.centre_m);
                let balls_m = way.norm() - one.radius_m - other.radius_m;
                if balls_m >= bar_m + FAR_M {
                    apart.bound_m = apart.bound_m.min(balls_m);
                    continue;
                }
                let slack_m = one.slack_m + other.slack_m;
                let pose = at_b * other.frame_from_shape;
                let from = |shape: &SharedShape, at: &Isometry3<f64>| {
                    let poses = [at_a * at, pose].map(|pose| to_parry_pose(&pose));
                    let (own, moving) = (shape.as_ref(), other.shape.as_ref());
                    // All pairs of convex bodies and meshes are known to parry.
                    let found = query::distance(&poses[0], own, &poses[1], moving);
                    found.map_or(0.0, |found| (found.distance - slack_m).max(0.0))
                };
                if let Some((cover, at)) = &one.cover {
                    let covers_m = from(cover, at);
                    if covers_m >= bar_m {
                        apart.bound_m = apart.bound_m.min(covers_m);
                        continue;
                    }
                }
                let found_m = match one.shape.as_trimesh() {
                    Some(mesh) => {
                        let mesh_from_other = (at_a * one.frame_from_shape).inverse() * pose;
                        let way = to_parry_pose(&mesh_from_other);
                        let far_m = bar_m + slack_m;
                        let Some(found_m) = from_mesh(mesh, &way, other.shape.as_ref(), far_m)
                        else {
                            apart.bound_m = apart.bound_m.min(bar_m);
                            continue;
                        };
                        (found_m - slack_m).max(0.0)
                    }
                    None => from(&one.shape, &one.frame_from_shape),
                };
                apart.least_m = apart.least_m.min(found_m);
                apart.bound_m = apart.bound_m.min(found_m);
            }
        }
        apart
    }

    /// The two points of a pair that are nearest to each other, world, the one of what moves first;
    /// `None` where they touch.
    pub(super) fn nearest_m(
        &self,
        pair: &Pair,
        frames: &[Isometry3<f64>],
    ) -> Option<[Vector3<f64>; 2]> {
        let [a, b] = pair.bodies.map(|index| &self.bodies[index]);
        let [at_a, at_b] = [&frames[a.frame], &frames[b.frame]];
        let all = a.pieces.iter().flat_map(|one| {
            b.pieces.iter().filter_map(move |other| {
                let [pose, other_pose] = [(at_a, one), (at_b, other)]
                    .map(|(at, piece)| to_parry_pose(&(at * piece.frame_from_shape)));
                let (shape, own) = (one.shape.as_ref(), other.shape.as_ref());
                match query::closest_points(&pose, shape, &other_pose, own, f64::MAX) {
                    Ok(query::ClosestPoints::WithinMargin(p, q)) => {
                        Some([q, p].map(|p| Vector3::new(p.x, p.y, p.z)))
                    }
                    _ => None,
                }
            })
        });
        let apart = |pair: &[Vector3<f64>; 2]| (pair[0] - pair[1]).norm();
        all.min_by(|p, q| apart(p).total_cmp(&apart(q)))
    }

    /// Whether what moves begins within what stands: distances are those of a mesh's skin.
    pub(super) fn begins_within(&self, pair: &Pair, frames: &[Isometry3<f64>]) -> bool {
        let [a, b] = pair.bodies.map(|index| &self.bodies[index]);
        let Some((solid, at)) = &a.solid else {
            return false;
        };
        b.pieces.iter().any(|piece| {
            let point = frames[b.frame] * Point3::from(piece.inner_m);
            let is_about = |own: &Piece| (point.coords - own.centre_m).norm() <= own.radius_m;
            a.pieces.iter().any(is_about) && solid.holds(&(at.inverse() * point).coords)
        })
    }
}
