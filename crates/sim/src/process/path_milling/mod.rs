//! Milling of stock along a path from a file.
//!
//! The cut itself is one in layers or, of a tool that leans somewhere, in space (`cut`), in the
//! path's work frame; this process moves it: the place of the tip is the arm's tool point with the
//! modes of tool and workpiece, the force is averaged over each step, and what is reported is told
//! by place: forces, deflection and vibration along the path, walls and floor against the
//! path as it is written.

pub(crate) mod along;
mod cut;
mod kept;
mod left;
mod nominal;
mod peak;
mod report;
pub(crate) mod setup;
mod space;
mod spindle;
mod written;

use super::modes::{self, Modes, TipMotion};
use super::quantity;
use super::teeth::averaged;
use super::{ContactStiffness, Findings, Process, Start, ToolState, soft_note};
use crate::loads::{Attachment, ContactOutcomes, Loads, Wrench};
use crate::stability::known::beyond_table;
use cut::Cut;
use kept::Kept;
use nalgebra::{Isometry3, Matrix3, Rotation3, Vector3};
use nominal::{NominalPath, OnPath};
use spindle::{SpindleCourse, speeds_told};
use std::f64::consts::TAU;
use truecut_core::cutting::milling::cut::MillingLoads;
use truecut_core::cutting::milling::layered::cut::ToolPlace;
use truecut_plan::cam::SpindleAtCuts;
use truecut_recording::{ChannelSpec, Field, Outcome};
use truecut_scenario::{PathMillingSpec, SpindleSpec};
use written::Written;

/// A path that sinks by no more than this part of its way is level.
const LEVEL: f64 = 1e-3;

/// All that a pass is made of.
#[derive(Debug, Clone, PartialEq)]
pub struct PathMillingSetup {
    pub spec: PathMillingSpec,
    /// Where the tool point would be without deflection.
    nominal: NominalPath,
    /// The path as it is written.
    written: Written,
    /// Lines of the file that its points come from.
    lines: Vec<Option<usize>>,
    /// When they are reached, s.
    reached_s: Vec<f64>,
    /// What the file says of the spindle; `None` of a robot program.
    said: Option<SpindleAtCuts>,
    /// How the spindle turns.
    spindle: SpindleCourse,
    pub world_from_work: Isometry3<f64>,
    /// Takes components in the work frame to components in the process frame.
    pub process_from_work: Rotation3<f64>,
    /// Axes of the tool at the start in the work frame, as columns.
    pub work_from_tool: Matrix3<f64>,
    /// Largest part of the arm's mass at its tool point that a tool mode moves.
    pub mode_share: f64,
    /// Natural frequency of the fastest mode of arm, tool and workpiece.
    pub fastest_mode_hz: f64,
}

impl PathMillingSetup {
    fn work_from_world(&self) -> Matrix3<f64> {
        let turn = self.world_from_work.rotation.inverse();
        turn.to_rotation_matrix().into_inner()
    }

    /// A cut of the whole stock by a tool that starts this far off the path.
    fn cut(&self, offset_m: &Vector3<f64>) -> Cut {
        let on = self.nominal.at(0.0);
        let start = ToolPlace {
            place_m: on.place_m + offset_m,
            axes: on.axes,
            ..ToolPlace::default()
        };
        self.written.cut(&self.spec, &start)
    }
}

/// The process.
#[derive(Debug, Clone)]
pub struct PathMilling {
    setup: PathMillingSetup,
    cut: Cut,
    step_s: f64,
    last: MillingStep,
    kept: Kept,
    modes: Modes,
    /// Deflections of the modes at the step last committed.
    modes_m: Vec<f64>,
    /// When the cut's law ended, s.
    broken_s: Option<f64>,
    rows_only: bool,
}

/// Values of the last committed step.
#[derive(Debug, Clone, Copy, Default)]
struct MillingStep {
    /// Averaged over the step, work frame.
    force_on_tool_n: Vector3<f64>,
    moment_on_tool_n_m: Vector3<f64>,
    /// Where the cut stood, if a step was committed.
    at: Option<ToolPlace>,
    deflection_m: Vector3<f64>,
    feed_m_per_s: Vector3<f64>,
    along_m: f64,
    /// What acts there at that instant.
    loads: MillingLoads,
    /// By chips so far.
    removed_m3: f64,
}

impl MillingStep {
    /// The deflection in the tool's axes, its x and y in the plane of cut.
    fn across_m(&self) -> Vector3<f64> {
        let axes = self.at.map_or_else(Rotation3::identity, |at| at.axes);
        axes.inverse() * self.deflection_m
    }

    /// What brakes the spindle, N m.
    fn torque_n_m(&self) -> f64 {
        let axis = self.at.map_or(Vector3::z_axis(), |at| at.axis());
        self.moment_on_tool_n_m.dot(&axis)
    }
}

impl PathMilling {
    pub fn new(setup: PathMillingSetup) -> Self {
        Self {
            cut: setup.cut(&Vector3::zeros()),
            kept: Kept::new(setup.nominal.length_m(), [1.0]),
            setup,
            step_s: 0.0,
            last: MillingStep::default(),
            modes: Modes::default(),
            modes_m: Vec::new(),
            broken_s: None,
            rows_only: false,
        }
    }

    fn rotation_rad(&self, time_s: f64) -> f64 {
        self.setup.spindle.rotation_rad(time_s)
    }

    /// Deflection of the arm's tool point from the path and its rate, work frame.
    fn arm_motion(&self, state: &ToolState, on: &OnPath) -> TipMotion {
        let s = &self.setup;
        let tool = s.world_from_work.inverse() * state.world_from_tool;
        let velocity = s.process_from_work.inverse() * state.tool.velocity_m_per_s;
        TipMotion {
            deflection_m: tool.translation.vector - on.place_m,
            rate_m_per_s: velocity - on.velocity_m_per_s,
        }
    }

    /// Deflection of the tip from the path and its rate, work frame.
    fn deflection(&self, arm: &TipMotion) -> TipMotion {
        let modes = self.modes.deflection(arm);
        TipMotion {
            deflection_m: arm.deflection_m + modes.deflection_m,
            rate_m_per_s: arm.rate_m_per_s + modes.rate_m_per_s,
        }
    }

    /// Where the cut stands a time ahead of an instant at which the tip is off the path.
    fn place(&self, time_s: f64, off: &TipMotion, ahead_s: f64) -> ToolPlace {
        let on = self.setup.nominal.at(time_s + ahead_s);
        let spindle_rad_s = self.setup.spindle.rad_s(time_s + ahead_s);
        ToolPlace {
            rotation_rad: self.rotation_rad(time_s + ahead_s),
            place_m: on.place_m + off.deflection_m + off.rate_m_per_s * ahead_s,
            vibration_m_per_rad: off.rate_m_per_s / spindle_rad_s,
            sinks: -on.velocity_m_per_s.z > LEVEL * on.velocity_m_per_s.norm(),
            axes: on.axes,
        }
    }

    fn wrench(&self, force: &Vector3<f64>, moment: &Vector3<f64>) -> Wrench {
        let axes = &self.setup.process_from_work;
        Wrench {
            frame: Attachment::Tool,
            force_n: axes * force,
            moment_n_m: axes * moment,
        }
    }

    /// Force and moment on the tip, averaged over a step.
    fn mean_loads(&self, state: &ToolState, arm: &TipMotion) -> MillingLoads {
        let off = self.deflection(arm);
        averaged(
            &self.setup.spec.cutter,
            |ahead| self.place(state.time_s, &off, ahead * self.step_s),
            |tooth, at| self.cut.ends_in_stock(tooth, at),
            |at| self.cut.evaluate(at),
        )
    }
}

impl Process for PathMilling {
    fn begin(&mut self, start: &Start) {
        self.step_s = start.time_step_s;
        let s = &self.setup;
        let offset_m = s.process_from_work.inverse() * start.tool_offset_m;
        let axes = [&s.work_from_tool, &s.work_from_world()];
        self.modes = Modes::new(&s.spec.attached, axes, start.time_step_s);
        let foot = TipMotion {
            deflection_m: offset_m,
            ..TipMotion::default()
        };
        self.modes.rest(&foot, &Vector3::zeros());
        self.cut = s.cut(&offset_m);
        let teeth = match s.spec.cutter.runout.offset_m == 0.0 {
            true => 1,
            false => s.spec.cutter.teeth,
        };
        let periods = s.spindle.speeds_rad_s().map(|rad_s| {
            let period_s = s.spec.tooth_period_at_s(rad_s) * teeth as f64;
            period_s / start.time_step_s
        });
        self.kept = Kept::new(s.nominal.length_m(), periods);
        self.last = MillingStep {
            deflection_m: offset_m,
            ..MillingStep::default()
        };
    }

    fn channels(&self) -> Vec<ChannelSpec> {
        let mut channels = quantity::channels(report::quantities(self));
        channels.extend(modes::channels("path_milling", &self.setup.spec.attached));
        channels
    }

    fn evaluate(&self, state: &ToolState) -> Loads {
        let arm = self.arm_motion(state, &self.setup.nominal.at(state.time_s));
        let mean = self.mean_loads(state, &arm);
        let (force, moment) = (mean.force_on_tool_n, mean.moment_on_tool_n_m);
        let mut loads = Loads::from(self.wrench(&force, &moment));
        if let Some(differs) = self.modes.on_arm_n(&arm, &force) {
            loads
                .wrenches
                .push(self.wrench(&differs, &Vector3::zeros()));
        }
        loads
    }

    fn commit(&mut self, state: &ToolState, loads: &Loads, _: &ContactOutcomes, dt_s: f64) {
        let on = self.setup.nominal.at(state.time_s);
        let arm = self.arm_motion(state, &on);
        let off = self.deflection(&arm);
        let at = self.place(state.time_s, &off, 0.0);
        let work_from_process = self.setup.process_from_work.inverse();
        let wrench = &loads.wrenches[0];
        let loads = self.cut.evaluate(&at);
        let removal = loads.removal_m3_per_rad;
        let turned_rad = self.setup.spindle.rad_s(state.time_s) * dt_s;
        self.last = MillingStep {
            force_on_tool_n: work_from_process * wrench.force_n,
            moment_on_tool_n_m: work_from_process * wrench.moment_n_m,
            at: Some(at),
            deflection_m: off.deflection_m,
            feed_m_per_s: on.velocity_m_per_s,
            along_m: on.along_m,
            loads,
            removed_m3: self.last.removed_m3 + removal * turned_rad,
        };
        if self.cut.turns_back(&at) {
            self.broken_s = Some(state.time_s);
        }
        self.cut.commit(&at);
        if !self.rows_only {
            let speed = self.setup.spindle.index(state.time_s);
            self.kept.at_speed(speed);
            self.kept.add(&self.last, &self.cut);
        }
        let axes = state.world_from_tool.rotation.to_rotation_matrix();
        self.modes
            .turn(&(self.setup.work_from_world() * axes.matrix()));
        self.modes_m.clear();
        self.modes_m.extend(self.modes.each_m(&arm));
        self.modes.advance(&arm, &self.last.force_on_tool_n);
    }

    fn ended(&self) -> Option<Outcome> {
        self.broken_s.map(|time_s| Outcome::Chatter {
            time_s,
            amplitude_m: self.kept.amplitude_m(),
            rule: report::broken_rule(self),
        })
    }

    fn record(&self, row: &mut Vec<f64>) {
        quantity::record(report::quantities(self), row);
        row.extend(&self.modes_m);
    }

    fn keep_rows_only(&mut self) {
        self.rows_only = true;
    }

    fn finish(&mut self) -> Findings {
        if self.rows_only {
            return Findings::default();
        }
        self.cut.finish();
        report::findings(self)
    }

    fn tooth_period_s(&self) -> Option<f64> {
        Some(self.setup.spec.tooth_period_s())
    }

    fn steps_with_teeth(&self) -> bool {
        true
    }

    fn fastest_mode_hz(&self) -> Option<f64> {
        self.setup.spec.attached.fastest_hz()
    }

    fn mode_share(&self) -> f64 {
        self.setup.mode_share
    }

    fn contact_stiffness(&self) -> Vec<ContactStiffness> {
        Vec::new()
    }

    fn field(&self) -> Option<Field> {
        Some(report::field(self))
    }

    fn field_values(&self) -> Vec<f32> {
        report::field_values(self)
    }

    fn arrows(&self) -> Vec<(&'static str, Attachment, Vector3<f64>)> {
        let force = self.setup.process_from_work * self.last.force_on_tool_n;
        vec![("cutting", Attachment::Tool, force)]
    }

    fn notes(&self) -> Vec<String> {
        let spec = &self.setup.spec;
        beyond_table(&spec.attached, spec.spindle.fastest_rad_s())
            .into_iter()
            .chain(soft_note(&spec.coefficients))
            .chain(self.of_the_file())
            .collect()
    }
}

impl PathMilling {
    /// What there is to tell of the spindle and the path's file.
    fn of_the_file(&self) -> Vec<String> {
        let told = |note: String| format!("process.path_milling.path.file: {note}");
        match &self.setup.spec.spindle {
            SpindleSpec::Steady(rad_s) => {
                // Turned back from rad/s: without what rounding adds.
                let rpm = (rad_s * 60.0 / TAU * 1e6).round() / 1e6;
                let file = self.setup.said.iter();
                let notes = file.flat_map(|one| one.contradictions(rpm));
                notes.map(told).collect()
            }
            SpindleSpec::OfFile(speeds) => vec![told(speeds_told(speeds))],
        }
    }
}
