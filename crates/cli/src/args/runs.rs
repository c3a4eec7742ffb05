//! Arguments of the commands that run scenarios.

use std::collections::BTreeMap;
use std::path::PathBuf;

use clap::Args;
use truecut_discrepancy::diagnose::Options;
use truecut_scenario::Scenario;

use super::Common;
use super::number::above_zero;
use crate::diagnose;
use crate::failure::Failure;
use crate::find::find_scenarios;

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
    #[arg(long, value_name = "RPM", value_parser = above_zero)]
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
pub struct FitArguments {
    /// Scenario file with a [fit] table
    scenario: PathBuf,
    /// Measured data (.csv or .parquet) [default: the file that the scenario names]
    #[arg(long, value_name = "FILE")]
    data: Option<PathBuf>,
    /// Folder for outputs; the scenario gets a folder of its own in it
    #[arg(long, value_name = "DIR", default_value = "out")]
    out: PathBuf,
    #[command(flatten)]
    common: Common,
}

/// `fit`, resolved.
pub struct FitPlan {
    pub scenario: Scenario,
    pub data: Option<PathBuf>,
    pub out: PathBuf,
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
        let mut options = Options::default();
        if let Some(runs) = self.max_runs {
            options.max_predictions = runs.get();
        }
        if let Some(causes) = self.max_causes {
            options.max_effects = causes.get();
        }
        Ok(diagnose::DiagnosePlan {
            scenario: self.common.load(&self.scenario)?,
            data: self.data,
            out: self.out,
            options,
        })
    }
}

impl FitArguments {
    /// Loads the scenario.
    pub fn resolve(self) -> Result<FitPlan, Failure> {
        Ok(FitPlan {
            scenario: self.common.load(&self.scenario)?,
            data: self.data,
            out: self.out,
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
        Ok(ComparePlan {
            scenario: self.common.load(&self.scenario)?,
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
