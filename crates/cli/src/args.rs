//! Arguments as written, and in the resolved form that the commands use.

mod finishing;
mod stability;

use std::collections::BTreeMap;
use std::path::PathBuf;

use clap::{Args, Parser, Subcommand};
use truecut_discrepancy::diagnose::Options;
use truecut_scenario::Scenario;

use crate::diagnose;
use crate::failure::Failure;
use crate::find::find_scenarios;

pub use finishing::{PathArguments, ProgramArguments};
pub use stability::{LobesArguments, PostureArguments};

/// Physics-backed simulation of robotic machining.
///
/// Exit codes: 0 good, 1 a claim failed or a robot program cannot be run as written, 2 bad input,
/// 3 a run diverged, 4 the cross-check disagrees.
#[derive(Debug, Parser)]
#[command(name = "truecut", version)]
pub struct Arguments {
    #[command(subcommand)]
    pub command: Command,
}

#[derive(Debug, Subcommand)]
pub enum Command {
    /// Run scenarios, judge their claims and write recordings
    Run(RunArguments),
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
    /// Look for what the simulation lacks against measured data, name it, and extend the scenario
    Diagnose(DiagnoseArguments),
    /// Stability diagram of a milling scenario: limit depth over spindle speed, with simulated runs
    Lobes(LobesArguments),
    /// Choose the arm's postures along the path of a milling scenario so that the cut is stable
    Posture(PostureArguments),
    /// Lay a contact wheel's lines on a face, and write the robot program that follows them
    Path(PathArguments),
    /// Read a robot program back, run through it, and say what the robot cannot do
    Program(ProgramArguments),
    /// Read load-deflection tables and hammer FRFs: joint stiffness with intervals, measured and
    /// modelled modes
    Identify(IdentifyArguments),
    /// Print what is understood of a robot: chain, masses, modes, stiffness at a posture
    Robot(RobotArguments),
    /// Print the JSON Schema of the scenario file, of the identification file or of the path job
    Schema(SchemaArguments),
}

/// How scenarios are changed and how many run at once.
#[derive(Debug, Args)]
pub struct Common {
    /// Change a key of the scenario, e.g. process.chamfer.spindle_rpm=400; may be repeated
    #[arg(long = "set", value_name = "KEY=VALUE", value_parser = parse_set)]
    pub set: Vec<(String, String)>,
    /// How many runs may go on at once [default: one for each core]
    #[arg(long, value_name = "N")]
    pub jobs: Option<std::num::NonZeroUsize>,
}

#[derive(Debug, Args)]
pub struct RunArguments {
    /// Scenario files
    #[arg(required = true, value_name = "SCENARIO")]
    scenarios: Vec<PathBuf>,
    /// Folder for outputs; each scenario gets a folder of its own in it
    #[arg(long, value_name = "DIR", default_value = "out")]
    out: PathBuf,
    #[command(flatten)]
    common: Common,
    /// Write no .rrd file for the viewer
    #[arg(long)]
    no_rrd: bool,
    /// Measured data (.csv or .parquet) in the place of data.file of the scenarios
    #[arg(long, value_name = "FILE")]
    data: Option<PathBuf>,
}

#[derive(Debug, Args)]
pub struct CheckArguments {
    /// Scenario files, or folders in which they are looked for
    #[arg(required = true, value_name = "PATH")]
    paths: Vec<PathBuf>,
    #[command(flatten)]
    common: Common,
    /// Where the JUnit XML goes
    #[arg(long, value_name = "FILE", default_value = "out/junit.xml")]
    junit: PathBuf,
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
pub struct CrosscheckArguments {
    /// Scenario files
    #[arg(required = true, value_name = "SCENARIO")]
    scenarios: Vec<PathBuf>,
    /// Folder for outputs; each scenario gets a folder of its own in it
    #[arg(long, value_name = "DIR", default_value = "out")]
    out: PathBuf,
    #[command(flatten)]
    common: Common,
}

#[derive(Debug, Args)]
pub struct CompareArguments {
    /// Scenario file, with a table [data]
    scenario: PathBuf,
    /// The measured data, .csv or .parquet [default: data.file of the scenario]
    #[arg(long, value_name = "FILE")]
    data: Option<PathBuf>,
    /// Folder for outputs; the scenario gets a folder of its own in it
    #[arg(long, value_name = "DIR", default_value = "out")]
    out: PathBuf,
    /// Speed of the spindle, to find lines at its orders of rotation [default: the scenario's]
    #[arg(long, value_name = "RPM", value_parser = parse_rpm)]
    rpm: Option<f64>,
    #[command(flatten)]
    common: Common,
}

#[derive(Debug, Args)]
pub struct DiagnoseArguments {
    /// Scenario file with a [data] table
    scenario: PathBuf,
    /// Measured data (.csv or .parquet) [default: the file that the scenario names]
    #[arg(long, value_name = "FILE")]
    data: Option<PathBuf>,
    /// Folder for outputs; the scenario gets a folder of its own in it
    #[arg(long, value_name = "DIR", default_value = "out")]
    out: PathBuf,
    /// Most simulations that the search may make [default: 2500]
    #[arg(long, value_name = "N")]
    max_runs: Option<std::num::NonZeroUsize>,
    /// Most causes that are named together [default: 4]
    #[arg(long, value_name = "N")]
    max_causes: Option<std::num::NonZeroUsize>,
    #[command(flatten)]
    common: Common,
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
}

impl SchemaArguments {
    /// The schema asked for.
    pub fn schema(&self) -> serde_json::Value {
        if self.identification {
            truecut_scenario::Identification::json_schema()
        } else if self.path {
            truecut_scenario::PathJob::json_schema()
        } else {
            truecut_scenario::Scenario::json_schema()
        }
    }
}

#[derive(Debug, Args)]
pub struct RobotArguments {
    /// URDF file
    pub urdf: PathBuf,
    /// Link whose frame is the flange [default: the end of the chain]
    #[arg(long, value_name = "LINK")]
    pub tip: Option<String>,
    /// Joint angles in degrees (prismatic joints in mm), in chain order, separated by commas
    #[arg(
        long,
        value_name = "A,B,…",
        value_delimiter = ',',
        allow_hyphen_values = true
    )]
    pub posture_deg: Option<Vec<f64>>,
    /// Print flange poses for the postures in this CSV file (rad and m, one posture a row)
    #[arg(long, value_name = "FILE")]
    pub fk: Option<PathBuf>,
    /// Print JSON
    #[arg(long, conflicts_with = "fk")]
    pub json: bool,
}

/// `run`, resolved.
pub struct RunPlan {
    pub scenarios: Vec<Scenario>,
    pub data: Option<PathBuf>,
    pub out: PathBuf,
    pub rrd: bool,
}

/// `compare`, resolved.
pub struct ComparePlan {
    pub scenario: Scenario,
    pub data: Option<PathBuf>,
    pub out: PathBuf,
    pub spindle_hz: Option<f64>,
}

/// `check`, resolved.
pub struct CheckPlan {
    pub files: Vec<PathBuf>,
    pub set: Vec<(String, String)>,
    pub junit: PathBuf,
}

impl RunArguments {
    /// Loads every scenario before any runs.
    pub fn resolve(self) -> Result<RunPlan, Failure> {
        let scenarios = load_all(&self.scenarios, &self.common)?;
        Ok(RunPlan {
            scenarios,
            data: self.data,
            out: self.out,
            rrd: !self.no_rrd,
        })
    }
}

impl DiagnoseArguments {
    /// Loads the scenario.
    pub fn resolve(self) -> Result<diagnose::DiagnosePlan, Failure> {
        self.common.use_jobs()?;
        let mut options = Options::default();
        if let Some(runs) = self.max_runs {
            options.max_predictions = runs.get();
        }
        if let Some(causes) = self.max_causes {
            options.max_effects = causes.get();
        }
        Ok(diagnose::DiagnosePlan {
            scenario: Scenario::load(&self.scenario, &self.common.set)?,
            data: self.data,
            out: self.out,
            options,
        })
    }
}

impl CrosscheckArguments {
    /// Loads every scenario before any runs.
    pub fn resolve(self) -> Result<RunPlan, Failure> {
        let scenarios = load_all(&self.scenarios, &self.common)?;
        Ok(RunPlan {
            scenarios,
            data: None,
            out: self.out,
            rrd: false,
        })
    }
}

impl CompareArguments {
    /// Loads the scenario.
    pub fn resolve(self) -> Result<ComparePlan, Failure> {
        self.common.use_jobs()?;
        Ok(ComparePlan {
            scenario: Scenario::load(&self.scenario, &self.common.set)?,
            data: self.data,
            out: self.out,
            spindle_hz: self.rpm.map(|rpm| rpm / 60.0),
        })
    }
}

impl CheckArguments {
    /// Finds the scenarios.
    pub fn resolve(self) -> Result<CheckPlan, Failure> {
        self.common.use_jobs()?;
        Ok(CheckPlan {
            files: find_scenarios(&self.paths)?,
            set: self.common.set,
            junit: self.junit,
        })
    }
}

impl Common {
    fn use_jobs(&self) -> Result<(), Failure> {
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

fn load_all(paths: &[PathBuf], common: &Common) -> Result<Vec<Scenario>, Failure> {
    common.use_jobs()?;
    let mut scenarios: Vec<Scenario> = Vec::new();
    let mut folders = BTreeMap::new();
    for path in paths {
        let scenario = Scenario::load(path, &common.set)?;
        if let Some(other) = folders.insert(scenario.stem(), path) {
            let (stem, other) = (scenario.stem(), other.display());
            let text = format!(
                "{other} and {} would both write to the folder \"{stem}\"",
                path.display()
            );
            return Err(Failure::with_help(
                text,
                "run them one by one, with different --out folders",
            ));
        }
        scenarios.push(scenario);
    }
    Ok(scenarios)
}

fn parse_set(text: &str) -> Result<(String, String), String> {
    match text.split_once('=') {
        Some((key, value)) if !key.trim().is_empty() && !value.trim().is_empty() => {
            Ok((key.trim().to_owned(), value.trim().to_owned()))
        }
        _ => Err("write KEY=VALUE, e.g. process.chamfer.spindle_rpm=400".into()),
    }
}

fn parse_rpm(text: &str) -> Result<f64, String> {
    let rpm = text
        .parse()
        .ok()
        .filter(|rpm: &f64| rpm.is_finite() && *rpm > 0.0);
    rpm.ok_or_else(|| "must be a number above 0".into())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_command_line_is_consistent() {
        use clap::CommandFactory;
        Arguments::command().debug_assert();
    }

    #[test]
    fn set_splits_at_the_first_equals_sign() {
        let pair = |key: &str, value: &str| Ok((key.to_owned(), value.to_owned()));
        assert_eq!(parse_set("name = a=b"), pair("name", "a=b"));
        assert!(parse_set("name").is_err() && parse_set("=1").is_err() && parse_set("a=").is_err());
    }
}
