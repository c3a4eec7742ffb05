//! Arguments of `path` and `program`.

use std::path::PathBuf;

use clap::Args;
use truecut_plan::program::DIALECTS;

use super::number::above_zero;

#[derive(Debug, Args)]
pub struct PathArguments {
    /// Path job: face, contact wheel, lines, robot and program
    pub file: PathBuf,
    /// Folder for outputs; the job gets a folder of its own in it
    #[arg(long, value_name = "DIR", default_value = "out")]
    pub out: PathBuf,
}

#[derive(Debug, Args)]
pub struct ProgramArguments {
    #[arg(help = program_files())]
    pub file: PathBuf,
    /// URDF file of the robot that runs it; its robot.toml gives the tool frame of jobs
    #[arg(long, value_name = "URDF")]
    pub robot: PathBuf,
    /// Link whose frame is the flange [default: the end of the chain]
    #[arg(long, value_name = "LINK")]
    pub tip: Option<String>,
    /// Path that the program is held against: the path.csv written with it
    #[arg(long, value_name = "CSV")]
    pub path: Option<PathBuf>,
    /// Pulses per degree of the turntable, if a job has one
    #[arg(long, value_name = "PULSES", value_parser = above_zero)]
    pub pulses_per_deg: Option<f64>,
    /// Where a job's base frame stands in the world; a module says it itself
    #[arg(
        long,
        value_name = "X,Y,Z",
        value_delimiter = ',',
        num_args = 3,
        allow_hyphen_values = true
    )]
    pub base_xyz_mm: Option<Vec<f64>>,
    /// Roll, pitch and yaw of a job's base frame in the world
    #[arg(
        long,
        value_name = "R,P,Y",
        value_delimiter = ',',
        num_args = 3,
        allow_hyphen_values = true
    )]
    pub base_rpy_deg: Option<Vec<f64>>,
}

/// What `truecut program` reads.
fn program_files() -> String {
    let all: Vec<&str> = DIALECTS.iter().map(|dialect| dialect.about()).collect();
    format!("Robot program: {}", all.join(" or "))
}
