//! Peripheral milling along a straight line.
//!
//! The cut itself is [`MillingCut`]; this process moves it: it turns process axes into the milling
//! frame, takes the feed off the motion so that what is left is the tool's deflection from its
//! path, averages the force over each step (a tooth that enters in the middle of a step cuts for
//! half of it), lets the cut begin (under way, through the face of the stock, or on a wedge) and
//! keeps what is reported at the end.

mod history;
mod report;
pub(crate) mod setup;
mod tip;

pub(crate) use report::linear_share;
pub(crate) use setup::notes;
pub use setup::{MillingTheory, TheoryInputs};

use super::modes::{self, Modes};
use super::quantity;
use super::teeth::averaged;
use super::{ContactStiffness, Findings, Process, Start, ToolState};
use crate::loads::{Attachment, ContactOutcomes, Loads, Wrench};
use crate::stability::known::beyond_table;
use history::{History, stride};
use nalgebra::{Matrix3, Rotation3, Vector3};
use truecut_core::cutting::milling::cut::{
    MillingCut, MillingLoads, MillingParameters, ToolState as CutState,
};
use truecut_core::cutting::milling::dexel::{FinishedSurface, RayGrid, Wall};
use truecut_recording::{ChannelSpec, Outcome};
use truecut_scenario::MillingSpec;

/// Rays of a finished surface per feed mark.
const RAYS_PER_MARK: f64 = 8.0;
/// Most rays of a finished surface.
const MOST_RAYS: f64 = 20_000.0;

/// All that a milling pass is made of.
#[derive(Debug, Clone, PartialEq)]
pub struct MillingSetup {
    pub spec: MillingSpec,
    /// The cut; its steady displacement is filled in at the start of the run.
    pub parameters: MillingParameters,
    /// Takes components in the milling frame to components in the process frame.
    pub process_from_milling: Rotation3<f64>,
    /// Force on the tool of the nominal cut, averaged over a revolution, milling frame, N.
    pub nominal_force_n: Vector3<f64>,
    /// Force (N) and moment (N m) on a tool that rests in the cut, sunk or lifted by them, milling
    /// frame.
    pub mean_load: (Vector3<f64>, Vector3<f64>),
    /// Axes of the world in the milling frame, as columns.
    pub milling_from_world: Matrix3<f64>,
    /// Axes of the tool at the start in the milling frame, as columns.
    pub milling_from_tool: Matrix3<f64>,
    /// Deflection of arm, tool and workpiece under it, milling frame, m.
    pub mean_deflection_m: Vector3<f64>,
    /// The walls that the pass finishes, the one of down-milling first.
    pub finished_walls: Vec<Wall>,
    pub theory: TheoryInputs,
    /// Largest part of the arm's mass at its tool point that a tool mode moves.
    pub mode_share: f64,
    /// Natural frequency of the fastest mode of arm, tool and workpiece.
    pub fastest_mode_hz: f64,
}

impl MillingSetup {
    /// The wall that is looked at while the run goes on.
    fn wall(&self) -> Option<Wall> {
        self.finished_walls.first().copied()
    }

    /// A vector of the process frame in the milling frame.
    fn in_milling(&self, in_process: &Vector3<f64>) -> Vector3<f64> {
        self.process_from_milling
            .inverse_transform_vector(in_process)
    }

    /// Distance along the path at a time, m.
    fn distance_m(&self, time_s: f64) -> f64 {
        self.spec.feed_m_per_s * time_s
    }

    fn tooth_period_s(&self) -> f64 {
        self.parameters
            .cutter
            .tooth_period_s(self.spec.spindle_rad_s)
    }

    /// Whether the arm starts in the cut, deflected by it.
    fn starts_in_cut(&self) -> bool {
        self.spec.lead_in_m.is_none() && self.spec.ramp_m == 0.0
    }

    /// Part of the full depth at a distance along the path.
    fn depth_share(&self, distance_m: f64) -> f64 {
        let behind_m = distance_m - self.spec.lead_in_m.unwrap_or(0.0);
        if self.spec.ramp_m == 0.0 {
            1.0
        } else {
            (behind_m / self.spec.ramp_m).clamp(0.0, 1.0)
        }
    }

    /// Distance from which on the cut has its full depth and width, m.
    fn settled_m(&self) -> f64 {
        let entry_m =
            (self.spec.lead_in_m).map_or(0.0, |lead_m| lead_m + self.parameters.cutter.radius_m);
        entry_m + self.spec.ramp_m
    }

    /// x of the cut at the start of the path: the cut counts from rotation 0.
    fn origin_m(&self) -> f64 {
        self.parameters.nominal_x_m(self.spec.start_angle_rad)
    }
}

/// The process.
#[derive(Debug, Clone)]
pub struct Milling {
    setup: MillingSetup,
    cut: MillingCut,
    step_s: f64,
    /// Tool point at the start minus the start of the path, milling frame, m.
    start_offset_m: Vector3<f64>,
    last: MillingStep,
    history: History,
    modes: Modes,
    /// Deflections of the modes at the step last committed.
    modes_m: Vec<f64>,
    /// When the cut's law ended, s, and the rule that was broken.
    broken: Option<(f64, &'static str)>,
    /// Nothing is kept for findings.
    rows_only: bool,
}

/// Values of the last committed step.
#[derive(Debug, Clone, Copy, Default)]
struct MillingStep {
    /// Averaged over the step.
    force_on_tool_n: Vector3<f64>,
    moment_on_tool_n_m: Vector3<f64>,
    /// Where the cut stood, if a step was committed.
    at: Option<CutState>,
    deflection_m: Vector3<f64>,
    rotation_rad: f64,
    wall_error_m: f64,
}

impl Milling {
    pub fn new(setup: MillingSetup) -> Self {
        Self {
            cut: MillingCut::new(setup.parameters, None),
            setup,
            step_s: 0.0,
            start_offset_m: Vector3::zeros(),
            last: MillingStep::default(),
            history: History::default(),
            modes: Modes::default(),
            modes_m: Vec::new(),
            broken: None,
            rows_only: false,
        }
    }

    /// Walls and floor to be finished, on rays from where the cut has its full width and depth.
    fn surface(&self) -> FinishedSurface {
        let s = &self.setup;
        let p = &s.parameters;
        let from_m = s.settled_m().min(s.spec.path.length_m);
        let length_m = s.spec.path.length_m - from_m;
        let spacing_m = (p.feed_per_tooth_m / RAYS_PER_MARK).max(length_m / MOST_RAYS);
        let grid = RayGrid {
            start_m: s.origin_m() + from_m,
            spacing_m,
            count: (length_m / spacing_m) as usize + 1,
        };
        let walls: Vec<(Wall, f64)> = (s.finished_walls.iter())
            .map(|wall| (*wall, 0.5 * p.stock.top_m))
            .collect();
        FinishedSurface::new(grid, &walls, &[0.0])
    }

    fn rotation_rad(&self, time_s: f64) -> f64 {
        self.setup.spec.start_angle_rad + self.setup.spec.spindle_rad_s * time_s
    }

    /// Deflection of the tip from its path on the workpiece and its rate, milling frame.
    fn deflection(&self, state: &ToolState) -> (Vector3<f64>, Vector3<f64>) {
        let arm = self.arm_motion(state);
        let modes = self.modes.deflection(&arm);
        (
            arm.deflection_m + modes.deflection_m,
            arm.rate_m_per_s + modes.rate_m_per_s,
        )
    }

    fn wrench(&self, force: &Vector3<f64>, moment: &Vector3<f64>) -> Wrench {
        let axes = &self.setup.process_from_milling;
        Wrench {
            frame: Attachment::Tool,
            force_n: axes * force,
            moment_n_m: axes * moment,
        }
    }

    /// Material left on the wall by the tooth that has passed it since the last step, if one has.
    fn note_wall(&mut self, rotation_rad: f64, deflection_m: &Vector3<f64>) {
        let cutter = &self.setup.parameters.cutter;
        let (apex_rad, side) = match self.setup.wall() {
            Some(Wall::Exit) => (std::f64::consts::PI, -1.0),
            Some(Wall::Entry) => (0.0, 1.0),
            None => return,
        };
        let passed = |rotation: f64| ((rotation - apex_rad) / cutter.pitch_rad()).floor();
        let (before, now) = (passed(self.last.rotation_rad), passed(rotation_rad));
        if now <= before {
            return;
        }
        // Tooth j follows the first by j pitches.
        let tooth = (now as i64).rem_euclid(cutter.teeth as i64) as usize;
        let at = apex_rad + now * cutter.pitch_rad();
        let share = (at - self.last.rotation_rad) / (rotation_rad - self.last.rotation_rad);
        let y_m = self.last.deflection_m.y + (deflection_m.y - self.last.deflection_m.y) * share;
        self.last.wall_error_m = cutter.radius_m - cutter.tooth_radius_m(tooth) - side * y_m;
    }

    fn keep(&mut self, time_s: f64, rate: &Vector3<f64>) {
        if self.rows_only || self.setup.distance_m(time_s) < self.setup.settled_m() {
            return;
        }
        self.history.add(&self.last.deflection_m, rate);
        let force = &mut self.history.force;
        force.add(self.last.rotation_rad, &self.last.force_on_tool_n);
    }
}

impl Process for Milling {
    fn begin(&mut self, start: &Start) {
        self.step_s = start.time_step_s;
        let s = &self.setup;
        self.start_offset_m = s.in_milling(&start.tool_offset_m);
        self.place_modes(start.time_step_s);
        let s = &self.setup;
        let mut parameters = s.parameters;
        let start_m = self.deflection(&ToolState::default()).0;
        parameters.steady_displacement_m = start_m;
        if !s.starts_in_cut() && !parameters.regeneration {
            parameters.steady_displacement_m += s.mean_deflection_m;
        }
        let surface = (!self.rows_only).then(|| self.surface());
        self.cut = MillingCut::new(parameters, surface);
        let period_s = self.setup.tooth_period_s();
        let cycles = self.setup.fastest_mode_hz * period_s;
        self.history.stride = stride(period_s / start.time_step_s, cycles);
        self.last = MillingStep {
            deflection_m: start_m,
            rotation_rad: self.rotation_rad(0.0),
            ..MillingStep::default()
        };
        self.last.wall_error_m = match self.setup.wall() {
            Some(Wall::Entry) => -start_m.y,
            _ => start_m.y,
        };
    }

    fn channels(&self) -> Vec<ChannelSpec> {
        let mut channels = quantity::channels(report::quantities(&self.setup, &self.last, None));
        channels.extend(modes::channels("milling", &self.setup.spec.attached));
        channels
    }

    fn evaluate(&self, state: &ToolState) -> Loads {
        let mean = averaged(
            &self.setup.parameters.cutter,
            |ahead| self.cut_state(state, ahead * self.step_s),
            |tooth, at| self.cut.ends_in_stock(tooth, at),
            |at| self.cut.evaluate(at),
        );
        let (force, moment) = (mean.force_on_tool_n, mean.moment_on_tool_n_m);
        let mut loads = Loads::from(self.wrench(&force, &moment));
        if let Some(differs) = self.modes.on_arm_n(&self.arm_motion(state), &force) {
            loads
                .wrenches
                .push(self.wrench(&differs, &Vector3::zeros()));
        }
        loads
    }

    fn commit(&mut self, state: &ToolState, loads: &Loads, _: &ContactOutcomes, _dt_s: f64) {
        let wrench = &loads.wrenches[0];
        let of_chips = self.cut_state(state, 0.0);
        let (deflection_m, rate) = self.deflection(state);
        let rotation_rad = self.rotation_rad(state.time_s);
        self.note_wall(rotation_rad, &deflection_m);
        let at = CutState {
            rotation_rad,
            displacement_m: deflection_m,
            ..CutState::default()
        };
        self.broken = tip::broken_rule(&self.cut, &at).map(|rule| (state.time_s, rule));
        self.cut.commit(&at);
        self.last = MillingStep {
            force_on_tool_n: self.setup.in_milling(&wrench.force_n),
            moment_on_tool_n_m: self.setup.in_milling(&wrench.moment_n_m),
            at: Some(of_chips),
            deflection_m,
            rotation_rad,
            ..self.last
        };
        self.keep(state.time_s, &rate);
        let force_n = self.last.force_on_tool_n;
        self.move_modes(state, &force_n);
    }

    fn ended(&self) -> Option<Outcome> {
        self.broken.map(|(time_s, rule)| Outcome::Chatter {
            time_s,
            amplitude_m: self.cut.amplitude_m(),
            rule: rule.to_owned(),
        })
    }

    fn record(&self, row: &mut Vec<f64>) {
        quantity::record(self.quantities(), row);
        row.extend(&self.modes_m);
    }

    fn keep_rows_only(&mut self) {
        self.rows_only = true;
        self.cut.drop_finished();
    }

    fn finish(&mut self) -> Findings {
        match self.rows_only {
            true => Findings::default(),
            false => report::findings(self),
        }
    }

    fn static_loads(&self) -> Loads {
        if !self.setup.starts_in_cut() {
            return Loads::default();
        }
        let (force, moment) = &self.setup.mean_load;
        Loads::from(self.wrench(force, moment))
    }

    fn tooth_period_s(&self) -> Option<f64> {
        Some(self.setup.tooth_period_s())
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

    fn arrows(&self) -> Vec<(&'static str, Attachment, Vector3<f64>)> {
        let force = self.setup.process_from_milling * self.last.force_on_tool_n;
        vec![("cutting", Attachment::Tool, force)]
    }

    fn notes(&self) -> Vec<String> {
        let spec = &self.setup.spec;
        let mut notes = notes(&spec.cut);
        notes.extend(beyond_table(&spec.attached, spec.spindle_rad_s));
        notes
    }
}
