//! The robot as a MuJoCo model (MJCF), for cross-checks.
//!
//! Bodies, inertias, joints and transmissions are written exactly: every number in the shortest
//! decimal form that reads back to the same `f64`. Springs and dampers are MuJoCo's joint
//! `stiffness` with `springref` = command, and `damping`; dry friction is `frictionloss`. There are
//! no contacts and no joint limits. Sites `flange`, `tool` and `foot` are on the last body.

use std::fmt::Write as _;

use nalgebra::{Isometry3, Vector3};

use crate::error::{ArmError, ArmErrorKind};
use crate::model::{FrameId, Joint, JointKind, Link, Robot, Shape, Visual};

/// How the joints are driven in the export.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum MjcfDrive {
    /// The motor follows the command exactly; the link hangs on the transmission.
    #[default]
    Position,
    /// Free joints: no stiffness, damping or friction.
    Free,
}

/// What an MJCF needs beside the robot.
#[derive(Debug, Clone, PartialEq)]
pub struct MjcfOptions {
    /// Initial joint coordinates (rad or m): the keyframe `start`.
    pub posture: Vec<f64>,
    /// Motor positions on the joint side (rad or m): the `springref` of each joint.
    pub command: Vec<f64>,
    /// World axes.
    pub gravity_m_s2: Vector3<f64>,
    pub drive: MjcfDrive,
    pub time_step_s: f64,
}

impl Robot {
    /// As [`to_mjcf`].
    ///
    /// # Errors
    /// As [`to_mjcf`].
    pub fn to_mjcf(&self, options: &MjcfOptions) -> Result<String, ArmError> {
        to_mjcf(self, options)
    }
}

/// The MJCF text of a robot; apply [`Robot::scaled`] first if the scenario scales it.
///
/// # Errors
/// If posture or command do not fit the chain, the time step is not positive, or a joint has no
/// stiffness and the drive needs one.
pub fn to_mjcf(robot: &Robot, options: &MjcfOptions) -> Result<String, ArmError> {
    robot.refuse_followers("a model for MuJoCo has joints that move by themselves")?;
    robot.check_length(&options.posture)?;
    robot.check_length(&options.command)?;
    if !(options.time_step_s > 0.0 && options.time_step_s.is_finite()) {
        return Err(ArmErrorKind::Argument {
            quantity: "time step (s)",
            value: options.time_step_s,
            rule: "a finite number above zero",
        }
        .into());
    }
    let springs = match options.drive {
        MjcfDrive::Position => Some(robot.transmission_stiffness("the position drive")?),
        MjcfDrive::Free => None,
    };
    let mut writer = MjcfWriter {
        text: String::new(),
        depth: 0,
    };
    writer.header(&robot.chain.name, options);
    writer.open("worldbody");
    writer.visuals(&robot.chain.base);
    for (i, (joint, link)) in robot
        .chain
        .joints
        .iter()
        .zip(&robot.chain.links)
        .enumerate()
    {
        let spring = springs.as_ref().map(|k| (k[(i, i)], options.command[i]));
        writer.body(joint, link, spring);
    }
    for (name, frame) in [
        ("flange", FrameId::Flange),
        ("tool", FrameId::Tool),
        ("foot", FrameId::Foot),
    ] {
        let pose = placement(&robot.last_link_from_frame(frame));
        writer.line(&format!("site name=\"{name}\" {pose}"));
    }
    for _ in &robot.chain.links {
        writer.close("body");
    }
    writer.close("worldbody");
    writer.open("keyframe");
    let posture = numbers(&options.posture);
    writer.line(&format!("key name=\"start\" qpos=\"{posture}\""));
    writer.close("keyframe");
    writer.close("mujoco");
    Ok(writer.text)
}

struct MjcfWriter {
    text: String,
    depth: usize,
}

impl MjcfWriter {
    fn raw(&mut self, content: &str) {
        // Writing to a String cannot fail.
        let _ = writeln!(self.text, "{:width$}{content}", "", width = 2 * self.depth);
    }

    fn line(&mut self, element: &str) {
        self.raw(&format!("<{element}/>"));
    }

    fn open(&mut self, element: &str) {
        self.raw(&format!("<{element}>"));
        self.depth += 1;
    }

    fn close(&mut self, element: &str) {
        self.depth -= 1;
        self.raw(&format!("</{element}>"));
    }

    fn header(&mut self, name: &str, options: &MjcfOptions) {
        let name = escape(name);
        self.open(&format!("mujoco model=\"{name}\""));
        self.line(
            "compiler angle=\"radian\" inertiafromgeom=\"false\" autolimits=\"false\" \
             balanceinertia=\"false\" boundmass=\"0\" boundinertia=\"0\"",
        );
        let gravity = vector(&options.gravity_m_s2);
        let step = options.time_step_s;
        self.open(&format!(
            "option timestep=\"{step:?}\" gravity=\"{gravity}\" integrator=\"RK4\""
        ));
        self.line("flag contact=\"disable\"");
        self.close("option");
    }

    /// Opens a body; `spring` is stiffness and reference coordinate.
    fn body(&mut self, joint: &Joint, link: &Link, spring: Option<(f64, f64)>) {
        let pose = placement(&joint.parent_from_joint);
        self.open(&format!("body name=\"{}\" {pose}", escape(&link.name)));
        let i = &link.inertia_about_com_kg_m2;
        let inertia = numbers(&[
            i[(0, 0)],
            i[(1, 1)],
            i[(2, 2)],
            i[(0, 1)],
            i[(0, 2)],
            i[(1, 2)],
        ]);
        let com = vector(&link.com_m);
        let mass = link.mass_kg;
        self.line(&format!(
            "inertial pos=\"{com}\" mass=\"{mass:?}\" fullinertia=\"{inertia}\""
        ));
        let kind = match joint.kind {
            JointKind::Revolute => "hinge",
            JointKind::Prismatic => "slide",
        };
        let mut element = format!(
            "joint name=\"{}\" type=\"{kind}\" axis=\"{}\" limited=\"false\"",
            escape(&joint.name),
            vector(&joint.axis)
        );
        if let Some((stiffness, reference)) = spring {
            let transmission = &joint.transmission;
            let _ = write!(
                element,
                " stiffness=\"{stiffness:?}\" springref=\"{reference:?}\" damping=\"{:?}\"",
                transmission.damping
            );
            if transmission.dry_friction > 0.0 {
                let _ = write!(element, " frictionloss=\"{:?}\"", transmission.dry_friction);
            }
        }
        self.line(&element);
        self.visuals(link);
    }

    fn visuals(&mut self, link: &Link) {
        for visual in &link.visuals {
            self.line(&geom(visual));
        }
    }
}

fn geom(visual: &Visual) -> String {
    let shape = match visual.shape {
        Shape::Box { half_extents_m } => {
            format!("type=\"box\" size=\"{}\"", vector(&half_extents_m))
        }
        Shape::Cylinder { radius_m, length_m } => {
            format!(
                "type=\"cylinder\" size=\"{}\"",
                numbers(&[radius_m, 0.5 * length_m])
            )
        }
        Shape::Capsule { radius_m, length_m } => {
            format!(
                "type=\"capsule\" size=\"{}\"",
                numbers(&[radius_m, 0.5 * length_m])
            )
        }
        Shape::Sphere { radius_m } => format!("type=\"sphere\" size=\"{radius_m:?}\""),
    };
    let rgba = visual.color_rgba.map(|v| format!("{v:?}")).join(" ");
    let pose = placement(&visual.link_from_visual);
    format!("geom {shape} {pose} rgba=\"{rgba}\" contype=\"0\" conaffinity=\"0\" mass=\"0\"")
}

fn placement(pose: &Isometry3<f64>) -> String {
    let q = pose.rotation;
    let quaternion = numbers(&[q.w, q.i, q.j, q.k]);
    format!(
        "pos=\"{}\" quat=\"{quaternion}\"",
        vector(&pose.translation.vector)
    )
}

fn vector(v: &Vector3<f64>) -> String {
    numbers(v.as_slice())
}

fn numbers(values: &[f64]) -> String {
    let texts: Vec<_> = values.iter().map(|v| format!("{v:?}")).collect();
    texts.join(" ")
}

fn escape(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
        .replace('"', "&quot;")
}
