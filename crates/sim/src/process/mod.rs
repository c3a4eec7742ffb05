//! Processes: what the tool does to the workpiece.
//!
//! A process sees the motion of tool and foot in the process frame and answers with [`Loads`]. It
//! is a state machine whose memory moves on once per step, in [`Process::commit`];
//! [`Process::evaluate`] changes nothing, so a step may be tried as often as the solver likes.

mod belt;
mod brush;
mod chamfer;
mod custom;
mod dispatch;
mod foot;
mod load;
mod milling;
mod modes;
pub(crate) mod path_milling;
mod pending_removal;
mod polish;
mod pressing;
mod quantity;
mod replay;
mod setup;
mod soft;
mod step_cache;
mod surface_polish;
mod teeth;
mod wheel;
mod yielding;

pub use belt::{Belt, BeltSetup, Cells, cells_within};
pub(crate) use belt::{NoPasses, Passes};
pub use brush::{BrushProcess, BrushSetup, Station};
pub use chamfer::{Chamfer, ChamferParameters, SlipTheory};
pub use custom::OwnProcess;
pub(crate) use dispatch::set_up;
pub use foot::{Foot, FootParameters};
pub use load::Load;
pub use milling::{Milling, MillingSetup, MillingTheory, TheoryInputs};
pub(crate) use milling::{linear_share, notes as milling_notes};
pub use path_milling::{PathMilling, PathMillingSetup};
pub use polish::{Polish, PolishSetup};
pub use quantity::Quantity;
pub use replay::{ForceSamples, Replay};
pub use setup::{ProcessSetup, SetupContext, tells_unfinished};
pub(crate) use setup::{ReadPart, StandingPart, cut_short};
pub(crate) use soft::soft_note;
pub use surface_polish::{SurfacePolish, SurfacePolishSetup};
pub use wheel::Wheel;

use crate::loads::{Attachment, ContactOutcomes, Loads};
pub use crate::scene::{Held, Tooling};
use nalgebra::{Isometry3, Vector3};
use truecut_recording::{ChannelSpec, Field, Outcome, PartMesh, Profile, Scalar};

/// Motion of one frame of the robot, in process axes, relative to where it stood after touch-down.
#[derive(Debug, Clone, Copy, Default)]
pub struct FrameMotion {
    /// From where the frame's origin stood after touch-down, process axes, m.
    pub displacement_m: Vector3<f64>,
    /// Of the frame's origin, process axes, m/s.
    pub velocity_m_per_s: Vector3<f64>,
}

/// What a process may know of the robot at one time.
#[derive(Debug, Clone, Copy, Default)]
pub struct ToolState {
    /// Time since touch-down, s.
    pub time_s: f64,
    /// Motion of the tool: process axes, from where it stood after touch-down.
    pub tool: FrameMotion,
    /// Motion of the foot, likewise.
    pub foot: FrameMotion,
    /// Where the tool stands, for processes that know where the workpiece is.
    pub world_from_tool: Isometry3<f64>,
    /// Angular velocity of the tool, world axes, rad/s.
    pub tool_turning_rad_s: Vector3<f64>,
}

/// A spring between robot and workpiece, for choosing the step: frame, process axis, N/m.
#[derive(Debug, Clone, Copy)]
pub struct ContactStiffness {
    pub frame: Attachment,
    pub direction: Vector3<f64>,
    pub stiffness_n_per_m: f64,
}

/// Slope of a force over a depth about `depth_m`, N/m.
fn slope_n_per_m(depth_m: f64, force_n: impl Fn(f64) -> f64) -> f64 {
    let step_m = 1e-3 * depth_m;
    (force_n(depth_m + step_m) - force_n(depth_m - step_m)) / (2.0 * step_m)
}

/// What a process found out by the end of the run.
#[derive(Debug, Clone, Default)]
pub struct Findings {
    pub scalars: Vec<Scalar>,
    pub profiles: Vec<Profile>,
    /// The workpiece as it is left, in its own frame, if the process keeps it as a body.
    pub part: Option<PartMesh>,
    /// Where the run left what the process' model describes.
    pub beyond: Option<Outcome>,
    /// That what the process is for never happened; of a run that was cut short it says nothing.
    pub idle: Option<Outcome>,
    /// Where something was asked of an actuator of the process that it does not give; a run's rule
    /// for overload says whether that counts.
    pub overload: Option<Outcome>,
}

/// What is known when the arm stands at its start.
#[derive(Debug, Clone, Copy)]
pub struct Start {
    /// Time step of the run, s.
    pub time_step_s: f64,
    /// Tool point at the start minus where an arm without load would have it, process axes, m.
    pub tool_offset_m: Vector3<f64>,
}

/// One machining process.
pub trait Process: Send {
    /// Called once, before the first step.
    fn begin(&mut self, _start: &Start) {}

    /// Channels that [`Process::record`] fills, in its order.
    fn channels(&self) -> Vec<ChannelSpec>;

    /// Loads on the robot at this state. Changes nothing.
    fn evaluate(&self, state: &ToolState) -> Loads;

    /// Advances the memory past this step. `state` and `loads` are those of [`Process::evaluate`]
    /// (with the velocity now known at the same instant), `contacts` what the step loop made of the
    /// requests.
    fn commit(&mut self, state: &ToolState, loads: &Loads, contacts: &ContactOutcomes, dt_s: f64);

    /// How the run ends with the step last committed, if the process itself cannot go on.
    fn ended(&self) -> Option<Outcome> {
        None
    }

    /// Appends one value per channel for the step last committed.
    fn record(&self, row: &mut Vec<f64>);

    /// Drops the memory that only [`Process::finish`] reads; forces and channels stay as they are,
    /// and there are no findings then.
    fn keep_rows_only(&mut self) {}

    /// Ends the run; by default nothing is found out.
    fn finish(&mut self) -> Findings {
        Findings::default()
    }

    /// Forces that act on the robot before the start and through touch-down, for the static
    /// equilibrium; none where it starts lifted.
    fn static_loads(&self) -> Loads {
        Loads::default()
    }

    /// Time between two cutting edges, s, if the process has edges.
    fn tooth_period_s(&self) -> Option<f64> {
        None
    }

    /// Whether the default step is to be a whole part of the tooth period, so that every tooth
    /// meets the same instants.
    fn steps_with_teeth(&self) -> bool {
        false
    }

    /// Whether it never loads the robot, and asks nothing of the tool's state but for its channels.
    fn is_idle(&self) -> bool {
        false
    }

    /// Whether all forces are given beforehand, whatever the arm does: nothing is in contact, and
    /// what shows beside the arm's vibration is how it differs from that of a linear one.
    fn is_given(&self) -> bool {
        false
    }

    /// Highest frequency of the forces that are given and not computed, Hz, if the process has any.
    fn highest_frequency_hz(&self) -> Option<f64> {
        None
    }

    /// Shortest time, s, in which something moves that the process itself carries along, if it
    /// does: a step must resolve it.
    fn quickest_s(&self) -> Option<f64> {
        None
    }

    /// What a reader of the recording should know.
    fn notes(&self) -> Vec<String> {
        Vec::new()
    }

    /// Fastest mode that the process steps beside the robot, Hz, if it has modes of its own.
    fn fastest_mode_hz(&self) -> Option<f64> {
        None
    }

    /// Largest part of the arm's mass at its tool point that one of these modes moves.
    fn mode_share(&self) -> f64 {
        0.0
    }

    /// Springs that stiffen the robot while in contact.
    fn contact_stiffness(&self) -> Vec<ContactStiffness>;

    /// Speed of the commanded motion along process Y, m/s.
    fn feed_along_y_m_per_s(&self) -> f64 {
        0.0
    }

    /// A quantity on the workpiece to be drawn, world frame, if there is one; asked for once.
    fn field(&self) -> Option<Field> {
        None
    }

    /// Values of that field now, x first.
    fn field_values(&self) -> Vec<f32> {
        Vec::new()
    }

    /// Forces on the robot to be drawn, in the process frame: (name, frame, force of the last
    /// step).
    fn arrows(&self) -> Vec<(&'static str, Attachment, Vector3<f64>)>;
}
