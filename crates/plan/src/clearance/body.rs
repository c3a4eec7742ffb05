//! Bodies, made of pieces of which parry knows distances.

use nalgebra::{Isometry3, Point3, Vector3};
use parry3d_f64::shape::SharedShape;
use truecut_arm::Shape;

use super::hull;
use super::solid::{Solid, y_to_z};

/// A convex body or a mesh, fixed to a frame.
pub(super) struct Piece {
    pub shape: SharedShape,
    pub frame_from_shape: Isometry3<f64>,
    /// A convex body about a mesh, which is asked first: a mesh has many triangles.
    pub cover: Option<(SharedShape, Isometry3<f64>)>,
    /// How far the body may stand out of the shape, m.
    pub slack_m: f64,
    /// A ball about it, in the frame.
    pub centre_m: Vector3<f64>,
    pub radius_m: f64,
    /// A point within it, in the frame.
    pub inner_m: Vector3<f64>,
}

/// Pieces that move as one.
pub(super) struct Body {
    pub name: String,
    /// 0 for the world, k + 1 for the k-th link that moves.
    pub frame: usize,
    pub pieces: Vec<Piece>,
    /// What stands, for telling what lies within it.
    pub solid: Option<(Solid, Isometry3<f64>)>,
    pub is_part: bool,
    /// A job brings it, and draws it.
    pub is_own: bool,
    pub cuts: bool,
}

pub(super) fn piece(shape: SharedShape, frame_from_shape: &Isometry3<f64>) -> Piece {
    let ball = shape.compute_local_bounding_sphere();
    let centre = Point3::new(ball.center.x, ball.center.y, ball.center.z);
    let centre_m = (frame_from_shape * centre).coords;
    let cover = shape.as_trimesh().map(|mesh| {
        let about = mesh.local_aabb();
        let (half, middle) = (about.half_extents(), about.center());
        let at = Isometry3::translation(middle.x, middle.y, middle.z);
        let shape = SharedShape::cuboid(half.x, half.y, half.z);
        (shape, frame_from_shape * at)
    });
    Piece {
        cover,
        radius_m: ball.radius,
        centre_m,
        inner_m: centre_m,
        frame_from_shape: *frame_from_shape,
        slack_m: 0.0,
        shape,
    }
}

pub(super) fn of_hull(hull: hull::Hull, at: Option<&Isometry3<f64>>) -> Piece {
    let at = at.copied().unwrap_or_default();
    let own = piece(hull.shape, &(at * hull.frame_from_shape));
    Piece {
        slack_m: hull.slack_m,
        radius_m: own.radius_m + hull.slack_m,
        inner_m: (at * Point3::from(hull.inner_m)).coords,
        ..own
    }
}

pub(super) fn of_shape(shape: &Shape, at: &Isometry3<f64>) -> Piece {
    match *shape {
        Shape::Box { half_extents_m: h } => piece(SharedShape::cuboid(h.x, h.y, h.z), at),
        Shape::Cylinder { radius_m, length_m } => {
            let shape = SharedShape::cylinder(0.5 * length_m, radius_m);
            piece(shape, &(at * y_to_z()))
        }
        Shape::Capsule { radius_m, length_m } => {
            piece(SharedShape::capsule_z(0.5 * length_m, radius_m), at)
        }
        Shape::Sphere { radius_m } => piece(SharedShape::ball(radius_m), at),
    }
}
