//! Files that a comparison of two recordings writes.

use std::path::{Path, PathBuf};

use truecut::Staged;
use truecut::outputs::write_file;
use truecut_discrepancy::between::{Answer, Between};
use truecut_scenario::Scenario;

use super::report;
use crate::diagnose::files::spare_inputs;
use crate::failure::Failure;
use crate::text;

const ANSWER: &str = "between.json";
const BEFORE: &str = "before.toml";
const AFTER: &str = "after.toml";
const REPORT: &str = "report.html";
const NAMES: [&str; 4] = [BEFORE, AFTER, REPORT, ANSWER];

/// The files that are worth naming.
pub struct Written {
    pub report: PathBuf,
    /// The scenario as it was, and as it is.
    pub scenarios: Option<[PathBuf; 2]>,
}

/// Makes the folder before the search starts and locks it.
///
/// # Errors
/// A folder that cannot be written to, or in which the answer would replace what it is about.
pub fn prepare(
    scenario: &Scenario,
    folder: &Path,
    recordings: [&Path; 2],
) -> Result<Staged, Failure> {
    let inputs = [scenario.path(), recordings[0], recordings[1]];
    spare_inputs(&inputs, folder, &NAMES)?;
    Ok(Staged::begin(folder)?)
}

/// Writes the answer, the scenario of each recording where something changed, and the report.
pub fn write(
    scenario: &Scenario,
    files: &Staged,
    pair: &Between,
    answer: &Answer,
) -> Result<Written, Failure> {
    let folder = files.folder();
    let mut written = Written {
        report: folder.join(REPORT),
        scenarios: None,
    };
    if answer.before != answer.after {
        let refitted = scenario.with_overrides(&pair.first.overrides(&answer.nominal))?;
        let rotary = pair.second.rotary();
        for (name, effects) in [(BEFORE, &answer.before), (AFTER, &answer.after)] {
            let text = refitted.text_for_folder(folder, effects, &rotary);
            write_file(&files.path(name), text.as_bytes())?;
        }
        written.scenarios = Some([BEFORE, AFTER].map(|name| folder.join(name)));
    }
    write_file(
        &files.path(REPORT),
        report::html(scenario, pair, answer).as_bytes(),
    )?;
    write_file(&files.path(ANSWER), text::json(&answer.changes)?.as_bytes())?;
    files.publish(&NAMES)?;
    Ok(written)
}
