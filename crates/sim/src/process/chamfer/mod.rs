//! Hole chamfering with an optional pressure foot.

mod report;
pub(crate) mod setup;

use super::quantity;
use super::step_cache::StepCache;
use super::{ContactStiffness, Findings, Foot, FootParameters, Process, ToolState, soft_note};
use crate::effect::CuttingEffects;
use crate::loads::{Attachment, ContactOutcomes, Loads, Wrench};
use nalgebra::Vector3;
use std::cell::RefCell;
use std::f64::consts::TAU;
use truecut_core::cutting::chamfer::EdgeForces;
use truecut_core::cutting::rim::Rim;
use truecut_core::cutting::runout_m;
use truecut_recording::ChannelSpec;
use truecut_scenario::{ChamferSpec, Regeneration};

/// Bins around the rim: a quarter of a degree, 92 µm on a 42 mm hole.
const RIM_BINS: usize = 1440;

/// A stick or slip event lasts at least this long, s.
pub const SLIP_EVENT_S: f64 = 3e-3;

/// All that a chamfering pass is made of.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ChamferParameters {
    /// The cut, with what effects change of it.
    pub cut: ChamferSpec,
    pub foot: Option<FootParameters>,
    pub effects: CuttingEffects,
}

impl ChamferParameters {
    /// Angle of an edge, from process Y towards Z, rad, growing with time.
    fn edge_angle_rad(&self, edge: usize, time_s: f64) -> f64 {
        let schedule = &self.cut.schedule;
        self.cut.start_angle_rad
            + schedule.spindle_rad_s * time_s
            + TAU * edge as f64 / schedule.edges as f64
    }

    /// Depth of an edge on a rigid arm at the angle of this sine and cosine, m.
    fn depth_m(&self, edge: usize, time_s: f64, (sin, cos): (f64, f64)) -> f64 {
        let depth = self.cut.schedule.edge_depth_m(time_s);
        let e = &self.effects;
        if !e.shift_depth() {
            return depth;
        }
        // What moves an edge outwards by r takes it deeper into the rim by r / tanθ.
        let hole = -(e.hole_offset_m[0] * cos + e.hole_offset_m[1] * sin);
        let runout = if e.runout_m == [0.0; 2] {
            0.0
        } else {
            let ahead = TAU * edge as f64 / self.cut.schedule.edges as f64;
            runout_m(e.runout_m, ahead)
        };
        let recess = if edge == 0 { e.recess_m } else { 0.0 };
        depth + e.depth_offset_m - recess + (hole + runout) / self.cut.chip.tan()
    }

    /// Depth that the edges before it have left at this angle on a rigid arm, m. The edge ahead
    /// came by one tooth period ago, but one that stands back may have left the surface of an
    /// earlier one.
    fn previous_depth_m(&self, edge: usize, time_s: f64, towards: (f64, f64)) -> f64 {
        let schedule = &self.cut.schedule;
        let before = |count: usize| {
            let ahead = (edge + count) % schedule.edges;
            self.depth_m(
                ahead,
                time_s - count as f64 * schedule.tooth_period_s(),
                towards,
            )
        };
        if self.effects.shift_depth() {
            (1..=schedule.edges)
                .map(before)
                .fold(f64::NEG_INFINITY, f64::max)
        } else {
            before(1)
        }
    }
}

/// What the slip conditions predict for this pass; published beside the result.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SlipTheory {
    pub paper_threshold_pa: f64,
    pub exact_threshold_pa: f64,
    pub general_threshold_pa: f64,
    /// Depth already cut at the first slip by the general condition, m; NaN if it holds.
    pub slip_depth_m: f64,
    /// Share of the axial force that the foot carries while its seals hold.
    pub axial_share: f64,
    /// `|S|`, lateral force on a held foot per newton of axial force in the arm.
    pub lateral_per_axial: f64,
}

/// The process.
#[derive(Debug, Clone)]
pub struct Chamfer {
    parameters: ChamferParameters,
    theory: Option<SlipTheory>,
    /// Surface that the chip thickness is measured against; none where it is the nominal one.
    thickness_rim: Option<Rim>,
    /// Surface that is really there, radial motion included; none where nobody asks for it.
    surface: Option<Rim>,
    foot: Option<Foot>,
    slip_started_s: Option<f64>,
    first_slip_s: Option<f64>,
    /// Way that an edge has cut along the rim, m.
    path_m: f64,
    last: ChamferStep,
    /// Edge states that the loads of this step were computed from.
    edge_states: StepCache<Vec<EdgeState>>,
    /// Room for the next ones.
    spare: RefCell<Vec<EdgeState>>,
}

/// Values of the last committed step.
#[derive(Debug, Clone, Copy, Default)]
struct ChamferStep {
    force_on_tool_n: Vector3<f64>,
    depth_m: f64,
    engaged_depth_m: f64,
    chip_area_m2: f64,
    edge_angle_rad: f64,
    torque_n_m: f64,
}

/// One edge at one instant.
#[derive(Debug, Clone, Copy)]
struct EdgeState {
    angle_rad: f64,
    /// Force on the tool, process axes.
    on_tool_n: Vector3<f64>,
    /// Depth that the chip is computed with, m.
    depth_m: f64,
    /// Depth that the edge really reaches, m.
    true_depth_m: f64,
    chip_area_m2: f64,
    forces: EdgeForces,
}

impl Chamfer {
    pub fn new(parameters: ChamferParameters, theory: Option<SlipTheory>) -> Self {
        let schedule = parameters.cut.schedule;
        let angles: Vec<f64> = (0..schedule.edges)
            .map(|e| parameters.edge_angle_rad(e, 0.0))
            .collect();
        let pitch = TAU / schedule.edges as f64;
        // The pass before the first one: so deep that the first revolution, too, meets a full chip.
        let previous = |angle: f64| {
            let turned = (angle - parameters.cut.start_angle_rad).rem_euclid(TAU);
            let edge = ((turned / pitch) as usize).min(schedule.edges - 1);
            let ahead = (angle - parameters.cut.start_angle_rad).rem_euclid(pitch);
            let arrival = ahead / schedule.spindle_rad_s;
            parameters
                .previous_depth_m(edge, arrival, angle.sin_cos())
                .max(0.0)
        };
        let first = |edge: usize| parameters.depth_m(edge, 0.0, angles[edge].sin_cos());
        Self {
            parameters,
            theory,
            thickness_rim: (parameters.cut.regeneration != Regeneration::Off)
                .then(|| Rim::new(RIM_BINS, previous, &angles, first)),
            surface: Some(Rim::new(RIM_BINS, |_| 0.0, &angles, first)),
            foot: parameters.foot.map(Foot::new),
            slip_started_s: None,
            first_slip_s: None,
            path_m: 0.0,
            last: ChamferStep::default(),
            edge_states: StepCache::default(),
            spare: RefCell::default(),
        }
    }

    fn edges(&self, state: &ToolState) -> Vec<EdgeState> {
        let mut edges = self.spare.take();
        edges.clear();
        let all = 0..self.parameters.cut.schedule.edges;
        edges.extend(all.map(|index| self.edge(index, state)));
        edges
    }

    fn edge(&self, index: usize, state: &ToolState) -> EdgeState {
        let p = &self.parameters;
        let angle_rad = p.edge_angle_rad(index, state.time_s);
        let (sin, cos) = angle_rad.sin_cos();
        let nominal = p.depth_m(index, state.time_s, (sin, cos));
        // Backward the tool cuts the far rim while it is drawn back, so moving on along X takes it
        // out.
        let axial = -p.cut.direction.axial_sign() * state.tool.displacement_m.x;
        let outward = state.tool.displacement_m.y * cos + state.tool.displacement_m.z * sin;
        let radial = outward / p.cut.chip.tan();
        let depth_m = match p.cut.regeneration {
            Regeneration::Off => nominal,
            Regeneration::Axial => nominal + axial,
            Regeneration::Full => nominal + axial + radial,
        };
        let previous = match &self.thickness_rim {
            None => p.previous_depth_m(index, state.time_s, (sin, cos)),
            Some(rim) => rim.depth_at_m(angle_rad),
        };
        let chip_area_m2 = p.cut.chip.between_m2(depth_m, previous);
        let forces = self.edge_forces(depth_m, chip_area_m2);
        EdgeState {
            angle_rad,
            on_tool_n: forces.on_tool_towards_n((sin, cos), p.cut.direction.axial_sign()),
            depth_m,
            true_depth_m: nominal + axial + radial,
            chip_area_m2,
            forces,
        }
    }

    fn edge_forces(&self, depth_m: f64, chip_area_m2: f64) -> EdgeForces {
        let p = &self.parameters;
        let length = p.cut.chip.edge_length_m(depth_m);
        let sharp = p.cut.coefficients.forces_n(chip_area_m2, length);
        if p.effects.wear_per_m == 0.0 {
            return sharp;
        }
        sharp.times(1.0 + p.effects.wear_per_m * self.path_m)
    }

    fn note_slip(&mut self, time_s: f64) {
        let sliding = self.foot.as_ref().is_some_and(Foot::sliding);
        if !sliding {
            self.slip_started_s = None;
            return;
        }
        let started = *self.slip_started_s.get_or_insert(time_s);
        if self.first_slip_s.is_none() && time_s - started >= SLIP_EVENT_S {
            self.first_slip_s = Some(started);
        }
    }
}

impl Process for Chamfer {
    fn channels(&self) -> Vec<ChannelSpec> {
        quantity::channels(self.quantities())
    }

    fn evaluate(&self, state: &ToolState) -> Loads {
        let edges = self.edges(state);
        let force = edges.iter().map(|edge| edge.on_tool_n).sum();
        self.edge_states.set(state.time_s, edges);
        let mut loads = Loads::from(Wrench::force(Attachment::Tool, force));
        if let Some(foot) = &self.foot {
            foot.press(state, &mut loads);
        }
        loads
    }

    fn commit(&mut self, state: &ToolState, loads: &Loads, contacts: &ContactOutcomes, dt_s: f64) {
        let mut area = 0.0;
        let mut tangential = 0.0;
        // Edges know nothing of velocities: those of the loads are those of this state.
        let cached = self.edge_states.take(state.time_s);
        let edges = cached.unwrap_or_else(|| self.edges(state));
        for (index, edge) in edges.iter().enumerate() {
            area += edge.chip_area_m2;
            tangential += edge.forces.tangential_n;
            if let Some(rim) = &mut self.thickness_rim {
                rim.cut(index, edge.angle_rad, edge.depth_m);
            }
            if let Some(surface) = &mut self.surface {
                surface.cut(index, edge.angle_rad, edge.true_depth_m);
            }
            if index == 0 {
                self.last.engaged_depth_m = edge.depth_m;
                self.last.edge_angle_rad = edge.angle_rad;
            }
        }
        *self.spare.get_mut() = edges;
        if area > 0.0 {
            let p = &self.parameters;
            self.path_m += p.cut.hole_radius_m * p.cut.schedule.spindle_rad_s * dt_s;
        }
        self.last.chip_area_m2 = area;
        self.last.torque_n_m = tangential * self.parameters.cut.hole_radius_m;
        self.last.depth_m = self.parameters.cut.schedule.depth_cut_m(state.time_s);
        self.last.force_on_tool_n = loads.wrenches[0].force_n;
        if let (Some(foot), Some(outcome)) = (&mut self.foot, contacts.first()) {
            foot.commit(state.time_s, &state.foot, outcome);
        }
        self.note_slip(state.time_s);
    }

    fn record(&self, row: &mut Vec<f64>) {
        quantity::record(self.quantities(), row);
    }

    fn keep_rows_only(&mut self) {
        self.surface = None;
    }

    fn notes(&self) -> Vec<String> {
        let coefficients = &self.parameters.cut.coefficients;
        soft_note(coefficients).into_iter().collect()
    }

    fn finish(&mut self) -> Findings {
        let Some(mut surface) = self.surface.take() else {
            return Findings::default();
        };
        surface.finish();
        let width = self.width_profile(&surface);
        Findings {
            scalars: self.scalars(&surface, &width),
            profiles: vec![width],
            ..Findings::default()
        }
    }

    fn static_loads(&self) -> Loads {
        let preload = self.foot.as_ref().map(Foot::touch_down_wrench);
        preload.map_or_else(Loads::default, Loads::from)
    }

    fn tooth_period_s(&self) -> Option<f64> {
        Some(self.parameters.cut.schedule.tooth_period_s())
    }

    fn contact_stiffness(&self) -> Vec<ContactStiffness> {
        self.foot.iter().map(Foot::contact_stiffness).collect()
    }

    fn arrows(&self) -> Vec<(&'static str, Attachment, Vector3<f64>)> {
        let mut arrows = vec![("cutting", Attachment::Tool, self.last.force_on_tool_n)];
        if let Some(foot) = &self.foot {
            let f = foot.force_on_workpiece_n();
            arrows.push((
                "foot normal",
                Attachment::Foot,
                Vector3::new(-f.x, 0.0, 0.0),
            ));
            arrows.push((
                "foot friction",
                Attachment::Foot,
                Vector3::new(0.0, -f.y, -f.z),
            ));
        }
        arrows
    }
}
