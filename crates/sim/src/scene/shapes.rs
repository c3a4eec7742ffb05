//! Bodies that a scene shows.

use super::pose;
use nalgebra::{Isometry3, UnitQuaternion, Vector3};
use std::f64::consts::TAU;
use truecut_arm::{DrawnLink, Robot, Shape as ArmShape};
use truecut_core::cutting::milling::layered::solid::Solid;
use truecut_plan::surface::Mesh;
use truecut_recording::{Body, Geometry, Pose, Shape};

/// Colour of the true arm, behind the enlarged one.
const GHOST_RGBA: [u8; 4] = [150, 155, 160, 90];
/// Colour of a workpiece.
const STEEL_RGBA: [u8; 4] = [120, 128, 138, 255];
/// Colour of what is cut, as that of a rim.
const CUT_RGBA: [u8; 4] = [255, 200, 60, 255];
/// Side of the workpiece, m.
const WORKPIECE_M: f64 = 0.4;
/// Thickness of the workpiece, m.
pub(crate) const THICKNESS_M: f64 = 0.03;
/// Thickness of the block under a polished face, m.
const BLOCK_M: f64 = 0.02;
/// Half of the thickness of a line around a face, m.
const OUTLINE_M: f64 = 0.5e-3;

/// Base and links of an arm, and notes on what could not be drawn of them.
pub(crate) fn arm_bodies(robot: &Robot, q: &[f64], kind: &str) -> (Vec<Body>, Vec<String>) {
    let mut poses = vec![Isometry3::identity()];
    poses.extend(robot.world_from_links(q));
    let (drawn, notes) = robot.drawn_links();
    let moving = robot.chain.moving().map(|body| body.link);
    let links = std::iter::once(&robot.chain.base).chain(moving);
    let bodies = links
        .zip(drawn)
        .zip(&poses)
        .map(|((link, drawn), at)| Body {
            path: format!("arm/{kind}/{}", link.name),
            shapes: link_shapes(drawn),
            initial_pose: pose(at),
        });
    (bodies.collect(), notes)
}

fn link_shapes(drawn: DrawnLink) -> Vec<Shape> {
    let rgba = |color: [f32; 4]| color.map(|c| (c * 255.0).round() as u8);
    let visuals = drawn.visuals.into_iter().map(|visual| Shape {
        geometry: match visual.shape {
            ArmShape::Box { half_extents_m } => Geometry::Box {
                half_extents_m: half_extents_m.into(),
            },
            ArmShape::Cylinder { radius_m, length_m } => Geometry::Cylinder { radius_m, length_m },
            ArmShape::Capsule { radius_m, length_m } => Geometry::Capsule { radius_m, length_m },
            ArmShape::Sphere { radius_m } => Geometry::Sphere { radius_m },
        },
        color_rgba: rgba(visual.color_rgba),
        body_from_shape: pose(&visual.link_from_visual),
    });
    let meshes = drawn.meshes.into_iter().map(|mesh| Shape {
        geometry: Geometry::Mesh {
            vertices_m: mesh.vertices_m.iter().map(|p| (*p).into()).collect(),
            triangles: mesh.triangles,
        },
        color_rgba: rgba(mesh.color_rgba),
        body_from_shape: Pose::IDENTITY,
    });
    visuals.chain(meshes).collect()
}

/// The shadow of bodies: the same shapes, grey and translucent, under another name.
pub(super) fn ghosts(bodies: &[Body], from: &str, to: &str) -> Vec<Body> {
    let ghost = |body: &Body| Body {
        path: body.path.replacen(from, to, 1),
        shapes: (body.shapes.iter())
            .map(|shape| Shape {
                color_rgba: GHOST_RGBA,
                ..shape.clone()
            })
            .collect(),
        initial_pose: body.initial_pose,
    };
    bodies.iter().map(ghost).collect()
}

/// A part of a workpiece.
pub(crate) fn steel(geometry: Geometry, body_from_shape: Pose) -> Shape {
    Shape {
        geometry,
        color_rgba: STEEL_RGBA,
        body_from_shape,
    }
}

/// A line around process X, drawn `line_m` thick to either side.
pub(super) fn ring(at_x_m: f64, ring_m: f64, line_m: f64, corners: u32) -> Geometry {
    let corner = |i: u32| {
        let (s, c) = (TAU * f64::from(i) / f64::from(corners)).sin_cos();
        [at_x_m, ring_m * c, ring_m * s]
    };
    Geometry::Line {
        points_m: (0..=corners).map(corner).collect(),
        radius_m: line_m,
    }
}

/// A plate with a hole of this radius: four bars around it, and its rim. The rim that is cut is at
/// the tool point: the near one, or `backward` the far one.
pub(crate) fn plate_with_hole(radius_m: f64, backward: bool) -> Vec<Shape> {
    let (middle, rim_m) = match backward {
        true => (-THICKNESS_M / 2.0, 1e-3),
        false => (THICKNESS_M / 2.0, -1e-3),
    };
    let half = WORKPIECE_M / 2.0;
    let bar = (half - radius_m) / 2.0;
    let along_x = THICKNESS_M / 2.0;
    let bars = [-1.0, 1.0].iter().flat_map(|side: &f64| {
        let offset = side * (radius_m + bar);
        [
            ([along_x, bar, half], [middle, offset, 0.0]),
            ([along_x, radius_m, bar], [middle, 0.0, offset]),
        ]
    });
    let bars = bars
        .map(|(half_extents_m, at)| steel(Geometry::Box { half_extents_m }, Pose::translation(at)));
    let rim = Shape {
        geometry: ring(rim_m, radius_m, 2e-3, 96),
        color_rgba: CUT_RGBA,
        body_from_shape: Pose::IDENTITY,
    };
    bars.chain([rim]).collect()
}

/// A strip of this length along process Y.
pub(crate) fn strip(length_m: f64) -> Vec<Shape> {
    let half_extents_m = [THICKNESS_M / 2.0, length_m / 2.0 + 0.03, 0.08];
    let at = Pose::translation([THICKNESS_M / 2.0, length_m / 2.0, 0.0]);
    vec![steel(Geometry::Box { half_extents_m }, at)]
}

/// A line around a face, in the frame of its patch.
pub(crate) fn outline(process_from_patch: &Isometry3<f64>, points_m: &[[f64; 3]]) -> Vec<Shape> {
    let line = Geometry::Line {
        points_m: points_m.to_vec(),
        radius_m: OUTLINE_M,
    };
    vec![steel(line, pose(process_from_patch))]
}

/// A body as it is.
pub(crate) fn body(process_from_mesh: &Isometry3<f64>, mesh: &Mesh) -> Vec<Shape> {
    let triangles = mesh.triangles().iter();
    let geometry = Geometry::Mesh {
        vertices_m: mesh.vertices_m().iter().map(|p| (*p).into()).collect(),
        triangles: triangles.map(|corners| corners.map(|i| i as u32)).collect(),
    };
    vec![steel(geometry, pose(process_from_mesh))]
}

/// A block of stock.
pub(crate) fn stock(process_from_block: &Isometry3<f64>, half_m: &Vector3<f64>) -> Shape {
    Shape {
        geometry: Geometry::Box {
            half_extents_m: (*half_m).into(),
        },
        color_rgba: STEEL_RGBA,
        body_from_shape: pose(process_from_block),
    }
}

/// Stock from a mesh.
pub(crate) fn solid(process_from_solid: &Isometry3<f64>, solid: &Solid) -> Shape {
    let triangles = solid.triangles_m();
    let geometry = Geometry::Mesh {
        vertices_m: triangles.iter().flatten().map(|p| (*p).into()).collect(),
        triangles: (0..triangles.len() as u32)
            .map(|k| [3 * k, 3 * k + 1, 3 * k + 2])
            .collect(),
    };
    steel(geometry, pose(process_from_solid))
}

/// What a straight pass leaves of its stock, in the milling frame: x along the feed from the
/// path's start, z up from the teeth's lowest point.
pub(crate) struct Milled {
    pub length_m: f64,
    pub cutter_radius_m: f64,
    /// From where to where across the feed the teeth cut.
    pub across_m: [f64; 2],
    pub depth_m: f64,
}

impl Milled {
    /// The floor that is cut, coloured, in the stock with the walls that remain: where the teeth
    /// reach across by their full radius they leave a wall.
    pub(crate) fn shapes(&self, process_from_milling: &Isometry3<f64>) -> Vec<Shape> {
        let (radius, depth) = (self.cutter_radius_m, self.depth_m);
        let beyond = 4.0 * radius;
        let ends = [-beyond, self.length_m + beyond];
        let ahead = [self.length_m + radius, self.length_m + beyond];
        let [right, left] = self.across_m;
        let mut boxes = vec![
            (STEEL_RGBA, [ends, [-beyond, beyond], [-THICKNESS_M, 0.0]]),
            (STEEL_RGBA, [ahead, [right, left], [0.0, depth]]),
            (
                CUT_RGBA,
                [[-beyond, ahead[0]], [right, left], [0.0, 0.05 * depth]],
            ),
        ];
        let is_wall = |at_m: f64| at_m.abs() >= radius * (1.0 - 1e-6);
        if is_wall(left) {
            boxes.push((STEEL_RGBA, [ends, [left, beyond], [0.0, depth]]));
        }
        if is_wall(right) {
            boxes.push((STEEL_RGBA, [ends, [-beyond, right], [0.0, depth]]));
        }
        let shape = |(color_rgba, sides): ([u8; 4], [[f64; 2]; 3])| {
            let centre = sides.map(|[from, to]| 0.5 * (from + to));
            Shape {
                geometry: Geometry::Box {
                    half_extents_m: sides.map(|[from, to]| 0.5 * (to - from)),
                },
                color_rgba,
                body_from_shape: pose(
                    &(process_from_milling
                        * Isometry3::from_parts(
                            Vector3::from(centre).into(),
                            UnitQuaternion::identity(),
                        )),
                ),
            }
        };
        boxes.into_iter().map(shape).collect()
    }
}

/// The block under a rectangular face, whose frame has the origin in a corner and z along the
/// normal.
pub(crate) fn block(process_from_face: &Isometry3<f64>, length_m: f64, width_m: f64) -> Vec<Shape> {
    let centre = Isometry3::translation(0.5 * length_m, 0.5 * width_m, -0.5 * BLOCK_M);
    let half_extents_m = [0.5 * length_m, 0.5 * width_m, 0.5 * BLOCK_M];
    let at = pose(&(process_from_face * centre));
    vec![steel(Geometry::Box { half_extents_m }, at)]
}
