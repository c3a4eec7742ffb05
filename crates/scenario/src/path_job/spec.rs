//! What a path job says, in SI.

use std::path::PathBuf;

use schemars::JsonSchema;
use serde::Deserialize;

/// Where something stands: millimetres and degrees in the file, m and rad here.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct PlaceSpec {
    /// Origin, m.
    pub xyz_m: [f64; 3],
    /// Roll, pitch and yaw about fixed axes x, y, z, rad.
    pub rpy_rad: [f64; 3],
}

/// The face to be finished.
#[derive(Debug, Clone, PartialEq)]
pub struct SurfaceSpec {
    /// File of the patch.
    pub patch: PathBuf,
    /// The whole workpiece as a closed mesh, in the patch's frame.
    pub body: Option<BodySpec>,
    /// Where the patch's frame stands in the world.
    pub place: PlaceSpec,
}

/// A mesh of the whole workpiece.
#[derive(Debug, Clone, PartialEq)]
pub struct BodySpec {
    /// STL or OBJ file.
    pub file: PathBuf,
    /// Length of the file's unit, m.
    pub unit_m: f64,
}

/// The contact wheel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContactWheelSpec {
    /// Radius with the belt on, m.
    pub radius_m: f64,
    /// Width, m.
    pub width_m: f64,
    /// How far the centre is set below the radius, m.
    pub indentation_m: f64,
    /// Normal force per width, N/m.
    pub line_load_n_per_m: f64,
    /// Effective modulus of wheel and workpiece, Pa.
    pub modulus_pa: f64,
}

/// How lines are laid on a patch.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum StrategySpec {
    /// Lines along which one parameter is constant.
    IsoParametric {
        /// Share of the swath that the next line covers again.
        overlap: f64,
    },
    /// Lines between which ridges of one height are left.
    IsoScallop {
        /// Greatest height of a ridge, m.
        scallop_m: f64,
        /// Share of the swath that the next line covers again, where the swath bounds the spacing.
        overlap: f64,
    },
    /// Sections of the patch with parallel planes.
    ParallelPlane {
        /// Share of the swath that the next line covers again.
        overlap: f64,
        /// Normal of the planes, in the patch's frame, of any length but zero.
        normal: [f64; 3],
    },
}

/// The parameter along which lines are fed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum FeedAlong {
    /// u, lines beside one another along v.
    #[default]
    U,
    /// v, lines beside one another along u.
    V,
}

/// Where the wheel's axis points.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum AxisSpec {
    /// Along the least curvature: the published rule.
    LeastCurvature,
    /// Where the swath is widest and the edge gap keeps a limit, m.
    WidestSwath {
        /// The limit, m.
        edge_gap_limit_m: f64,
    },
}

/// The path on the patch.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PathSpec {
    /// How lines are laid.
    pub strategy: StrategySpec,
    /// The parameter along which they are fed.
    pub feed_along: FeedAlong,
    /// Where the wheel's axis points.
    pub axis: AxisSpec,
    /// Largest distance of points along a line, m.
    pub step_m: f64,
    /// Distance that the contact keeps from the borders, m.
    pub margin_m: f64,
    /// How far the wheel is lifted before and after each line, m.
    pub lift_m: f64,
    /// Speed of the tool on a line, m/s.
    pub feed_m_per_s: f64,
    /// How deep the wheel may lie in patch and body, m.
    pub gouge_limit_m: f64,
}

/// What brings the copies of a symmetric part to the wheel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Carrier {
    /// The arm goes to each copy.
    Arm,
    /// A turntable brings each copy to where the first one was.
    Turntable {
        /// Pulses of its motor per degree, for jobs.
        pulses_per_deg: Option<f64>,
    },
}

/// A part of N-fold symmetry.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SymmetrySpec {
    /// Number of copies, 2 at least.
    pub count: usize,
    /// A point of the axis, world, m.
    pub centre_m: [f64; 3],
    /// The axis, world, of any length but zero.
    pub axis: [f64; 3],
    /// What brings the copies to the wheel.
    pub carrier: Carrier,
}

/// When a taught file is played.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum TaughtWhen {
    /// Before the lines of each copy.
    Before,
    /// After the lines of each copy.
    After,
}

/// Postures recorded on the arm.
#[derive(Debug, Clone, PartialEq)]
pub struct TaughtSpec {
    /// CSV file.
    pub file: PathBuf,
    /// When it is played.
    pub when: TaughtWhen,
}

/// The language of the program.
#[derive(Debug, Clone, PartialEq)]
pub enum DialectSpec {
    /// Motoman job.
    Jbi {
        /// Year, month, day, hour, minute.
        date: [u16; 5],
        /// Positions as encoder pulses.
        pulses: bool,
        /// Number of the tool.
        tool_number: u8,
    },
    /// ABB module.
    Rapid {
        /// Zone of the points between.
        zone: Option<String>,
        /// Name of the tool.
        tool_name: String,
    },
}

/// The robot program.
#[derive(Debug, Clone, PartialEq)]
pub struct ProgramSpec {
    /// Its name, and that of its file.
    pub name: String,
    /// A remark in its head.
    pub comment: String,
    /// The language.
    pub dialect: DialectSpec,
    /// Speed of moves by joints, share of the top speed.
    pub joint_share: f64,
    /// Largest motion of one joint from point to point on a line, rad.
    pub largest_step_rad: f64,
    /// Where the controller's base frame stands in the world.
    pub base: PlaceSpec,
}
