//! Convex hulls with few corners.

use nalgebra::{Isometry3, Vector3};
use parry3d_f64::math::Vector as ParryVector;
use parry3d_f64::query::PointQuery;
use parry3d_f64::shape::{ConvexPolyhedron, SharedShape};
use parry3d_f64::transformation::try_convex_hull;

use super::solid::to_parry;

/// Most corners of a hull: each distance looks at all of them.
const MOST_CORNERS: usize = 200;

/// A convex body about points.
pub(super) struct Hull {
    pub shape: SharedShape,
    pub frame_from_shape: Isometry3<f64>,
    /// A point within it.
    pub inner_m: Vector3<f64>,
    /// How far points stand out of it at most, m: distances from it are so much less.
    pub slack_m: f64,
}

/// The convex hull of points. Of one with many corners those that stand out most are kept; points
/// that have no hull (in a plane, on a line) get the box about them.
pub(super) fn of_points(points_m: &[Vector3<f64>]) -> Option<Hull> {
    let points: Vec<ParryVector> = points_m.iter().map(to_parry).collect();
    let Ok((corners, _)) = try_convex_hull(&points) else {
        return box_about(points_m);
    };
    if corners.len() <= MOST_CORNERS {
        return match ConvexPolyhedron::from_convex_hull(&corners) {
            Some(hull) => Some(made(hull, 0.0)),
            None => box_about(points_m),
        };
    }
    thinned(&corners).or_else(|| box_about(points_m))
}

fn made(hull: ConvexPolyhedron, slack_m: f64) -> Hull {
    let corners = hull.points();
    let sum = corners
        .iter()
        .fold(Vector3::zeros(), |sum, p| sum + Vector3::new(p.x, p.y, p.z));
    Hull {
        inner_m: sum / corners.len() as f64,
        frame_from_shape: Isometry3::identity(),
        shape: SharedShape::new(hull),
        slack_m,
    }
}

/// The hull of those corners that lie furthest from those taken before, one after the other.
fn thinned(corners: &[ParryVector]) -> Option<Hull> {
    let mut kept = vec![0];
    let mut away = vec![f64::INFINITY; corners.len()];
    while kept.len() < MOST_CORNERS {
        let last = corners[kept[kept.len() - 1]];
        for (own, corner) in away.iter_mut().zip(corners) {
            *own = own.min((*corner - last).length());
        }
        let furthest = (0..corners.len()).max_by(|a, b| away[*a].total_cmp(&away[*b]))?;
        kept.push(furthest);
    }
    let few: Vec<ParryVector> = kept.into_iter().map(|k| corners[k]).collect();
    let hull = ConvexPolyhedron::from_convex_hull(&few)?;
    let outside = corners
        .iter()
        .map(|p| hull.distance_to_local_point(*p, true));
    let slack_m = outside.fold(0.0, f64::max);
    Some(made(hull, slack_m))
}

fn box_about(points_m: &[Vector3<f64>]) -> Option<Hull> {
    let first = *points_m.first()?;
    let (low, high) = points_m
        .iter()
        .fold((first, first), |(low, high), p| (low.inf(p), high.sup(p)));
    let half = ((high - low) * 0.5).map(|half| half.max(THIN_M));
    let inner_m = (low + high) * 0.5;
    Some(Hull {
        shape: SharedShape::cuboid(half.x, half.y, half.z),
        frame_from_shape: Isometry3::translation(inner_m.x, inner_m.y, inner_m.z),
        inner_m,
        slack_m: 0.0,
    })
}

/// Least half thickness of a box about a plane, m.
const THIN_M: f64 = 1e-6;

#[cfg(test)]
mod tests {
    use super::*;

    /// A ball's points: the hull lies within it, and no point further out than it says.
    #[test]
    fn verify_a_thinned_hull_says_how_far_points_stand_out() {
        let golden = std::f64::consts::PI * (3.0 - 5_f64.sqrt());
        let point = |k: u32| {
            let z = 1.0 - 2.0 * (f64::from(k) + 0.5) / 2000.0;
            let (s, c) = (golden * f64::from(k)).sin_cos();
            let r = (1.0 - z * z).sqrt();
            Vector3::new(r * c, r * s, z) * 0.1
        };
        let points: Vec<_> = (0..2000).map(point).collect();
        let hull = of_points(&points).expect("a hull");
        // 200 corners spread over a sphere stand some 0.25 radii apart: a sagitta of 1 %.
        assert!(
            hull.slack_m > 0.3e-3 && hull.slack_m < 3e-3,
            "{}",
            hull.slack_m
        );
        for point in &points {
            let away = hull.shape.distance_to_local_point(to_parry(point), true);
            assert!(away <= hull.slack_m + 1e-12);
        }
    }

    #[test]
    fn points_in_a_plane_get_a_box() {
        let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
        let points = corners.map(|[x, y]| Vector3::new(x, y, 0.5));
        let hull = of_points(&points).expect("a box");
        let above = to_parry(&Vector3::new(0.5, 0.5, 0.7));
        let place = hull.frame_from_shape.translation.vector;
        let away = hull
            .shape
            .distance_to_local_point(above - to_parry(&place), true);
        assert!((away - 0.2).abs() < 1e-5, "{away}");
    }
}
