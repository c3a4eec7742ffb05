//! `truecut diagnose`: what the simulation gets wrong about measured data, its cause, and what is
//! gained.

mod between;
mod files;
mod report;
mod text;
mod viewer;

use std::borrow::Cow;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::path::PathBuf;
use std::process::ExitCode;

use truecut::{KeptModel, Staged, data};
use truecut_discrepancy::compare::CompareError;
use truecut_discrepancy::confirmed::Confirmed;
use truecut_discrepancy::diagnose::{self, DiagnoseError, Progress, Stage};
use truecut_discrepancy::model::Model;
use truecut_discrepancy::trial::{Thinning, Trial};
use truecut_files::watched;
use truecut_recording::{Measured, short_number};
use truecut_scenario::Scenario;

use crate::args::DiagnoseArguments;
use crate::exit_status::ExitStatus;
use crate::failure::Failure;
use crate::progress::PatientBar;
use crate::signals::Signals;
use crate::waiting::told;

const BAR: &str = "{msg:32} {wide_bar} {pos} runs  {elapsed}";

/// The files that were written and are worth naming.
pub struct Written {
    pub report: PathBuf,
    pub viewer: PathBuf,
    pub extended: Option<PathBuf>,
    /// The command that plans a motion which tells the causes apart, where one can.
    pub excite: Option<String>,
}

/// Diagnoses, writes the files, prints the answer. A signal stops the search at its next
/// simulation; those that were made are kept, and the next diagnosis of the same goes on from
/// there.
pub fn diagnose(arguments: &DiagnoseArguments) -> Result<ExitCode, Failure> {
    if let Some([first, second]) = arguments.between.as_deref() {
        return between::diagnose(arguments, [first, second]);
    }
    let signals = Signals::catch()?;
    let scenario = &arguments.common.load(&arguments.scenario)?;
    let options = arguments.options();
    let bar = PatientBar::new(options.max_predictions as u64, BAR);
    let (prepared, read) = watched(|| prepared(arguments, scenario, &bar));
    let (data, files, trial) = prepared?;
    let runs = files::runs(&files);
    let model = KeptModel::new(
        &trial,
        &runs,
        &identity(scenario, read),
        Some(signals.stop()),
    )
    .map_err(|error| Failure::at(&runs, error))?;
    let show = |now: Progress| bar.made(now.predictions, words(now.stage).into());
    let answer = told(&bar, words(Stage::Nominal), || {
        diagnose::diagnose(&model, &trial.observation, &options, &show)
    });
    if let Some(code) = signals.exit_code() {
        drop(bar);
        crate::print(&format!(
            "{}\n  stopped by a signal, without an answer: {} simulations are kept in {}, and the same call goes on \
             from there\n\n",
            scenario.name,
            model.made(),
            runs.display()
        ))?;
        return Ok(code.into());
    }
    let answer = answer.map_err(|error| {
        // There is nothing to go on with.
        let _ = std::fs::remove_file(&runs);
        refused(&trial, scenario, &data.source, &error)
    })?;
    let confirmed = told(&bar, "confirming the answer", || {
        Confirmed::of(&trial, answer)
    });
    let written = told(&bar, "writing", || {
        files::write(scenario, &files, &trial, &confirmed)
    })?;
    drop(bar);
    if model.kept() > 0 {
        crate::print(&format!(
            "{} simulations were kept from a diagnosis that was stopped\n",
            model.kept()
        ))?;
    }
    crate::print(&text::printed(&trial, &confirmed, &written))?;
    Ok(ExitStatus::Good.into())
}

/// The data, the files to come, and both as what a search asks: each told while it takes its time.
fn prepared(
    arguments: &DiagnoseArguments,
    scenario: &Scenario,
    bar: &PatientBar,
) -> Result<(Measured, Staged, Trial), Failure> {
    let read = || data::measured(scenario, arguments.data.as_deref());
    let data = told(bar, "reading", read)?;
    if data.outputs().next().is_none() {
        let message = format!("{}: {}", data.source, CompareError::NoOutput);
        return Err(scenario.problem("data", message).into());
    }
    let folder = arguments.out.join(scenario.stem());
    let files = files::prepare(scenario, &folder, &data.source)?;
    let trial = told(bar, "preparing", || Trial::new(scenario, &data));
    let trial = trial.map_err(|error| Failure::sim(scenario, error))?;
    Ok((data, files, trial))
}

/// What must be the same for predictions to be the same: the scenario as it runs, what it reads,
/// the version.
fn identity(scenario: &Scenario, read: u64) -> String {
    let mut digest = DefaultHasher::new();
    (scenario.effective_text(), read, env!("CARGO_PKG_VERSION")).hash(&mut digest);
    format!("{:016x}", digest.finish())
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

fn words(stage: Stage) -> Cow<'static, str> {
    match stage {
        Stage::Nominal => "simulating it as it is".into(),
        Stage::Refit => "refitting nominal values".into(),
        Stage::Screening(0) => "looking for a first cause".into(),
        Stage::Screening(found) => format!("{found} found, looking for more").into(),
        Stage::Fitting(_) => "fitting causes".into(),
        Stage::Alternatives => "looking for other explanations".into(),
        Stage::Ceiling => "bounding what is left".into(),
        Stage::Curve => "beyond the search: drawing what has no name as a curve".into(),
        Stage::Experiments => "looking for a better experiment".into(),
        Stage::SetUps => "trying other set-ups".into(),
    }
}
