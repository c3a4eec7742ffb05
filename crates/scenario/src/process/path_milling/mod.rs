//! The `[process.path_milling]` table: an end mill cuts stock along a path from a file.

use std::f64::consts::{PI, TAU};
use std::path::Path;

use schemars::JsonSchema;
use serde::Deserialize;
use truecut_core::chatter::AttachedModes;
use truecut_core::cutting::chamfer::CuttingCoefficients;
use truecut_core::cutting::milling::cutter::Cutter;
use truecut_plan::cam::SpindleSpeed;
use truecut_plan::path_file::PathFile;
use truecut_recording::short_number;

use crate::check::Check;
use crate::fault::Fault;
use crate::modes::WorkpieceTable;
use crate::process::material::{CuttingTable, MaterialTable};
use crate::process::milling::coefficients;
use crate::process::milling::cutter::CutterTable;
use crate::process::path_file::PathFileTable;
use crate::process::{Facts, Knob, ModesIn, Parts, PostureFrom, Room};
use crate::units::{from_deg, from_rpm};

mod stock;

pub use stock::StockSpec;
use stock::StockTable;

/// Milling of stock along a path from a file. The cutter turns clockwise seen from the spindle.
#[derive(Debug, Clone, PartialEq)]
pub struct PathMillingSpec {
    /// The end mill.
    pub cutter: Cutter,
    /// Cutting force coefficients.
    pub coefficients: CuttingCoefficients,
    /// Spindle speed.
    pub spindle: SpindleSpec,
    /// Angle of the first tooth at the start, from the work frame's y towards its x.
    pub start_angle_rad: f64,
    /// Path from CAM, or robot program.
    pub path: PathFile,
    /// What is cut.
    pub stock: StockSpec,
    /// Modes of tool and workpiece beside the arm's.
    pub attached: AttachedModes,
}

/// Speed of a spindle along a path.
#[derive(Debug, Clone, PartialEq)]
pub enum SpindleSpec {
    /// One speed all the time, rad/s.
    Steady(f64),
    /// Those that the path's file gives, one at least.
    OfFile(Vec<SpindleSpeed>),
}

impl SpindleSpec {
    /// Speeds, rad/s, each with the point of the path at which it comes on; the first one is there
    /// from the start on.
    pub fn speeds_rad_s(&self) -> Vec<(usize, f64)> {
        match self {
            Self::Steady(rad_s) => vec![(0, *rad_s)],
            Self::OfFile(speeds) => {
                let each = speeds.iter();
                each.map(|one| (one.from, from_rpm(one.rpm))).collect()
            }
        }
    }

    /// The one speed, rad/s, where it never changes.
    pub fn steady_rad_s(&self) -> Option<f64> {
        let speeds = self.speeds_rad_s();
        let [(_, first), others @ ..] = &speeds[..] else {
            return None;
        };
        others
            .iter()
            .all(|(_, rad_s)| rad_s == first)
            .then_some(*first)
    }

    /// The fastest, rad/s.
    pub fn fastest_rad_s(&self) -> f64 {
        let speeds = self.speeds_rad_s().into_iter();
        speeds.map(|(_, rad_s)| rad_s).fold(0.0, f64::max)
    }
}

impl PathMillingSpec {
    /// Least time between two teeth.
    pub fn tooth_period_s(&self) -> f64 {
        self.tooth_period_at_s(self.spindle.fastest_rad_s())
    }

    /// Time between two teeth at a spindle speed, rad/s.
    pub fn tooth_period_at_s(&self, spindle_rad_s: f64) -> f64 {
        TAU / (spindle_rad_s * self.cutter.teeth as f64)
    }
}

/// Milling of stock along a path from a file.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct PathMillingTable {
    /// Spindle speed. Default: what the path from CAM says (S, SPINDL), with its changes.
    #[schemars(extend("exclusiveMinimum" = 0.0, "x-rule" = "the spindle turns"))]
    spindle_rpm: Option<f64>,
    /// Angle of the first tooth at the start, from the work frame's y towards its x. Default: 0.
    start_angle_deg: Option<f64>,
    /// The end mill.
    cutter: CutterTable,
    /// Cutting force coefficients from a file; or give [process.path_milling.cutting].
    material: Option<MaterialTable>,
    /// Cutting force coefficients; or give [process.path_milling.material].
    cutting: Option<CuttingTable>,
    /// Where the tool goes.
    path: PathFileTable,
    /// What is cut.
    stock: StockTable,
    /// How it is held. Default: it is rigid.
    workpiece: Option<WorkpieceTable>,
}

const TABLE: &str = "process.path_milling";

impl PathMillingTable {
    /// `None` after recording a fault. `folder` is that of the scenario file.
    pub(crate) fn resolve(self, folder: &Path, check: &mut Check) -> Option<PathMillingSpec> {
        let own_wear_land_m = self.cutter.wear_land_m();
        let cutter_table = format!("{TABLE}.cutter");
        let (mut cutter, (tool, over_speed)) = self.cutter.resolve(&cutter_table, check);
        let attached = AttachedModes {
            tool,
            workpiece: (self.workpiece).map_or_else(Vec::new, |piece| {
                piece.resolve(&format!("{TABLE}.workpiece.mode"), check)
            }),
            over_speed,
        };
        let cutting = coefficients(TABLE, self.material, self.cutting, folder, check);
        if let Some((_, indentation)) = &cutting {
            let arc_m = PI * cutter.radius_m;
            cutter.flank = indentation.resolve(&cutter_table, own_wear_land_m, arc_m, check);
            if !cutter.is_flat() && !cutter.flank.is_sharp() {
                let is = format!(
                    "is {}, but must be 0 where flanks are worn: the law of process damping is that of an upright \
                     edge. Give `wear_land_mm = 0`",
                    short_number(cutter.corner_radius_m * 1e3)
                );
                check.wrong(&cutter_table, "corner_radius_mm", is, "with worn flanks");
            }
        }
        let because = "the cutting force acts at the robot's tool point, which follows the path";
        let keys = ["tool_xyz_mm", "tool_rpy_deg"];
        check.ignored(&format!("{TABLE}.path"), &keys, because);
        let path = self.path.resolve(&format!("{TABLE}.path"), folder, check);
        let stock = self.stock.resolve(&cutter.profile(), folder, check);
        let path = path?;
        let spindle = match self.spindle_rpm {
            Some(rpm) => {
                check.rim(TABLE, "spindle_rpm", rpm, cutter.radius_m);
                SpindleSpec::Steady(from_rpm(rpm))
            }
            None => spindle_of_file(&path, !attached.over_speed.is_empty(), check)?,
        };
        Some(PathMillingSpec {
            cutter,
            coefficients: cutting?.0,
            attached: attached.at(spindle.fastest_rad_s()),
            spindle,
            start_angle_rad: from_deg(self.start_angle_deg.unwrap_or(0.0)),
            path,
            stock: stock?,
        })
    }
}

/// Speeds that a path's file gives, or `None` after recording a fault.
fn spindle_of_file(
    path: &PathFile,
    modes_over_speed: bool,
    check: &mut Check,
) -> Option<SpindleSpec> {
    let cam = match path.cam() {
        Ok(cam) => cam,
        Err(error) => {
            let key = format!("{TABLE}.path.file");
            check.refuse(Fault::value(&key, error.to_string(), "cannot be read"));
            return None;
        }
    };
    let file = path.file.display();
    let said = match cam {
        None => Err(format!("{file} is a robot program, which gives no speed")),
        Some(cam) => cam.spindle_speeds().map_err(|(line, kind)| {
            let line = line.map_or_else(String::new, |line| format!(":{line}"));
            format!("{file}{line}: {kind}")
        }),
    };
    let speeds = match said {
        Ok(speeds) => speeds,
        Err(why) => {
            let key = format!("{TABLE}.spindle_rpm");
            let message = format!(
                "missing key `spindle_rpm` in [{TABLE}], and the path's file does not say the speed: {why}"
            );
            check.refuse(Fault::key(&key, message, "`spindle_rpm` is missing here"));
            return None;
        }
    };
    let spindle = SpindleSpec::OfFile(speeds);
    if modes_over_speed && spindle.steady_rad_s().is_none() {
        let message = format!(
            "`{TABLE}.path.file`: {file} changes the spindle's speed, but modes that are given over it are taken at one: give `spindle_rpm`"
        );
        let key = format!("{TABLE}.path.file");
        check.refuse(Fault::value(&key, message, "changes the speed"));
        return None;
    }
    Some(spindle)
}

/// What a person could change at the machine.
const KNOBS: &[Knob] = &[Knob::new(
    "process.path_milling.spindle_rpm",
    "spindle speed",
    &[0.5, 2.0],
)];

impl Room for PathMillingSpec {
    type Table = PathMillingTable;

    fn resolve(table: PathMillingTable, folder: &Path, check: &mut Check) -> Option<Self> {
        table.resolve(folder, check)
    }

    fn facts(&self) -> Facts {
        Facts {
            rate_rad_s: self.spindle.steady_rad_s(),
            natural_duration_s: Some(f64::INFINITY),
            signals: &[
                "path_milling.torque",
                "path_milling.chip_thickness",
                "tool.displacement_x",
                "tool.displacement_y",
                "tool.displacement_z",
            ],
            knobs: KNOBS,
            files: &["path.file", "material.file", "stock.mesh"],
            needs_drive: Some("path_milling"),
            needs_robot: true,
            modes: ModesIn::Elsewhere(
                "milling has them in [[process.path_milling.cutter.mode]] and \
                 [[process.path_milling.workpiece.mode]]",
            ),
            replays: false,
            posture: PostureFrom::Path,
            parts: Parts::NONE,
        }
    }
}
