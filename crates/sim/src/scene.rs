//! What can be seen of a cell: the arm as it is and with its deflection enlarged, workpiece, foot,
//! forces.

pub(crate) mod shapes;

pub(crate) use shapes::arm_bodies;
use shapes::{add_drum, foot_shape};

use crate::loads::Attachment;
use crate::plant::Plant;
use crate::process::Process;
use nalgebra::{Isometry3, UnitQuaternion};
use std::sync::Arc;
use truecut_arm::Robot;
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
    pub deflection_scale: f64,
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

impl Stage {
    /// The scene of a cell and the means to fill its frames.
    pub(crate) fn new(setting: Arc<Setting>, process: &dyn Process) -> (Self, Scene) {
        let (robot, start) = (&setting.robot, &setting.start);
        let has_foot = process
            .contact_stiffness()
            .iter()
            .any(|spring| spring.frame == Attachment::Foot);
        let mut bodies = arm_bodies(robot, start, "exaggerated", false);
        bodies.extend(arm_bodies(robot, start, "true", true));
        if let Some(size_m) = process.drum_m() {
            add_drum(&mut bodies, robot, start, size_m);
        }
        let origin = pose(&setting.world_from_process);
        let mut fixed = Vec::new();
        let shapes = (setting.workpiece)();
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
            deflection_scale: setting.deflection_scale,
            // The viewer's own frames the whole arm.
            camera: None,
        };
        let stage = Self {
            setting,
            fixed,
            has_foot,
            fields: scene.fields.len(),
        };
        (stage, scene)
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
