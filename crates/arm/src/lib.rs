//! The arm of truecut: from a URDF and a `robot.toml` to kinematics, dynamics, compliance and
//! modes.
//!
//! A [`Robot`] is a serial chain of 1 to 12 one-degree-of-freedom joints. The URDF gives geometry,
//! inertia and limits; `robot.toml` beside it gives what a URDF cannot say: stiffness, damping, dry
//! friction and rotor inertia of each transmission, each with its source, and the tool frame
//! (format: [`config`]). What is fixed is merged with its inertia; side branches
//! (grippers, mounts) are merged with their joints at zero, which [`Chain::notes`] states.
//!
//! # Conventions
//!
//! SI throughout. Posture `q` lists the joint coordinates in chain order, rad for revolute and m
//! for prismatic joints. World is the URDF's root frame, z up. `a_from_b` is the pose of b in a.
//! Jacobians and wrenches have their linear part first, in world axes at the frame's origin.
//! Methods panic on slices of the wrong length, as indexing does; outside input is checked with
//! [`Robot::check_posture`]. Files never cause a panic: every fault is one [`ArmError`] with its
//! place.
//!
//! # Tour
//!
//! ```
//! use nalgebra::Vector3;
//! use truecut_arm::{FrameId, Load, Robot, directional_stiffness, planar_principal};
//!
//! # fn main() -> Result<(), truecut_arm::ArmError> {
//! # let assets = concat!(env!("CARGO_MANIFEST_DIR"), "/../../assets/robots");
//! # let urdf = format!("{assets}/irb6600_175_255/robot.urdf");
//! let robot = Robot::load(urdf.as_ref(), None, None)?;
//! let q = [-48.38, 54.82, 6.86, 54.16, 107.43, -21.95].map(f64::to_radians);
//! robot.check_posture(&q)?;
//!
//! // Where is the tool, and what does a newton do there?
//! let tool = robot.world_from_frame(&q, FrameId::Tool);
//! assert!(tool.translation.vector.norm() < 2.9);
//! let compliance = robot.process_compliance(&q, FrameId::Tool)?;
//! let along_feed = directional_stiffness(&compliance, &Vector3::x_axis());
//! assert!((along_feed / 0.86476e6 - 1.0).abs() < 2e-4);
//! let lateral = planar_principal(&compliance, &Vector3::y_axis(), &Vector3::z_axis());
//! assert!(lateral.k_min_n_per_m < lateral.k_max_n_per_m);
//!
//! // How does it vibrate?
//! let modes = robot.modes(&q, None)?;
//! assert!((modes.frequency_hz[0] - 6.672).abs() < 1e-3);
//!
//! // Where must the motors stand so that the arm rests at q under gravity?
//! let gravity = truecut_arm::standard_gravity_m_s2();
//! let command = robot.holding_command(&q, &Load::gravity(gravity))?;
//! let rest = robot.static_posture(&command, &Load::gravity(gravity))?;
//! assert!(rest.iter().zip(q).all(|(a, b)| (a - b).abs() < 1e-12));
//! # Ok(())
//! # }
//! ```

mod bounds;
mod compliance;
pub mod config;
mod doubts;
mod drawing;
mod dynamics;
mod equilibrium;
mod error;
pub mod estimate;
mod estimated;
mod held;
mod ik;
mod ik_branches;
mod ik_path;
mod inertials;
mod kinematics;
mod load;
mod mass_sum;
mod merge;
mod meshes;
mod mjcf;
mod modal;
mod model;
mod motion;
mod moving;
mod nearest;
mod opw;
mod packages;
mod placed;
mod posture_rows;
pub mod report;
mod report_estimates;
mod report_text;
mod self_motion;
mod six_axes;
mod solids;
mod table;
mod tangent;
mod tip;
mod tip_modes;
mod told;
mod tree;
mod turns;
mod undrawn;
mod urdf;
mod visual;
mod xacro;
mod xml;
mod xml_bounds;
mod xml_text;

pub use bounds::Masses;
pub use compliance::{
    PlanarStiffness, axial_lateral_coupling, clamped, directional_stiffness, in_axes,
    planar_principal, translational,
};
pub use drawing::{DrawnLink, DrawnMesh};
pub use dynamics::{Dynamics, Energy};
pub use error::{ArmError, ArmErrorKind};
pub use estimated::TransmissionValue;
pub use ik::IkOptions;
pub use ik_branches::{BranchOptions, IkSolver, tool_pose};
pub use ik_path::PathOptions;
pub use load::{CONFIG_FILE_NAME, Reading, expanded_urdf};
pub use meshes::{LinkMesh, MeshData, MeshFileError};
pub use mjcf::{MjcfDrive, MjcfOptions, to_mjcf};
pub use modal::{LinearArm, Modes};
pub use model::{
    Chain, FrameId, Frames, Joint, JointKind, Limits, Link, MAX_JOINTS, Robot, Servo, Shape,
    Solids, ToolLoad, Transmission, TransmissionSources, Visual, standard_gravity_m_s2,
};
pub use moving::{Follower, Moving};
pub use opw::{ArmBranch, Elbow, OpwGeometry, Shoulder, SingularityDistance, Wrist};
pub use packages::Packages;
pub use placed::Placed;
pub use report::RobotReport;
pub use solids::LinkSolids;
pub use tangent::Load;
