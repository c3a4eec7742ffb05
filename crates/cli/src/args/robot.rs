//! Arguments of `truecut robot`.

use std::path::PathBuf;

use clap::{Args, Subcommand, ValueEnum};
use truecut_arm::{FrameId, Masses, Packages, Reading};

use super::number::{above_zero, finite};
use super::parse_named;

/// Which robot, and where what it names is found.
#[derive(Debug, Args)]
pub struct RobotSource {
    /// Link whose frame is the flange [default: the end of the chain]
    #[arg(long, value_name = "LINK")]
    pub tip: Option<String>,
    /// Folder of a package that the file names; may be repeated. ROS_PACKAGE_PATH is searched, too,
    /// and so are the folders beside the robot's own package
    #[arg(long = "package", value_name = "NAME=DIR", value_parser = parse_named)]
    packages: Vec<(String, String)>,
    /// Argument of a xacro file; may be repeated
    #[arg(long = "arg", value_name = "NAME=VALUE", value_parser = parse_named)]
    arguments: Vec<(String, String)>,
}

impl RobotSource {
    pub fn packages(&self) -> Packages {
        let named = self.packages.iter().cloned();
        Packages::from_environment(named.map(|(name, folder)| (name, PathBuf::from(folder))))
    }

    pub fn arguments(&self) -> std::collections::BTreeMap<String, String> {
        self.arguments.iter().cloned().collect()
    }

    /// As options of another call that reads the same robot, each after a space.
    pub fn as_options(&self) -> String {
        let tip = self.tip.iter().map(|link| format!(" --tip {link:?}"));
        let named = |option: &str, of: &[(String, String)]| -> String {
            of.iter()
                .map(|(name, value)| format!(" --{option} {:?}", format!("{name}={value}")))
                .collect()
        };
        let packages = named("package", &self.packages);
        tip.collect::<String>() + &packages + &named("arg", &self.arguments)
    }

    /// How the robot is read.
    pub fn reading<'a>(&'a self, config: Option<&'a PathBuf>, masses: Masses) -> Reading<'a> {
        Reading {
            config: config.map(PathBuf::as_path),
            tip: self.tip.as_deref(),
            masses,
            packages: self.packages(),
            arguments: self.arguments(),
        }
    }
}

#[derive(Debug, Args)]
#[command(args_conflicts_with_subcommands = true, subcommand_negates_reqs = true)]
pub struct RobotArguments {
    #[command(subcommand)]
    pub command: Option<RobotCommand>,
    /// URDF or xacro file
    #[arg(required = true)]
    pub urdf: Option<PathBuf>,
    #[command(flatten)]
    pub source: RobotSource,
    /// Transmission data [default: robot.toml beside the file]
    #[arg(long, value_name = "FILE")]
    pub config: Option<PathBuf>,
    /// Joint angles in degrees (prismatic joints in mm), in chain order, separated by commas
    #[arg(
        long,
        value_name = "A,B,…",
        value_delimiter = ',',
        value_parser = finite,
        allow_hyphen_values = true
    )]
    pub posture_deg: Option<Vec<f64>>,
    /// Print flange poses for a posture `j1,j2,…` (rad and m, slides included), or for the postures
    /// in this CSV file, one a row: rad and m, or as the heading says (j1_deg, j1_mm). Among other
    /// columns those that name joints are read, in degrees and mm where their names do not say: a
    /// path.csv, taught points, what --ik prints
    #[arg(long, value_name = "POSTURE|FILE", allow_hyphen_values = true)]
    pub fk: Option<String>,
    /// Print all postures for a pose `x,y,z,roll,pitch,yaw` (m and rad), or for the poses in this
    /// CSV file (such rows, or rows as --fk prints them)
    #[arg(
        long,
        value_name = "POSE|FILE",
        allow_hyphen_values = true,
        conflicts_with = "fk"
    )]
    pub ik: Option<String>,
    /// Where the slides of the arm stand, in chain order, for --ik (a track is driven to a place,
    /// and the arm reaches from there; without it slides move, and postures are samples) and for
    /// --fk (of a table that has no columns for them)
    #[arg(
        long,
        value_name = "A,B,…",
        value_delimiter = ',',
        value_parser = finite,
        allow_hyphen_values = true,
        conflicts_with_all = ["urdf_text", "posture_deg"]
    )]
    pub slide_mm: Option<Vec<f64>>,
    /// The frame that --ik puts at the pose
    #[arg(long, value_enum, default_value = "tool", requires = "ik")]
    pub frame: Frame,
    /// Print the URDF that a xacro file comes to
    #[arg(long, conflicts_with_all = ["fk", "ik"])]
    pub urdf_text: bool,
    /// Print JSON
    #[arg(long, conflicts_with_all = ["fk", "urdf_text"])]
    pub json: bool,
}

#[derive(Debug, Subcommand)]
pub enum RobotCommand {
    /// Write a robot.toml for an arm of which only a data sheet is known: every value estimated by
    /// a stated rule
    Init(InitArguments),
}

#[derive(Debug, Args)]
pub struct InitArguments {
    /// URDF or xacro file
    pub urdf: PathBuf,
    #[command(flatten)]
    pub source: RobotSource,
    /// Mass of the arm with its base, kg [default: the masses of the file]
    #[arg(long, value_name = "KG", value_parser = above_zero)]
    pub mass: Option<f64>,
    /// What the arm may carry, kg
    #[arg(long, value_name = "KG", value_parser = above_zero)]
    pub payload: f64,
    /// How far from its first axis the arm reaches, m: held against the file's chain
    #[arg(long, value_name = "M", value_parser = above_zero)]
    pub reach: Option<f64>,
    /// Pose repeatability (ISO 9283), mm: told as the force that is lost in it
    #[arg(long, value_name = "MM", value_parser = above_zero)]
    pub repeatability: Option<f64>,
    /// The file to write [default: robot.toml beside the robot's file]
    #[arg(long, value_name = "FILE")]
    pub out: Option<PathBuf>,
    /// Write over a file that is there
    #[arg(long)]
    pub force: bool,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
pub enum Frame {
    Flange,
    Tool,
    Foot,
}

impl From<Frame> for FrameId {
    fn from(frame: Frame) -> FrameId {
        match frame {
            Frame::Flange => FrameId::Flange,
            Frame::Tool => FrameId::Tool,
            Frame::Foot => FrameId::Foot,
        }
    }
}
