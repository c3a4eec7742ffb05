//! `truecut excite`: a motion within all limits that makes what is asked identifiable.

mod files;
mod program;
mod text;

use std::path::Path;

use truecut::{Staged, data};
use truecut_discrepancy::diagnose::Diagnosis;
use truecut_discrepancy::excite::{self, Request};
use truecut_scenario::Scenario;

use crate::args::ExciteArguments;
use crate::exit_status::ExitStatus;
use crate::failure::Failure;
use crate::progress::Progress;

/// Plans a motion, writes it with its scenario and a robot program, prints what it will tell.
pub fn excite(arguments: &ExciteArguments) -> Result<ExitStatus, Failure> {
    let scenario = &arguments.load()?;
    let diagnosis = (arguments.diagnosis.as_deref()).map(read).transpose()?;
    // A motion may be planned before there are data of any.
    let named = scenario.data.as_ref().and_then(|data| data.file.as_ref());
    let has_data = named.is_some_and(|file| file.exists());
    let present = match arguments.data.is_some() || has_data {
        true => Some(data::measured(scenario, arguments.data.as_deref())?),
        false => None,
    };
    let language = program::Language::of(scenario, arguments)?;
    let folder = arguments.out.join(scenario.stem());
    let staged = Staged::begin(&folder)?;
    let request = Request {
        scenario,
        diagnosis: diagnosis.as_ref(),
        present: present.as_ref(),
    };
    let planned = Progress::of_one("looking for a motion", |progress| {
        excite::excite(&request, progress)
    });
    let planned = planned.map_err(|error| refused(scenario, arguments, error))?;
    let (programs, note) = language.write(&planned)?;
    let written = files::write(scenario, &planned, programs, &staged)?;
    crate::print(&text::printed(&planned.report, note.as_deref(), &written))
}

/// What was asked for on the command line has no place in the file.
fn refused(
    scenario: &Scenario,
    arguments: &ExciteArguments,
    error: truecut_sim::SimError,
) -> Failure {
    match &error {
        truecut_sim::SimError::Scenario { key, message }
            if key == excite::ASKED && !scenario.gives(excite::ASKED) =>
        {
            let message = message.trim_start_matches(&format!("`{}` ", excite::ASKED));
            let (option, file) = match &arguments.diagnosis {
                Some(file) => ("--diagnosis", format!("{}: ", file.display())),
                None => ("--for", String::new()),
            };
            Failure::with_help(
                format!("{file}{option}: {message}"),
                format!("for the scenario {}", scenario.path().display()),
            )
        }
        _ => Failure::sim(scenario, error),
    }
}

/// The diagnosis of a file, with at least two explanations.
fn read(path: &Path) -> Result<Diagnosis, Failure> {
    let text = truecut_files::read_text(path).map_err(|error| Failure::at(path, error))?;
    let diagnosis: Diagnosis = serde_json::from_str(&text)
        .map_err(|error| Failure::at(path, format!("is no diagnosis.json: {error}")))?;
    if diagnosis.causes.is_empty() || diagnosis.alternatives.is_empty() {
        return Err(Failure::at(
            path,
            "holds no two explanations that a motion could tell apart: its verdict is not \"ambiguous\"",
        ));
    }
    Ok(diagnosis)
}
