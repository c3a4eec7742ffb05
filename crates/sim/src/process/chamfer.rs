//! Hole chamfering with an optional pressure foot.

use super::{ContactStiffness, Findings, Foot, FootParameters, Process, ToolState};
use crate::loads::{Attachment, ContactOutcomes, Loads, Wrench};
use nalgebra::Vector3;
use std::f64::consts::TAU;
use truecut_core::cutting::chamfer::{ChipArea, CuttingCoefficients, EdgeForces, FeedSchedule};
use truecut_core::cutting::rim::Rim;
use truecut_core::roughness;
use truecut_recording::{ChannelSpec, Profile, Scalar, Unit};

/// Bins around the rim: a quarter of a degree, 92 µm on a 42 mm hole.
const RIM_BINS: usize = 1440;

/// A stick or slip event lasts at least this long, s.
pub const SLIP_EVENT_S: f64 = 3e-3;

/// Which motion of the tool the chip thickness sees.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Regeneration {
    /// None: the nominal chip.
    Off,
    /// Axial motion, against the surface of the previous pass (`spec` 1.9).
    Axial,
    /// Axial and radial motion.
    Full,
}

/// All that a chamfering pass is made of.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ChamferParameters {
    pub schedule: FeedSchedule,
    pub chip: ChipArea,
    pub coefficients: CuttingCoefficients,
    /// +1 backward, -1 forward: sign of the axial cutting force on the tool.
    pub axial_sign: f64,
    /// Angle of the first edge at t = 0, from process Y towards Z, rad.
    pub start_angle_rad: f64,
    pub hole_radius_m: f64,
    pub regeneration: Regeneration,
    pub foot: Option<FootParameters>,
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
    /// Surface that the chip thickness is measured against.
    thickness_rim: Rim,
    /// Surface that is really there, radial motion included.
    surface: Rim,
    foot: Option<Foot>,
    slip_started_s: Option<f64>,
    first_slip_s: Option<f64>,
    last: Last,
}

#[derive(Debug, Clone, Copy, Default)]
struct Last {
    force_on_tool_n: Vector3<f64>,
    depth_m: f64,
    engaged_depth_m: f64,
    chip_area_m2: f64,
    edge_angle_rad: f64,
    torque_n_m: f64,
}

/// One edge at one instant.
struct EdgeState {
    angle_rad: f64,
    /// Depth that the chip is computed with, m.
    depth_m: f64,
    /// Depth that the edge really reaches, m.
    true_depth_m: f64,
    chip_area_m2: f64,
}

impl Chamfer {
    pub fn new(parameters: ChamferParameters, theory: Option<SlipTheory>) -> Self {
        let schedule = parameters.schedule;
        let angles: Vec<f64> = (0..schedule.edges)
            .map(|e| parameters.start_angle_rad + TAU * e as f64 / schedule.edges as f64)
            .collect();
        let pitch = TAU / schedule.edges as f64;
        // The pass before the first one: so deep that the first revolution, too, meets a full chip.
        let previous = |angle: f64| {
            let ahead = (angle - parameters.start_angle_rad).rem_euclid(pitch);
            let arrival = ahead / schedule.spindle_rad_s;
            schedule
                .edge_depth_m(arrival - schedule.tooth_period_s())
                .max(0.0)
        };
        let first_depth = schedule.edge_depth_m(0.0);
        Self {
            parameters,
            theory,
            thickness_rim: Rim::new(RIM_BINS, previous, &angles, first_depth),
            surface: Rim::new(RIM_BINS, |_| 0.0, &angles, first_depth),
            foot: parameters.foot.map(Foot::new),
            slip_started_s: None,
            first_slip_s: None,
            last: Last::default(),
        }
    }

    fn edge(&self, index: usize, state: &ToolState) -> EdgeState {
        let p = &self.parameters;
        let schedule = &p.schedule;
        let angle_rad = p.start_angle_rad
            + schedule.spindle_rad_s * state.time_s
            + TAU * index as f64 / schedule.edges as f64;
        let (sin, cos) = angle_rad.sin_cos();
        let nominal = schedule.edge_depth_m(state.time_s);
        // Backward the tool cuts the far rim while it is drawn back, so moving on along X takes it out.
        let axial = -p.axial_sign * state.tool.displacement_m.x;
        let outward = state.tool.displacement_m.y * cos + state.tool.displacement_m.z * sin;
        let radial = outward / p.chip.half_angle_rad.tan();
        let depth_m = match p.regeneration {
            Regeneration::Off => nominal,
            Regeneration::Axial => nominal + axial,
            Regeneration::Full => nominal + axial + radial,
        };
        let previous = match p.regeneration {
            Regeneration::Off => schedule.edge_depth_m(state.time_s - schedule.tooth_period_s()),
            _ => self.thickness_rim.depth_at_m(angle_rad),
        };
        EdgeState {
            angle_rad,
            depth_m,
            true_depth_m: nominal + axial + radial,
            chip_area_m2: p.chip.between_m2(depth_m, previous),
        }
    }

    fn edge_forces(&self, edge: &EdgeState) -> EdgeForces {
        let p = &self.parameters;
        let length = p.chip.edge_length_m(edge.depth_m);
        p.coefficients.forces_n(edge.chip_area_m2, length)
    }

    fn edge_force_n(&self, edge: &EdgeState) -> Vector3<f64> {
        self.edge_forces(edge)
            .on_tool_n(edge.angle_rad, self.parameters.axial_sign)
    }

    /// Volume of the chamfer: at each angle a triangle of legs `d` and `d tanθ` that is swept along the rim
    /// at the radius of its centroid, m³.
    fn removed_volume_m3(&self) -> f64 {
        let p = &self.parameters;
        let tan = p.chip.half_angle_rad.tan();
        let step = TAU / self.surface.bins() as f64;
        (self.surface.depths_m().iter())
            .map(|d| 0.5 * d * d * tan * (p.hole_radius_m + d * tan / 3.0) * step)
            .sum()
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

    fn width_profile(&self) -> Profile {
        let tan = self.parameters.chip.half_angle_rad.tan();
        Profile {
            name: "chamfer.width".into(),
            description: "Radial width of the finished chamfer around the rim".into(),
            axis_name: "rim_angle".into(),
            axis_unit: Unit::Radian,
            axis: (0..self.surface.bins())
                .map(|i| self.surface.angle_rad(i))
                .collect(),
            unit: Unit::Metre,
            values: self.surface.depths_m().iter().map(|d| d * tan).collect(),
        }
    }

    fn scalars(&self, width: &Profile) -> Vec<Scalar> {
        let metre =
            |name: &str, value: f64, text: &str| Scalar::new(name, Unit::Metre, value, text);
        let values = &width.values;
        let mean = values.iter().sum::<f64>() / values.len() as f64;
        let low = values.iter().copied().fold(f64::INFINITY, f64::min);
        let to_normal = self.parameters.chip.half_angle_rad.cos();
        let slip_depth = self
            .first_slip_s
            .map_or(f64::NAN, |t| self.parameters.schedule.depth_cut_m(t));
        let mut scalars = vec![
            metre(
                "chamfer.width_mean",
                mean,
                "Mean radial width of the chamfer",
            ),
            metre("chamfer.width_min", low, "Smallest width around the rim"),
            metre(
                "chamfer.width_max",
                low + roughness::spread(values),
                "Largest width around the rim",
            ),
            metre(
                "chamfer.width_spread",
                roughness::spread(values),
                "Largest minus smallest width around the rim",
            ),
            metre(
                "chamfer.vibration_roughness",
                roughness::arithmetic_mean_deviation(values) * to_normal,
                "Ra that vibration leaves: mean deviation of the surface, along its normal, around the rim",
            ),
        ];
        scalars.push(Scalar::new(
            "chamfer.removed_volume",
            Unit::CubicMetre,
            self.removed_volume_m3(),
            "Volume of the finished chamfer",
        ));
        if self.foot.is_some() {
            scalars.push(metre(
                "chamfer.first_slip_depth",
                slip_depth,
                "Depth already cut when the foot first slipped for 3 ms or more",
            ));
        }
        scalars.extend(self.theory.iter().flat_map(theory_scalars));
        scalars
    }
}

fn theory_scalars(theory: &SlipTheory) -> Vec<Scalar> {
    let pascal = |name: &str, value: f64, text: &str| Scalar::new(name, Unit::Pascal, value, text);
    vec![
        pascal(
            "theory.paper_threshold_pressure",
            theory.paper_threshold_pa,
            "Foot pressure that source A's eq. (27) asks for at the last tooth (backward feed only; 0: none needed)",
        ),
        pascal(
            "theory.exact_threshold_pressure",
            theory.exact_threshold_pa,
            "Foot pressure at which friction balances the rotating force at the last tooth, in the plane; no regeneration",
        ),
        pascal(
            "theory.general_threshold_pressure",
            theory.general_threshold_pa,
            "The same with the lateral force that the arm's axial load puts on the foot; no regeneration",
        ),
        Scalar::new(
            "theory.slip_depth",
            Unit::Metre,
            theory.slip_depth_m,
            "Depth already cut at which the general condition is first broken; no regeneration",
        ),
        Scalar::new(
            "theory.axial_share",
            Unit::One,
            theory.axial_share,
            "Share of the axial force that the foot carries while its seals hold",
        ),
        Scalar::new(
            "theory.lateral_per_axial",
            Unit::One,
            theory.lateral_per_axial,
            "Lateral force on a held foot per newton of axial force in the arm",
        ),
    ]
}

impl Process for Chamfer {
    fn channels(&self) -> Vec<ChannelSpec> {
        let newton = |name: &str, text: &str| ChannelSpec::new(name, Unit::Newton, text);
        let mut channels = vec![
            newton("cutting.force_x", "Cutting force on the tool, process X"),
            newton("cutting.force_y", "Cutting force on the tool, process Y"),
            newton("cutting.force_z", "Cutting force on the tool, process Z"),
            ChannelSpec::new(
                "cutting.depth",
                Unit::Metre,
                "Depth already cut by the feed, D(t)",
            ),
            ChannelSpec::new(
                "cutting.engaged_depth",
                Unit::Metre,
                "Depth of the first edge, vibration included",
            ),
            ChannelSpec::new(
                "cutting.chip_area",
                Unit::SquareMetre,
                "Chip area of all edges",
            ),
            ChannelSpec::new(
                "cutting.edge_angle",
                Unit::Radian,
                "Angle of the first edge, from process Y towards Z",
            ),
            ChannelSpec::new(
                "cutting.torque",
                Unit::NewtonMetre,
                "Torque of all edges about the spindle, at the rim of the hole",
            ),
            newton(
                "dynamometer.force_x",
                "Axial force on the workpiece: cutting and foot",
            ),
            newton(
                "dynamometer.force_y",
                "Force on the workpiece, process Y: cutting and foot friction",
            ),
            newton(
                "dynamometer.force_z",
                "Force on the workpiece, process Z: cutting and foot friction",
            ),
        ];
        if self.foot.is_some() {
            channels.extend(Foot::channels());
        }
        channels
    }

    fn evaluate(&self, state: &ToolState) -> Loads {
        let mut loads = Loads::default();
        let force = (0..self.parameters.schedule.edges)
            .map(|e| self.edge_force_n(&self.edge(e, state)))
            .sum();
        loads.wrenches.push(Wrench::force(Attachment::Tool, force));
        if let Some(foot) = &self.foot {
            let (wrench, contact) = foot.evaluate(&state.foot);
            loads.wrenches.push(wrench);
            loads.contacts.push(contact);
        }
        loads
    }

    fn commit(&mut self, state: &ToolState, loads: &Loads, contacts: &ContactOutcomes, _dt: f64) {
        let mut area = 0.0;
        let mut tangential = 0.0;
        for index in 0..self.parameters.schedule.edges {
            let edge = self.edge(index, state);
            area += edge.chip_area_m2;
            tangential += self.edge_forces(&edge).tangential_n;
            self.thickness_rim.cut(index, edge.angle_rad, edge.depth_m);
            self.surface.cut(index, edge.angle_rad, edge.true_depth_m);
            if index == 0 {
                self.last.engaged_depth_m = edge.depth_m;
                self.last.edge_angle_rad = edge.angle_rad.rem_euclid(TAU);
            }
        }
        self.last.chip_area_m2 = area;
        self.last.torque_n_m = tangential * self.parameters.hole_radius_m;
        self.last.depth_m = self.parameters.schedule.depth_cut_m(state.time_s);
        self.last.force_on_tool_n = loads.wrenches[0].force_n;
        if let (Some(foot), Some(outcome)) = (&mut self.foot, contacts.first()) {
            foot.commit(state.time_s, &state.foot, outcome);
        }
        self.note_slip(state.time_s);
    }

    fn record(&self, row: &mut Vec<f64>) {
        let cutting = self.last.force_on_tool_n;
        let foot = self
            .foot
            .as_ref()
            .map_or_else(Vector3::zeros, Foot::force_on_workpiece_n);
        let dynamometer = foot - cutting;
        row.extend(cutting.iter());
        row.extend([
            self.last.depth_m,
            self.last.engaged_depth_m,
            self.last.chip_area_m2,
            self.last.edge_angle_rad,
            self.last.torque_n_m,
        ]);
        row.extend(dynamometer.iter());
        if let Some(foot) = &self.foot {
            foot.record(row);
        }
    }

    fn finish(&mut self) -> Findings {
        self.surface.finish();
        let width = self.width_profile();
        Findings {
            scalars: self.scalars(&width),
            profiles: vec![width],
        }
    }

    fn static_loads(&self) -> Loads {
        let mut loads = Loads::default();
        loads
            .wrenches
            .extend(self.foot.iter().map(Foot::touch_down_wrench));
        loads
    }

    fn duration_s(&self) -> Option<f64> {
        Some(self.parameters.schedule.duration_s())
    }

    fn tooth_period_s(&self) -> Option<f64> {
        Some(self.parameters.schedule.tooth_period_s())
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
