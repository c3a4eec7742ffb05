//! A process whose tool or workpiece bends: `[[tool.mode]]`, `[[workpiece.mode]]`.
//!
//! The process inside sees the tip where the modes have it, relative to the workpiece, and knows
//! nothing of them; what it asks of the tool acts on the modes, and these on the arm
//! ([`super::modes`]). Moments and what acts on the foot are the arm's as they are. Coordinates are
//! counted from where the tool stood after touch-down, process axes; a tool that turns on its way
//! takes the directions of its modes along.

use nalgebra::{Isometry3, Matrix3, UnitQuaternion, Vector3};
use std::f64::consts::TAU;
use truecut_arm::{FrameId, Load, Robot};
use truecut_core::chatter::{AttachedMode, AttachedModes};
use truecut_recording::{ChannelSpec, Field, Outcome};

use super::modes::{self, Modes, TipMotion};
use super::{ContactStiffness, Findings, FrameMotion, Process, Start, ToolState};
use crate::error::SimError;
use crate::loads::{Attachment, ContactOutcomes, Loads, Wrench};

/// The process inside, and the modes.
pub(super) struct Yielding {
    inner: Box<dyn Process>,
    name: String,
    attached: AttachedModes,
    process_from_world: UnitQuaternion<f64>,
    /// Axes of the tool at the start, as columns in the process frame.
    process_from_tool: Matrix3<f64>,
    modes: Modes,
    /// Largest part of the arm's mass at its tool point that a mode moves.
    share: f64,
    /// What the modes add to the place of the tip as the run starts, process axes.
    start_m: Vector3<f64>,
    /// Deflections of the modes at the step last committed.
    modes_m: Vec<f64>,
}

impl Yielding {
    /// A process, called `name`, on an arm that starts in `posture`.
    ///
    /// # Errors
    /// Tool modes that weigh more than the arm at its tool point.
    pub fn new(
        (name, inner): (&str, Box<dyn Process>),
        attached: &AttachedModes,
        robot: &Robot,
        posture: &[f64],
    ) -> Result<Self, SimError> {
        let axes = robot.tool_axes(posture);
        let tool: Vec<_> = attached
            .tool
            .iter()
            .map(|mode| mode.turned(&axes))
            .collect();
        let arm = robot.linearised(posture, FrameId::Tool, &Load::none())?;
        (arm.with_tool(&tool)).map_err(|error| SimError::too_heavy("tool.mode", error))?;
        let process_from_world = robot.world_from_process(posture).rotation.inverse();
        Ok(Self {
            inner,
            name: name.to_owned(),
            attached: attached.clone(),
            process_from_world,
            process_from_tool: process_from_world.to_rotation_matrix() * axes,
            modes: Modes::default(),
            share: arm.largest_share(&tool),
            start_m: Vector3::zeros(),
            modes_m: Vec::new(),
        })
    }

    /// The tip on its modes, relative to the workpiece.
    fn at_tip(&self, state: &ToolState) -> ToolState {
        let modes = self.modes.deflection(&foot(&state.tool));
        let in_world = self.process_from_world.inverse() * modes.deflection_m;
        let mut world_from_tool = state.world_from_tool;
        world_from_tool.translation.vector += in_world;
        ToolState {
            tool: FrameMotion {
                displacement_m: state.tool.displacement_m + modes.deflection_m - self.start_m,
                velocity_m_per_s: state.tool.velocity_m_per_s + modes.rate_m_per_s,
            },
            world_from_tool,
            ..*state
        }
    }

    /// Axes of the tool in the process frame, as columns.
    fn tool_axes(&self, world_from_tool: &Isometry3<f64>) -> Matrix3<f64> {
        let turned = self.process_from_world * world_from_tool.rotation;
        turned.to_rotation_matrix().into_inner()
    }

    /// Frequency of a mode with the contact's springs beside its own, Hz.
    fn pressed_hz(&self, mode: &AttachedMode, axes: &Matrix3<f64>) -> f64 {
        let direction = axes * mode.direction;
        let springs = self.inner.contact_stiffness();
        let at_tip = springs
            .iter()
            .filter(|spring| spring.frame == Attachment::Tool);
        let stiffness = at_tip.fold(mode.stiffness_n_per_m, |sum, spring| {
            sum + spring.stiffness_n_per_m * spring.direction.dot(&direction).powi(2)
        });
        (stiffness / mode.mass_kg()).sqrt() / TAU
    }
}

/// The arm's tool point as the foot of the tool's modes.
fn foot(tool: &FrameMotion) -> TipMotion {
    TipMotion {
        deflection_m: tool.displacement_m,
        rate_m_per_s: tool.velocity_m_per_s,
    }
}

/// What loads ask of the tip, N.
fn on_tip_n(loads: &Loads) -> Vector3<f64> {
    let wrenches = loads.wrenches.iter();
    let at_tip = wrenches.filter(|wrench| wrench.frame == Attachment::Tool);
    at_tip.map(|wrench| wrench.force_n).sum()
}

impl Process for Yielding {
    fn begin(&mut self, start: &Start) {
        let world = self.process_from_world.to_rotation_matrix();
        let axes = [&self.process_from_tool, world.matrix()];
        self.modes = Modes::new(&self.attached, axes, start.time_step_s);
        let at_rest = TipMotion::default();
        let force_n = on_tip_n(&self.inner.static_loads());
        self.modes.rest(&at_rest, &force_n);
        self.start_m = self.modes.deflection(&at_rest).deflection_m;
        self.inner.begin(&Start {
            tool_offset_m: start.tool_offset_m + self.start_m,
            ..*start
        });
    }

    fn channels(&self) -> Vec<ChannelSpec> {
        let mut channels = self.inner.channels();
        channels.extend(modes::channels(&self.name, &self.attached));
        channels
    }

    fn evaluate(&self, state: &ToolState) -> Loads {
        let mut loads = self.inner.evaluate(&self.at_tip(state));
        let force_n = on_tip_n(&loads);
        if let Some(differs) = self.modes.on_arm_n(&foot(&state.tool), &force_n) {
            let wrench = Wrench::force(Attachment::Tool, differs);
            loads.wrenches.push(wrench);
        }
        loads
    }

    fn commit(&mut self, state: &ToolState, loads: &Loads, contacts: &ContactOutcomes, dt_s: f64) {
        let mut own = loads.clone();
        if !self.attached.tool.is_empty() {
            own.wrenches.pop();
        }
        let at_tip = self.at_tip(state);
        self.inner.commit(&at_tip, &own, contacts, dt_s);
        let foot = foot(&state.tool);
        self.modes.turn(&self.tool_axes(&state.world_from_tool));
        self.modes_m.clear();
        self.modes_m.extend(self.modes.each_m(&foot));
        self.modes.advance(&foot, &on_tip_n(&own));
    }

    fn record(&self, row: &mut Vec<f64>) {
        self.inner.record(row);
        row.extend(&self.modes_m);
    }

    fn fastest_mode_hz(&self) -> Option<f64> {
        let world = self.process_from_world.to_rotation_matrix();
        let tool = self
            .attached
            .tool
            .iter()
            .map(|mode| (mode, &self.process_from_tool));
        let workpiece = self
            .attached
            .workpiece
            .iter()
            .map(|mode| (mode, world.matrix()));
        let own = tool
            .chain(workpiece)
            .map(|(mode, axes)| self.pressed_hz(mode, axes));
        own.chain(self.inner.fastest_mode_hz())
            .max_by(f64::total_cmp)
    }

    fn mode_share(&self) -> f64 {
        self.share.max(self.inner.mode_share())
    }

    fn ended(&self) -> Option<Outcome> {
        self.inner.ended()
    }

    fn keep_rows_only(&mut self) {
        self.inner.keep_rows_only();
    }

    fn finish(&mut self) -> Findings {
        self.inner.finish()
    }

    fn static_loads(&self) -> Loads {
        self.inner.static_loads()
    }

    fn tooth_period_s(&self) -> Option<f64> {
        self.inner.tooth_period_s()
    }

    fn steps_with_teeth(&self) -> bool {
        self.inner.steps_with_teeth()
    }

    fn is_given(&self) -> bool {
        self.inner.is_given()
    }

    fn highest_frequency_hz(&self) -> Option<f64> {
        self.inner.highest_frequency_hz()
    }

    fn quickest_s(&self) -> Option<f64> {
        self.inner.quickest_s()
    }

    fn notes(&self) -> Vec<String> {
        self.inner.notes()
    }

    fn contact_stiffness(&self) -> Vec<ContactStiffness> {
        self.inner.contact_stiffness()
    }

    fn feed_along_y_m_per_s(&self) -> f64 {
        self.inner.feed_along_y_m_per_s()
    }

    fn field(&self) -> Option<Field> {
        self.inner.field()
    }

    fn field_values(&self) -> Vec<f32> {
        self.inner.field_values()
    }

    fn arrows(&self) -> Vec<(&'static str, Attachment, Vector3<f64>)> {
        self.inner.arrows()
    }
}
