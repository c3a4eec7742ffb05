//! Arguments of the commands that run scenarios.

use std::collections::BTreeMap;
use std::path::PathBuf;

use clap::Args;
use truecut_discrepancy::between::SEARCHES;
use truecut_discrepancy::diagnose::Options;
use truecut_scenario::Scenario;

use super::Common;
use super::number::above_zero;
use crate::failure::Failure;

#[derive(Debug, Args)]
pub struct RunArguments {
    /// Scenario files
    #[arg(required = true, value_name = "SCENARIO")]
    scenarios: Vec<PathBuf>,
    /// Folder for outputs; each scenario gets a folder of its own in it
    #[arg(long, value_name = "DIR", default_value = "out")]
    pub out: PathBuf,
    #[command(flatten)]
    pub common: Common,
    /// Write no .rrd file for the viewer
    #[arg(long)]
    pub no_rrd: bool,
    /// Measured data (.csv or .parquet) in the place of data.file of the scenarios
    #[arg(long, value_name = "FILE")]
    pub data: Option<PathBuf>,
}

#[derive(Debug, Args)]
pub struct CheckArguments {
    /// Scenario files, or folders in which they are looked for
    #[arg(required = true, value_name = "PATH")]
    pub paths: Vec<PathBuf>,
    #[command(flatten)]
    pub common: Common,
    /// Where the JUnit XML goes
    #[arg(long, value_name = "FILE", default_value = "out/junit.xml")]
    pub junit: PathBuf,
    /// Folder for the recordings and summaries of what fails [default: they are not kept]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
}

#[derive(Debug, Args)]
pub struct CrosscheckArguments {
    /// Scenario files
    #[arg(required = true, value_name = "SCENARIO")]
    scenarios: Vec<PathBuf>,
    /// Folder for outputs; each scenario gets a folder of its own in it
    #[arg(long, value_name = "DIR", default_value = "out")]
    pub out: PathBuf,
    #[command(flatten)]
    pub common: Common,
}

#[derive(Debug, Args)]
pub struct CompareArguments {
    /// Scenario file, with a table [data]
    pub scenario: PathBuf,
    /// The measured data, .csv or .parquet [default: data.file of the scenario]
    #[arg(long, value_name = "FILE")]
    pub data: Option<PathBuf>,
    /// Folder for outputs; the scenario gets a folder of its own in it
    #[arg(long, value_name = "DIR", default_value = "out")]
    pub out: PathBuf,
    /// Speed of the spindle, to find lines at its orders of rotation [default: the scenario's]
    #[arg(long, value_name = "RPM", value_parser = above_zero)]
    pub rpm: Option<f64>,
    #[command(flatten)]
    pub common: Common,
}

#[derive(Debug, Args)]
pub struct DiagnoseArguments {
    /// Scenario file with a [data] table
    pub scenario: PathBuf,
    /// Measured data (.csv or .parquet) [default: the file that the scenario names]
    #[arg(long, value_name = "FILE")]
    pub data: Option<PathBuf>,
    /// Two recordings of the same machine, the earlier first: what changed between them; what the
    /// scenario lacks in both is no change
    #[arg(long, value_names = ["FIRST", "SECOND"], num_args = 2,
        conflicts_with = "data", action = clap::ArgAction::Set)]
    pub between: Option<Vec<PathBuf>>,
    /// Folder for outputs; the scenario gets a folder of its own in it
    #[arg(long, value_name = "DIR", default_value = "out")]
    pub out: PathBuf,
    /// Most simulations that the search may make [default: 2500; with --between, whose searches
    /// share them, 10000]
    #[arg(long, value_name = "N", value_parser = super::number::count)]
    max_runs: Option<std::num::NonZeroUsize>,
    /// Most causes that are named together [default: 4]
    #[arg(long, value_name = "N", value_parser = super::number::count)]
    max_causes: Option<std::num::NonZeroUsize>,
    #[command(flatten)]
    pub common: Common,
}

#[derive(Debug, Args)]
pub struct FitArguments {
    /// Scenario file with a [fit] table
    pub scenario: PathBuf,
    /// Measured data (.csv or .parquet) [default: the file that the scenario names]
    #[arg(long, value_name = "FILE")]
    pub data: Option<PathBuf>,
    /// Folder for outputs; the scenario gets a folder of its own in it
    #[arg(long, value_name = "DIR", default_value = "out")]
    pub out: PathBuf,
    #[command(flatten)]
    pub common: Common,
}

#[derive(Debug, Args)]
pub struct ExciteArguments {
    /// Scenario file with [process.replay] and a [data] table that says what will be measured
    pub scenario: PathBuf,
    /// What the motion is to show: unknowns of [fit] (links, coulomb), effects (joint_coulomb.2),
    /// keys of [[uncertain]] [default: all that the scenario leaves open]
    #[arg(long = "for", value_name = "NAME", value_delimiter = ',')]
    asked: Vec<String>,
    /// The diagnosis.json of an ambiguous verdict, whose explanations the motion is to tell apart
    #[arg(long, value_name = "FILE", conflicts_with = "asked")]
    pub diagnosis: Option<PathBuf>,
    /// Measured data (.csv or .parquet) whose motion is compared with [default: the file that the
    /// scenario names, if any]
    #[arg(long, value_name = "FILE")]
    pub data: Option<PathBuf>,
    /// Language of the robot program: jbi, krl, ls, rapid, urscript [default: the one that robots
    /// of this name are programmed in, if any]
    #[arg(long, value_name = "NAME")]
    pub dialect: Option<String>,
    /// Option of that language, e.g. "date=2026-01-31 12:00"; may be repeated
    #[arg(long = "program-option", value_name = "KEY=VALUE", value_parser = super::parse_set)]
    pub program_options: Vec<(String, String)>,
    /// Folder for outputs; the scenario gets a folder of its own in it
    #[arg(long, value_name = "DIR", default_value = "out")]
    pub out: PathBuf,
    #[command(flatten)]
    pub common: Common,
}

impl ExciteArguments {
    /// The scenario, with what is asked for on the command line.
    pub fn load(&self) -> Result<Scenario, Failure> {
        let mut scenario = self.common.load(&self.scenario)?;
        if !self.asked.is_empty() {
            scenario.excite.asked = Some(self.asked.clone());
        }
        Ok(scenario)
    }
}

impl RunArguments {
    /// Every scenario, loaded before any runs.
    pub fn load(&self) -> Result<Vec<Scenario>, Failure> {
        load_all(&self.scenarios, &self.common)
    }
}

impl CrosscheckArguments {
    /// Every scenario, loaded before any runs.
    pub fn load(&self) -> Result<Vec<Scenario>, Failure> {
        load_all(&self.scenarios, &self.common)
    }
}

impl DiagnoseArguments {
    /// How far the search may go.
    pub fn options(&self) -> Options {
        let mut options = Options::default();
        if self.between.is_some() {
            options.max_predictions *= SEARCHES;
        }
        if let Some(runs) = self.max_runs {
            options.max_predictions = runs.get();
        }
        if let Some(causes) = self.max_causes {
            options.max_effects = causes.get();
        }
        options
    }
}

fn load_all(paths: &[PathBuf], common: &Common) -> Result<Vec<Scenario>, Failure> {
    common.use_jobs()?;
    let mut scenarios: Vec<Scenario> = Vec::new();
    let mut folders = BTreeMap::new();
    for path in paths {
        if path.is_dir() {
            return Err(Failure::with_help(
                format!("{} is a folder, but a scenario is a file", path.display()),
                format!("truecut check {} runs every scenario in it", path.display()),
            ));
        }
        let scenario = Scenario::load(path, &common.set)?;
        // Not every system tells apart names that differ by case only.
        if let Some(other) = folders.insert(scenario.stem().to_lowercase(), path) {
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
