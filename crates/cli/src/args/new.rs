//! Arguments of `truecut new`.

use std::path::PathBuf;

use clap::{Args, ValueEnum};

use super::number::finite;
use super::parse_named;

#[derive(Debug, Args)]
pub struct NewArguments {
    /// What the tool does
    #[arg(value_enum, value_name = "PROCESS")]
    pub process: ProcessName,
    /// The robot's URDF or xacro file
    #[arg(long, value_name = "FILE")]
    pub robot: PathBuf,
    /// Transmission data [default: robot.toml beside the robot's file]
    #[arg(long, value_name = "FILE")]
    pub config: Option<PathBuf>,
    /// Argument of the robot's file, if that is xacro; may be repeated
    #[arg(long = "arg", value_name = "NAME=VALUE", value_parser = parse_named)]
    pub arguments: Vec<(String, String)>,
    /// The file to write; a file that is there is kept
    #[arg(short, long, value_name = "FILE", default_value = "scenario.toml")]
    pub out: PathBuf,
    /// Name of the scenario [default: what the tool does]
    #[arg(long)]
    pub name: Option<String>,
    /// Joint angles in degrees (prismatic joints in mm), in chain order, for load and chamfer
    /// [default: a posture far from limits and singularities]
    #[arg(
        long,
        value_name = "A,B,…",
        value_delimiter = ',',
        value_parser = finite,
        allow_hyphen_values = true,
        conflicts_with = "place_mm"
    )]
    pub posture_deg: Option<Vec<f64>>,
    /// Where milling and polishing begin, in the world, mm [default: a place that is reached]
    #[arg(
        long,
        value_name = "X,Y,Z",
        value_delimiter = ',',
        value_parser = finite,
        allow_hyphen_values = true
    )]
    pub place_mm: Option<Vec<f64>>,
}

/// What the tool does.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum ProcessName {
    /// A force at the tool
    Load,
    /// Chamfers the rim of a hole
    Chamfer,
    /// Mills along a line
    Milling,
    /// Polishes a level rectangle
    Polish,
}
