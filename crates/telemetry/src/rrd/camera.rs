//! Where to look from, when the scene does not say.

use nalgebra::{Point3, Vector3};
use truecut_recording::{Body, Camera, Field, Geometry, Scene};

use super::field::BAR;
use super::shapes::isometry;

/// From the side and somewhat above, far enough away to see everything.
pub(super) fn whole(scene: &Scene) -> Camera {
    let Some((low, high)) = bounds(scene) else {
        return Camera {
            position_m: [3.0, -3.0, 2.0],
            target_m: [0.0; 3],
        };
    };
    let target = 0.5 * (low + high);
    // The arm reaches from its base to the workpiece: it is seen best across that direction.
    let base = scene.bodies.first().map_or(Vector3::zeros(), place_of);
    let reach = workpiece(scene).map_or(Vector3::x(), |body| place_of(body) - base);
    let ahead = horizontal(&reach).unwrap_or(Vector3::x());
    let direction: Vector3<f64> = 0.45 * ahead + 0.85 * across(&ahead) + 0.35 * Vector3::z();
    let away_m = 1.2 * (high - low).norm();
    Camera {
        position_m: (target + away_m * direction.normalize()).into(),
        target_m: target.into(),
    }
}

/// The workpiece from near by, from the arm's side. `None` if there is none, or no arm.
pub(super) fn near_tool(scene: &Scene) -> Option<Camera> {
    let workpiece = workpiece(scene)?;
    let target = place_of(workpiece);
    let last_link = scene
        .bodies
        .iter()
        .rfind(|body| body.path.starts_with("arm/"))?;
    let base = place_of(scene.bodies.first()?);
    // A tool that stands upright over the workpiece leans nowhere: from the arm's base, then.
    let lean = place_of(last_link) - target;
    let leans = horizontal(&lean).filter(|_| lean.xy().norm() > UPRIGHT * lean.norm());
    let from_workpiece = leans.or_else(|| horizontal(&(base - target)))?;
    let side = across(&from_workpiece);
    // On the side away from the base, where the arm does not stand in the way.
    let away = if side.dot(&(target - base)) >= 0.0 {
        1.0
    } else {
        -1.0
    };
    let direction: Vector3<f64> = 0.5 * from_workpiece + 0.8 * away * side + 0.4 * Vector3::z();
    Some(Camera {
        position_m: (target + away_m(workpiece) * direction.normalize()).into(),
        target_m: target.into(),
    })
}

/// From how far a workpiece is seen: a small one, and the tool that it is for, from nearer by.
fn away_m(workpiece: &Body) -> f64 {
    let shapes = workpiece.shapes.iter();
    let reaches = shapes.map(|shape| {
        Vector3::from(shape.body_from_shape.translation_m).norm() + reach(&shape.geometry)
    });
    (3.0 * reaches.fold(0.0, f64::max)).clamp(NEAREST_M, FARTHEST_M)
}

const NEAREST_M: f64 = 0.15;
const FARTHEST_M: f64 = 0.75;
/// Less than this part of a tool's way aside is upright.
const UPRIGHT: f64 = 0.1;
/// Parts of its height that a view from above is wide: it stands beside two others.
const NARROW: f64 = 0.43;

/// Straight onto a field, its longer side up, from where it fills a narrow view; with that
/// direction up.
pub(super) fn above(field: &Field) -> (Camera, [f64; 3]) {
    let pose = isometry(&field.world_from_field);
    // With its bar of colours.
    let [mut length_m, mut width_m] = field.size_m;
    let bar_m = 2.0 * BAR * length_m.max(width_m);
    let side = if length_m >= width_m {
        width_m += bar_m;
        Vector3::x()
    } else {
        length_m += bar_m;
        Vector3::y()
    };
    let place = |z: f64| pose * Point3::new(0.5 * length_m, 0.5 * width_m, z);
    // The viewer's camera sees as much height as it is away.
    let away_m = 1.2 * (length_m.max(width_m)).max(length_m.min(width_m) / NARROW);
    let camera = Camera {
        position_m: place(away_m).coords.into(),
        target_m: place(0.0).coords.into(),
    };
    (camera, (pose * side).into())
}

fn workpiece(scene: &Scene) -> Option<&Body> {
    scene.bodies.iter().find(|body| body.path == "workpiece")
}

fn place_of(body: &Body) -> Vector3<f64> {
    Vector3::from(body.initial_pose.translation_m)
}

/// Low and high corner of a box that holds the first look, roughly.
fn bounds(scene: &Scene) -> Option<(Vector3<f64>, Vector3<f64>)> {
    let shapes = scene
        .bodies
        .iter()
        .flat_map(|body| body.shapes.iter().map(|shape| (&body.initial_pose, shape)));
    let balls = shapes.map(|(pose, shape)| {
        let center = isometry(pose) * Point3::from(shape.body_from_shape.translation_m);
        let radius = Vector3::repeat(reach(&shape.geometry));
        (center.coords - radius, center.coords + radius)
    });
    balls.reduce(|a, b| (a.0.inf(&b.0), a.1.sup(&b.1)))
}

/// Radius of a ball around the shape's own origin that holds it.
fn reach(geometry: &Geometry) -> f64 {
    match geometry {
        Geometry::Box { half_extents_m } => Vector3::from(*half_extents_m).norm(),
        Geometry::Cylinder { radius_m, length_m } => radius_m.hypot(0.5 * length_m),
        Geometry::Capsule { radius_m, length_m } => radius_m + 0.5 * length_m,
        Geometry::Sphere { radius_m } => *radius_m,
        Geometry::Mesh {
            vertices_m: points_m,
            ..
        }
        | Geometry::Line { points_m, .. } => points_m
            .iter()
            .map(|point| Vector3::from(*point).norm())
            .fold(0.0, f64::max),
    }
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
    use truecut_recording::{Pose, Shape};

    /// A face that looks along x, its length along y: seen from in front, from where its width
    /// fits.
    #[test]
    fn a_field_is_seen_from_where_its_normal_points() {
        // From (x, y, z) to (y, z, x).
        let world_from_field = Pose {
            translation_m: [1.0, 2.0, 3.0],
            rotation_xyzw: [0.5, 0.5, 0.5, 0.5],
        };
        let (camera, up) = above(&Field {
            path: "depth".into(),
            world_from_field,
            size_m: [0.2, 0.1],
            cells: [2, 2],
            full_scale: 1.0,
            unit: truecut_recording::Unit::Metre,
            vertices_m: Vec::new(),
        });
        let near = |a: [f64; 3], b: [f64; 3]| (Vector3::from(a) - Vector3::from(b)).norm() < 1e-12;
        // The bar of colours counts to its width.
        let width_m = 0.1 + 2.0 * BAR * 0.2;
        let across = 3.0 + 0.5 * width_m;
        assert!(near(camera.target_m, [1.0, 2.1, across]), "{camera:?}");
        let away_m = 1.2 * width_m / NARROW;
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
        let whole = whole(&scene);
        assert!(whole.position_m[2] > whole.target_m[2], "from above");
        let distance = (Vector3::from(whole.position_m) - Vector3::from(whole.target_m)).norm();
        assert!((1.0..5.0).contains(&distance), "{whole:?}");

        let near = near_tool(&scene).unwrap();
        assert_eq!(near.target_m, [1.35, -0.9, 0.5]);
        assert!(
            near.position_m[1] < -0.9,
            "on the arm's side of the workpiece: {near:?}"
        );
        assert!(near_tool(&Scene::default()).is_none());
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
            let near = near_tool(&scene).expect("a view");
            let from = Vector3::from(near.position_m) - Vector3::from(near.target_m);
            assert!(
                (from.norm() - 3.0 * 0.2).abs() < 1e-9 && from.z > 0.0,
                "{near:?}"
            );
            assert!(from.dot(&Vector3::new(-1.0, 0.2, 0.0)) > 0.2, "{near:?}");
        }
    }
}
