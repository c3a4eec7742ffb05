//! The `[process.milling]` table: an end mill cuts along a straight line.

pub(in crate::process) mod cutter;
mod flank;
mod path;
mod planned;

pub use planned::PlannedPath;

use std::f64::consts::TAU;
use std::path::Path;

use schemars::JsonSchema;
use serde::Deserialize;
use truecut_core::chatter::AttachedModes;
use truecut_core::cutting::chamfer::CuttingCoefficients;
use truecut_core::cutting::milling::cutter::Cutter;
use truecut_core::cutting::milling::nominal::NominalCut;
use truecut_plan::motion::straight::StraightPath;
use truecut_recording::short_number;

use crate::check::Check;
use crate::fault::Fault;
use crate::modes::WorkpieceTable;
use crate::process::material::{CuttingTable, Given, Indentation, MaterialTable, one_of};
use crate::process::{Facts, Knob, ModesIn, Parts, PostureFrom, Room};
use crate::run::RunSpec;
use crate::units::{from_deg, from_mm, from_rpm};
use cutter::{CutterTable, EngagementName, engaged};
use path::PathTable;

/// Peripheral milling along a straight line. The cutter turns clockwise seen from the spindle.
#[derive(Debug, Clone, PartialEq)]
pub struct MillingSpec {
    /// Cutter, coefficients, engagement, depth and feed per tooth.
    pub cut: NominalCut,
    /// Spindle speed.
    pub spindle_rad_s: f64,
    /// Angle φ of the first tooth at the start.
    pub start_angle_rad: f64,
    /// Speed of the tool along its path.
    pub feed_m_per_s: f64,
    /// Teeth meet the surface that earlier teeth left (true), or the one of a tool that does not
    /// vibrate (false).
    pub regeneration: bool,
    /// Way from the cutter's rim to the face of the stock at the start; `None`: the cut is under
    /// way at the start.
    pub lead_in_m: Option<f64>,
    /// Way along which the depth of cut rises from zero to the full one, behind the lead-in: the
    /// stock begins as a wedge.
    pub ramp_m: f64,
    /// Where the tool goes.
    pub path: StraightPath,
    /// Modes of tool and workpiece beside the arm's.
    pub attached: AttachedModes,
}

impl MillingSpec {
    /// Time between two teeth.
    pub fn tooth_period_s(&self) -> f64 {
        tooth_period_s(self.spindle_rad_s, &self.cut.cutter)
    }

    /// Refuses a run that lasts longer than its path.
    pub(crate) fn check_duration(&self, duration_s: f64, check: &mut Check) {
        let pass_s = self.pass_s();
        if duration_s > pass_s * (1.0 + 1e-9) {
            let message = format!(
                "`run.duration_s` is {duration_s}, but the path of {} mm ends after {} s: the tool has nowhere to go",
                self.path.length_m * 1e3,
                short_number(pass_s)
            );
            let fault = Fault::value("run.duration_s", message, "longer than the path takes");
            check.refuse(fault.with_help("lengthen the path, or leave the key out"));
        }
    }

    /// Time from one end of the path to the other.
    pub fn pass_s(&self) -> f64 {
        self.path.length_m / self.feed_m_per_s
    }
}

/// Milling along a straight line with an end mill.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct MillingTable {
    /// Spindle speed.
    #[schemars(extend("exclusiveMinimum" = 0.0, "x-rule" = "the spindle turns"))]
    spindle_rpm: f64,
    /// Feed speed; or give feed_mm_per_tooth.
    #[schemars(extend("exclusiveMinimum" = 0.0, "x-rule" = "without feed there is no chip"))]
    feed_mm_per_s: Option<f64>,
    /// Feed per tooth; or give feed_mm_per_s.
    #[schemars(extend("exclusiveMinimum" = 0.0, "x-rule" = "without feed there is no chip"))]
    feed_mm_per_tooth: Option<f64>,
    /// Depth of cut along the tool axis.
    #[schemars(extend(
        "exclusiveMinimum" = 0.0,
        "maximum" = 1e3,
        "x-rule" = "a cut has a depth, no more than a metre"
    ))]
    axial_depth_mm: f64,
    /// Where teeth meet material.
    engagement: EngagementName,
    /// Radial depth of cut (engagements "up" and "down").
    #[schemars(extend("exclusiveMinimum" = 0.0, "x-rule" = "a cut has a depth"))]
    radial_depth_mm: Option<f64>,
    /// Where teeth enter, from +y towards the feed (engagement "between").
    #[schemars(extend(
        "minimum" = 0.0,
        "exclusiveMaximum" = 180.0,
        "x-rule" = "teeth cut on the side of the feed, from 0 to 180"
    ))]
    entry_deg: Option<f64>,
    /// Where teeth leave (engagement "between").
    #[schemars(extend(
        "exclusiveMinimum" = 0.0,
        "maximum" = 180.0,
        "x-rule" = "teeth cut on the side of the feed, from 0 to 180"
    ))]
    exit_deg: Option<f64>,
    /// Whether teeth meet the surface that earlier teeth left; else that of a tool which does not
    /// vibrate. Default: true.
    regeneration: Option<bool>,
    /// Angle of the first tooth at the start, from +y towards the feed. Default: 0.
    start_angle_deg: Option<f64>,
    /// Way from the cutter's rim to the face of the stock at the start. Default: the cut is under
    /// way at the start, the arm deflected by its mean force.
    #[schemars(extend("minimum" = 0.0, "x-rule" = "the cutter starts outside the stock"))]
    lead_in_mm: Option<f64>,
    /// Way along which the depth of cut rises from zero to the full one, behind the lead-in: the
    /// stock begins as a wedge. Default:
    /// 0.
    #[schemars(extend("minimum" = 0.0, "x-rule" = "the depth rises along the feed"))]
    ramp_mm: Option<f64>,
    /// The end mill.
    cutter: CutterTable,
    /// Cutting force coefficients from a file; or give [process.milling.cutting].
    material: Option<MaterialTable>,
    /// Cutting force coefficients; or give [process.milling.material].
    cutting: Option<CuttingTable>,
    /// Where the tool goes.
    path: PathTable,
    /// What is cut. Default: it is rigid.
    workpiece: Option<WorkpieceTable>,
}

/// Largest feed per tooth as a part of the cutter's diameter: chips are far thinner than the
/// cutter.
const LARGEST_FEED: f64 = 0.1;

const TABLE: &str = "process.milling";

impl MillingTable {
    /// `None` after recording a fault.
    pub(crate) fn resolve(self, folder: &Path, check: &mut Check) -> Option<MillingSpec> {
        let own_wear_land_m = self.cutter.wear_land_m();
        let because = "a straight cut does not sink";
        check.ignored("process.milling.cutter", &["centre_cutting"], because);
        let because = "a straight cut has a flat cutter; process.path_milling leads one with a round corner through stock";
        check.ignored("process.milling.cutter", &["corner_radius_mm"], because);
        let (mut cutter, (tool, over_speed)) = self.cutter.resolve("process.milling.cutter", check);
        let attached = AttachedModes {
            tool,
            workpiece: (self.workpiece).map_or_else(Vec::new, |piece| {
                piece.resolve("process.milling.workpiece.mode", check)
            }),
            over_speed,
        };
        let angles_deg = [self.entry_deg, self.exit_deg];
        let diameter_m = 2.0 * cutter.radius_m;
        let engagement = engaged(
            self.engagement,
            self.radial_depth_mm,
            angles_deg,
            diameter_m,
            check,
        );
        check.rim(TABLE, "spindle_rpm", self.spindle_rpm, cutter.radius_m);
        let spindle_rad_s = from_rpm(self.spindle_rpm);
        let period_s = tooth_period_s(spindle_rad_s, &cutter);
        let feed_m_per_s = feed(
            self.feed_mm_per_s,
            self.feed_mm_per_tooth,
            period_s,
            diameter_m,
            check,
        );
        let cutting = coefficients(TABLE, self.material, self.cutting, folder, check);
        if let (Some((_, indentation)), Some(engagement)) = (&cutting, &engagement) {
            let arc_m = cutter.radius_m * (engagement.exit_rad - engagement.entry_rad);
            let own = "process.milling.cutter";
            cutter.flank = indentation.resolve(own, own_wear_land_m, arc_m, check);
        }
        let path = self.path.resolve(check);
        let (lead_in_m, ramp_m) = (
            self.lead_in_mm.map(from_mm),
            from_mm(self.ramp_mm.unwrap_or(0.0)),
        );
        if let Some(path) = &path {
            check_entry(lead_in_m, ramp_m, path.length_m, check);
        }
        let feed_m_per_s = feed_m_per_s?;
        Some(MillingSpec {
            cut: NominalCut {
                cutter,
                coefficients: cutting?.0,
                engagement: engagement?,
                axial_depth_m: from_mm(self.axial_depth_mm),
                feed_per_tooth_m: feed_m_per_s * period_s,
            },
            spindle_rad_s,
            start_angle_rad: from_deg(self.start_angle_deg.unwrap_or(0.0)),
            feed_m_per_s,
            regeneration: self.regeneration.unwrap_or(true),
            lead_in_m,
            ramp_m,
            path: path?,
            attached: attached.at(spindle_rad_s),
        })
    }
}

/// Coefficients, and what they say of worn flanks; `None` after recording a fault.
pub(in crate::process) fn coefficients(
    table: &str,
    material: Option<MaterialTable>,
    cutting: Option<CuttingTable>,
    folder: &Path,
    check: &mut Check,
) -> Option<(CuttingCoefficients, Indentation)> {
    let (numbers, wear_land) = match one_of(table, material, cutting, check)? {
        Given::Material(material) => (
            material.read(table, folder, check)?,
            format!("{table}.material.file"),
        ),
        Given::Cutting(cutting) => (cutting, format!("{table}.cutting.wear_land_mm")),
    };
    Some((numbers.coefficients(), numbers.indentation(wear_land)))
}

fn tooth_period_s(spindle_rad_s: f64, cutter: &Cutter) -> f64 {
    TAU / (spindle_rad_s * cutter.teeth as f64)
}

/// The feed in time, m/s, from one of both ways to give it.
fn feed(
    feed_mm_per_s: Option<f64>,
    feed_mm_per_tooth: Option<f64>,
    tooth_period_s: f64,
    diameter_m: f64,
    check: &mut Check,
) -> Option<f64> {
    let (key, feed_m_per_s) = match (feed_mm_per_s, feed_mm_per_tooth) {
        (Some(speed), None) => ("feed_mm_per_s", from_mm(speed)),
        (None, Some(feed)) => ("feed_mm_per_tooth", from_mm(feed) / tooth_period_s),
        (Some(_), Some(_)) => {
            let because = "feed_mm_per_s already gives the feed";
            check.ignored(TABLE, &["feed_mm_per_tooth"], because);
            return None;
        }
        (None, None) => {
            let message = format!(
                "missing key `feed_mm_per_s` in [{TABLE}]: the feed is given by it or by \
                 `feed_mm_per_tooth`"
            );
            let path = format!("{TABLE}.feed_mm_per_s");
            check.refuse(Fault::key(&path, message, "the feed is missing here"));
            return None;
        }
    };
    let chip_m = feed_m_per_s * tooth_period_s;
    if chip_m > LARGEST_FEED * diameter_m {
        let message = format!(
            "gives a feed per tooth of {:.4} mm, but must give at most {} mm, a tenth of \
             the diameter: chips are far thinner than the cutter",
            chip_m * 1e3,
            LARGEST_FEED * diameter_m * 1e3
        );
        check.wrong(TABLE, key, message, "too much for the cutter");
    }
    Some(feed_m_per_s)
}

/// The cut must come to its full depth on the path.
fn check_entry(lead_in_m: Option<f64>, ramp_m: f64, length_m: f64, check: &mut Check) {
    let before_m = lead_in_m.unwrap_or(0.0) + ramp_m;
    if before_m < length_m {
        return;
    }
    let key = if lead_in_m.unwrap_or(0.0) >= length_m {
        "lead_in_mm"
    } else {
        "ramp_mm"
    };
    let path = format!("process.milling.{key}");
    let message = format!(
        "`{path}`: the full depth is reached {} mm from the start, but must be before the path's end at {} mm",
        before_m * 1e3,
        length_m * 1e3
    );
    check.refuse(Fault::value(&path, message, "longer than the path"));
}

/// What a person could change at the machine.
const KNOBS: &[Knob] = &[
    Knob::new("process.milling.spindle_rpm", "spindle speed", &[0.5, 2.0]),
    Knob::new("process.milling.axial_depth_mm", "axial depth", &[0.5, 2.0]),
];

impl Room for MillingSpec {
    type Table = MillingTable;

    fn resolve(table: MillingTable, folder: &Path, check: &mut Check) -> Option<Self> {
        table.resolve(folder, check)
    }

    fn facts(&self) -> Facts {
        Facts {
            rate_rad_s: Some(self.spindle_rad_s),
            natural_duration_s: Some(self.pass_s()),
            signals: &[
                "milling.torque",
                "milling.chip_thickness",
                "tool.displacement_x",
                "tool.displacement_y",
                "tool.displacement_z",
            ],
            knobs: KNOBS,
            files: &["material.file"],
            needs_drive: Some("milling"),
            needs_robot: true,
            modes: ModesIn::Elsewhere(
                "milling has them in [[process.milling.cutter.mode]] and \
                 [[process.milling.workpiece.mode]]",
            ),
            replays: false,
            posture: PostureFrom::Scenario,
            parts: Parts::NONE,
        }
    }

    fn check_run(&self, run: &RunSpec, check: &mut Check) {
        self.check_duration(run.duration_s, check);
    }
}
