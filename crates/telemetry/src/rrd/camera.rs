//! Where to look from, when the scene does not say.

use truecut_recording::{Body, Camera, Field, Geometry, Pose, Scene};

/// From the side and somewhat above, far enough away to see everything.
pub(super) fn whole(scene: &Scene) -> Camera {
    let Some((low, high)) = bounds(scene) else {
        return Camera {
            position_m: [3.0, -3.0, 2.0],
            target_m: [0.0; 3],
        };
    };
    let target_m: [f64; 3] = std::array::from_fn(|axis| 0.5 * (low[axis] + high[axis]));
    let size_m = norm(minus(high, low));
    // The arm reaches from its base to the workpiece: it is seen best across that direction.
    let base = scene
        .bodies
        .first()
        .map_or([0.0; 3], |body| body.initial_pose.translation_m);
    let reach = workpiece(scene).map_or([1.0, 0.0, 0.0], |body| {
        minus(body.initial_pose.translation_m, base)
    });
    let ahead = horizontal(reach).unwrap_or([1.0, 0.0, 0.0]);
    let aside = [-ahead[1], ahead[0], 0.0];
    let direction = [0, 1, 2].map(|i| 0.45 * ahead[i] + 0.85 * aside[i] + [0.0, 0.0, 0.35][i]);
    Camera {
        position_m: along(target_m, direction, 1.2 * size_m),
        target_m,
    }
}

/// The workpiece from near by, from the arm's side. `None` if there is none, or no arm.
pub(super) fn near_tool(scene: &Scene) -> Option<Camera> {
    let target_m = workpiece(scene)?.initial_pose.translation_m;
    let last_link = scene
        .bodies
        .iter()
        .rfind(|body| body.path.starts_with("arm/"))?;
    let base = scene.bodies.first()?.initial_pose.translation_m;
    let from_workpiece = horizontal(minus(last_link.initial_pose.translation_m, target_m))?;
    let side = [-from_workpiece[1], from_workpiece[0], 0.0];
    // On the side away from the base, where the arm does not stand in the way.
    let away = if dot(side, minus(target_m, base)) >= 0.0 {
        1.0
    } else {
        -1.0
    };
    let direction =
        [0, 1, 2].map(|i| 0.5 * from_workpiece[i] + 0.8 * away * side[i] + [0.0, 0.0, 0.4][i]);
    Some(Camera {
        position_m: along(target_m, direction, 0.75),
        target_m,
    })
}

/// Parts of its height that a view from above is wide: it stands beside two others.
const NARROW: f64 = 0.43;

/// Straight onto a field, its longer side up, from where it fills a narrow view; with that
/// direction up.
pub(super) fn above(field: &Field) -> (Camera, [f64; 3]) {
    let pose = &field.world_from_field;
    let [length_m, width_m] = field.size_m;
    let middle = [0.5 * length_m, 0.5 * width_m, 0.0];
    let side = if length_m >= width_m {
        [1.0, 0.0, 0.0]
    } else {
        [0.0, 1.0, 0.0]
    };
    let up = minus(place(pose, side), pose.translation_m);
    // The viewer's camera sees as much height as it is away.
    let away_m = 1.2 * (length_m.max(width_m)).max(length_m.min(width_m) / NARROW);
    let camera = Camera {
        position_m: place(pose, [middle[0], middle[1], away_m]),
        target_m: place(pose, middle),
    };
    (camera, up)
}

fn workpiece(scene: &Scene) -> Option<&Body> {
    scene.bodies.iter().find(|body| body.path == "workpiece")
}

/// Low and high corner of a box that holds the first look, roughly.
fn bounds(scene: &Scene) -> Option<([f64; 3], [f64; 3])> {
    let shapes = scene
        .bodies
        .iter()
        .flat_map(|body| body.shapes.iter().map(|shape| (&body.initial_pose, shape)));
    let balls = shapes.map(|(pose, shape)| {
        (
            place(pose, shape.body_from_shape.translation_m),
            reach(&shape.geometry),
        )
    });
    balls
        .map(|(center, radius)| {
            (
                center.map(|value| value - radius),
                center.map(|value| value + radius),
            )
        })
        .reduce(|a, b| {
            (
                std::array::from_fn(|i| a.0[i].min(b.0[i])),
                std::array::from_fn(|i| a.1[i].max(b.1[i])),
            )
        })
}

/// Radius of a ball around the shape's own origin that holds it.
fn reach(geometry: &Geometry) -> f64 {
    match geometry {
        Geometry::Box { half_extents_m } => norm(*half_extents_m),
        Geometry::Cylinder { radius_m, length_m } => radius_m.hypot(0.5 * length_m),
        Geometry::Capsule { radius_m, length_m } => radius_m + 0.5 * length_m,
        Geometry::Sphere { radius_m } => *radius_m,
        Geometry::Mesh {
            vertices_m: points_m,
            ..
        }
        | Geometry::Line { points_m, .. } => points_m
            .iter()
            .map(|point| norm(*point))
            .fold(0.0, f64::max),
    }
}

/// A point of a body, in the world.
fn place(pose: &Pose, point: [f64; 3]) -> [f64; 3] {
    let [x, y, z, w] = pose.rotation_xyzw;
    let axis = [x, y, z];
    let twice = cross(axis, point).map(|value| 2.0 * value);
    let turned = cross(axis, twice);
    std::array::from_fn(|i| pose.translation_m[i] + point[i] + w * twice[i] + turned[i])
}

fn along(from: [f64; 3], direction: [f64; 3], distance_m: f64) -> [f64; 3] {
    let length = norm(direction);
    std::array::from_fn(|i| from[i] + distance_m / length * direction[i])
}

/// The direction within the floor, of length 1; `None` if it is straight up.
fn horizontal(v: [f64; 3]) -> Option<[f64; 3]> {
    let length = v[0].hypot(v[1]);
    (length > 1e-6).then(|| [v[0] / length, v[1] / length, 0.0])
}

fn minus(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|i| a[i] - b[i])
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

fn norm(v: [f64; 3]) -> f64 {
    dot(v, v).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use truecut_recording::Shape;

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
            vertices_m: Vec::new(),
        });
        let near = |a: [f64; 3], b: [f64; 3]| norm(minus(a, b)) < 1e-12;
        assert!(near(camera.target_m, [1.0, 2.1, 3.05]), "{camera:?}");
        let away_m = 1.2 * 0.1 / NARROW;
        assert!(
            near(camera.position_m, [1.0 + away_m, 2.1, 3.05]),
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
        let distance = norm(minus(whole.position_m, whole.target_m));
        assert!((1.0..5.0).contains(&distance), "{whole:?}");

        let near = near_tool(&scene).unwrap();
        assert_eq!(near.target_m, [1.35, -0.9, 0.5]);
        assert!(
            near.position_m[1] < -0.9,
            "on the arm's side of the workpiece: {near:?}"
        );
        assert!(near_tool(&Scene::default()).is_none());
    }

    #[test]
    fn verify_a_quarter_turn() {
        let half = 0.5_f64.sqrt();
        let pose = Pose {
            translation_m: [0.0, 0.0, 1.0],
            rotation_xyzw: [0.0, 0.0, half, half],
        };
        let placed = place(&pose, [1.0, 0.0, 0.0]);
        assert!(norm(minus(placed, [0.0, 1.0, 1.0])) < 1e-12, "{placed:?}");
    }
}
