//! The `[process.milling]` table: an end mill cuts along a straight line.

mod material;
mod path;
mod planned;

pub use material::MillingCoefficients;
pub use path::{Elbow, MillingPathSpec, PathStart, Shoulder, TurnKnot, Wrist};
pub use planned::PlannedPath;

use std::f64::consts::{PI, TAU};
use std::path::Path;

use schemars::JsonSchema;
use serde::Deserialize;

use crate::check::Check;
use crate::document::Fault;
use crate::units::{from_deg, from_mm, from_rpm, from_um};
use material::{CuttingTable, MaterialTable};
use path::PathTable;

/// Peripheral milling along a straight line.
#[derive(Debug, Clone, PartialEq)]
pub struct MillingSpec {
    /// The end mill.
    pub cutter: CutterSpec,
    /// Cutting force coefficients.
    pub coefficients: MillingCoefficients,
    /// Spindle speed; the cutter turns clockwise seen from the spindle.
    pub spindle_rad_s: f64,
    /// Angle φ of the first tooth at the start.
    pub start_angle_rad: f64,
    /// Speed of the tool along its path.
    pub feed_m_per_s: f64,
    /// Depth of cut along the tool axis.
    pub axial_depth_m: f64,
    /// Where teeth meet material.
    pub engagement: EngagementSpec,
    /// Teeth meet the surface that earlier teeth left (true), or the one of a tool that does not vibrate (false).
    pub regeneration: bool,
    /// Way from the cutter's rim to the face of the stock at the start; `None`: the cut is under way at the start.
    pub lead_in_m: Option<f64>,
    /// Way along which the depth of cut rises from zero to the full one, behind the lead-in: the stock begins as a wedge.
    pub ramp_m: f64,
    /// Where the tool goes.
    pub path: MillingPathSpec,
}

/// A cylindrical end mill with equally spaced teeth.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CutterSpec {
    /// Diameter.
    pub diameter_m: f64,
    /// Number of teeth.
    pub teeth: u32,
    /// Angle between cutting edge and tool axis; positive if the edge lags behind with height.
    pub helix_rad: f64,
    /// Offset of the cutter's axis from the spindle's.
    pub runout_m: f64,
    /// Angle of that offset from the first tooth, in the sense of rotation.
    pub runout_angle_rad: f64,
}

/// Where teeth meet material; angles are φ, from +y towards the feed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum EngagementSpec {
    /// The whole diameter.
    Slot,
    /// Up-milling.
    Up {
        /// Radial depth of cut.
        radial_depth_m: f64,
    },
    /// Down-milling.
    Down {
        /// Radial depth of cut.
        radial_depth_m: f64,
    },
    /// Between two angles.
    Between {
        /// φ_st, in [0, π).
        entry_rad: f64,
        /// φ_ex, in (φ_st, π].
        exit_rad: f64,
    },
}

impl EngagementSpec {
    /// Entry and exit angle for a diameter, rad (Altintas, *Manufacturing Automation*, 2012, section 2.5).
    pub fn angles_rad(&self, diameter_m: f64) -> [f64; 2] {
        match *self {
            Self::Slot => [0.0, PI],
            Self::Up { radial_depth_m } => [0.0, (1.0 - 2.0 * radial_depth_m / diameter_m).acos()],
            Self::Down { radial_depth_m } => [(2.0 * radial_depth_m / diameter_m - 1.0).acos(), PI],
            Self::Between {
                entry_rad,
                exit_rad,
            } => [entry_rad, exit_rad],
        }
    }
}

impl MillingSpec {
    /// Time between two teeth.
    pub fn tooth_period_s(&self) -> f64 {
        TAU / (self.spindle_rad_s * f64::from(self.cutter.teeth))
    }

    /// Feed per tooth.
    pub fn feed_per_tooth_m(&self) -> f64 {
        self.feed_m_per_s * self.tooth_period_s()
    }

    /// Refuses a run that lasts longer than its path.
    pub(crate) fn check_duration(&self, duration_s: f64, check: &mut Check) {
        let pass_s = self.pass_s();
        if duration_s > pass_s * (1.0 + 1e-9) {
            let message = format!(
                "`run.duration_s` is {duration_s}, but the path of {} mm ends after {pass_s} s: the tool has nowhere to go",
                self.path.length_m * 1e3
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

/// Engagements by name.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
enum EngagementName {
    /// The whole diameter.
    Slot,
    /// Up-milling: teeth enter at the wall they make.
    Up,
    /// Down-milling: teeth leave at the wall they make.
    Down,
    /// Between the angles entry_deg and exit_deg.
    Between,
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
    #[schemars(extend("exclusiveMinimum" = 0.0, "x-rule" = "a cut has a depth"))]
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
    /// Whether teeth meet the surface that earlier teeth left; else that of a tool which does not vibrate. Default:
    /// true.
    regeneration: Option<bool>,
    /// Angle of the first tooth at the start, from +y towards the feed. Default: 0.
    start_angle_deg: Option<f64>,
    /// Way from the cutter's rim to the face of the stock at the start. Default: the cut is under way at the start, the arm
    /// deflected by its mean force.
    #[schemars(extend("minimum" = 0.0, "x-rule" = "the cutter starts outside the stock"))]
    lead_in_mm: Option<f64>,
    /// Way along which the depth of cut rises from zero to the full one, behind the lead-in: the stock begins as a wedge. Default:
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
}

/// A cylindrical end mill.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct CutterTable {
    /// Diameter.
    #[schemars(extend("exclusiveMinimum" = 0.0, "x-rule" = "a cutter has a diameter"))]
    diameter_mm: f64,
    /// Number of equally spaced teeth.
    #[schemars(range(min = 1, max = 64), extend("x-rule" = "a cutter has 1 to 64 teeth"))]
    teeth: u32,
    /// Angle between cutting edge and tool axis; positive if the edge lags behind with height. Default: 0.
    #[schemars(range(min = -75.0, max = 75.0), extend("x-rule" = "an edge runs along the cutter"))]
    helix_deg: Option<f64>,
    /// Offset of the cutter's axis from the spindle's. Default: 0.
    #[schemars(extend("minimum" = 0.0, "x-rule" = "runout_angle_deg gives the direction"))]
    runout_um: Option<f64>,
    /// Angle of that offset from the first tooth, in the sense of rotation. Default: 0.
    runout_angle_deg: Option<f64>,
}

/// Largest feed per tooth as a part of the cutter's diameter: chips are far thinner than the cutter.
const LARGEST_FEED: f64 = 0.1;

impl MillingTable {
    /// `None` after recording a fault.
    pub(crate) fn resolve(self, folder: &Path, check: &mut Check) -> Option<MillingSpec> {
        let cutter = self.cutter.resolve(check);
        let engagement = self.engagement(cutter.diameter_m, check);
        let spindle_rad_s = from_rpm(self.spindle_rpm);
        let tooth_period_s = TAU / (spindle_rad_s * f64::from(cutter.teeth));
        let feed_m_per_s = self.feed_m_per_s(tooth_period_s, cutter.diameter_m, check);
        let lead_in_m = self.lead_in_mm.map(from_mm);
        let coefficients = material::resolve(self.material, self.cutting, folder, check);
        let path = self.path.resolve(check);
        let ramp_m = from_mm(self.ramp_mm.unwrap_or(0.0));
        if let Some(path) = &path {
            check_entry(lead_in_m, ramp_m, path.length_m, check);
        }
        Some(MillingSpec {
            cutter,
            coefficients: coefficients?,
            spindle_rad_s,
            start_angle_rad: from_deg(self.start_angle_deg.unwrap_or(0.0)),
            feed_m_per_s: feed_m_per_s?,
            axial_depth_m: from_mm(self.axial_depth_mm),
            engagement: engagement?,
            regeneration: self.regeneration.unwrap_or(true),
            lead_in_m,
            ramp_m,
            path: path?,
        })
    }

    fn feed_m_per_s(&self, tooth_period_s: f64, diameter_m: f64, check: &mut Check) -> Option<f64> {
        let table = "process.milling";
        let (key, feed_m_per_s) = match (self.feed_mm_per_s, self.feed_mm_per_tooth) {
            (Some(speed), None) => ("feed_mm_per_s", from_mm(speed)),
            (None, Some(feed)) => ("feed_mm_per_tooth", from_mm(feed) / tooth_period_s),
            (Some(_), Some(_)) => {
                let because = "feed_mm_per_s already gives the feed";
                check.ignored(table, &["feed_mm_per_tooth"], because);
                return None;
            }
            (None, None) => {
                let message = format!(
                    "missing key `feed_mm_per_s` in [{table}]: the feed is given by it or by `feed_mm_per_tooth`"
                );
                let path = format!("{table}.feed_mm_per_s");
                check.refuse(Fault::key(&path, message, "the feed is missing here"));
                return None;
            }
        };
        let chip_m = feed_m_per_s * tooth_period_s;
        if chip_m > LARGEST_FEED * diameter_m {
            let path = format!("{table}.{key}");
            let message = format!(
                "`{path}` gives a feed per tooth of {:.4} mm, but must give at most {} mm, a tenth of the diameter: \
                 chips are far thinner than the cutter",
                chip_m * 1e3,
                LARGEST_FEED * diameter_m * 1e3
            );
            check.refuse(Fault::value(&path, message, "too much for the cutter"));
        }
        Some(feed_m_per_s)
    }

    fn engagement(&self, diameter_m: f64, check: &mut Check) -> Option<EngagementSpec> {
        let table = "process.milling";
        let name = self.engagement;
        if matches!(name, EngagementName::Slot | EngagementName::Between) {
            let because = "only the engagements \"up\" and \"down\" have a radial depth";
            check.ignored(table, &["radial_depth_mm"], because);
        }
        if name != EngagementName::Between {
            let because = "only engagement = \"between\" is given by angles";
            check.ignored(table, &["entry_deg", "exit_deg"], because);
        }
        let who = "this engagement";
        Some(match name {
            EngagementName::Slot => EngagementSpec::Slot,
            EngagementName::Up => EngagementSpec::Up {
                radial_depth_m: self.radial_depth_m(diameter_m, check)?,
            },
            EngagementName::Down => EngagementSpec::Down {
                radial_depth_m: self.radial_depth_m(diameter_m, check)?,
            },
            EngagementName::Between => {
                let entry = check.needed(table, "entry_deg", self.entry_deg, who)?;
                let exit = check.needed(table, "exit_deg", self.exit_deg, who)?;
                if entry >= exit {
                    let path = format!("{table}.exit_deg");
                    let message = format!(
                        "`{path}` is {exit}, but must be greater than entry_deg = {entry}: teeth leave after they enter"
                    );
                    check.refuse(Fault::value(&path, message, "not behind the entry"));
                }
                EngagementSpec::Between {
                    entry_rad: from_deg(entry),
                    exit_rad: from_deg(exit),
                }
            }
        })
    }

    fn radial_depth_m(&self, diameter_m: f64, check: &mut Check) -> Option<f64> {
        let table = "process.milling";
        let depth_mm = check.needed(
            table,
            "radial_depth_mm",
            self.radial_depth_mm,
            "this engagement",
        )?;
        let depth_m = from_mm(depth_mm);
        if depth_m > diameter_m {
            let path = format!("{table}.radial_depth_mm");
            let message = format!(
                "`{path}` is {depth_mm}, but must be at most the cutter's diameter of {} mm: it cuts no wider",
                diameter_m * 1e3
            );
            check.refuse(Fault::value(&path, message, "wider than the cutter"));
        }
        Some(depth_m)
    }
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

impl CutterTable {
    fn resolve(&self, check: &mut Check) -> CutterSpec {
        let table = "process.milling.cutter";
        let diameter_m = from_mm(self.diameter_mm);
        let runout_m = from_um(self.runout_um.unwrap_or(0.0));
        if runout_m == 0.0 {
            check.ignored(table, &["runout_angle_deg"], "the cutter has no runout");
        }
        if runout_m >= 0.25 * diameter_m {
            let path = format!("{table}.runout_um");
            let message = format!(
                "`{path}` is {}, but must be less than half the cutter's radius of {} mm: every tooth has a radius",
                runout_m * 1e6,
                diameter_m * 5e2
            );
            check.refuse(Fault::value(&path, message, "too much for the cutter"));
        }
        CutterSpec {
            diameter_m,
            teeth: self.teeth,
            helix_rad: from_deg(self.helix_deg.unwrap_or(0.0)),
            runout_m,
            runout_angle_rad: from_deg(self.runout_angle_deg.unwrap_or(0.0)),
        }
    }
}
