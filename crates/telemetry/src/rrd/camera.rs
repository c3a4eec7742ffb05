//! Where to look from, when the scene does not say.

use nalgebra::{Point3, Vector3};
use truecut_recording::{Body, Camera, Field, Geometry, Scene, Shape};

use super::field;
use super::shapes::isometry;

/// How wide a view is that shares the left half with others, in parts of its height.
pub(super) fn aspect(views: usize) -> f64 {
    1.4 / views.max(1) as f64
}

/// From the side and somewhat above, from where the arm and the workpiece fill a view of that
/// width.
pub(super) fn whole(scene: &Scene, aspect: f64) -> Camera {
    // The arm reaches from its base to the workpiece: it is seen best across that direction.
    let base = scene.bodies.first().map_or(Vector3::zeros(), place_of);
    let reach = workpiece(scene).map_or(Vector3::x(), |body| place_of(body) - base);
    let ahead = horizontal(&reach).unwrap_or(Vector3::x());
    let direction: Vector3<f64> = 0.45 * ahead + 0.85 * across(&ahead) + 0.35 * Vector3::z();
    let points: Vec<Vector3<f64>> = scene.bodies.iter().flat_map(points_of).collect();
    fitted(&points, &direction.normalize(), aspect).unwrap_or(Camera {
        position_m: [3.0, -3.0, 2.0],
        target_m: [0.0; 3],
    })
}

/// The camera in this direction from which all points are just seen, and which looks at their
/// middle. `None` without points.
fn fitted(points: &[Vector3<f64>], direction: &Vector3<f64>, aspect: f64) -> Option<Camera> {
    let right = Vector3::z().cross(direction).try_normalize(1e-6)?;
    let up = direction.cross(&right);
    let axes = [(right, 0.5 * SEEN * aspect), (up, 0.5 * SEEN)];
    let middle = |axis: &Vector3<f64>| {
        let along = points.iter().map(|point| point.dot(axis));
        let ends = along
            .map(|x| (x, x))
            .reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)));
        ends.map(|(low, high)| 0.5 * (low + high))
    };
    let mut target = Vector3::zeros();
    for axis in [&right, &up, direction] {
        target += middle(axis)? * axis;
    }
    // As much height is seen as a thing is away: half of it on either side of the middle.
    let away = points.iter().flat_map(|point| {
        let from = point - target;
        axes.map(|(axis, half)| from.dot(&axis).abs() / half + from.dot(direction))
    });
    let away_m = away.fold(0.0, f64::max);
    Some(Camera {
        position_m: (target + away_m * direction).into(),
        target_m: target.into(),
    })
}

/// The workpiece from near by, from the arm's side, in a view of that width. `None` if there is
/// none, or no arm.
pub(super) fn near_tool(scene: &Scene, aspect: f64) -> Option<Camera> {
    let workpiece = workpiece(scene)?;
    let origin = place_of(workpiece);
    let last_link = scene
        .bodies
        .iter()
        .rfind(|body| body.path.starts_with("arm/"))?;
    let base = place_of(scene.bodies.first()?);
    // A tool that stands upright over the workpiece leans nowhere: from the arm's base, then.
    let lean = place_of(last_link) - origin;
    let leans = horizontal(&lean).filter(|_| lean.xy().norm() > UPRIGHT * lean.norm());
    let from_workpiece = leans.or_else(|| horizontal(&(base - origin)))?;
    let side = across(&from_workpiece);
    // On the side away from the base, where the arm does not stand in the way.
    let away = if side.dot(&(origin - base)) >= 0.0 {
        1.0
    } else {
        -1.0
    };
    let direction: Vector3<f64> = 0.5 * from_workpiece + 0.8 * away * side + 0.4 * Vector3::z();
    let direction = direction.normalize();
    // A workpiece may stand anywhere about its own origin, and the tool comes to it from afar.
    let mut points = points_of(workpiece);
    points.extend(nearest_shape(last_link, &points));
    let seen = fitted(&points, &direction, aspect)?;
    let target = Vector3::from(seen.target_m);
    let away_m = (Vector3::from(seen.position_m) - target).norm();
    let away_m = (AIR * away_m).clamp(NEAREST_M, FARTHEST_M);
    Some(Camera {
        position_m: (target + away_m * direction).into(),
        target_m: target.into(),
    })
}

/// Parts of a view that what is to be seen fills.
const SEEN: f64 = 0.9;
/// How much further away than to fill the view with tool and workpiece.
const AIR: f64 = 1.1;
const NEAREST_M: f64 = 0.15;
const FARTHEST_M: f64 = 0.9;
/// Less than this part of a tool's way aside is upright.
const UPRIGHT: f64 = 0.1;
/// Parts of its height that a view from above is wide: it stands beside two others.
pub(super) const NARROW: f64 = 0.43;

/// Straight onto a field, its longer side up, from where it fills a narrow view with its bar of
/// colours and the bar's numbers; with that direction up.
pub(super) fn above(field: &Field) -> (Camera, [f64; 3]) {
    let pose = isometry(&field.world_from_field);
    let [length_m, width_m] = field.size_m;
    let tall_m = length_m.max(width_m);
    let wide_m = length_m.min(width_m) + field::beside_m(field);
    let lies_along = length_m >= width_m;
    let place = |z: f64| {
        let (x, y) = if lies_along {
            (tall_m, wide_m)
        } else {
            (wide_m, tall_m)
        };
        pose * Point3::new(0.5 * x, 0.5 * y, z)
    };
    // The viewer's camera sees as much height as it is away; texts stand above and below.
    let away_m = (field::WITH_TEXTS * tall_m).max(1.1 * wide_m / NARROW);
    let camera = Camera {
        position_m: place(away_m).coords.into(),
        target_m: place(0.0).coords.into(),
    };
    let up = if lies_along {
        Vector3::x()
    } else {
        Vector3::y()
    };
    (camera, (pose * up).into())
}

fn workpiece(scene: &Scene) -> Option<&Body> {
    scene.bodies.iter().find(|body| body.path == "workpiece")
}

fn place_of(body: &Body) -> Vector3<f64> {
    Vector3::from(body.initial_pose.translation_m)
}

/// Points of a body, world, that reach as far as it does.
fn points_of(body: &Body) -> Vec<Vector3<f64>> {
    let shapes = body.shapes.iter();
    shapes
        .flat_map(|shape| points_of_shape(body, shape))
        .collect()
}

fn points_of_shape(body: &Body, shape: &Shape) -> Vec<Vector3<f64>> {
    let world_from_shape = isometry(&body.initial_pose) * isometry(&shape.body_from_shape);
    let points = corners(&shape.geometry).into_iter();
    let place = |point: [f64; 3]| (world_from_shape * Point3::from(point)).coords;
    points.map(place).collect()
}

/// Of a link with what it carries the shape that is nearest to the middle of some points: the tool.
fn nearest_shape(link: &Body, to: &[Vector3<f64>]) -> Vec<Vector3<f64>> {
    let middle = to.iter().sum::<Vector3<f64>>() / to.len().max(1) as f64;
    let shapes = link.shapes.iter().map(|shape| {
        let points = points_of_shape(link, shape);
        let nearest = points.iter().map(|point| (point - middle).norm());
        (nearest.fold(f64::INFINITY, f64::min), points)
    });
    let nearest = shapes.min_by(|a, b| a.0.total_cmp(&b.0));
    nearest.map(|(_, points)| points).unwrap_or_default()
}

/// The corners of a shape, or of a box about it.
fn corners(geometry: &Geometry) -> Vec<[f64; 3]> {
    let [x, y, z] = match geometry {
        Geometry::Box { half_extents_m } => *half_extents_m,
        Geometry::Cylinder { radius_m, length_m } => [*radius_m, *radius_m, 0.5 * length_m],
        Geometry::Capsule { radius_m, length_m } => {
            [*radius_m, *radius_m, radius_m + 0.5 * length_m]
        }
        Geometry::Sphere { radius_m } => [*radius_m; 3],
        Geometry::Mesh {
            vertices_m: points_m,
            ..
        }
        | Geometry::Line { points_m, .. } => return points_m.clone(),
    };
    let signs = (0..8).map(|k| [k & 1, k & 2, k & 4].map(|bit| if bit == 0 { -1.0 } else { 1.0 }));
    signs.map(|[a, b, c]| [a * x, b * y, c * z]).collect()
}

/// The direction within the floor, of length 1; `None` if it is straight up.
fn horizontal(v: &Vector3<f64>) -> Option<Vector3<f64>> {
    Vector3::new(v.x, v.y, 0.0).try_normalize(1e-6)
}

/// A quarter turn to the left of a direction within the floor.
fn across(v: &Vector3<f64>) -> Vector3<f64> {
    Vector3::z().cross(v)
}

#[cfg(test)]
mod tests {
    use super::*;
    use truecut_recording::Pose;

    /// A face that looks along x, its length along y: seen from in front, from where its width
    /// fits.
    #[test]
    fn a_field_is_seen_from_where_its_normal_points() {
        // From (x, y, z) to (y, z, x).
        let world_from_field = Pose {
            translation_m: [1.0, 2.0, 3.0],
            rotation_xyzw: [0.5, 0.5, 0.5, 0.5],
        };
        let field = Field {
            path: "depth".into(),
            world_from_field,
            size_m: [0.2, 0.1],
            cells: [2, 2],
            full_scale: 1.0,
            unit: truecut_recording::Unit::Metre,
            vertices_m: Vec::new(),
        };
        let (camera, up) = above(&field);
        let near = |a: [f64; 3], b: [f64; 3]| (Vector3::from(a) - Vector3::from(b)).norm() < 1e-12;
        // The bar of colours and its numbers count to its width.
        let width_m = 0.1 + field::beside_m(&field);
        let across = 3.0 + 0.5 * width_m;
        assert!(near(camera.target_m, [1.0, 2.1, across]), "{camera:?}");
        let away_m = 1.1 * width_m / NARROW;
        assert!(
            near(camera.position_m, [1.0 + away_m, 2.1, across]),
            "{camera:?}"
        );
        assert!(near(up, [0.0, 1.0, 0.0]), "{up:?}");
    }

    fn body(path: &str, at: [f64; 3], radius_m: f64) -> Body {
        let geometry = Geometry::Sphere { radius_m };
        let shape = Shape {
            geometry,
            color_rgba: [255; 4],
            body_from_shape: Pose::IDENTITY,
        };
        Body {
            path: path.into(),
            shapes: vec![shape],
            initial_pose: Pose::translation(at),
        }
    }

    #[test]
    fn both_cameras_face_what_they_are_for() {
        let scene = Scene {
            bodies: vec![
                body("arm/true/base", [0.0; 3], 0.3),
                body("arm/true/link_6", [1.3, -1.2, 0.5], 0.1),
                body("workpiece", [1.35, -0.9, 0.5], 0.2),
            ],
            ..Scene::default()
        };
        let whole = whole(&scene, 0.7);
        assert!(whole.position_m[2] > whole.target_m[2], "from above");
        let distance = (Vector3::from(whole.position_m) - Vector3::from(whole.target_m)).norm();
        assert!((1.0..5.0).contains(&distance), "{whole:?}");

        let near = near_tool(&scene, 0.7).unwrap();
        // The middle of tool and workpiece.
        assert!((-1.2..-0.9).contains(&near.target_m[1]), "{near:?}");
        assert!(
            near.position_m[1] < -0.9,
            "on the arm's side of the workpiece: {near:?}"
        );
        assert!(near_tool(&Scene::default(), 0.7).is_none());
    }

    /// A spindle straight above its workpiece, or off by what rounding leaves, has a view, too:
    /// from the base's side, not along the arm.
    #[test]
    fn an_upright_tool_is_seen_from_near_by() {
        for off in [0.0, 1e-5, -1e-5] {
            let scene = Scene {
                bodies: vec![
                    body("arm/true/base", [0.0; 3], 0.3),
                    body("arm/true/link_6", [1.0, -0.2 + off, 0.55], 0.1),
                    body("workpiece", [1.0, -0.2, 0.3], 0.2),
                ],
                ..Scene::default()
            };
            let near = near_tool(&scene, 0.7).expect("a view");
            let from = Vector3::from(near.position_m) - Vector3::from(near.target_m);
            assert!(from.norm() > 0.4 && from.z > 0.0, "{near:?}");
            assert!(from.dot(&Vector3::new(-1.0, 0.2, 0.0)) > 0.2, "{near:?}");
        }
    }

    /// Whatever stands about, and however narrow the view: everything is within it, and something
    /// near its end.
    #[test]
    fn a_camera_shows_everything_and_no_more() {
        for (aspect, reach) in [(0.47, 0.4), (0.7, 2.5), (2.0, 1.0), (0.47, 1.7)] {
            let bodies = [
                [0.0; 3],
                [0.3 * reach, -0.2, 1.4],
                [reach, -0.5 * reach, 0.5],
            ];
            let bodies = bodies.map(|at| body("arm/true/link", at, 0.1));
            let scene = Scene {
                bodies: bodies.to_vec(),
                ..Scene::default()
            };
            let camera = whole(&scene, aspect);
            let [eye, target] = [camera.position_m, camera.target_m].map(Vector3::from);
            let into = (target - eye).normalize();
            let right = into.cross(&Vector3::z()).normalize();
            let up = right.cross(&into);
            let points = scene.bodies.iter().flat_map(points_of);
            let most = points.fold(0.0_f64, |most, point| {
                let from = point - eye;
                let half = 0.5 * from.dot(&into);
                let sides = [from.dot(&right) / (half * aspect), from.dot(&up) / half];
                most.max(sides[0].abs()).max(sides[1].abs())
            });
            assert!((most - SEEN).abs() < 1e-9, "{aspect}, {reach}: {most}");
        }
    }
}
