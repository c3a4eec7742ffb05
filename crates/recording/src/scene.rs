//! What can be seen of a run, in no viewer's terms: bodies made of simple shapes, and force arrows.

use serde::{Deserialize, Serialize};

use crate::unit::Unit;

/// Position and orientation of one frame in another.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Pose {
    /// Origin, in metres.
    pub translation_m: [f64; 3],
    /// Unit quaternion, scalar last.
    pub rotation_xyzw: [f64; 4],
}

impl Pose {
    /// No displacement, no rotation.
    pub const IDENTITY: Pose = Pose {
        translation_m: [0.0; 3],
        rotation_xyzw: [0.0, 0.0, 0.0, 1.0],
    };

    /// A displacement without rotation.
    pub fn translation(translation_m: [f64; 3]) -> Pose {
        Pose {
            translation_m,
            ..Pose::IDENTITY
        }
    }

    /// A point of the frame, m, where it is in the other: v + 2 w (q × v) + 2 q × (q × v), and the
    /// frame's origin.
    #[must_use]
    pub fn place(&self, point_m: &[f64; 3]) -> [f64; 3] {
        let [i, j, k, w] = self.rotation_xyzw;
        let cross = |a: [f64; 3], b: [f64; 3]| {
            [
                a[1] * b[2] - a[2] * b[1],
                a[2] * b[0] - a[0] * b[2],
                a[0] * b[1] - a[1] * b[0],
            ]
        };
        let (q, v) = ([i, j, k], *point_m);
        let once = cross(q, v);
        let twice = cross(q, once);
        std::array::from_fn(|n| self.translation_m[n] + v[n] + 2.0 * (w * once[n] + twice[n]))
    }
}

impl Default for Pose {
    fn default() -> Pose {
        Pose::IDENTITY
    }
}

/// The form of one shape, centred on its own frame.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Geometry {
    /// Edges along the axes.
    Box {
        /// Half of each edge.
        half_extents_m: [f64; 3],
    },
    /// Along z, from −length/2 to +length/2.
    Cylinder {
        /// Radius.
        radius_m: f64,
        /// Whole length.
        length_m: f64,
    },
    /// A cylinder along z with a half ball on each end.
    Capsule {
        /// Radius.
        radius_m: f64,
        /// Length without the half balls.
        length_m: f64,
    },
    /// A ball.
    Sphere {
        /// Radius.
        radius_m: f64,
    },
    /// Triangles.
    Mesh {
        /// Corners.
        vertices_m: Vec<[f64; 3]>,
        /// Three corners each, counter-clockwise seen from outside.
        triangles: Vec<[u32; 3]>,
    },
    /// An open or closed line, drawn with a given thickness.
    Line {
        /// Points in order.
        points_m: Vec<[f64; 3]>,
        /// Half of the thickness.
        radius_m: f64,
    },
}

/// A form with its colour and its place on a body.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Shape {
    /// The form.
    pub geometry: Geometry,
    /// Red, green, blue, opacity.
    pub color_rgba: [u8; 4],
    /// Where the shape sits on its body.
    pub body_from_shape: Pose,
}

/// Something that moves as a whole.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Body {
    /// Its name in the scene: `arm/true/link_2`, `arm/exaggerated/link_2`, `workpiece`, `foot`.
    pub path: String,
    /// What it looks like.
    pub shapes: Vec<Shape>,
    /// Where it is at the start, in the world.
    pub initial_pose: Pose,
}

/// A force that is drawn as an arrow.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Arrow {
    /// Its name in the scene: `force/cutting`.
    pub path: String,
    /// Written beside it.
    pub label: String,
    /// Red, green, blue, opacity.
    pub color_rgba: [u8; 4],
    /// Length of the arrow for a force of 1 N, in metres.
    pub metres_per_newton: f64,
}

fn one() -> Unit {
    Unit::One
}

/// A rectangle of cells on which a quantity is drawn in colours: plane, or bent to a face.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Field {
    /// Its name in the scene: `removed_depth`.
    pub path: String,
    /// Its frame in the world: origin in a corner, x along the columns, z towards the eye.
    pub world_from_field: Pose,
    /// Size along x and y, in metres.
    pub size_m: [f64; 2],
    /// Cells along x and y.
    pub cells: [usize; 2],
    /// Value at which the colours end, SI.
    pub full_scale: f64,
    /// Unit of the values.
    #[serde(default = "one")]
    pub unit: Unit,
    /// Middles of the cells in its frame, x first, where they do not lie in the rectangle; empty
    /// where they do.
    #[serde(default)]
    pub vertices_m: Vec<[f64; 3]>,
}

impl Field {
    /// Middles of the cells in the world, m, x first.
    #[must_use]
    pub fn places_m(&self) -> Vec<[f64; 3]> {
        let at = &self.world_from_field;
        if !self.vertices_m.is_empty() {
            return self.vertices_m.iter().map(|p| at.place(p)).collect();
        }
        let [columns, rows] = self.cells;
        let side = [0, 1].map(|k| self.size_m[k] / self.cells[k] as f64);
        let middle = |k: usize| {
            let (x, y) = ((k % columns) as f64 + 0.5, (k / columns) as f64 + 0.5);
            at.place(&[x * side[0], y * side[1], 0.0])
        };
        (0..columns * rows).map(middle).collect()
    }

    /// The last part of its name in the scene.
    #[must_use]
    pub fn name(&self) -> &str {
        let last = self.path.rsplit('/').next();
        last.unwrap_or(&self.path)
    }
}

/// Where a person should look from, and at what.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Camera {
    /// The eye, in the world.
    pub position_m: [f64; 3],
    /// What it looks at, in the world.
    pub target_m: [f64; 3],
}

/// Everything that can be seen. World axes, z up.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Scene {
    /// What moves, in the order of [`Frame::poses`].
    pub bodies: Vec<Body>,
    /// Forces, in the order of [`Frame::arrows`].
    pub arrows: Vec<Arrow>,
    /// Quantities on surfaces, in the order of [`Frame::fields`].
    #[serde(default)]
    pub fields: Vec<Field>,
    /// By how much the deflection of the bodies under `arm/exaggerated` is enlarged; stated in the
    /// view.
    pub deflection_scale: f64,
    /// The first look; `None` lets the viewer choose.
    pub camera: Option<Camera>,
}

impl Default for Scene {
    fn default() -> Scene {
        Scene {
            bodies: Vec::new(),
            arrows: Vec::new(),
            fields: Vec::new(),
            deflection_scale: 1.0,
            camera: None,
        }
    }
}

/// The scene at one time.
#[derive(Clone, Debug, PartialEq)]
pub struct Frame {
    /// Simulated time.
    pub time_s: f64,
    /// Pose in the world of each of [`Scene::bodies`].
    pub poses: Vec<Pose>,
    /// Point of attack (m) and force (N), in the world, of each of [`Scene::arrows`].
    pub arrows: Vec<([f64; 3], [f64; 3])>,
    /// Values of each of [`Scene::fields`], x first; empty while a field keeps its last ones.
    pub fields: Vec<Vec<f32>>,
}
