//! A table `path` of a process: a file of CAM, or a robot program, leads the arm.

use std::path::Path;

use schemars::JsonSchema;
use serde::Deserialize;
use truecut_plan::cam::{self, CamOptions, Rapid, WorkSetup};
use truecut_plan::path_file::{PathFile, PathFileKind};
use truecut_plan::program::{DIALECTS, dialect_of};

use crate::check::Check;
use crate::path_job::place;
use crate::units::{from_deg, from_mm};

/// A path in a file, and where it stands.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct PathFileTable {
    /// Path from CAM (G-code, APT, poses in CSV) or robot program, told apart by its ending,
    /// relative to this file.
    file: String,
    /// Unit of lengths where a path from CAM does not say it. Default: "mm".
    unit: Option<LengthUnit>,
    /// How far chords may lie off arcs of a path from CAM. Default: 0.01.
    #[schemars(extend("exclusiveMinimum" = 0.0, "x-rule" = "chords lie off an arc"))]
    chord_mm: Option<f64>,
    /// Work frame, the zero of a path from CAM, in the world. Default: [0, 0, 0].
    work_xyz_mm: Option<[f64; 3]>,
    /// Roll, pitch and yaw of the work frame about the world's x, y, z. Default: [0, 0, 0].
    work_rpy_deg: Option<[f64; 3]>,
    /// Base frame of a robot program whose file does not hold it, in the world. Default: [0, 0, 0].
    base_xyz_mm: Option<[f64; 3]>,
    /// Roll, pitch and yaw of the base frame about the world's x, y, z. Default: [0, 0, 0].
    base_rpy_deg: Option<[f64; 3]>,
    /// What follows a path from CAM, in the robot's tool frame. Default: [0, 0, 0], its origin.
    tool_xyz_mm: Option<[f64; 3]>,
    /// Roll, pitch and yaw of it about the tool frame's x, y, z; its z points into the workpiece.
    /// Default: [0, 0, 0].
    tool_rpy_deg: Option<[f64; 3]>,
    /// Turn about the tool's axis where a path from CAM leaves it free. Default: the one whose
    /// postures are nearest to the start.
    spin_deg: Option<f64>,
    /// Speed of rapid traverse, a straight line here. Default: 250.
    #[schemars(extend("exclusiveMinimum" = 0.0, "x-rule" = "rapid traverse gets on"))]
    rapid_mm_per_s: Option<f64>,
    /// Top speed of joints on lines, a fraction of their limits: lines on which a joint would be
    /// faster are slower than their feed. Default: 1.
    #[schemars(extend("exclusiveMinimum" = 0.0, "maximum" = 1.0, "x-rule" = "a fraction of the top speed"))]
    joint_speed: Option<f64>,
}

/// Units of lengths that a path may be in.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
enum LengthUnit {
    /// Millimetres.
    #[default]
    Mm,
    /// 25.4 mm.
    Inch,
}

const DEFAULT_RAPID_MM_PER_S: f64 = 250.0;
const DEFAULT_CHORD_MM: f64 = 0.01;
/// Of keys that a path from CAM has and a robot program has not.
const CAM_KEYS: [&str; 8] = [
    "unit",
    "chord_mm",
    "work_xyz_mm",
    "work_rpy_deg",
    "tool_xyz_mm",
    "tool_rpy_deg",
    "spin_deg",
    "rapid_mm_per_s",
];
const BASE_KEYS: [&str; 2] = ["base_xyz_mm", "base_rpy_deg"];

impl PathFileTable {
    /// `None` after recording a fault. `table` is its own key, `folder` that of the scenario file.
    pub(crate) fn resolve(self, table: &str, folder: &Path, check: &mut Check) -> Option<PathFile> {
        let file = folder.join(&self.file);
        let kind = if cam::is_cam(&file) {
            let because = "a path from CAM stands in its work frame";
            check.ignored(table, &BASE_KEYS, because);
            self.of_cam()
        } else if let Some(dialect) = dialect_of(&file) {
            let because = "a robot program says it, or it is the robot's";
            check.ignored(table, &CAM_KEYS, because);
            if dialect.holds_base() {
                let because = format!("a {} says where its base frame stands", dialect.noun());
                check.ignored(table, &BASE_KEYS, &because);
            }
            PathFileKind::Program {
                dialect,
                world_from_base: place(self.base_xyz_mm, self.base_rpy_deg),
            }
        } else {
            let programs = DIALECTS.iter().flat_map(|one| one.extensions());
            let programs: Vec<String> = programs.map(|ending| format!(".{ending}")).collect();
            let is = format!(
                "is \"{}\", but must end as a path from CAM does ({}), or a robot program ({}): the ending \
                 tells the format",
                self.file,
                cam::endings(),
                programs.join(", ")
            );
            check.wrong(table, "file", is, "unknown ending");
            return None;
        };
        Some(PathFile {
            file,
            kind,
            joint_share: self.joint_speed.unwrap_or(1.0),
        })
    }

    fn of_cam(&self) -> PathFileKind {
        PathFileKind::Cam {
            options: CamOptions {
                unit_m: match self.unit.unwrap_or_default() {
                    LengthUnit::Mm => 1e-3,
                    LengthUnit::Inch => 25.4e-3,
                },
                chord_m: from_mm(self.chord_mm.unwrap_or(DEFAULT_CHORD_MM)),
            },
            setup: WorkSetup {
                world_from_work: place(self.work_xyz_mm, self.work_rpy_deg),
                spin_rad: self.spin_deg.map(from_deg),
                rapid: Rapid::Line {
                    speed_m_per_s: from_mm(self.rapid_mm_per_s.unwrap_or(DEFAULT_RAPID_MM_PER_S)),
                },
                // The arm starts at the first point.
                joint_share: 1.0,
                zone_m: None,
            },
            tool_from_tip: place(self.tool_xyz_mm, self.tool_rpy_deg),
        }
    }
}
