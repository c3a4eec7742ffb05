//! `truecut diagnose --between`: what changed from one recording to another.

mod files;
mod report;
mod text;

use std::path::Path;
use std::process::ExitCode;

use truecut::data;
use truecut_discrepancy::between::{Between, BetweenError, changes};
use truecut_discrepancy::diagnose::Progress;
use truecut_recording::Measured;
use truecut_scenario::Scenario;

use super::words;
use crate::args::DiagnoseArguments;
use crate::exit_status::ExitStatus;
use crate::failure::Failure;
use crate::progress::PatientBar;

/// Compares the recordings, writes the files, prints the answer.
pub fn diagnose(
    arguments: &DiagnoseArguments,
    recordings: [&Path; 2],
) -> Result<ExitCode, Failure> {
    let scenario = &arguments.common.load(&arguments.scenario)?;
    let options = arguments.options();
    refuse_the_same(recordings)?;
    let [first, second] = recordings.map(|path| data::measured(scenario, Some(path)));
    let (first, second) = (first?, second?);
    refuse_other_columns(&first, &second)?;
    let folder = arguments.out.join(scenario.stem());
    let files = files::prepare(scenario, &folder, recordings)?;
    let failed = |error| refused(scenario, error);
    let pair = Between::new(scenario, &first, &second).map_err(failed)?;
    let most = options.max_predictions as u64;
    let bar = PatientBar::new(most, "{msg:32} {wide_bar} {pos} runs  {elapsed}");
    let show = |now: Progress| bar.made(now.predictions, words(now.stage).into());
    let answer = changes(&pair, &options, &show);
    drop(bar);
    let answer = answer.map_err(failed)?;
    let written = files::write(scenario, &files, &pair, &answer)?;
    crate::print(&text::printed(&pair, &answer, &written))?;
    Ok(ExitStatus::Good.into())
}

/// One file twice has nothing to tell.
fn refuse_the_same([first, second]: [&Path; 2]) -> Result<(), Failure> {
    let place = |path: &Path| path.canonicalize().ok();
    match (place(first), place(second)) {
        (Some(a), Some(b)) if a == b => Err(Failure::with_help(
            format!("{}: both recordings are this file", second.display()),
            "--between takes two recordings of the machine, made at different times",
        )),
        _ => Ok(()),
    }
}

/// Refuses recordings of which one has a channel that is constant, and so left out, in the other.
fn refuse_other_columns(first: &Measured, second: &Measured) -> Result<(), Failure> {
    for (one, other) in [(first, second), (second, first)] {
        let missing = one
            .outputs()
            .find(|channel| other.channel(&channel.spec.name).is_err());
        if let Some(missing) = missing {
            return Err(Failure::with_help(
                format!(
                    "{}: {} is not measured here, but in {}; both recordings must have the same channels",
                    other.source, missing.spec.name, one.source
                ),
                "leave its [[data.channel]] out of the scenario, or give data that have it",
            ));
        }
    }
    Ok(())
}

fn refused(scenario: &Scenario, error: BetweenError) -> Failure {
    match error {
        BetweenError::Sim { error, .. } => Failure::sim(scenario, *error),
        error => Failure::with_help(
            error.to_string(),
            format!("for the scenario {}", scenario.path().display()),
        ),
    }
}
