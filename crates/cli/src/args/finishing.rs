//! Arguments of `path` and `program`.

use std::path::PathBuf;

use clap::Args;
use truecut_plan::program::DIALECTS;

use super::number::{above_zero, above_zero_to, finite, three, within};

#[derive(Debug, Args)]
pub struct PathArguments {
    /// Path job (.toml: face, contact wheel, lines, robot and program), or a path from CAM: G-code
    /// (.nc, .ngc, .gcode …), APT (.apt, .cls …) or poses (.csv)
    pub file: PathBuf,
    /// Folder for outputs; the job gets a folder of its own in it
    #[arg(long, value_name = "DIR", default_value = "out")]
    pub out: PathBuf,
    #[command(flatten)]
    pub cam: CamArguments,
}

/// What a path from CAM needs beside its file.
#[derive(Debug, Default, PartialEq, Args)]
#[command(next_help_heading = "For paths from CAM")]
pub struct CamArguments {
    /// URDF file of the arm; its robot.toml gives the tool frame, z into the workpiece
    #[arg(long, value_name = "URDF")]
    pub robot: Option<PathBuf>,
    /// Transmission data and tool frame [default: robot.toml beside the URDF]
    #[arg(long, value_name = "FILE")]
    pub config: Option<PathBuf>,
    /// Link whose frame is the flange [default: the end of the chain]
    #[arg(long, value_name = "LINK")]
    pub tip: Option<String>,
    /// Where the slides of the arm stand while the program runs, in chain order
    #[arg(
        long,
        value_name = "A,B,…",
        value_delimiter = ',',
        value_parser = finite,
        allow_hyphen_values = true
    )]
    pub slide_mm: Option<Vec<f64>>,
    /// Posture near to which the path shall begin, one value a rotary joint [default: the middle of
    /// the joints' ranges]
    #[arg(
        long,
        value_name = "A,B,…",
        value_delimiter = ',',
        value_parser = finite,
        allow_hyphen_values = true
    )]
    pub posture_deg: Option<Vec<f64>>,
    /// Language of the robot program [default: rapid]
    #[arg(long, value_parser = dialects())]
    pub dialect: Option<String>,
    /// Option of the dialect, key=value, e.g. date="2026-01-31 12:00" for jbi
    #[arg(long, value_name = "KEY=VALUE")]
    pub option: Vec<String>,
    /// Name of the program [default: of the file]
    #[arg(long)]
    pub name: Option<String>,
    /// Where the work frame stands in the world
    #[arg(long, value_name = "X,Y,Z", value_parser = three, allow_hyphen_values = true)]
    pub work_xyz_mm: Option<[f64; 3]>,
    /// Roll, pitch and yaw of the work frame in the world
    #[arg(long, value_name = "R,P,Y", value_parser = three, allow_hyphen_values = true)]
    pub work_rpy_deg: Option<[f64; 3]>,
    /// Where the controller's base frame stands in the world
    #[arg(long, value_name = "X,Y,Z", value_parser = three, allow_hyphen_values = true)]
    pub base_xyz_mm: Option<[f64; 3]>,
    /// Roll, pitch and yaw of the base frame in the world
    #[arg(long, value_name = "R,P,Y", value_parser = three, allow_hyphen_values = true)]
    pub base_rpy_deg: Option<[f64; 3]>,
    /// Unit of lengths where the file does not say it [default: mm]
    #[arg(long, value_parser = ["mm", "inch"])]
    pub unit: Option<String>,
    /// How far chords may lie off an arc [default: 0.01]
    #[arg(long, value_name = "MM", value_parser = chord)]
    pub chord_mm: Option<f64>,
    /// Turn about the tool's axis [default: the one that keeps the joints nearest to the middle of
    /// their ranges, or to --posture-deg]
    #[arg(long, value_name = "DEG", value_parser = turn, allow_hyphen_values = true)]
    pub spin_deg: Option<f64>,
    /// Speed in rapid traverse [default: 250]
    #[arg(long, value_name = "SPEED", value_parser = speed)]
    pub rapid_mm_per_s: Option<f64>,
    /// Speed of the move to the first point, fraction of the top speed [default: 0.25]
    #[arg(long, value_name = "FRACTION", value_parser = share)]
    pub joint_speed: Option<f64>,
    /// Within what points are passed; 0 stops at each [default: the dialect's]
    #[arg(long, value_name = "MM", value_parser = zone, allow_hyphen_values = true)]
    pub zone_mm: Option<f64>,
    /// Digital output that runs the spindle: a name in RAPID, else a number
    #[arg(long, value_name = "OUTPUT")]
    pub spindle_signal: Option<String>,
    /// Acceleration of the tool on lines, for the cycle time
    #[arg(long, value_name = "M/S2", value_parser = above_zero)]
    pub acceleration_m_per_s2: Option<f64>,
    /// Cell (.toml): part, fixtures and what the flange carries, which must not touch
    #[arg(long, value_name = "FILE")]
    pub cell: Option<PathBuf>,
}

/// Faster than any robot by far, mm/s.
const FASTEST_MM_PER_S: f64 = 1e3 * truecut_plan::program::FASTEST_M_PER_S;
/// Larger than any part, mm.
const LARGEST_MM: f64 = 10_000.0;
/// Turns beyond this are a slip, degrees.
const MOST_TURNED_DEG: f64 = 3600.0;

fn speed(text: &str) -> Result<f64, String> {
    above_zero_to(text, FASTEST_MM_PER_S)
}

fn share(text: &str) -> Result<f64, String> {
    above_zero_to(text, 1.0)
}

fn chord(text: &str) -> Result<f64, String> {
    above_zero_to(text, LARGEST_MM)
}

fn zone(text: &str) -> Result<f64, String> {
    within(text, 0.0..=LARGEST_MM)
}

fn turn(text: &str) -> Result<f64, String> {
    within(text, -MOST_TURNED_DEG..=MOST_TURNED_DEG)
}

/// Names of all dialects.
fn dialects() -> clap::builder::PossibleValuesParser {
    clap::builder::PossibleValuesParser::new(DIALECTS.iter().map(|dialect| dialect.name()))
}

#[derive(Debug, Args)]
pub struct ProgramArguments {
    #[arg(help = program_files())]
    pub file: PathBuf,
    /// URDF file of the robot that runs it; its robot.toml gives the tool frame of jobs
    #[arg(long, value_name = "URDF")]
    pub robot: PathBuf,
    /// Transmission data and tool frame [default: robot.toml beside the URDF]
    #[arg(long, value_name = "FILE")]
    pub config: Option<PathBuf>,
    /// Link whose frame is the flange [default: the end of the chain]
    #[arg(long, value_name = "LINK")]
    pub tip: Option<String>,
    /// Where the slides of the arm stand while the program runs, in chain order
    #[arg(
        long,
        value_name = "A,B,…",
        value_delimiter = ',',
        value_parser = finite,
        allow_hyphen_values = true
    )]
    pub slide_mm: Option<Vec<f64>>,
    /// Path that the program is held against: the path.csv written with it
    #[arg(long, value_name = "CSV")]
    pub path: Option<PathBuf>,
    /// Pulses per degree of the turntable, if a job has one
    #[arg(long, value_name = "PULSES", value_parser = above_zero)]
    pub pulses_per_deg: Option<f64>,
    /// Digital output that runs the spindle: a name in RAPID, else a number
    #[arg(long, value_name = "OUTPUT")]
    pub spindle_signal: Option<String>,
    /// Acceleration of the tool on lines, for the cycle time
    #[arg(long, value_name = "M/S2", value_parser = above_zero)]
    pub acceleration_m_per_s2: Option<f64>,
    /// Where a job's base frame stands in the world; a module says it itself
    #[arg(long, value_name = "X,Y,Z", value_parser = three, allow_hyphen_values = true)]
    pub base_xyz_mm: Option<[f64; 3]>,
    /// Roll, pitch and yaw of a job's base frame in the world
    #[arg(long, value_name = "R,P,Y", value_parser = three, allow_hyphen_values = true)]
    pub base_rpy_deg: Option<[f64; 3]>,
    /// Cell (.toml): part, fixtures and what the flange carries, which must not touch
    #[arg(long, value_name = "FILE")]
    pub cell: Option<PathBuf>,
}

/// What `truecut program` reads.
fn program_files() -> String {
    let all: Vec<&str> = DIALECTS.iter().map(|dialect| dialect.about()).collect();
    format!("Robot program: {}", all.join(" or "))
}
