//! What can be seen of a cell: the arm as it is and with its deflection enlarged, workpiece, foot, forces.

use crate::loads::Attachment;
use crate::plant::Plant;
use crate::process::Process;
use nalgebra::{Isometry3, UnitQuaternion, Vector3};
use std::f64::consts::FRAC_PI_2;
use std::sync::Arc;
use truecut_arm::{FrameId, Link, Robot, Shape as ArmShape};
use truecut_plan::surface::Mesh;
use truecut_recording::{Arrow, Body, Frame, Geometry, Pose, Scene, Shape};

/// Colour of the true arm, behind the enlarged one.
const GHOST_RGBA: [u8; 4] = [150, 155, 160, 90];
/// Colour of a brush or a contact wheel.
const DRUM_RGBA: [u8; 4] = [205, 150, 60, 255];
/// Length of a force arrow, m/N.
const ARROW_M_PER_N: f64 = 1.5e-3;
/// Side of the workpiece, m.
const WORKPIECE_M: f64 = 0.4;
/// Thickness of the workpiece, m.
const THICKNESS_M: f64 = 0.03;
/// Thickness of the block under a polished face, m.
const BLOCK_M: f64 = 0.02;
/// Half of the thickness of a line around a face, m.
const OUTLINE_M: f64 = 0.5e-3;

/// What the workpiece looks like.
#[derive(Debug, Clone)]
pub(crate) enum Workpiece {
    /// A plate with a hole of this radius, m.
    Hole(f64),
    /// A strip of this length along process Y, m.
    Strip(f64),
    /// A slab under a milling path of this length along `feed` (process axes), and its depth of cut, m.
    Slab {
        feed: Vector3<f64>,
        length_m: f64,
        width_m: f64,
        depth_m: f64,
    },
    /// A block under a rectangular face, whose frame has the origin in a corner and z along the normal.
    Block {
        process_from_face: Isometry3<f64>,
        length_m: f64,
        width_m: f64,
    },
    /// A line around a face, in the frame of its patch.
    Outline {
        process_from_patch: Isometry3<f64>,
        points_m: Vec<[f64; 3]>,
    },
    /// A body as it is.
    Mesh {
        process_from_mesh: Isometry3<f64>,
        mesh: Arc<Mesh>,
    },
    /// Nothing.
    None,
}

/// What the scene is made from, when one is asked for.
pub(crate) struct Setting {
    pub robot: Arc<Robot>,
    pub start: Vec<f64>,
    pub world_from_process: Isometry3<f64>,
    pub workpiece: Workpiece,
    pub deflection_scale: f64,
}

impl Setting {
    /// The scene, and the means to fill its frames.
    pub(crate) fn stage(&self, process: &dyn Process) -> (Stage, Scene) {
        Stage::new(
            &self.robot,
            &self.start,
            self.world_from_process,
            self.deflection_scale,
            &self.workpiece,
            process,
        )
    }
}

/// Builds frames of the scene.
pub(crate) struct Stage {
    robot: Robot,
    reference: Vec<f64>,
    scale: f64,
    world_from_process: Isometry3<f64>,
    fixed: Vec<Pose>,
    has_foot: bool,
    /// How many fields there are.
    fields: usize,
}

pub(crate) fn pose(p: &Isometry3<f64>) -> Pose {
    let q = p.rotation;
    Pose {
        translation_m: p.translation.vector.into(),
        rotation_xyzw: [q.i, q.j, q.k, q.w],
    }
}

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

fn workpiece_shapes(workpiece: &Workpiece) -> Vec<Shape> {
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
fn add_drum(bodies: &mut [Body], robot: &Robot, q: &[f64], [radius_m, width_m]: [f64; 2]) {
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

fn foot_shape() -> Shape {
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

impl Stage {
    /// The scene of a cell and the means to fill its frames.
    pub(crate) fn new(
        robot: &Robot,
        reference: &[f64],
        world_from_process: Isometry3<f64>,
        scale: f64,
        workpiece: &Workpiece,
        process: &dyn Process,
    ) -> (Self, Scene) {
        let has_foot = process
            .contact_stiffness()
            .iter()
            .any(|spring| spring.frame == Attachment::Foot);
        let mut bodies = arm_bodies(robot, reference, "exaggerated", false);
        bodies.extend(arm_bodies(robot, reference, "true", true));
        if let Some(size_m) = process.drum_m() {
            add_drum(&mut bodies, robot, reference, size_m);
        }
        let origin = pose(&world_from_process);
        let mut fixed = Vec::new();
        let shapes = workpiece_shapes(workpiece);
        if !shapes.is_empty() {
            fixed.push(origin);
            bodies.push(Body {
                path: "workpiece".into(),
                shapes,
                initial_pose: origin,
            });
        }
        if has_foot {
            bodies.push(Body {
                path: "foot".into(),
                shapes: vec![foot_shape()],
                initial_pose: origin,
            });
        }
        let colors = [[235, 70, 60, 255], [70, 160, 230, 255], [250, 170, 40, 255]];
        let arrows = process
            .arrows()
            .iter()
            .zip(colors)
            .map(|((name, ..), color_rgba)| Arrow {
                path: format!("force/{}", name.replace(' ', "_")),
                label: (*name).to_string(),
                color_rgba,
                metres_per_newton: ARROW_M_PER_N,
            })
            .collect();
        let scene = Scene {
            bodies,
            arrows,
            fields: process.field().into_iter().collect(),
            deflection_scale: scale,
            // The viewer's own frames the whole arm.
            camera: None,
        };
        let stage = Self {
            robot: robot.clone(),
            reference: reference.to_vec(),
            scale,
            world_from_process,
            fixed,
            has_foot,
            fields: scene.fields.len(),
        };
        (stage, scene)
    }

    /// The scene at the plant's present instant. `rigid` is where the arm would stand without deflection
    /// (the command, shifted to the posture of touch-down). Values of fields are many: they are left out where not asked for.
    pub(crate) fn frame(
        &self,
        time_s: f64,
        plant: &dyn Plant,
        process: &dyn Process,
        commanded_shift: &[f64],
        with_fields: bool,
    ) -> Frame {
        let joints = plant.joints();
        let rigid = self.reference.iter().zip(commanded_shift);
        let enlarged: Vec<f64> = rigid
            .zip(&joints.position)
            .map(|((reference, shift), q)| {
                let still = reference + shift;
                still + self.scale * (q - still)
            })
            .collect();
        let mut poses = vec![Pose::IDENTITY];
        poses.extend(self.robot.world_from_links(&enlarged).iter().map(pose));
        poses.push(Pose::IDENTITY);
        poses.extend(plant.link_poses().iter().map(pose));
        poses.extend(&self.fixed);
        let at =
            |q: &[f64], attachment: Attachment| self.robot.world_from_frame(q, attachment.into());
        if self.has_foot {
            let foot = at(&enlarged, Attachment::Foot);
            poses.push(pose(&Isometry3::from_parts(
                foot.translation,
                self.world_from_process.rotation,
            )));
        }
        let turn: UnitQuaternion<f64> = self.world_from_process.rotation;
        let arrows = process
            .arrows()
            .iter()
            .map(|(_, attachment, force)| {
                let origin = at(&enlarged, *attachment).translation.vector;
                (origin.into(), (turn * force).into())
            })
            .collect();
        let fields = (0..self.fields).map(|_| match with_fields {
            true => process.field_values(),
            false => Vec::new(),
        });
        Frame {
            time_s,
            poses,
            arrows,
            fields: fields.collect(),
        }
    }
}
