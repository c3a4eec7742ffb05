//! Bodies that a scene shows.

use super::{Workpiece, pose};
use nalgebra::{Isometry3, UnitQuaternion, Vector3};
use std::f64::consts::FRAC_PI_2;
use truecut_arm::{FrameId, Link, Robot, Shape as ArmShape};
use truecut_recording::{Body, Geometry, Pose, Shape};

/// Colour of the true arm, behind the enlarged one.
const GHOST_RGBA: [u8; 4] = [150, 155, 160, 90];
/// Colour of a brush or a contact wheel.
const DRUM_RGBA: [u8; 4] = [205, 150, 60, 255];
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

/// Four bars around the hole, and the rim.
fn plate_with_hole(radius_m: f64) -> Vec<Shape> {
    let half = WORKPIECE_M / 2.0;
    let bar = (half - radius_m) / 2.0;
    let steel = [120, 128, 138, 255];
    let along_x = THICKNESS_M / 2.0;
    let mut shapes: Vec<Shape> = [-1.0, 1.0]
        .iter()
        .flat_map(|side: &f64| {
            let offset = side * (radius_m + bar);
            [
                ([along_x, bar, half], [along_x, offset, 0.0]),
                ([along_x, radius_m, bar], [along_x, 0.0, offset]),
            ]
        })
        .map(|(half_extents_m, at)| Shape {
            geometry: Geometry::Box { half_extents_m },
            color_rgba: steel,
            body_from_shape: Pose::translation(at),
        })
        .collect();
    let points_m = (0..=96)
        .map(|i| {
            let (s, c) = (std::f64::consts::TAU * f64::from(i) / 96.0).sin_cos();
            [-1e-3, radius_m * c, radius_m * s]
        })
        .collect();
    shapes.push(Shape {
        geometry: Geometry::Line {
            points_m,
            radius_m: 2e-3,
        },
        color_rgba: [255, 200, 60, 255],
        body_from_shape: Pose::IDENTITY,
    });
    shapes
}

pub(super) fn workpiece_shapes(workpiece: &Workpiece) -> Vec<Shape> {
    match workpiece {
        Workpiece::None => Vec::new(),
        Workpiece::Slab {
            feed,
            length_m,
            width_m,
            depth_m,
        } => vec![slab(*feed, *length_m, *width_m, *depth_m)],
        Workpiece::Block {
            process_from_face,
            length_m,
            width_m,
        } => vec![block(process_from_face, *length_m, *width_m)],
        Workpiece::Outline {
            process_from_patch,
            points_m,
        } => vec![Shape {
            geometry: Geometry::Line {
                points_m: points_m.clone(),
                radius_m: OUTLINE_M,
            },
            color_rgba: [120, 128, 138, 255],
            body_from_shape: pose(process_from_patch),
        }],
        Workpiece::Mesh {
            process_from_mesh,
            mesh,
        } => vec![Shape {
            geometry: Geometry::Mesh {
                vertices_m: mesh.vertices_m().iter().map(|p| (*p).into()).collect(),
                triangles: (mesh.triangles().iter())
                    .map(|corners| corners.map(|i| i as u32))
                    .collect(),
            },
            color_rgba: [120, 128, 138, 255],
            body_from_shape: pose(process_from_mesh),
        }],
        Workpiece::Hole(radius_m) => plate_with_hole(*radius_m),
        Workpiece::Strip(length_m) => vec![Shape {
            geometry: Geometry::Box {
                half_extents_m: [THICKNESS_M / 2.0, length_m / 2.0 + 0.03, 0.08],
            },
            color_rgba: [120, 128, 138, 255],
            body_from_shape: Pose::translation([THICKNESS_M / 2.0, length_m / 2.0, 0.0]),
        }],
    }
}

/// The stock under a straight path that begins at the origin: its upper face is the depth of cut above the tip.
fn slab(feed: Vector3<f64>, length_m: f64, width_m: f64, depth_m: f64) -> Shape {
    let turn = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), feed.z.atan2(feed.y));
    let centre = feed * (0.5 * length_m) + Vector3::x() * (0.5 * THICKNESS_M - depth_m);
    Shape {
        geometry: Geometry::Box {
            half_extents_m: [0.5 * THICKNESS_M, 0.5 * length_m + width_m, width_m],
        },
        color_rgba: [120, 128, 138, 255],
        body_from_shape: pose(&Isometry3::from_parts(centre.into(), turn)),
    }
}

/// The block under a face.
fn block(process_from_face: &Isometry3<f64>, length_m: f64, width_m: f64) -> Shape {
    let centre = Isometry3::translation(0.5 * length_m, 0.5 * width_m, -0.5 * BLOCK_M);
    Shape {
        geometry: Geometry::Box {
            half_extents_m: [0.5 * length_m, 0.5 * width_m, 0.5 * BLOCK_M],
        },
        color_rgba: [120, 128, 138, 255],
        body_from_shape: pose(&(process_from_face * centre)),
    }
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
    let ring = (0..=64)
        .map(|i| {
            let (s, c) = (std::f64::consts::TAU * f64::from(i) / 64.0).sin_cos();
            [-6e-3, 0.055 * c, 0.055 * s]
        })
        .collect();
    Shape {
        geometry: Geometry::Line {
            points_m: ring,
            radius_m: 6e-3,
        },
        color_rgba: [70, 160, 230, 255],
        body_from_shape: Pose::IDENTITY,
    }
}
