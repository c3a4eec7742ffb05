//! Bodies that a scene shows.

use super::pose;
use nalgebra::{Isometry3, UnitQuaternion, Vector3};
use std::f64::consts::{FRAC_PI_2, TAU};
use truecut_arm::{FrameId, Link, Robot, Shape as ArmShape};
use truecut_plan::surface::Mesh;
use truecut_recording::{Body, Geometry, Pose, Shape};

/// Colour of the true arm, behind the enlarged one.
const GHOST_RGBA: [u8; 4] = [150, 155, 160, 90];
/// Colour of a brush or a contact wheel.
const DRUM_RGBA: [u8; 4] = [205, 150, 60, 255];
/// Colour of a workpiece.
const STEEL_RGBA: [u8; 4] = [120, 128, 138, 255];
/// Side of the workpiece, m.
const WORKPIECE_M: f64 = 0.4;
/// Thickness of the workpiece, m.
const THICKNESS_M: f64 = 0.03;
/// Thickness of the block under a polished face, m.
const BLOCK_M: f64 = 0.02;
/// Half of the thickness of a line around a face, m.
const OUTLINE_M: f64 = 0.5e-3;

fn link_shapes(link: &Link, ghost: bool) -> Vec<Shape> {
    link.visuals
        .iter()
        .map(|visual| Shape {
            geometry: match visual.shape {
                ArmShape::Box { half_extents_m } => Geometry::Box {
                    half_extents_m: half_extents_m.into(),
                },
                ArmShape::Cylinder { radius_m, length_m } => {
                    Geometry::Cylinder { radius_m, length_m }
                }
                ArmShape::Capsule { radius_m, length_m } => {
                    Geometry::Capsule { radius_m, length_m }
                }
                ArmShape::Sphere { radius_m } => Geometry::Sphere { radius_m },
            },
            color_rgba: if ghost {
                GHOST_RGBA
            } else {
                visual.color_rgba.map(|c| (c * 255.0).round() as u8)
            },
            body_from_shape: pose(&visual.link_from_visual),
        })
        .collect()
}

pub(crate) fn arm_bodies(robot: &Robot, q: &[f64], kind: &str, ghost: bool) -> Vec<Body> {
    let mut poses = vec![Isometry3::identity()];
    poses.extend(robot.world_from_links(q));
    let links = std::iter::once(&robot.chain.base).chain(&robot.chain.links);
    links
        .zip(&poses)
        .map(|(link, at)| Body {
            path: format!("arm/{kind}/{}", link.name),
            shapes: link_shapes(link, ghost),
            initial_pose: pose(at),
        })
        .collect()
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
fn ring(at_x_m: f64, ring_m: f64, line_m: f64, corners: u32) -> Geometry {
    let corner = |i: u32| {
        let (s, c) = (TAU * f64::from(i) / f64::from(corners)).sin_cos();
        [at_x_m, ring_m * c, ring_m * s]
    };
    Geometry::Line {
        points_m: (0..=corners).map(corner).collect(),
        radius_m: line_m,
    }
}

/// A plate with a hole of this radius: four bars around it, and its rim.
pub(crate) fn plate_with_hole(radius_m: f64) -> Vec<Shape> {
    let half = WORKPIECE_M / 2.0;
    let bar = (half - radius_m) / 2.0;
    let along_x = THICKNESS_M / 2.0;
    let bars = [-1.0, 1.0].iter().flat_map(|side: &f64| {
        let offset = side * (radius_m + bar);
        [
            ([along_x, bar, half], [along_x, offset, 0.0]),
            ([along_x, radius_m, bar], [along_x, 0.0, offset]),
        ]
    });
    let bars = bars
        .map(|(half_extents_m, at)| steel(Geometry::Box { half_extents_m }, Pose::translation(at)));
    let rim = Shape {
        geometry: ring(-1e-3, radius_m, 2e-3, 96),
        color_rgba: [255, 200, 60, 255],
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

/// The stock under a straight path of this length along `feed` (process axes) that begins at the
/// origin: its upper face is the depth of cut above the tip.
pub(crate) fn slab(feed: Vector3<f64>, length_m: f64, width_m: f64, depth_m: f64) -> Vec<Shape> {
    let turn = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), feed.z.atan2(feed.y));
    let centre = feed * (0.5 * length_m) + Vector3::x() * (0.5 * THICKNESS_M - depth_m);
    let half_extents_m = [0.5 * THICKNESS_M, 0.5 * length_m + width_m, width_m];
    let at = pose(&Isometry3::from_parts(centre.into(), turn));
    vec![steel(Geometry::Box { half_extents_m }, at)]
}

/// The block under a rectangular face, whose frame has the origin in a corner and z along the
/// normal.
pub(crate) fn block(process_from_face: &Isometry3<f64>, length_m: f64, width_m: f64) -> Vec<Shape> {
    let centre = Isometry3::translation(0.5 * length_m, 0.5 * width_m, -0.5 * BLOCK_M);
    let half_extents_m = [0.5 * length_m, 0.5 * width_m, 0.5 * BLOCK_M];
    let at = pose(&(process_from_face * centre));
    vec![steel(Geometry::Box { half_extents_m }, at)]
}

/// The drum on the last link of the arm as it is and of the enlarged one.
pub(super) fn add_drum(
    bodies: &mut [Body],
    robot: &Robot,
    q: &[f64],
    [radius_m, width_m]: [f64; 2],
) {
    let Some(world_from_last) = robot.world_from_links(q).last().copied() else {
        return;
    };
    let last_from_tool = world_from_last.inverse() * robot.world_from_frame(q, FrameId::Tool);
    // A cylinder stands along its z axis.
    let about_y = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), FRAC_PI_2);
    let drum = |color_rgba| Shape {
        geometry: Geometry::Cylinder {
            radius_m,
            length_m: width_m,
        },
        color_rgba,
        body_from_shape: pose(&(last_from_tool * about_y)),
    };
    let count = bodies.len() / 2;
    bodies[count - 1].shapes.push(drum(DRUM_RGBA));
    bodies[2 * count - 1].shapes.push(drum(GHOST_RGBA));
}

pub(super) fn foot_shape() -> Shape {
    Shape {
        geometry: ring(-6e-3, 0.055, 6e-3, 64),
        color_rgba: [70, 160, 230, 255],
        body_from_shape: Pose::IDENTITY,
    }
}
