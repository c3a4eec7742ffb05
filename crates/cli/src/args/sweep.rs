//! Arguments of `truecut sweep`.

use std::num::NonZeroUsize;
use std::ops::Range;
use std::path::PathBuf;

use clap::{Args, ValueEnum};
use truecut::Engine;
use truecut_scenario::Scenario;

use super::Common;
use super::number;
use crate::failure::Failure;

#[derive(Debug, Args)]
pub struct SweepArguments {
    /// A scenario with a [sweep]
    #[arg(value_name = "SCENARIO")]
    scenario: PathBuf,
    /// Folder for outputs; the sweep gets a folder of its own in it
    #[arg(long, value_name = "DIR", default_value = "out")]
    pub out: PathBuf,
    #[command(flatten)]
    common: Common,
    /// What integrates the arm: reduced is linear about the posture, and many times as fast
    #[arg(long, value_enum, default_value_t)]
    engine: EngineName,
    /// Make these rows alone, by their numbers from 0 without the last, as a part: see --part
    #[arg(long, value_name = "A..B", value_parser = rows, requires = "part")]
    pub rows: Option<Range<usize>>,
    /// The file that gets the rows of --rows; nothing is run if it has them already
    #[arg(short = 'o', long, value_name = "FILE", requires = "rows")]
    pub part: Option<PathBuf>,
    /// Put parts together to the table; together they must have every row
    #[arg(long, value_name = "PART", num_args = 1.., conflicts_with = "rows")]
    pub merge: Vec<PathBuf>,
    /// Who runs the rows
    #[arg(long, value_enum, default_value_t, conflicts_with_all = ["rows", "merge"])]
    pub workers_on: Workers,
    /// Rows of a part that a worker makes [default: some ten seconds of work]
    #[arg(long, value_name = "N", value_parser = number::count)]
    pub part_rows: Option<NonZeroUsize>,
    /// Folder of the HyperQueue server [default: HyperQueue's own]
    #[arg(long, value_name = "DIR")]
    pub server: Option<PathBuf>,
    /// How often a worker's part is tried again that did not come [default: 3]
    #[arg(long, value_name = "N")]
    pub retries: Option<usize>,
    /// Longest time that a part may take, in seconds; it fails beyond it
    #[arg(long, value_name = "S", value_parser = number::above_zero)]
    pub limit_s: Option<f64>,
}

/// Who runs the rows of a sweep.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, ValueEnum)]
pub enum Workers {
    /// The cores of this machine
    #[default]
    Local,
    /// The workers of a HyperQueue server, on as many machines as it has
    Hyperqueue,
}

/// What integrates the arm.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, ValueEnum)]
enum EngineName {
    #[default]
    Rapier,
    Reduced,
}

impl SweepArguments {
    /// The scenario, which has a sweep.
    pub fn load(&self) -> Result<Scenario, Failure> {
        let of_workers = [
            ("--part-rows", self.part_rows.is_some()),
            ("--server", self.server.is_some()),
            ("--retries", self.retries.is_some()),
        ];
        let is_cluster = self.workers_on == Workers::Hyperqueue;
        let given = of_workers.iter().find(|(_, is_given)| *is_given);
        if let Some((name, _)) = given.filter(|_| !is_cluster) {
            let text = format!("{name} has no effect without --workers-on hyperqueue");
            return Err(Failure::message(text));
        }
        if self.limit_s.is_some() && !is_cluster && self.rows.is_none() {
            let text = "--limit-s has no effect: it is about parts, of --rows or of workers";
            return Err(Failure::message(text));
        }
        // Workers and whoever puts parts together read the file by one name, wherever they start.
        let path = self.scenario.canonicalize();
        let scenario = self
            .common
            .load(path.as_ref().unwrap_or(&self.scenario))
            .map_err(|error| match &path {
                Ok(_) => error,
                Err(cause) => Failure::at(&self.scenario, cause),
            })?;
        if scenario.sweep.is_none() {
            let fault = scenario.problem("process", "there is no [sweep] table");
            return Err(fault.into());
        }
        Ok(scenario)
    }

    /// What integrates the arm.
    pub fn engine(&self) -> Engine {
        match self.engine {
            EngineName::Rapier => Engine::Rapier,
            EngineName::Reduced => Engine::REDUCED,
        }
    }

    /// The arguments of a call that makes some rows of the same sweep, on one core.
    pub fn for_part(&self, scenario: &Scenario, rows: &Range<usize>, part: String) -> Vec<String> {
        let mut words = vec!["sweep".to_owned(), scenario.path().display().to_string()];
        for (key, value) in &self.common.set {
            words.extend(["--set".to_owned(), format!("{key}={value}")]);
        }
        let name = self.engine.to_possible_value();
        let name = name.map_or_else(String::new, |name| name.get_name().to_owned());
        let rows = format!("{}..{}", rows.start, rows.end);
        let fixed = ["--engine", &name, "--jobs", "1", "--rows", &rows];
        words.extend(fixed.map(str::to_owned));
        words.extend(["--part".to_owned(), part]);
        if let Some(limit_s) = self.limit_s {
            words.extend(["--limit-s".to_owned(), limit_s.to_string()]);
        }
        words
    }
}

/// Two numbers of rows.
fn rows(text: &str) -> Result<Range<usize>, String> {
    let ends = text.split_once("..");
    let ends = ends.and_then(|(from, to)| Some((from.parse().ok()?, to.parse().ok()?)));
    ends.filter(|(from, to)| from < to)
        .map(|(from, to)| from..to)
        .ok_or_else(|| "must be A..B with whole numbers A below B, such as 0..50".to_owned())
}
