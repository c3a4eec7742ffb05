//! The `[process.chamfer]` table: a rotating tool with straight edges cuts the rim of a hole.

use std::f64::consts::TAU;

use schemars::JsonSchema;
use serde::Deserialize;

use crate::check::Check;
use crate::document::Fault;
use crate::foot::{FootSpec, FootTable};
use crate::units::{from_deg, from_mm, from_mpa, from_n_per_mm, from_rpm};

/// Chamfering the rim of a hole, with or without a pressure foot.
#[derive(Debug, Clone, PartialEq)]
pub struct ChamferSpec {
    /// Which side of the plate is cut, and so which way the feed goes.
    pub direction: FeedDirection,
    /// Spindle speed.
    pub spindle_rad_s: f64,
    /// Feed per revolution of the spindle.
    pub feed_m_per_rev: f64,
    /// Feed depth at the end of the ramp, measured along the spindle axis.
    pub depth_m: f64,
    /// Angle between the cutting edge and the spindle axis, in (0, π/2).
    pub half_angle_rad: f64,
    /// Diameter of the hole before chamfering.
    pub hole_diameter_m: f64,
    /// Number of equally spaced cutting edges.
    pub edges: u32,
    /// Angle of the first edge at the start, from process Y towards process Z.
    pub start_angle_rad: f64,
    /// Revolutions at full depth after the ramp.
    pub dwell_revolutions: f64,
    /// Which vibrations change the chip.
    pub regeneration: Regeneration,
    /// Cutting force coefficients.
    pub cutting: CuttingSpec,
    /// Pressure foot; `None` means that there is none.
    pub foot: Option<FootSpec>,
}

/// Which way the feed goes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum FeedDirection {
    /// The tool is pushed away from the robot, into the near rim; the axial force unloads the foot.
    Forward,
    /// The tool is pulled towards the robot, into the far rim; the axial force loads the foot.
    Backward,
}

/// Which vibrations change the chip.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Regeneration {
    /// None: the chip is that of a rigid machine.
    Off,
    /// Axial vibration, against the surface that the previous revolution left.
    #[default]
    Axial,
    /// Axial and radial vibration, against the rim that the previous revolution left.
    Full,
}

/// Cutting force coefficients of the chamfering edge.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CuttingSpec {
    /// Axial force per chip area, K_fc.
    pub axial_pa: f64,
    /// Force in the plane across the spindle per chip area, K_rt = √(K_rc² + K_tc²).
    pub in_plane_pa: f64,
    /// Angle β = atan(K_rc/K_tc) between the in-plane force and the tangent.
    pub in_plane_angle_rad: f64,
    /// Axial edge force per length of engaged edge.
    pub edge_axial_n_per_m: f64,
    /// Radial edge force per length of engaged edge.
    pub edge_radial_n_per_m: f64,
    /// Tangential edge force per length of engaged edge.
    pub edge_tangential_n_per_m: f64,
}

impl ChamferSpec {
    /// Time of one revolution of the spindle.
    pub fn revolution_s(&self) -> f64 {
        TAU / self.spindle_rad_s
    }

    /// Feed speed along the spindle axis, as a magnitude.
    pub fn feed_m_per_s(&self) -> f64 {
        self.feed_m_per_rev / self.revolution_s()
    }

    /// Time of the ramp: the first edge starts one feed per tooth deep and ends at the full depth.
    pub fn ramp_s(&self) -> f64 {
        (self.depth_m - self.feed_per_tooth_m()) / self.feed_m_per_s()
    }

    /// Feed per tooth, m.
    pub fn feed_per_tooth_m(&self) -> f64 {
        self.feed_m_per_rev / f64::from(self.edges)
    }

    /// Time of the ramp and of the dwell after it.
    pub fn cycle_s(&self) -> f64 {
        self.ramp_s() + self.dwell_revolutions * self.revolution_s()
    }
}

/// Chamfering the rim of a hole.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct ChamferTable {
    /// Forward: towards the workpiece, near rim. Backward: towards the robot, far rim.
    direction: FeedDirection,
    /// Spindle speed.
    #[schemars(extend("exclusiveMinimum" = 0.0, "x-rule" = "the spindle turns"))]
    spindle_rpm: f64,
    /// Feed per revolution of the spindle.
    #[schemars(extend("exclusiveMinimum" = 0.0, "x-rule" = "without feed there is no chip"))]
    feed_mm_per_rev: f64,
    /// Feed depth at the end of the ramp, along the spindle axis.
    #[schemars(extend("exclusiveMinimum" = 0.0, "x-rule" = "a chamfer has a depth"))]
    depth_mm: f64,
    /// Angle between the cutting edge and the spindle axis.
    #[schemars(extend(
        "exclusiveMinimum" = 0.0,
        "exclusiveMaximum" = 90.0,
        "x-rule" = "at 0 the edge is parallel to the spindle, at 90 it is across it"
    ))]
    half_angle_deg: f64,
    /// Diameter of the hole before chamfering.
    #[schemars(extend("exclusiveMinimum" = 0.0, "x-rule" = "a hole has a diameter"))]
    hole_diameter_mm: f64,
    /// Number of equally spaced cutting edges. Default: 1.
    #[schemars(range(min = 1, max = 64), extend("x-rule" = "a tool has 1 to 64 edges"))]
    edges: Option<u32>,
    /// Angle of the first edge at the start, from process Y towards process Z. Default: 0.
    start_angle_deg: Option<f64>,
    /// Revolutions at full depth after the ramp. Default: 2.
    #[schemars(extend("minimum" = 0.0, "x-rule" = "time runs forward"))]
    dwell_revolutions: Option<f64>,
    /// Which vibrations change the chip. Default: "axial".
    regeneration: Option<Regeneration>,
    /// Cutting force coefficients.
    cutting: CuttingTable,
    /// Pressure foot. Default: no foot.
    foot: Option<FootTable>,
}

/// Cutting force coefficients.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct CuttingTable {
    /// Axial force per chip area.
    #[schemars(extend("minimum" = 0.0, "x-rule" = "cutting resists the feed"))]
    axial_mpa: f64,
    /// In-plane force per chip area.
    #[schemars(extend("minimum" = 0.0, "x-rule" = "cutting resists the rotation"))]
    in_plane_mpa: f64,
    /// Angle between the in-plane force and the tangent. Default: 0.
    #[schemars(
        range(min = -90.0, max = 90.0),
        extend("x-rule" = "the tangential force opposes the rotation")
    )]
    in_plane_angle_deg: Option<f64>,
    /// Axial edge force per length of engaged edge. Default: 0.
    #[schemars(extend("minimum" = 0.0, "x-rule" = "an edge is pushed off, never drawn in"))]
    edge_axial_n_per_mm: Option<f64>,
    /// Radial edge force per length of engaged edge. Default: 0.
    #[schemars(extend("minimum" = 0.0, "x-rule" = "an edge is pushed off, never drawn in"))]
    edge_radial_n_per_mm: Option<f64>,
    /// Tangential edge force per length of engaged edge. Default: 0.
    #[schemars(extend("minimum" = 0.0, "x-rule" = "cutting resists the rotation"))]
    edge_tangential_n_per_mm: Option<f64>,
}

/// Revolutions at full depth where a scenario does not give them: one to finish, one to measure.
const DEFAULT_DWELL_REVOLUTIONS: f64 = 2.0;

impl ChamferTable {
    pub(crate) fn resolve(self, check: &mut Check) -> ChamferSpec {
        if check.document().has("run.duration_s") {
            let because = "run.duration_s already says when the run ends";
            check.ignored("process.chamfer", &["dwell_revolutions"], because);
        }
        let edges = self.edges.unwrap_or(1);
        let feed_per_tooth_mm = self.feed_mm_per_rev / f64::from(edges);
        if self.depth_mm <= feed_per_tooth_mm {
            let path = "process.chamfer.depth_mm";
            let message = format!(
                "`{path}` is {}, but must be greater than the feed per tooth of {feed_per_tooth_mm} mm: \
                 the first edge already cuts that deep",
                self.depth_mm
            );
            check.refuse(Fault::value(path, message, "reached at the first touch"));
        }
        let cutting = &self.cutting;
        ChamferSpec {
            direction: self.direction,
            spindle_rad_s: from_rpm(self.spindle_rpm),
            feed_m_per_rev: from_mm(self.feed_mm_per_rev),
            depth_m: from_mm(self.depth_mm),
            half_angle_rad: from_deg(self.half_angle_deg),
            hole_diameter_m: from_mm(self.hole_diameter_mm),
            edges,
            start_angle_rad: from_deg(self.start_angle_deg.unwrap_or(0.0)),
            dwell_revolutions: self.dwell_revolutions.unwrap_or(DEFAULT_DWELL_REVOLUTIONS),
            regeneration: self.regeneration.unwrap_or_default(),
            cutting: CuttingSpec {
                axial_pa: from_mpa(cutting.axial_mpa),
                in_plane_pa: from_mpa(cutting.in_plane_mpa),
                in_plane_angle_rad: from_deg(cutting.in_plane_angle_deg.unwrap_or(0.0)),
                edge_axial_n_per_m: from_n_per_mm(cutting.edge_axial_n_per_mm.unwrap_or(0.0)),
                edge_radial_n_per_m: from_n_per_mm(cutting.edge_radial_n_per_mm.unwrap_or(0.0)),
                edge_tangential_n_per_m: from_n_per_mm(
                    cutting.edge_tangential_n_per_mm.unwrap_or(0.0),
                ),
            },
            foot: self
                .foot
                .map(|foot| foot.resolve("process.chamfer.foot", check)),
        }
    }
}
