//! What can be seen of a cell: the arm as it is and with its deflection enlarged, workpiece, foot,
//! forces.

pub(crate) mod shapes;
pub(crate) mod tooling;
mod view;

pub(crate) use shapes::arm_bodies;
pub use tooling::{Held, Tooling};
pub use view::{Surroundings, arm_view, mesh_body};

use crate::loads::Attachment;
use crate::plant::Plant;
use crate::process::{Process, ReadPart};
use nalgebra::{Isometry3, Quaternion, UnitQuaternion};
use std::sync::Arc;
use truecut_arm::Robot;
use truecut_plan::clearance::Tool;
use truecut_recording::{Arrow, Body, Frame, Pose, Scene, Shape};

/// Length of a force arrow, m/N.
const ARROW_M_PER_N: f64 = 1.5e-3;

/// Draws the workpiece in process axes, when a scene is asked for.
pub(crate) type DrawWorkpiece = Box<dyn Fn() -> Vec<Shape> + Send + Sync>;

/// What the scene is made from, when one is asked for.
pub(crate) struct Setting {
    pub robot: Arc<Robot>,
    pub start: Vec<f64>,
    pub world_from_process: Isometry3<f64>,
    pub workpiece: DrawWorkpiece,
    pub tooling: Tooling,
    /// The part that the process works on, for clearances.
    pub part: ReadPart,
    pub deflection_scale: f64,
}

impl Setting {
    /// The process's tool at its size, in the frame of the flange.
    pub fn tools(&self) -> Vec<Tool> {
        let Some(world_from_last) = self.robot.world_from_links(&self.start).last().copied() else {
            return Vec::new();
        };
        let at = [&world_from_last, &self.world_from_process];
        let shapes = tooling::tools_on_last_link(&self.robot, at[0], at[1], &self.tooling);
        let flange = self.robot.frames.last_link_from_flange;
        let tool = |shape: Shape| {
            Some(Tool {
                name: self.tooling.name.to_owned(),
                solid: view::solid(&shape.geometry)?,
                flange_from_solid: flange.inverse() * isometry(&shape.body_from_shape),
            })
        };
        shapes.into_iter().filter_map(tool).collect()
    }
}

/// Builds frames of the scene.
pub(crate) struct Stage {
    setting: Arc<Setting>,
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

fn isometry(pose: &Pose) -> Isometry3<f64> {
    let rotation = UnitQuaternion::from_quaternion(Quaternion::from(pose.rotation_xyzw));
    Isometry3::from_parts(pose.translation_m.into(), rotation)
}

/// The scene of a cell, and notes on what could not be drawn.
pub(crate) fn scene(setting: &Setting, process: &dyn Process) -> (Scene, Vec<String>) {
    let (robot, start) = (&setting.robot, &setting.start);
    let (mut bodies, notes) = arm_bodies(robot, start, "exaggerated");
    if let Some(last) = bodies.last_mut() {
        let held =
            tooling::on_last_link(robot, start, &setting.world_from_process, &setting.tooling);
        last.shapes.extend(held);
    }
    bodies.extend(shapes::ghosts(&bodies, "exaggerated", "true"));
    let origin = pose(&setting.world_from_process);
    let mut stand = |path: &str, shapes: Vec<Shape>| {
        if !shapes.is_empty() {
            bodies.push(Body {
                path: path.into(),
                shapes,
                initial_pose: origin,
            });
        }
    };
    stand("workpiece", (setting.workpiece)());
    stand("foot", at_foot(&setting.tooling));
    let colors = [[235, 70, 60, 255], [70, 160, 230, 255], [250, 170, 40, 255]];
    let arrows = process.arrows();
    let arrows = arrows
        .iter()
        .zip(colors)
        .map(|((name, ..), color_rgba)| Arrow {
            path: format!("force/{}", name.replace(' ', "_")),
            label: (*name).to_string(),
            color_rgba,
            metres_per_newton: ARROW_M_PER_N,
        });
    let scene = Scene {
        arrows: arrows.collect(),
        fields: process.field().into_iter().collect(),
        deflection_scale: setting.deflection_scale,
        // The viewer's own frames the whole arm.
        camera: None,
        bodies,
    };
    (scene, notes)
}

fn at_foot(tooling: &Tooling) -> Vec<Shape> {
    let shapes = tooling.shapes.iter();
    let shapes = shapes.filter(|(held, _)| *held == Held::Foot);
    shapes.map(|(_, shape)| shape.clone()).collect()
}

impl Stage {
    /// The means to fill the frames of a cell's [`scene`].
    pub(crate) fn new(setting: Arc<Setting>, process: &dyn Process) -> Self {
        let has_workpiece = !(setting.workpiece)().is_empty();
        let origin = pose(&setting.world_from_process);
        Self {
            fixed: has_workpiece.then_some(origin).into_iter().collect(),
            has_foot: !at_foot(&setting.tooling).is_empty(),
            fields: process.field().into_iter().count(),
            setting,
        }
    }

    /// The scene at the plant's present instant. `rigid` is where the arm would stand without
    /// deflection (the command, shifted to the posture of touch-down). Values of fields are many:
    /// they are left out where not asked for.
    pub(crate) fn frame(
        &self,
        time_s: f64,
        plant: &dyn Plant,
        process: &dyn Process,
        commanded_shift: &[f64],
        with_fields: bool,
    ) -> Frame {
        let (joints, setting) = (plant.joints(), &self.setting);
        let rigid = setting.start.iter().zip(commanded_shift);
        let enlarged: Vec<f64> = rigid
            .zip(&joints.position)
            .map(|((reference, shift), q)| {
                let still = reference + shift;
                still + setting.deflection_scale * (q - still)
            })
            .collect();
        let mut poses = vec![Pose::IDENTITY];
        poses.extend(setting.robot.world_from_links(&enlarged).iter().map(pose));
        poses.push(Pose::IDENTITY);
        poses.extend(plant.link_poses().iter().map(pose));
        poses.extend(&self.fixed);
        let at = |q: &[f64], attachment: Attachment| {
            setting.robot.world_from_frame(q, attachment.into())
        };
        if self.has_foot {
            let foot = at(&enlarged, Attachment::Foot);
            poses.push(pose(&Isometry3::from_parts(
                foot.translation,
                setting.world_from_process.rotation,
            )));
        }
        let turn: UnitQuaternion<f64> = setting.world_from_process.rotation;
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
