//! Rows of a sweep as a file: a line of JSON for each, below one that says of which sweep.

use std::collections::BTreeMap;
use std::fs::File;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::io::Write;
use std::path::Path;

use serde::{Deserialize, Serialize};
use truecut_files::{read_text, watched};
use truecut_recording::Outcome;
use truecut_scenario::Scenario;
use truecut_sim::run::{Engine, Run, RunError};
use truecut_sim::sweep::{Fault, TableRow};

/// The first line.
#[derive(Debug, Serialize, Deserialize, PartialEq)]
pub struct Head {
    pub sweep: String,
    /// Of the scenario as it runs, the engine, the files that it reads and the version.
    identity: String,
}

impl Head {
    /// That of a scenario which can run in an engine.
    ///
    /// # Errors
    /// What makes it unfit to run.
    pub fn of(scenario: &Scenario, engine: Engine) -> Result<Head, RunError> {
        let run = Run {
            engine,
            ..Run::of(scenario)
        };
        let (checked, read) = watched(|| run.check());
        checked?;
        let mut digest = DefaultHasher::new();
        let text = scenario.effective_text();
        (text, read, format!("{engine:?}"), env!("CARGO_PKG_VERSION")).hash(&mut digest);
        Ok(Head {
            sweep: scenario.name.clone(),
            identity: format!("{:016x}", digest.finish()),
        })
    }
}

/// A row that is done.
#[derive(Serialize, Deserialize)]
struct Line {
    row: usize,
    /// As texts, since JSON has neither infinity nor a number that is none.
    values: Vec<String>,
    fault: Option<(Outcome, String)>,
}

/// Why a file does not give rows of a sweep.
#[derive(Debug, PartialEq)]
pub enum Foreign {
    /// It cannot be read: why.
    Unread(String),
    /// Its first line is not that of a sweep's rows.
    NoRows,
    /// Its rows are those of another sweep: its name.
    Sweep(String),
    /// Its rows are those of a sweep of this name, of another text, other files or another version.
    Identity,
}

/// The rows of a file, if they are of this sweep. A line that was torn is none.
pub fn of_sweep(path: &Path, head: &Head) -> Result<BTreeMap<usize, TableRow>, Foreign> {
    let text = read_text(path).map_err(|error| Foreign::Unread(error.to_string()))?;
    let mut lines = text.lines();
    let first = lines
        .next()
        .and_then(|line| serde_json::from_str(line).ok());
    let found: Head = first.ok_or(Foreign::NoRows)?;
    if found.sweep != head.sweep {
        return Err(Foreign::Sweep(found.sweep));
    }
    if found != *head {
        return Err(Foreign::Identity);
    }
    let rows = lines.filter_map(|line| serde_json::from_str::<Line>(line).ok()?.row());
    Ok(rows.collect())
}

/// Writes a file's first line and some rows.
pub fn write(
    file: &mut File,
    head: &Head,
    rows: &BTreeMap<usize, TableRow>,
) -> std::io::Result<()> {
    writeln!(file, "{}", serde_json::to_string(head)?)?;
    for (index, row) in rows {
        append(file, *index, row)?;
    }
    Ok(())
}

/// A line at once, so that a kill tears at most the last.
pub fn append(file: &mut File, index: usize, row: &TableRow) -> std::io::Result<()> {
    let line = Line {
        row: index,
        values: row.values.iter().map(f64::to_string).collect(),
        fault: (row.fault.as_ref()).map(|it| (it.outcome.clone(), it.why.clone())),
    };
    file.write_all(format!("{}\n", serde_json::to_string(&line)?).as_bytes())
}

impl Line {
    fn row(self) -> Option<(usize, TableRow)> {
        let values = self.values.iter().map(|value| value.parse().ok());
        let row = TableRow {
            values: values.collect::<Option<Vec<f64>>>()?,
            fault: (self.fault).map(|(outcome, why)| Fault { outcome, why }),
        };
        Some((self.row, row))
    }
}
