//! The `[process.chamfer]` table: a rotating tool with straight edges cuts the rim of a hole.

use std::path::Path;

use schemars::JsonSchema;
use serde::Deserialize;
use truecut_core::cutting::chamfer::{ChipArea, CuttingCoefficients, FeedSchedule};

use crate::check::Check;
use crate::foot::{FootSpec, FootTable};
use crate::process::material::{Given, MaterialTable, one_of};
use crate::process::{Facts, Knob, ModesIn, Parts, PostureFrom, Room};
use crate::units::{from_deg, from_mm, from_mpa, from_n_per_mm, from_rpm};

/// Chamfering the rim of a hole, with or without a pressure foot.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ChamferSpec {
    /// Which side of the plate is cut, and so which way the feed goes.
    pub direction: FeedDirection,
    /// Spindle, feed, edges and depth.
    pub schedule: FeedSchedule,
    /// What an edge at its angle to the spindle axis takes off.
    pub chip: ChipArea,
    /// Radius of the hole before chamfering.
    pub hole_radius_m: f64,
    /// Angle of the first edge at the start, from process Y towards process Z.
    pub start_angle_rad: f64,
    /// Which vibrations change the chip.
    pub regeneration: Regeneration,
    /// Cutting force coefficients.
    pub coefficients: CuttingCoefficients,
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

impl FeedDirection {
    /// Sign of the axial cutting force on the tool along process X.
    pub fn axial_sign(self) -> f64 {
        match self {
            FeedDirection::Forward => -1.0,
            FeedDirection::Backward => 1.0,
        }
    }
}

impl ChamferSpec {
    /// Time of the ramp and of the dwell after it. The first edge starts one feed per tooth deep.
    pub fn cycle_s(&self) -> f64 {
        let schedule = &self.schedule;
        let revolution_s = schedule.revolution_s();
        let feed_m_per_s = schedule.feed_m_per_rev / revolution_s;
        let ramp_s = (schedule.depth_m - schedule.feed_per_tooth_m()) / feed_m_per_s;
        ramp_s + schedule.dwell_revolutions * revolution_s
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
    #[schemars(extend(
        "exclusiveMinimum" = 0.0,
        "maximum" = 1e3,
        "x-rule" = "a chamfer has a depth, no more than a metre"
    ))]
    depth_mm: f64,
    /// Angle between the cutting edge and the spindle axis.
    #[schemars(extend(
        "exclusiveMinimum" = 0.0,
        "exclusiveMaximum" = 90.0,
        "x-rule" = "at 0 the edge is parallel to the spindle, at 90 it is across it"
    ))]
    half_angle_deg: f64,
    /// Diameter of the hole before chamfering.
    #[schemars(extend(
        "minimum" = 0.1,
        "maximum" = 1e4,
        "x-rule" = "no hole that is chamfered is finer than a drill, or larger than a machine's bed"
    ))]
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
    /// Cutting force coefficients of milling, turned to the edge, from a file; or give
    /// [process.chamfer.cutting].
    material: Option<MaterialTable>,
    /// Cutting force coefficients; or give [process.chamfer.material].
    cutting: Option<CuttingTable>,
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

impl CuttingTable {
    fn resolve(&self) -> CuttingCoefficients {
        let edge = |n_per_mm: Option<f64>| from_n_per_mm(n_per_mm.unwrap_or(0.0));
        CuttingCoefficients {
            edge_axial_n_per_m: edge(self.edge_axial_n_per_mm),
            edge_radial_n_per_m: edge(self.edge_radial_n_per_mm),
            edge_tangential_n_per_m: edge(self.edge_tangential_n_per_mm),
            ..CuttingCoefficients::from_resultant(
                from_mpa(self.axial_mpa),
                from_mpa(self.in_plane_mpa),
                from_deg(self.in_plane_angle_deg.unwrap_or(0.0)),
            )
        }
    }
}

const TABLE: &str = "process.chamfer";

/// Revolutions at full depth where a scenario does not give them: one to finish, one to measure.
const DEFAULT_DWELL_REVOLUTIONS: f64 = 2.0;

impl ChamferTable {
    /// `None` after recording a fault.
    pub(crate) fn resolve(self, folder: &Path, check: &mut Check) -> Option<ChamferSpec> {
        if check.document().has("run.duration_s") {
            let because = "run.duration_s already says when the run ends";
            check.ignored("process.chamfer", &["dwell_revolutions"], because);
        }
        let edges = self.edges.unwrap_or(1);
        let feed_per_tooth_mm = self.feed_mm_per_rev / f64::from(edges);
        if self.depth_mm <= feed_per_tooth_mm {
            let message = format!(
                "is {}, but must be greater than the feed per tooth of {feed_per_tooth_mm} mm: \
                 the first edge already cuts that deep",
                self.depth_mm
            );
            let label = "reached at the first touch";
            check.wrong("process.chamfer", "depth_mm", message, label);
        }
        let hole_radius_m = from_mm(self.hole_diameter_mm) / 2.0;
        check.rim(TABLE, "spindle_rpm", self.spindle_rpm, hole_radius_m);
        let spindle_rad_s = from_rpm(self.spindle_rpm);
        let half_angle_rad = from_deg(self.half_angle_deg);
        let coefficients = match one_of(TABLE, self.material, self.cutting, check)? {
            Given::Material(material) => {
                let numbers = material.read(TABLE, folder, check)?;
                numbers.coefficients().of_straight_edge(half_angle_rad)
            }
            Given::Cutting(cutting) => cutting.resolve(),
        };
        Some(ChamferSpec {
            direction: self.direction,
            schedule: FeedSchedule {
                spindle_rad_s,
                feed_m_per_rev: from_mm(self.feed_mm_per_rev),
                edges: edges as usize,
                depth_m: from_mm(self.depth_mm),
                dwell_revolutions: self.dwell_revolutions.unwrap_or(DEFAULT_DWELL_REVOLUTIONS),
            },
            chip: ChipArea::new(half_angle_rad),
            hole_radius_m,
            start_angle_rad: from_deg(self.start_angle_deg.unwrap_or(0.0)),
            regeneration: self.regeneration.unwrap_or_default(),
            coefficients,
            foot: self
                .foot
                .map(|foot| foot.resolve("process.chamfer.foot", spindle_rad_s, check)),
        })
    }
}

/// What a person could change at the machine.
const KNOBS: &[Knob] = &[
    Knob::new("process.chamfer.spindle_rpm", "spindle speed", &[0.6, 1.6]),
    Knob::new(
        "process.chamfer.feed_mm_per_rev",
        "feed per revolution",
        &[0.5, 2.0],
    ),
    Knob::new("process.chamfer.depth_mm", "depth", &[0.5, 1.5]),
    Knob::new(
        "process.chamfer.foot.pressure_mpa",
        "foot pressure",
        &[0.6, 1.5],
    ),
];

impl Room for ChamferSpec {
    type Table = ChamferTable;

    fn resolve(table: ChamferTable, folder: &Path, check: &mut Check) -> Option<Self> {
        table.resolve(folder, check)
    }

    fn facts(&self) -> Facts {
        Facts {
            rate_rad_s: Some(self.schedule.spindle_rad_s),
            natural_duration_s: Some(self.cycle_s()),
            signals: &["cutting.depth", "foot.normal_force", "tool.displacement_x"],
            knobs: KNOBS,
            files: &["material.file"],
            needs_drive: Some("chamfer"),
            needs_robot: true,
            modes: ModesIn::Scenario,
            replays: false,
            posture: PostureFrom::Scenario,
            parts: Parts {
                edges: Some(self.schedule.edges),
                foot: self.foot,
                ..Parts::NONE
            },
        }
    }
}
