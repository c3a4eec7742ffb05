//! What a process asks of the plant in one step.
//!
//! Everything is expressed in the process frame: X along the tool axis into the workpiece, Y
//! horizontal, Z = X × Y, fixed in space, with its origin at the tool point after touch-down.

use arrayvec::ArrayVec;
use nalgebra::{Vector2, Vector3, Vector6};
use truecut_arm::FrameId;
use truecut_core::friction::{FrictionLaw, PlanarContact};

/// Most wrenches, and most contacts, that one process may ask for: two, and what tool modes make of
/// them.
pub const MAX_LOADS: usize = 3;

/// The frames of the robot that loads act on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Attachment {
    /// Where the tool cuts.
    Tool,
    /// Where the pressure foot stands.
    Foot,
}

impl From<Attachment> for FrameId {
    fn from(attachment: Attachment) -> Self {
        match attachment {
            Attachment::Tool => Self::Tool,
            Attachment::Foot => Self::Foot,
        }
    }
}

/// Force and moment on the robot at one of its frames, in [process axes](self).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Wrench {
    /// Where it attacks: the frame's origin.
    pub frame: Attachment,
    /// On the robot, process axes, N.
    pub force_n: Vector3<f64>,
    /// On the robot about the frame's origin, process axes, N m.
    pub moment_n_m: Vector3<f64>,
}

impl Wrench {
    /// A force without moment.
    pub fn force(frame: Attachment, force_n: Vector3<f64>) -> Self {
        Self {
            frame,
            force_n,
            moment_n_m: Vector3::zeros(),
        }
    }
}

/// A force over a moment, as one vector.
pub(crate) fn stacked(force: &Vector3<f64>, moment: &Vector3<f64>) -> Vector6<f64> {
    Vector6::from_iterator(force.iter().chain(moment).copied())
}

/// A frictional contact in the process Y–Z plane. The normal law is a spring that the process has
/// evaluated; how much of the friction acts depends on the free velocity and the effective mass,
/// which only the step loop knows.
#[derive(Debug, Clone, Copy)]
pub struct ContactRequest {
    /// Where the robot is touched.
    pub frame: Attachment,
    /// By which the workpiece presses on the robot, N; zero or less is no contact. It belongs to
    /// the [`Loads::wrenches`] as well: here it only bounds the friction.
    pub normal_force_n: f64,
    /// Friction against the sliding of this point over the workpiece, which stands still.
    pub law: FrictionLaw,
}

/// All that acts on the robot from outside in one step.
#[derive(Debug, Clone, Default)]
pub struct Loads {
    pub wrenches: ArrayVec<Wrench, MAX_LOADS>,
    pub contacts: ArrayVec<ContactRequest, MAX_LOADS>,
}

impl From<Wrench> for Loads {
    /// One wrench and no contact.
    fn from(wrench: Wrench) -> Self {
        Self {
            wrenches: ArrayVec::from_iter([wrench]),
            contacts: ArrayVec::new(),
        }
    }
}

/// What a contact did in the step, averaged over it.
#[derive(Debug, Clone, Copy)]
pub struct ContactOutcome {
    /// Friction force on the robot in process Y and Z, N.
    pub friction_n: Vector2<f64>,
    /// Sliding velocity after the step, m/s.
    pub velocity_m_per_s: Vector2<f64>,
    pub sliding: bool,
}

impl ContactOutcome {
    pub(crate) fn from_contact(contact: &PlanarContact, dt_s: f64) -> Self {
        Self {
            friction_n: contact.impulse_n_s / dt_s,
            velocity_m_per_s: contact.velocity_m_per_s,
            sliding: contact.sliding,
        }
    }
}

/// Outcomes in the order of [`Loads::contacts`].
pub type ContactOutcomes = ArrayVec<ContactOutcome, MAX_LOADS>;
