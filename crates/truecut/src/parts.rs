//! Parts of a sweep: some of its rows in a file each, made anywhere and in any order, put together
//! to the table that one machine would have made.

use std::collections::BTreeMap;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;

use truecut_files::write_whole;
use truecut_scenario::{Scenario, SweepSpec};
use truecut_sim::run::{Engine, RunError};
use truecut_sim::sweep::{Sweep, SweepTable, TableRow};

use crate::journal::unwritten_at;
use crate::rows::{self, Foreign, Head};

/// The parts of a scenario's sweep. A part depends on its rows alone, and carries the name of the
/// sweep and a number that stands for the scenario, the files that it reads and the version: parts
/// of another sweep are never put together with these.
///
/// ```
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// use truecut::{Engine, Made, Scenario, SweepParts};
///
/// # let folder = tempfile::tempdir()?;
/// # let folder = folder.path();
/// let text = r#"
/// name = "Parts"
/// [robot]
/// urdf = "rig_1dof/robot.urdf"
/// [run]
/// duration_s = 0.05
/// [process.load]
/// release_n = [100, 0, 0]
/// [[sweep.axis]]
/// key = "process.load.release_n.0"
/// from = 10
/// to = 40
/// steps = 4
/// [[sweep.column]]
/// name = "swing"
/// metric = "peak"
/// channel = "tool.displacement_x"
/// unit = "um"
/// "#;
/// # let robots = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets/robots");
/// let scenario = Scenario::from_str(&robots.join("parts.toml"), text, &[])?;
/// let parts = SweepParts::of(&scenario, Engine::Rapier)?;
/// let (first, second) = (folder.join("first.jsonl"), folder.join("second.jsonl"));
/// assert_eq!(parts.make(&(0..3), &first, &|_| {}, None)?, Made::Now);
/// assert_eq!(parts.make(&(0..3), &first, &|_| {}, None)?, Made::Before);
/// assert!(parts.merge(&[first.clone()]).is_err(), "a row is missing");
/// parts.make(&(3..4), &second, &|_| {}, None)?;
/// let table = parts.merge(&[second, first])?;
/// assert_eq!(table, truecut::sweep(&scenario, &|_| {})?);
/// # Ok(()) }
/// ```
pub struct SweepParts<'a> {
    scenario: &'a Scenario,
    engine: Engine,
    head: Head,
    count: usize,
}

/// When a part was made.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Made {
    /// In this call.
    Now,
    /// It was there, whole.
    Before,
}

impl<'a> SweepParts<'a> {
    /// The parts of the sweep of a scenario, run in an engine.
    ///
    /// # Errors
    /// What makes the scenario unfit to run.
    pub fn of(scenario: &'a Scenario, engine: Engine) -> Result<SweepParts<'a>, RunError> {
        if scenario.sweep.is_none() {
            return Err(scenario
                .problem("process", "there is no [sweep] table")
                .into());
        }
        Ok(SweepParts {
            scenario,
            engine,
            head: Head::of(scenario, engine)?,
            count: scenario.sweep.as_ref().map_or(0, SweepSpec::count),
        })
    }

    /// How many rows the sweep has.
    pub fn count(&self) -> usize {
        self.count
    }

    /// Makes some rows, by their numbers from 0, as a file; nothing if the file has them already.
    /// The file gets its name once it is whole.
    ///
    /// # Errors
    /// As [`Sweep::execute`]; a file of that name that is no part of this sweep; a file that cannot
    /// be written.
    pub fn make(
        &self,
        rows: &Range<usize>,
        path: &Path,
        progress: &(dyn Fn(f64) + Sync),
        stop: Option<&AtomicBool>,
    ) -> Result<Made, RunError> {
        if path.exists() && self.read(path)?.into_keys().eq(rows.clone()) {
            return Ok(Made::Before);
        }
        let sweep = Sweep {
            engine: self.engine,
            rows: Some(rows),
            progress,
            stop,
            ..Sweep::of(self.scenario)
        };
        let table = sweep.execute()?;
        let made = table.rows.into_iter().zip(table.faults);
        let made = made.map(|(values, fault)| TableRow { values, fault });
        let made: BTreeMap<usize, TableRow> = rows.clone().zip(made).collect();
        let folder = path
            .parent()
            .filter(|folder| !folder.as_os_str().is_empty());
        folder
            .map_or(Ok(()), std::fs::create_dir_all)
            .and_then(|()| write_whole(path, |file| rows::write(file, &self.head, &made)))
            .map_err(|error| unwritten_at(path, error))?;
        Ok(Made::Now)
    }

    /// Whether a file has these rows, all of them and no other.
    pub fn has(&self, rows: &Range<usize>, path: &Path) -> bool {
        self.read(path)
            .is_ok_and(|found| found.into_keys().eq(rows.clone()))
    }

    /// Puts parts together. Rows that are in several are the same in all.
    ///
    /// # Errors
    /// A file that cannot be read or is no part of this sweep; rows that no part has; a row that
    /// differs between parts or lies beyond the sweep.
    pub fn merge(&self, parts: &[PathBuf]) -> Result<SweepTable, RunError> {
        let mut rows: BTreeMap<usize, (TableRow, &Path)> = BTreeMap::new();
        for path in parts {
            for (index, row) in self.read(path)? {
                if let Some((other, first)) = rows.get(&index)
                    && !same(other, &row)
                {
                    let message = format!(
                        "{}: row {index} is not the same as in {}",
                        path.display(),
                        first.display()
                    );
                    let help = "rows are the same to the bit on machines of one kind: make one of \
                                the parts again";
                    return Err(fault(message, help));
                }
                rows.insert(index, (row, path));
            }
        }
        let missing = gaps(self.count, rows.keys().copied());
        if !missing.is_empty() {
            let text: Vec<String> = (missing.iter().take(MOST_TOLD))
                .map(|gap| format!("{}..{}", gap.start, gap.end))
                .collect();
            let more = match missing.len().saturating_sub(MOST_TOLD) {
                0 => String::new(),
                more => format!(" and {more} more"),
            };
            let lacking: usize = missing.iter().map(Range::len).sum();
            let message = format!(
                "{lacking} of {} rows are in no part: {}{more}",
                self.count,
                text.join(", ")
            );
            return Err(fault(
                message,
                "`truecut sweep SCENARIO --rows A..B -o PART` makes them",
            ));
        }
        let rows = rows.into_values().map(|(row, _)| row);
        Ok(SweepTable::of(self.scenario, rows))
    }

    fn read(&self, path: &Path) -> Result<BTreeMap<usize, TableRow>, RunError> {
        let told = |why: String, help| Err(fault(format!("{}: {why}", path.display()), help));
        let found = match rows::of_sweep(path, &self.head) {
            Ok(found) => found,
            Err(Foreign::Unread(why)) => return told(why, "a part is what `--rows` has made"),
            Err(Foreign::NoRows) => {
                let why = "is no part of a sweep".to_owned();
                return told(why, "a part is what `--rows` has made");
            }
            Err(Foreign::Sweep(other)) => {
                let name = &self.head.sweep;
                let why = format!("is a part of the sweep \"{other}\", not of \"{name}\"");
                return told(why, "parts of one sweep are put together");
            }
            Err(Foreign::Identity) => {
                let why = "was made of another text of the scenario, with other files, overrides or \
                           another version";
                return told(why.to_owned(), "make the part again");
            }
        };
        let beyond = found.keys().next_back().filter(|last| **last >= self.count);
        if let Some(last) = beyond {
            let why = format!("has row {last}, but the sweep has {} rows", self.count);
            return told(why, "make the part again");
        }
        let of_columns = SweepTable::of(self.scenario, []).columns.len();
        let misfit = found.iter().find(|(_, row)| row.values.len() != of_columns);
        if let Some((index, row)) = misfit {
            let count = row.values.len();
            let why =
                format!("row {index} has {count} values, but the sweep has {of_columns} columns");
            return told(why, "make the part again");
        }
        Ok(found)
    }
}

/// Most gaps that an error lists.
const MOST_TOLD: usize = 10;

/// Whether rows are the same to the bit.
fn same(one: &TableRow, other: &TableRow) -> bool {
    let bits = |row: &TableRow| -> Vec<u64> { row.values.iter().map(|x| x.to_bits()).collect() };
    bits(one) == bits(other) && one.fault == other.fault
}

/// Runs of numbers below `count` that are not there.
fn gaps(count: usize, there: impl Iterator<Item = usize>) -> Vec<Range<usize>> {
    let mut next = 0;
    let mut gaps = Vec::new();
    for index in there.chain([count]) {
        if index > next {
            gaps.push(next..index);
        }
        next = index + 1;
    }
    gaps
}

fn fault(message: String, help: &str) -> RunError {
    RunError::Data {
        message,
        help: Some(help.to_owned()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gaps_are_told_as_runs() {
        let there = [1, 2, 5];
        assert_eq!(gaps(7, there.into_iter()), [0..1, 3..5, 6..7]);
        assert_eq!(gaps(3, 0..3), Vec::<Range<usize>>::new());
        let all = gaps(3, std::iter::empty());
        assert_eq!(all, std::iter::once(0..3).collect::<Vec<_>>());
    }
}
