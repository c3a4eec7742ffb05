//! The robot as the rest of the program sees it: a serial chain, its transmissions and its frames.

use std::path::PathBuf;

use nalgebra::{Isometry3, Matrix3, Unit, Vector3};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::meshes::LinkMesh;
use crate::moving::Follower;

/// Most joints a chain may have.
pub const MAX_JOINTS: usize = 12;

/// The acceleration of gravity that truecut uses, 9.81 m/s² along −z of the world.
#[must_use]
pub fn standard_gravity_m_s2() -> Vector3<f64> {
    Vector3::new(0.0, 0.0, -9.81)
}

/// What a joint's coordinate is: an angle in rad or a displacement in m.
///
/// A URDF `continuous` joint is [`Revolute`](JointKind::Revolute) with infinite position limits.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum JointKind {
    Revolute,
    Prismatic,
}

impl JointKind {
    /// The unit of the joint's coordinate: `rad` or `m`.
    #[must_use]
    pub fn coordinate_unit(self) -> &'static str {
        match self {
            Self::Revolute => "rad",
            Self::Prismatic => "m",
        }
    }

    /// The unit of the joint's generalised force: `N m` or `N`.
    #[must_use]
    pub fn effort_unit(self) -> &'static str {
        match self {
            Self::Revolute => "N m",
            Self::Prismatic => "N",
        }
    }
}

/// Bounds of a joint, in the unit of its coordinate (rad or m, per second, N m or N).
///
/// A bound that the URDF does not give is infinite.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limits {
    pub lower: f64,
    pub upper: f64,
    pub velocity: f64,
    pub effort: f64,
}

/// Gains of a P–P servo: position loop outside, velocity loop inside, torque limited.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Servo {
    /// Position loop gain in 1/s.
    pub position_gain_per_s: f64,
    /// Velocity loop gain in N m s/rad or N s/m, on the joint side of the gear.
    pub velocity_gain: f64,
    /// Largest torque (N m) or force (N) of the drive, on the joint side of the gear.
    pub torque_limit: f64,
    /// Share of the command's velocity that is added to the position loop's wish; 1 leaves no lag.
    pub velocity_feed_forward: f64,
}

impl Servo {
    /// What the loops resist a lasting torque with, N m/rad or N/m: the product of both gains,
    /// since there is no integral action.
    #[must_use]
    pub fn static_stiffness(&self) -> f64 {
        self.position_gain_per_s * self.velocity_gain
    }
}

/// Where the values of a [`Transmission`] come from; empty where no value was given.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize)]
pub struct TransmissionSources {
    pub stiffness: String,
    pub linear_to: String,
    pub damping: String,
    pub dry_friction: String,
    pub rotor_inertia: String,
    pub servo: String,
    pub pulses: String,
}

/// What lies between the motor and the link of one joint.
///
/// Units are those of the joint: N m/rad or N/m, N m s/rad or N s/m, N m or N, kg m² or kg,
/// all on the joint side of the gear.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Transmission {
    /// `None` if no file gives it; then only rigid questions (kinematics, dynamics) can be
    /// answered.
    pub stiffness: Option<f64>,
    /// Wind-up, rad (m), to which the spring is a straight line; `None` if no file gives it: see
    /// [`Joint::linear_to`].
    pub linear_to: Option<f64>,
    pub damping: f64,
    pub dry_friction: f64,
    pub rotor_inertia: f64,
    pub servo: Option<Servo>,
    /// The servo acts on the link: `stiffness` and `damping` are those of its loops. See
    /// [`Robot::close_rigid_servos`].
    pub rigid_servo: bool,
    /// Encoder pulses per rad (m) of the joint, as the controller's program files count them;
    /// `None` if no file gives it.
    pub pulses_per_unit: Option<f64>,
    pub sources: TransmissionSources,
}

/// A joint of the chain and the transmission that drives it.
#[derive(Debug, Clone, PartialEq)]
pub struct Joint {
    pub name: String,
    pub kind: JointKind,
    /// Joint frame at coordinate zero, in the previous link's frame (the world for the first).
    pub parent_from_joint: Isometry3<f64>,
    /// Axis of rotation or translation, in the joint frame.
    pub axis: Unit<Vector3<f64>>,
    pub limits: Option<Limits>,
    pub transmission: Transmission,
    /// `<dynamics damping>` of the URDF; the transmission's damping unless `robot.toml` gives one.
    pub urdf_damping: f64,
    /// `<dynamics friction>` of the URDF; the transmission's dry friction unless `robot.toml` gives
    /// one.
    pub urdf_friction: f64,
}

/// Wind-up of a rotary joint to which its spring is taken for a straight line, rad, where no file
/// says more. A joint stands 1/450 rad under its rated torque, 2.5 times as much at the soft end of
/// that rule (docs/physics/estimates.md), and five times the rated torque is the most that a
/// cycloidal reducer may take in an emergency (`nabtesco_rv`).
const LINEAR_TO_RAD: f64 = 0.03;

/// The same of a slide, m: a third of a percent of three metres of belt, the softest drive in use.
const LINEAR_TO_M: f64 = 0.01;

impl Joint {
    /// Wind-up, rad (m), to which the spring of the transmission is a straight line.
    pub fn linear_to(&self) -> f64 {
        self.transmission.linear_to.unwrap_or(match self.kind {
            JointKind::Revolute => LINEAR_TO_RAD,
            JointKind::Prismatic => LINEAR_TO_M,
        })
    }
}

/// A primitive shape of a visual, centred in its own frame; cylinder and capsule lie along z.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Shape {
    Box { half_extents_m: Vector3<f64> },
    Cylinder { radius_m: f64, length_m: f64 },
    Capsule { radius_m: f64, length_m: f64 },
    Sphere { radius_m: f64 },
}

/// A primitive shape to draw, fixed to a link.
#[derive(Debug, Clone, PartialEq)]
pub struct Visual {
    pub shape: Shape,
    pub link_from_visual: Isometry3<f64>,
    /// Red, green, blue, opacity, each 0 to 1.
    pub color_rgba: [f32; 4],
}

/// A rigid body of the chain: a URDF link with all that is fixed to it.
#[derive(Debug, Clone, PartialEq)]
pub struct Link {
    pub name: String,
    pub mass_kg: f64,
    /// Centre of mass in the link frame.
    pub com_m: Vector3<f64>,
    /// Inertia tensor about the centre of mass, in link axes.
    pub inertia_about_com_kg_m2: Matrix3<f64>,
    pub visuals: Vec<Visual>,
    /// Files to draw, see [`Robot::drawn_links`].
    pub meshes: Vec<LinkMesh>,
    /// What may touch something else, see [`Robot::solids`].
    pub solids: Solids,
}

/// What of a link takes up room: the shapes and meshes that a URDF has for collision, else those
/// that it has to be seen, each in the link's frame.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Solids {
    pub shapes: Vec<(Shape, Isometry3<f64>)>,
    pub meshes: Vec<LinkMesh>,
}

/// A serial chain. `links[i]` is moved by `joints[i]`, and its frame is that joint's frame.
#[derive(Debug, Clone, PartialEq)]
pub struct Chain {
    pub name: String,
    pub joints: Vec<Joint>,
    pub links: Vec<Link>,
    /// Joints that others take along, in their order; see [`Chain::moving`].
    pub followers: Vec<Follower>,
    /// All that stands still, in the URDF root frame.
    pub base: Link,
    /// Name of the URDF link whose frame is the flange.
    pub tip: String,
    /// What was merged, chosen or left out when the file was read; one sentence each.
    pub notes: Vec<String>,
    /// Those of them that speak against where the arm goes and how fast: lengths, angles, limits
    /// and speeds that look like another unit.
    pub motion_doubts: Vec<String>,
    /// Links of the robot's file whose masses are estimates, by their sources.
    pub estimated_masses: Vec<String>,
    /// Why masses and inertias seem to be placeholders, if they do.
    pub placeholders: Option<String>,
}

/// The frames of a robot, each fixed to the last link.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Frames {
    pub last_link_from_flange: Isometry3<f64>,
    pub flange_from_tool: Isometry3<f64>,
    pub flange_from_foot: Isometry3<f64>,
}

/// A frame of the arm.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum FrameId {
    /// The URDF tip link.
    Flange,
    /// The tool frame of robot.toml, where the process acts.
    Tool,
    /// The foot frame of robot.toml, that of the pressure foot.
    Foot,
}

/// A robot: chain, transmissions and frames. Made by [`Robot::load`].
///
/// World frame is the URDF root frame, z up.
#[derive(Debug, Clone, PartialEq)]
pub struct Robot {
    pub name: String,
    pub chain: Chain,
    pub frames: Frames,
    pub urdf_path: PathBuf,
    /// The `robot.toml` that was read, if any.
    pub config_path: Option<PathBuf>,
    /// Damping ratios of the modes in place of the transmissions' damping: one for all, or one for
    /// each, slowest first. Empty: the transmissions'.
    pub damping_ratios: Vec<f64>,
    /// What a controller is told of the tool's load, if robot.toml says it.
    pub tool_load: Option<ToolLoad>,
}

/// Mass and centre of what is mounted on the flange.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ToolLoad {
    pub mass_kg: f64,
    /// In the flange frame.
    pub centre_m: Vector3<f64>,
}

impl Robot {
    /// Number of joints.
    #[must_use]
    pub fn dof(&self) -> usize {
        self.chain.joints.len()
    }

    /// Last link from `frame`.
    #[must_use]
    pub fn last_link_from_frame(&self, frame: FrameId) -> Isometry3<f64> {
        let flange = self.frames.last_link_from_flange;
        match frame {
            FrameId::Flange => flange,
            FrameId::Tool => flange * self.frames.flange_from_tool,
            FrameId::Foot => flange * self.frames.flange_from_foot,
        }
    }

    /// Turns every joint that has a servo but no stiffness into one whose servo acts on its link: a
    /// P–P servo on a rigid transmission is a spring `k_v k_p` between command and link and a
    /// damper `k_v`.
    pub fn close_rigid_servos(&mut self) {
        for joint in &mut self.chain.joints {
            let transmission = &mut joint.transmission;
            if let (None, Some(servo)) = (transmission.stiffness, transmission.servo) {
                let gain = servo.velocity_gain;
                transmission.stiffness = Some(gain * servo.position_gain_per_s);
                transmission.damping = gain;
                transmission.rigid_servo = true;
            }
        }
    }

    /// The same robot with all masses and inertias (rotors included), transmission stiffnesses and
    /// transmission dampings multiplied by factors.
    #[must_use]
    pub fn scaled(&self, inertia: f64, stiffness: f64, damping: f64) -> Self {
        let mut robot = self.clone();
        let followers = robot.chain.followers.iter_mut().map(|own| &mut own.link);
        let links = robot.chain.links.iter_mut().chain(followers);
        for link in links.chain([&mut robot.chain.base]) {
            link.mass_kg *= inertia;
            link.inertia_about_com_kg_m2 *= inertia;
        }
        for joint in &mut robot.chain.joints {
            let transmission = &mut joint.transmission;
            transmission.stiffness = transmission.stiffness.map(|k| k * stiffness);
            transmission.damping *= damping;
            transmission.rotor_inertia *= inertia;
        }
        robot
    }
}
