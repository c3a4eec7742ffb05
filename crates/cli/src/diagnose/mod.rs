//! `truecut diagnose`: what the simulation gets wrong about measured data, its cause, and what is
//! gained.

mod files;
mod report;
mod text;
mod viewer;

use std::path::PathBuf;

use truecut::data;
use truecut_discrepancy::confirmed::Confirmed;
use truecut_discrepancy::diagnose::{self, DiagnoseError, Progress, Stage};
use truecut_discrepancy::model::Model;
use truecut_discrepancy::trial::{Thinning, Trial};
use truecut_recording::short_number;
use truecut_scenario::Scenario;

use crate::args::DiagnoseArguments;
use crate::exit_status::ExitStatus;
use crate::failure::Failure;
use crate::progress::PatientBar;

/// The files that were written and are worth naming.
pub struct Written {
    pub report: PathBuf,
    pub viewer: PathBuf,
    pub extended: Option<PathBuf>,
}

/// Diagnoses, writes the files, prints the answer.
pub fn diagnose(arguments: &DiagnoseArguments) -> Result<ExitStatus, Failure> {
    let scenario = &arguments.common.load(&arguments.scenario)?;
    let options = arguments.options();
    let data = data::measured(scenario, arguments.data.as_deref())?;
    let folder = arguments.out.join(scenario.stem());
    files::prepare(scenario, &folder, &data.source)?;
    let trial = Trial::new(scenario, &data).map_err(|error| Failure::sim(scenario, error))?;
    let runs = options.max_predictions as u64;
    let bar = PatientBar::new(runs, "{msg:32} {wide_bar} {pos} runs  {elapsed}");
    let show = |now: Progress| {
        bar.tell(|bar| {
            bar.set_message(words(now.stage));
            bar.set_position(now.predictions as u64);
        });
    };
    let answer = diagnose::diagnose(&trial, &trial.observation, &options, &show)
        .map_err(|error| refused(&trial, scenario, &data.source, &error))?;
    drop(bar);
    let confirmed = Confirmed::of(&trial, answer);
    let written = files::write(scenario, &folder, &trial, &confirmed)?;
    crate::print(&text::printed(&trial, &confirmed, &written))?;
    Ok(ExitStatus::Good)
}

/// The fault, at the key of the scenario that it is about.
fn refused(trial: &Trial, scenario: &Scenario, source: &str, error: &DiagnoseError) -> Failure {
    let few = matches!(
        error,
        DiagnoseError::TooFewSamples { .. } | DiagnoseError::TooFewRows { .. }
    );
    let thinning = trial
        .thinning()
        .filter(|thinning| few && thinning.every > 1);
    let text = match thinning {
        None => format!("{source}: {error}"),
        Some(thinning) => format!("{source}: {error}; {}", kept(trial, &thinning, error)),
    };
    let (channel, key) = match error {
        DiagnoseError::Unit { channel, .. } => (Some(channel), "unit"),
        DiagnoseError::TooFewSamples { output, .. }
        | DiagnoseError::TooFewRows { output, .. }
        | DiagnoseError::NotFinite { output, .. } => {
            let spec = trial.channels().get(output - 1);
            (spec.map(|spec| &spec.name), "channel")
        }
        _ => (None, ""),
    };
    let mapped = scenario.data.iter().flat_map(|data| &data.mapping.channels);
    let place = (mapped.enumerate()).find(|(_, one)| Some(&one.channel) == channel);
    if let Some((index, _)) = place {
        return scenario
            .problem(&format!("data.channel.{index}.{key}"), text)
            .into();
    }
    Failure::with_help(
        text,
        format!("for the scenario {}", scenario.path().display()),
    )
}

/// Why so few samples are left, and what leaves enough.
fn kept(trial: &Trial, thinning: &Thinning, error: &DiagnoseError) -> String {
    let measured = trial.measured();
    let advice = match error {
        DiagnoseError::TooFewSamples { found, .. } => {
            let lacks = diagnose::MIN_SAMPLES as f64 / (*found).max(1) as f64;
            let duration_s = measured.duration_s();
            let longer = format!(
                "take a record of {:.0} s in place of {duration_s:.1} s",
                (lacks * duration_s).ceil()
            );
            let enough_hz = (thinning.enough_hz(*found)).ceil();
            match enough_hz < 0.5 * measured.rate_hz() {
                true => format!(
                    "raise process.replay.compare_cutoff_hz to {enough_hz:.0} Hz, or {longer}"
                ),
                false => longer,
            }
        }
        _ => "a higher process.replay.compare_cutoff_hz leaves more".to_owned(),
    };
    format!(
        "drive forces are filtered at {} Hz and thinned to {} samples a period of that (one of {}, of {} samples): {advice}",
        short_number(thinning.cutoff_hz),
        short_number(thinning.per_period),
        thinning.every,
        measured.time_s.len(),
    )
}

fn words(stage: Stage) -> String {
    match stage {
        Stage::Refit => "refitting nominal values".to_owned(),
        Stage::Screening(0) => "looking for a first cause".to_owned(),
        Stage::Screening(found) => format!("{found} found, looking for more"),
        Stage::Fitting(_) => "fitting causes".to_owned(),
        Stage::Alternatives => "looking for other explanations".to_owned(),
        Stage::Ceiling => "bounding what is left".to_owned(),
        Stage::Experiments => "looking for a better experiment".to_owned(),
    }
}
