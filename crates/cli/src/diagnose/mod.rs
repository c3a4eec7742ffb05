//! `truecut diagnose`: what the simulation gets wrong about measured data, its cause, and what is
//! gained.

mod files;
mod report;
mod text;
mod viewer;

use std::path::PathBuf;

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use truecut::data;
use truecut_discrepancy::confirmed::Confirmed;
use truecut_discrepancy::diagnose::{self, DiagnoseError, Options, Progress, Stage};
use truecut_discrepancy::model::Model;
use truecut_discrepancy::trial::Trial;
use truecut_scenario::Scenario;

use crate::exit_status::ExitStatus;
use crate::failure::Failure;

/// `diagnose`, resolved.
pub struct DiagnosePlan {
    pub scenario: Scenario,
    /// Instead of the file that the scenario names.
    pub data: Option<PathBuf>,
    /// Where the answer goes.
    pub out: PathBuf,
    pub options: Options,
}

/// The files that were written and are worth naming.
pub struct Written {
    pub report: PathBuf,
    pub viewer: PathBuf,
    pub extended: Option<PathBuf>,
}

/// Diagnoses, writes the files, prints the answer.
pub fn diagnose(plan: &DiagnosePlan) -> Result<ExitStatus, Failure> {
    let scenario = &plan.scenario;
    let data = data::measured(scenario, plan.data.as_deref())?;
    files::prepare(plan, &data.source)?;
    let trial = Trial::new(scenario, &data).map_err(|error| Failure::sim(scenario, error))?;
    let bar = Bar::new(plan.options.max_predictions);
    let answer = diagnose::diagnose(&trial, &trial.observation, &plan.options, &|now| {
        bar.show(now)
    })
    .map_err(|error| refused(&trial, scenario, &data.source, &error))?;
    bar.end();
    let confirmed = Confirmed::of(&trial, answer);
    let written = files::write(plan, &trial, &confirmed)?;
    crate::print(&text::printed(&trial, &confirmed, &written))?;
    Ok(ExitStatus::Good)
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
