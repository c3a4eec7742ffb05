//! What can be seen of a run, in no viewer's terms: bodies made of simple shapes, and force arrows.

use serde::{Deserialize, Serialize};

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

impl Geometry {
    /// The body that an outline sweeps as it turns about z: a tube, a cone, a plate with a hole.
    /// The outline is a closed polygon of (radius, z) in metres, counter-clockwise with the radius
    /// to the right and z up; it is turned in so many steps, at least three.
    pub fn revolved(outline_m: &[(f64, f64)], segments: u32) -> Geometry {
        let segments = segments.max(3);
        let corners = outline_m.len() as u32;
        let angle = |segment: u32| std::f64::consts::TAU * f64::from(segment) / f64::from(segments);
        let vertices_m = (0..segments)
            .flat_map(|segment| {
                let (sin, cos) = angle(segment).sin_cos();
                outline_m
                    .iter()
                    .map(move |(radius, z)| [radius * cos, radius * sin, *z])
            })
            .collect();
        let mut triangles = Vec::new();
        for segment in 0..segments {
            let (here, there) = (segment * corners, (segment + 1) % segments * corners);
            for corner in 0..corners {
                let next = (corner + 1) % corners;
                triangles.push([here + corner, there + corner, there + next]);
                triangles.push([here + corner, there + next, here + next]);
            }
        }
        Geometry::Mesh {
            vertices_m,
            triangles,
        }
    }
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
    /// Middles of the cells in its frame, x first, where they do not lie in the rectangle; empty
    /// where they do.
    #[serde(default)]
    pub vertices_m: Vec<[f64; 3]>,
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

#[cfg(test)]
mod tests {
    use super::*;

    /// Volume by the divergence theorem: right, and positive, only if every triangle faces outward.
    #[test]
    fn verify_volume_of_a_tube() {
        let (inner, outer, length) = (0.021, 0.06, 0.02);
        let outline = [(inner, 0.0), (outer, 0.0), (outer, length), (inner, length)];
        let segments = 96;
        let Geometry::Mesh {
            vertices_m,
            triangles,
        } = Geometry::revolved(&outline, segments)
        else {
            panic!("a body of revolution is a mesh");
        };
        let corner = |index: u32| vertices_m[index as usize];
        let volume: f64 = triangles
            .iter()
            .map(|triangle| {
                let [a, b, c] = triangle.map(corner);
                let cross = [
                    b[1] * c[2] - b[2] * c[1],
                    b[2] * c[0] - b[0] * c[2],
                    b[0] * c[1] - b[1] * c[0],
                ];
                (a[0] * cross[0] + a[1] * cross[1] + a[2] * cross[2]) / 6.0
            })
            .sum();
        // A polygon of n sides in a circle of radius r has the area ½ n r² sin(2π/n).
        let n = f64::from(segments);
        let polygon = 0.5 * n * (std::f64::consts::TAU / n).sin();
        let expected = polygon * (outer * outer - inner * inner) * length;
        assert!(
            (volume / expected - 1.0).abs() < 1e-12,
            "{volume} against {expected}"
        );
    }
}
