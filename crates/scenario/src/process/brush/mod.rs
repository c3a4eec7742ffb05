//! The `[process.brush]` table: a wheel brush deburrs edges of a mesh, led by taught postures,
//! along a path from a file, or along the edges themselves.

mod along;
mod edge;

use std::path::{Path, PathBuf};

use nalgebra::Isometry3;
use schemars::JsonSchema;
use serde::Deserialize;
use truecut_core::wheel::brush::Brush;
use truecut_plan::path_file::PathFile;
use truecut_plan::surface::MeshFile;

pub use along::AlongEdges;
pub use edge::{EdgePlace, EdgeSpec};

use crate::check::Check;
use crate::fault::Fault;
use crate::process::path_file::PathFileTable;
use crate::process::{Facts, Knob, ModesIn, Parts, PostureFrom, Room, WheelHold, WheelPart};
use crate::robot::RobotSpec;
use crate::units::{from_mm, from_mpa, from_rpm};

/// Brushing of edges. The brush's centre is the tool frame's origin, its axis the frame's y.
#[derive(Debug, Clone, PartialEq)]
pub struct BrushSpec {
    /// What leads it.
    pub way: BrushWay,
    /// Brush and bristles.
    pub brush: Brush,
    /// Right-handed about the tool's y axis.
    pub spin_rad_s: f64,
    /// Preston coefficient: removed depth per pressure and sliding distance.
    pub preston_per_pa: f64,
    /// Largest distance of the places on an edge for which its state is kept.
    pub station_m: f64,
    /// The workpiece.
    pub workpiece: MeshFile,
    /// Where its frame stands in the world.
    pub world_from_mesh: Isometry3<f64>,
    /// By how much faces turn, at least, where an edge is picked, and an edge, where it ends.
    pub crease_rad: f64,
    /// Edges that are deburred.
    pub edges: Vec<EdgeSpec>,
}

/// What leads a brush.
#[derive(Debug, Clone, PartialEq)]
pub enum BrushWay {
    /// Taught postures.
    Taught {
        /// CSV file of the postures.
        file: PathBuf,
        /// Speed of the tool from posture to posture.
        feed_m_per_s: f64,
        /// Top speed of joints on the way, share of their limits.
        joint_share: f64,
    },
    /// A path from CAM, or a robot program.
    Path(PathFile),
    /// A way that is laid along the edges, one after the other.
    Along(AlongEdges),
}

/// Brushing of edges by taught postures.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct BrushTable {
    /// CSV file of taught postures with a column j1, j2, … for each joint (degrees; mm for
    /// prismatic joints), relative to this file. The arm starts in the first one and ends in the
    /// last one. Or give [process.brush.path].
    taught: Option<String>,
    /// Path from a file in their place.
    path: Option<PathFileTable>,
    /// In the place of both: the way is laid along the edges, in their order.
    along: Option<along::AlongTable>,
    /// Speed of the tool from posture to posture (with taught).
    #[schemars(extend("exclusiveMinimum" = 0.0, "x-rule" = "the brush is fed along the edge"))]
    feed_mm_per_s: Option<f64>,
    /// Top speed of joints on the way, a fraction of their limits (with taught). Default: 0.25.
    #[schemars(extend("exclusiveMinimum" = 0.0, "maximum" = 1.0, "x-rule" = "a fraction of the top speed"))]
    joint_speed: Option<f64>,
    /// Radius to the tips of the bristles.
    #[schemars(extend("exclusiveMinimum" = 0.0, "x-rule" = "a brush has a radius"))]
    radius_mm: f64,
    /// Width.
    #[schemars(extend("exclusiveMinimum" = 0.0, "x-rule" = "a brush has a width"))]
    width_mm: f64,
    /// Speed of rotation, right-handed about the tool's y axis.
    speed_rpm: f64,
    /// Number of bristles.
    #[schemars(range(min = 1, max = 10_000_000), extend("x-rule" = "1 to 10000000 bristles"))]
    bristles: u32,
    /// Diameter of a bristle.
    #[schemars(extend("exclusiveMinimum" = 0.0, "x-rule" = "a bristle has a diameter"))]
    bristle_diameter_mm: f64,
    /// Length of a bristle from hub to tip.
    #[schemars(extend("exclusiveMinimum" = 0.0, "x-rule" = "bristles stand out of the hub"))]
    free_length_mm: f64,
    /// Young's modulus of the wire.
    #[schemars(extend("exclusiveMinimum" = 0.0, "x-rule" = "bristles are elastic"))]
    youngs_modulus_mpa: f64,
    /// Coefficient of friction of the tips.
    #[schemars(extend("minimum" = 0.0, "x-rule" = "friction opposes sliding"))]
    mu: f64,
    /// Preston coefficient.
    #[schemars(extend(
        "minimum" = 0.0,
        "maximum" = 1e-6,
        "x-rule" = "brushing removes material, less than a metre of it on a metre's way under 1 MPa"
    ))]
    preston_per_pa: f64,
    /// Largest distance of the places on an edge for which its state is kept. Default: 1.
    #[schemars(extend("exclusiveMinimum" = 0.0, "x-rule" = "places get on along the edge"))]
    station_mm: Option<f64>,
    /// The workpiece.
    workpiece: edge::WorkpieceTable,
    /// Edges that are deburred.
    #[schemars(length(min = 1), extend("x-rule" = "a brush deburrs one edge at least"))]
    edge: Vec<edge::EdgeTable>,
}

const TABLE: &str = "process.brush";
/// Where a scenario does not say, of the joints' top speed.
const DEFAULT_JOINT_SHARE: f64 = 0.25;
/// Where a scenario does not give a distance of places on an edge, mm.
const DEFAULT_STATION_MM: f64 = 1.0;
/// Part of the hub's surface that round bristles cover where they touch one another.
const CLOSEST_PACKING: f64 = 0.9069;

impl BrushTable {
    /// `None` after recording a fault. `folder` is that of the scenario file.
    pub(crate) fn resolve(mut self, folder: &Path, check: &mut Check) -> Option<BrushSpec> {
        let faults = [
            self.still(),
            self.no_hub(),
            self.too_dense(),
            self.too_far_apart(),
        ];
        let is_sound = faults.iter().all(Option::is_none);
        (faults.into_iter().flatten()).for_each(|fault| check.refuse(fault));
        check.rim(TABLE, "speed_rpm", self.speed_rpm, from_mm(self.radius_mm));
        let way = self.way(folder, check);
        let laid = matches!(way, Some(BrushWay::Along(_)));
        let edges: Vec<Option<EdgeSpec>> = (self.edge.into_iter().enumerate())
            .map(|(index, edge)| edge.resolve(index, laid, check))
            .collect();
        is_sound.then_some(())?;
        let edges = edges.into_iter().collect::<Option<Vec<_>>>()?;
        let (workpiece, world_from_mesh, crease_rad) =
            self.workpiece.resolve(&edges, folder, check);
        Some(BrushSpec {
            way: way?,
            brush: Brush {
                radius_m: from_mm(self.radius_mm),
                width_m: from_mm(self.width_mm),
                bristles: f64::from(self.bristles),
                bristle_diameter_m: from_mm(self.bristle_diameter_mm),
                free_length_m: from_mm(self.free_length_mm),
                youngs_modulus_pa: from_mpa(self.youngs_modulus_mpa),
                mu: self.mu,
            },
            spin_rad_s: from_rpm(self.speed_rpm),
            preston_per_pa: self.preston_per_pa,
            station_m: from_mm(self.station_mm.unwrap_or(DEFAULT_STATION_MM)),
            world_from_mesh,
            workpiece,
            crease_rad,
            edges,
        })
    }

    /// `None` after recording a fault.
    fn way(&mut self, folder: &Path, check: &mut Check) -> Option<BrushWay> {
        if let Some(along) = self.along.take() {
            let because = "[process.brush.along] gives the way, its speeds and its joints' share";
            let keys = ["taught", "path", "feed_mm_per_s", "joint_speed"];
            check.ignored(TABLE, &keys, because);
            let brush = (self.radius_mm, self.width_mm, self.free_length_mm);
            return Some(BrushWay::Along(along.resolve(brush, check)?));
        }
        if let Some(path) = self.path.take() {
            let because = "[process.brush.path] gives the way, its speeds and its joints' share";
            let keys = ["taught", "feed_mm_per_s", "joint_speed"];
            check.ignored(TABLE, &keys, because);
            let path = path.resolve("process.brush.path", folder, check)?;
            return Some(BrushWay::Path(path));
        }
        let who = "a brush without [process.brush.path] or [process.brush.along]";
        let taught = check.needed(TABLE, "taught", self.taught.take(), who);
        let feed = check.needed(TABLE, "feed_mm_per_s", self.feed_mm_per_s, who);
        Some(BrushWay::Taught {
            file: folder.join(taught?),
            feed_m_per_s: from_mm(feed?),
            joint_share: self.joint_speed.unwrap_or(DEFAULT_JOINT_SHARE),
        })
    }

    fn still(&self) -> Option<Fault> {
        let path = format!("{TABLE}.speed_rpm");
        let message = format!(
            "`{path}` is 0, but must not be: a brush that stands still only rubs by the feed"
        );
        (self.speed_rpm == 0.0).then(|| Fault::value(&path, message, "does not turn"))
    }

    fn too_far_apart(&self) -> Option<Fault> {
        let station_mm = self.station_mm?;
        let path = format!("{TABLE}.station_mm");
        let message = format!(
            "`{path}` is {station_mm}, but must be at most `{TABLE}.width_mm`, {} mm: the brush would miss what is between",
            self.width_mm
        );
        (station_mm > self.width_mm).then(|| Fault::value(&path, message, "wider than the brush"))
    }

    fn no_hub(&self) -> Option<Fault> {
        let path = format!("{TABLE}.free_length_mm");
        let message = format!(
            "`{path}` is {}, but must be below `{TABLE}.radius_mm`, {} mm: bristles stand on a hub",
            self.free_length_mm, self.radius_mm
        );
        (self.free_length_mm >= self.radius_mm)
            .then(|| Fault::value(&path, message, "leaves no hub"))
    }

    fn too_dense(&self) -> Option<Fault> {
        let hub_mm2 =
            std::f64::consts::TAU * (self.radius_mm - self.free_length_mm) * self.width_mm;
        let each_mm2 = std::f64::consts::FRAC_PI_4 * self.bristle_diameter_mm.powi(2);
        let most = CLOSEST_PACKING * hub_mm2 / each_mm2;
        if hub_mm2 <= 0.0 || f64::from(self.bristles) <= most {
            return None;
        }
        let path = format!("{TABLE}.bristles");
        let message = format!(
            "`{path}` is {}, but must be at most {most:.0}: round bristles of {} mm cover at most {CLOSEST_PACKING} of a hub {} mm wide with a radius of {} mm",
            self.bristles,
            self.bristle_diameter_mm,
            self.width_mm,
            self.radius_mm - self.free_length_mm
        );
        Some(Fault::value(&path, message, "do not fit on the hub"))
    }
}

/// By such a part of their length bristles are typically pressed in.
const TYPICAL_INDENTATION: f64 = 0.05;

/// What a person could change at the machine.
const KNOBS: &[Knob] = &[
    Knob::new("process.brush.speed_rpm", "brush speed", &[0.6, 1.6]),
    Knob::new("process.brush.feed_mm_per_s", "feed", &[0.5, 2.0]),
    Knob::new("process.brush.along.feed_mm_per_s", "feed", &[0.5, 2.0]),
];

impl Room for BrushSpec {
    type Table = BrushTable;

    fn resolve(table: BrushTable, folder: &Path, check: &mut Check) -> Option<Self> {
        table.resolve(folder, check)
    }

    fn facts(&self) -> Facts {
        Facts {
            rate_rad_s: Some(self.spin_rad_s.abs()).filter(|rate| *rate > 0.0),
            natural_duration_s: Some(f64::INFINITY),
            signals: &[
                "brush.bristle_force",
                "brush.shortening",
                "brush.contact_length",
                "tool.displacement_x",
            ],
            knobs: KNOBS,
            files: &["taught", "path.file", "workpiece.mesh"],
            needs_drive: Some("brush"),
            needs_robot: true,
            modes: ModesIn::Scenario,
            replays: false,
            posture: match self.way {
                BrushWay::Taught { .. } => PostureFrom::Taught,
                BrushWay::Path(_) | BrushWay::Along(_) => PostureFrom::Path,
            },
            parts: Parts {
                wheel: Some(WheelPart {
                    hold: WheelHold::Path,
                    shows_removal: true,
                    turns: true,
                    over_edges: false,
                    indentation_m: TYPICAL_INDENTATION * self.brush.free_length_m,
                }),
                ..Parts::NONE
            },
        }
    }

    fn lead(&self, _robot: &mut RobotSpec, check: &mut Check) {
        if let BrushWay::Taught { .. } = self.way {
            let because = "the arm starts in the first taught posture";
            check.ignored("robot", &["posture_deg", "posture_mm"], because);
        }
    }
}
