//! `truecut diagnose`: what the simulation gets wrong about measured data, its cause, and what is gained.

mod files;
mod report;
mod telling;
mod viewer;

use std::path::PathBuf;

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use truecut_discrepancy::diagnose::{self, Answer, DiagnoseError, Options, Progress, Stage};
use truecut_discrepancy::model::{Columns, Model};
use truecut_discrepancy::trial::Trial;
use truecut_scenario::Scenario;

use crate::data;
use crate::failure::Failure;
use crate::verdict::Verdict;

/// `diagnose`, resolved.
pub struct Plan {
    pub scenario: Scenario,
    /// Instead of the file that the scenario names.
    pub data: Option<PathBuf>,
    /// Where the answer goes.
    pub out: PathBuf,
    pub options: Options,
}

/// A diagnosis with the predictions of the full model.
pub struct Confirmed {
    pub answer: Answer,
    /// The nominal model.
    pub nominal: Columns,
    /// The extended model.
    pub extended: Columns,
    /// What stood in the way of running the full model with the answer, if anything.
    pub failure: Option<String>,
}

/// Diagnoses, writes the files, tells the answer.
pub fn diagnose(plan: &Plan) -> Result<Verdict, Failure> {
    let scenario = &plan.scenario;
    let data = data::needed(scenario, plan.data.as_deref())?;
    files::prepare(plan, &data.source)?;
    let trial = Trial::new(scenario, &data).map_err(|error| Failure::sim(scenario, error))?;
    let bar = Bar::new(plan.options.max_predictions);
    let answer = diagnose::diagnose(&trial, &trial.observation, &plan.options, &|now| {
        bar.show(now)
    })
    .map_err(|error| refused(&trial, scenario, &data.source, &error))?;
    bar.end();
    let confirmed = confirm(&trial, answer);
    let written = files::write(plan, &trial, &confirmed)?;
    crate::print(&telling::tell(&trial, &confirmed, &written))?;
    Ok(Verdict::Good)
}

/// Runs the answer in the full model and scores it there.
fn confirm(trial: &Trial, mut answer: Answer) -> Confirmed {
    let before: Vec<f64> = trial.nominal().iter().map(|one| one.value).collect();
    let (nominal, extended) = rayon::join(
        || trial.confirm(&before, &[]),
        || trial.confirm(&answer.nominal, &answer.effects),
    );
    let failures = [nominal.as_ref().err(), extended.as_ref().err()];
    let failure = failures
        .into_iter()
        .flatten()
        .next()
        .map(ToString::to_string);
    let nominal = nominal.unwrap_or_else(|_| answer.before.clone());
    let extended = extended.unwrap_or_else(|_| answer.after.clone());
    if failure.is_none() {
        score(trial, &mut answer, &nominal, &extended);
    }
    Confirmed {
        answer,
        nominal,
        extended,
        failure,
    }
}

/// Errors on the test part, of the full model.
fn score(trial: &Trial, answer: &mut Answer, nominal: &Columns, extended: &Columns) {
    for (index, spec) in trial.channels().iter().enumerate() {
        let measured = &trial.observation.outputs[index].values;
        let rows = &answer.test_rows[index];
        let rms = |column: &[f64]| {
            let squares = rows
                .iter()
                .map(|&row| (measured[row] - column[row]).powi(2));
            (squares.sum::<f64>() / rows.len().max(1) as f64).sqrt()
        };
        if let Some(errors) = answer.diagnosis.channels.get_mut(&spec.name) {
            errors.before = rms(&nominal[index]);
            errors.after = rms(&extended[index]);
        }
    }
}

/// The fault, at the key of the scenario that it is about.
fn refused(trial: &Trial, scenario: &Scenario, source: &str, error: &DiagnoseError) -> Failure {
    let text = format!("{source}: {error}");
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

/// Progress on standard error, once the work takes more than two seconds.
struct Bar {
    bar: ProgressBar,
    begun: std::time::Instant,
}

impl Bar {
    fn new(predictions: usize) -> Bar {
        let bar =
            ProgressBar::with_draw_target(Some(predictions as u64), ProgressDrawTarget::hidden());
        if let Ok(style) = ProgressStyle::with_template("{msg:32} {wide_bar} {pos} runs  {elapsed}")
        {
            bar.set_style(style);
        }
        Bar {
            bar,
            begun: std::time::Instant::now(),
        }
    }

    fn show(&self, now: Progress) {
        if self.begun.elapsed().as_secs() >= 2 && self.bar.is_hidden() {
            self.bar.set_draw_target(ProgressDrawTarget::stderr());
        }
        self.bar.set_message(words(now.stage));
        self.bar.set_position(now.predictions as u64);
    }

    fn end(&self) {
        self.bar.finish_and_clear();
    }
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
