//! Arguments as written, and in the resolved form that the commands use.

mod finishing;
mod new;
mod number;
mod part;
mod robot;
mod runs;
mod stability;
mod sweep;

use std::path::{Path, PathBuf};

use clap::{Args, CommandFactory, FromArgMatches, Parser, Subcommand};
use truecut_scenario::Scenario;

use crate::failure::Failure;

pub use finishing::{CamArguments, PathArguments, ProgramArguments};
pub use new::{NewArguments, ProcessName};
pub use part::PartArguments;
pub use robot::{InitArguments, RobotArguments, RobotCommand};
pub use runs::{
    CheckArguments, CompareArguments, CrosscheckArguments, DiagnoseArguments, ExciteArguments,
    FitArguments, RunArguments,
};
pub use stability::{CriterionName, LobesArguments, PostureArguments};
pub use sweep::{SweepArguments, Workers};

/// Physics-backed simulation of robotic machining.
///
/// Exit codes: 0 good, 1 a claim failed or a robot program cannot be run as written, 2 bad input,
/// 3 a run diverged, 4 the cross-check disagrees, 5 a run ended in chatter, 6 a drive is
/// overloaded, 7 masses or inertias of the arm are placeholders, 8 a run left what its model
/// describes, 130 or 143 a signal ended the command.
#[derive(Debug, Parser)]
#[command(name = "truecut", version)]
pub struct Arguments {
    #[command(subcommand)]
    pub command: Command,
    /// Most memory that may be used, such as 2G: files whose contents would take more, and runs
    /// whose rows would, are refused beforehand [default: the limits of the control group and of
    /// the process, if any]
    #[arg(long, global = true, value_name = "BYTES", value_parser = number::bytes)]
    pub max_memory: Option<u64>,
}

impl Arguments {
    /// Those of this call; ends the program where they make no sense.
    pub fn given() -> Arguments {
        let mut matches = Arguments::as_command().get_matches();
        Arguments::from_arg_matches_mut(&mut matches).unwrap_or_else(|error| error.exit())
    }

    fn as_command() -> clap::Command {
        signed(Arguments::command())
    }
}

/// Takes numbers below zero as values, so that each is held to the rule of its own argument.
fn signed(command: clap::Command) -> clap::Command {
    let own = command
        .get_subcommands()
        .map(|own| own.get_name().to_owned());
    let own: Vec<String> = own.collect();
    let command = command.mut_args(|one| match one.get_action().takes_values() {
        true if !one.is_positional() => one.allow_negative_numbers(true),
        _ => one,
    });
    (own.iter()).fold(command, |command, name| {
        command.mut_subcommand(name, signed)
    })
}

#[derive(Debug, Subcommand)]
pub enum Command {
    /// Write a scenario of your robot that runs, to begin with
    New(NewArguments),
    /// Run scenarios, judge their claims and write recordings
    Run(RunArguments),
    /// Run a sweep whole, some of its rows as a part, put parts together, or run it on a cluster
    Sweep(SweepArguments),
    /// Run every scenario found, judge the claims, print one table and write JUnit XML
    Check(CheckArguments),
    /// Open a recording in the viewer, or list what it holds
    View(ViewArguments),
    /// Write the robot of a scenario, in its posture, as a MuJoCo model
    ExportMjcf(ExportArguments),
    /// Run scenarios here and in MuJoCo, and compare the recordings
    Crosscheck(CrosscheckArguments),
    /// Run a scenario, compare it with measured data, and report what the simulation gets wrong
    Compare(CompareArguments),
    /// Print what is in a file of measured data: channels, units, rate, gaps, faults, and the lines
    /// of a scenario that would read it
    Data(DataArguments),
    /// Look for what the simulation lacks against measured data, name it, and extend the scenario
    Diagnose(DiagnoseArguments),
    /// Fit links, rotors and friction of all joints to measured motion and drive forces at once
    Fit(FitArguments),
    /// Plan a motion within all limits that makes friction, links or causes identifiable
    Excite(ExciteArguments),
    /// Stability diagram of a milling scenario: limit depth over spindle speed, with simulated runs
    Lobes(LobesArguments),
    /// Choose the arm's postures along the path of a milling scenario so that the cut is stable
    Posture(PostureArguments),
    /// Print what is understood of a part's mesh: size, defects, faces, edges
    Part(PartArguments),
    /// Lay a contact wheel's lines on a face, and write the robot program that follows them
    Path(PathArguments),
    /// Read a robot program back, run through it, and say what the robot cannot do
    Program(ProgramArguments),
    /// Read load-deflection tables and hammer FRFs: joint stiffness with intervals, measured and
    /// modelled modes
    Identify(IdentifyArguments),
    /// Print what is understood of a robot: chain, masses, modes, stiffness at a posture
    Robot(RobotArguments),
    /// Print the completions of a shell, or write the manual's pages
    Completions(CompletionsArguments),
    /// Print the JSON Schema of the scenario file, the identification file, the path job, the
    /// cell, a surface or robot.toml
    Schema(SchemaArguments),
}

/// How scenarios are changed and how many run at once.
#[derive(Debug, Args)]
pub struct Common {
    /// Change a key of the scenario, e.g. process.chamfer.spindle_rpm=400; may be repeated
    #[arg(long = "set", value_name = "KEY=VALUE", value_parser = parse_set)]
    pub set: Vec<(String, String)>,
    /// How many runs may go on at once [default: one for each core]
    #[arg(long, value_name = "N", value_parser = number::count)]
    pub jobs: Option<std::num::NonZeroUsize>,
}

#[derive(Debug, Args)]
#[group(required = true, multiple = false)]
pub struct CompletionsArguments {
    /// The shell, whose completions are printed
    #[arg(value_enum)]
    shell: Option<clap_complete::Shell>,
    /// Write a page of the manual for each command into this folder instead
    #[arg(long, value_name = "DIR")]
    man: Option<PathBuf>,
}

impl CompletionsArguments {
    /// What is printed; pages of the manual are written.
    ///
    /// # Errors
    /// A folder that cannot be written to.
    pub fn text(&self) -> Result<String, Failure> {
        let mut command = Arguments::as_command();
        if let Some(folder) = &self.man {
            std::fs::create_dir_all(folder)
                .and_then(|()| clap_mangen::generate_to(command, folder))
                .map_err(|error| Failure::at(folder, error))?;
            return Ok(format!("  {}/truecut.1\n", folder.display()));
        }
        let mut text = Vec::new();
        if let Some(shell) = self.shell {
            clap_complete::generate(shell, &mut command, "truecut", &mut text);
        }
        Ok(String::from_utf8_lossy(&text).into_owned())
    }
}

#[derive(Debug, Args)]
pub struct DataArguments {
    /// Measured data: .csv, .txt, .tsv, .parquet, .arrow or .mcap
    pub file: PathBuf,
    /// The first row of a CSV file does not name the columns
    #[arg(long)]
    pub no_header: bool,
    /// Print the lines for the scenario alone
    #[arg(long, conflicts_with = "json")]
    pub toml: bool,
    /// Print everything as JSON
    #[arg(long)]
    pub json: bool,
}

#[derive(Debug, Args)]
pub struct ViewArguments {
    /// A recording: .rrd, .parquet or .arrows
    pub file: PathBuf,
    /// Convert a .parquet or .arrows file to a .rrd in the same folder
    #[arg(long)]
    pub rrd: bool,
}

#[derive(Debug, Args)]
pub struct ExportArguments {
    /// Scenario file
    pub scenario: PathBuf,
    /// The MJCF file to write
    #[arg(short, long, value_name = "FILE")]
    pub output: PathBuf,
    /// Change a key of the scenario; may be repeated
    #[arg(long = "set", value_name = "KEY=VALUE", value_parser = parse_set)]
    pub set: Vec<(String, String)>,
}

#[derive(Debug, Args)]
pub struct IdentifyArguments {
    /// Identification file, with [stiffness], [modes] or both
    pub file: PathBuf,
    /// Folder for outputs; the identification gets a folder of its own in it
    #[arg(long, value_name = "DIR", default_value = "out")]
    pub out: PathBuf,
}

#[derive(Debug, Args)]
pub struct SchemaArguments {
    /// Of the identification file
    #[arg(long, conflicts_with = "path")]
    pub identification: bool,
    /// Of the path job
    #[arg(long)]
    pub path: bool,
    /// Of robot.toml
    #[arg(long, conflicts_with_all = ["path", "identification"])]
    pub robot: bool,
    /// Of the file of a surface's patch
    #[arg(long, conflicts_with_all = ["path", "identification", "robot"])]
    pub surface: bool,
    /// Of the cell
    #[arg(long, conflicts_with_all = ["path", "identification", "robot", "surface"])]
    pub cell: bool,
}

impl SchemaArguments {
    /// The schema asked for.
    pub fn schema(&self) -> serde_json::Value {
        if self.identification {
            truecut_scenario::Identification::json_schema()
        } else if self.robot {
            truecut_arm::config::json_schema().to_value()
        } else if self.surface {
            truecut_plan::surface::PatchFile::json_schema()
        } else if self.cell {
            truecut_scenario::CellFile::json_schema()
        } else if self.path {
            truecut_scenario::PathJob::json_schema()
        } else {
            truecut_scenario::Scenario::json_schema()
        }
    }
}

impl Common {
    /// The scenario of a file, changed.
    pub fn load(&self, path: &Path) -> Result<Scenario, Failure> {
        self.use_jobs()?;
        Ok(Scenario::load(path, &self.set)?)
    }

    pub fn use_jobs(&self) -> Result<(), Failure> {
        let asked = self.jobs.map_or(0, std::num::NonZeroUsize::get);
        if asked > MOST_JOBS {
            return Err(Failure::message(format!(
                "--jobs is {asked}, but must be at most {MOST_JOBS}: each takes a thread"
            )));
        }
        let cores = std::thread::available_parallelism().map_or(1, std::num::NonZeroUsize::get);
        let threads = asked.min(MOST_THREADS_PER_CORE * cores);
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build_global();
        pool.map_err(|error| Failure::message(format!("cannot start {threads} jobs: {error}")))
    }
}

/// More jobs are a typing error.
const MOST_JOBS: usize = 1024;

/// More threads per core only slow each other down.
const MOST_THREADS_PER_CORE: usize = 4;

fn parse_set(text: &str) -> Result<(String, String), String> {
    parse_pair(text)
        .ok_or_else(|| "write KEY=VALUE, e.g. process.chamfer.spindle_rpm=400".to_owned())
}

/// An argument of a xacro file, or where a package is.
fn parse_named(text: &str) -> Result<(String, String), String> {
    parse_pair(text).ok_or_else(|| "write NAME=VALUE, e.g. prefix=left_".to_owned())
}

fn parse_pair(text: &str) -> Option<(String, String)> {
    let (key, value) = text
        .split_once('=')
        .map(|pair| (pair.0.trim(), pair.1.trim()))?;
    let is_whole = !key.is_empty() && !value.is_empty();
    is_whole.then(|| (key.to_owned(), value.to_owned()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_command_line_is_consistent() {
        Arguments::as_command().debug_assert();
    }

    #[test]
    fn set_splits_at_the_first_equals_sign() {
        let pair = |key: &str, value: &str| Ok((key.to_owned(), value.to_owned()));
        assert_eq!(parse_set("name = a=b"), pair("name", "a=b"));
        assert!(parse_set("name").is_err() && parse_set("=1").is_err() && parse_set("a=").is_err());
    }
}
