//! Files that a diagnosis writes, all in its own folder; the user's files are only read.

use std::path::{Path, PathBuf};

use truecut_discrepancy::diagnose::{Diagnosis, Verdict};
use truecut_discrepancy::excite::{self, Outlook};
use truecut_discrepancy::trial::Trial;
use truecut_scenario::Scenario;

use super::{Confirmed, Written, report, viewer};
use crate::failure::Failure;
use crate::text;
use truecut::Staged;
use truecut::outputs::write_file;

const ANSWER: &str = "diagnosis.json";
const EXTENDED: &str = "extended.toml";
const EXPERIMENT: &str = "experiment.toml";
const REPORT: &str = "report.html";
const VIEWER: &str = "diagnosis.rrd";
/// Predictions of a search that goes on, or was stopped.
const RUNS: &str = "diagnosis.runs";
const NAMES: [&str; 6] = [ANSWER, EXTENDED, EXPERIMENT, REPORT, VIEWER, RUNS];

/// Makes the folder before the search starts and locks it. Files of an earlier diagnosis stay until
/// there is a new one.
///
/// # Errors
/// A folder that cannot be written to, or in which an answer would replace what is being diagnosed.
pub fn prepare(scenario: &Scenario, folder: &Path, data: &str) -> Result<Staged, Failure> {
    spare_inputs(&[scenario.path(), Path::new(data)], folder, &NAMES)?;
    // What cannot be begun now could not be written after the search.
    Ok(Staged::begin(folder)?)
}

/// Where the predictions of the search are kept.
pub fn runs(files: &Staged) -> PathBuf {
    files.folder().join(RUNS)
}

/// Refuses a folder in which one of these files would replace an input, or is a folder itself.
///
/// # Errors
/// As said.
pub fn spare_inputs(inputs: &[&Path], folder: &Path, names: &[&str]) -> Result<(), Failure> {
    for name in names {
        let path = folder.join(name);
        if path.is_dir() {
            let text = "it is a folder, but a file of this name is to be written";
            return Err(Failure::at(&path, text));
        }
        let Ok(there) = folder.join(name).canonicalize() else {
            continue;
        };
        for input in inputs {
            if input.canonicalize().is_ok_and(|input| input == there) {
                let text = format!(
                    "the answer would replace {}, which it is about",
                    input.display()
                );
                return Err(Failure::with_help(text, "choose another folder with --out"));
            }
        }
    }
    Ok(())
}

/// Writes the answer, the extended scenario, the experiment proposed, the report and the curves.
/// What was kept of the search has served.
pub fn write(
    scenario: &Scenario,
    files: &Staged,
    trial: &Trial,
    confirmed: &Confirmed,
) -> Result<Written, Failure> {
    let folder = files.folder();
    let answer = &confirmed.answer;
    let mut written = Written {
        report: folder.join(REPORT),
        viewer: folder.join(VIEWER),
        extended: None,
        excite: excite(scenario, &answer.diagnosis, &folder.join(ANSWER)),
    };
    let text = extended(scenario, trial, confirmed, folder)?;
    if !answer.effects.is_empty() {
        write_file(&files.path(EXTENDED), text.as_bytes())?;
        written.extended = Some(folder.join(EXTENDED));
    }
    if let Some(best) = answer.diagnosis.experiments.first() {
        let varied = scenario.with_overrides(&best.overrides)?;
        let text = varied.text_for_folder(folder, &[], &trial.rotary());
        write_file(&files.path(EXPERIMENT), text.as_bytes())?;
    }
    write_file(
        &files.path(REPORT),
        report::html(scenario, trial, confirmed).as_bytes(),
    )?;
    viewer::write(trial, confirmed, &text, &files.path(VIEWER))?;
    let json = text::json(&answer.diagnosis)?;
    write_file(&files.path(ANSWER), json.as_bytes())?;
    files.publish(&[RUNS, EXTENDED, EXPERIMENT, REPORT, VIEWER, ANSWER])?;
    Ok(written)
}

/// What a motion could do to tell the causes apart: the command that plans one, or that none can;
/// `None` where no motion is planned, or the causes are not ambiguous.
fn excite(scenario: &Scenario, diagnosis: &Diagnosis, answer: &Path) -> Option<String> {
    if diagnosis.verdict != Verdict::Ambiguous || diagnosis.alternatives.is_empty() {
        return None;
    }
    match excite::outlook(scenario, diagnosis) {
        Outlook::NotPlanned => None,
        Outlook::CannotTell => Some(
            "no motion tells them apart: they change the drive forces alike in every state of the arm; another \
             sensor would, or a look at the machine"
                .to_owned(),
        ),
        Outlook::MayTell => Some(format!(
            "a motion that tells them apart, and by how much the odds grow: truecut excite {} --diagnosis {}",
            scenario.path().display(),
            answer.display()
        )),
    }
}

/// The user's file with refitted values and effects; relative paths lead from the new folder to the
/// same files.
fn extended(
    scenario: &Scenario,
    trial: &Trial,
    confirmed: &Confirmed,
    folder: &Path,
) -> Result<String, Failure> {
    let answer = &confirmed.answer;
    let scenario = scenario.with_overrides(&trial.overrides(&answer.nominal))?;
    Ok(scenario.text_for_folder(folder, &answer.effects, &trial.rotary()))
}
