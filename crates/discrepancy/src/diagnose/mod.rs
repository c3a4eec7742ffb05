//! Finds the effects that explain the discrepancy of a model, or reports that none do.
//!
//! 1. The data are divided into blocks: for fitting, for choosing, and a last part that is opened
//!    once, when the choice is frozen.
//! 2. Nominal parameters are refitted within their stated uncertainty before structure is blamed.
//! 3. *Detection*: likelihood-ratio tests of each candidate's signature under coloured noise, whose
//!    autoregression is fitted together with the candidate, at a family-wise error that counts all
//!    tests made.
//! 4. *Search* by simulation error: the best are fitted by damped Gauss-Newton; forward selection
//!    with a look at pairs, replacement, backward removal.
//! 5. *Choice* on the validation blocks by a paired test, with a least practical gain.
//! 6. Causes that cannot be distinguished are reported together, with an experiment that would.
//! 7. A flexible predictor of what is left bounds what any model could still gain.
//!
//! All of it works on any [`Model`]. Runs are deterministic: parallel parts keep their order.

mod ambiguity;
mod answer;
mod body;
mod budget;
mod ceiling;
mod choice;
mod conclude;
mod curve;
mod data;
mod derivatives;
mod doubts;
mod evidence;
mod features;
mod fit;
mod floor;
mod gate;
mod late;
mod lengths;
mod memory;
mod moments;
mod noise;
mod orders;
mod pairs;
mod played;
mod problem;
mod race;
mod refit;
mod resonance;
mod revise;
mod ringing;
mod scan;
mod screen;
mod search;
mod set_up;
mod signature;
mod simpler;
mod smooth;
mod span;
mod starts;
mod step;
mod together;
mod uncertainty;
mod unite;
mod validate;

use std::time::Instant;

use thiserror::Error;
use truecut_recording::ChannelSpec;
use truecut_scenario::effect::Effect;

pub(crate) use self::set_up::doubt as set_up_doubt;
use crate::compare::{Pair, UnitSuspicion, unit_suspicion};
use crate::model::{Columns, Model, PredictError};
pub(crate) use answer::target_name;
pub use answer::{
    Alternative, Cause, Ceiling, Change, ChannelErrors, CorrelatedSignal, Diagnosis, Evidence,
    FitRecord, Nominal, Parameter, Proposal, SmallestSeen, UnknownCurve, Verdict, Work,
};
pub(crate) use budget::Part;
pub(crate) use conclude::{breaks_away_from, courses};
pub use data::{Fine, MIN_SAMPLES, Observation, Output, Regressor};
pub use floor::{NoiseSample, NoiseSource};
pub(crate) use refit::{Refit, likelihood, refitted};

/// Options of a diagnosis.
#[derive(Debug, Clone, PartialEq)]
pub struct Options {
    /// Probability of a detection in pure noise, over all candidates together.
    pub family_wise_error: f64,
    /// Least part of a channel's held-out residual rms that an effect must take away.
    pub min_gain: f64,
    /// Most effects that are named together.
    pub max_effects: usize,
    /// Most simulations.
    pub max_predictions: usize,
    /// Part of the discrepancy which, if it stays unexplained, leaves the cause unknown.
    pub unknown_above: f64,
    /// Candidates that are fitted after each screening.
    pub fitted_candidates: usize,
}

impl Default for Options {
    fn default() -> Options {
        Options {
            family_wise_error: 0.005,
            min_gain: 0.01,
            max_effects: 4,
            max_predictions: 2500,
            unknown_above: 0.1,
            fitted_candidates: 6,
        }
    }
}

/// Stage of the work.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stage {
    /// The scenario as it is.
    Nominal,
    /// Nominal parameters within their uncertainty.
    Refit,
    /// Signatures of candidates; the number of effects already found.
    Screening(usize),
    /// Candidates fitted by simulation error.
    Fitting(usize),
    /// Alternative causes.
    Alternatives,
    /// Bound on the gain of any further model.
    Ceiling,
    /// What has no name, as a curve: each of its values takes simulations of its own, beyond those
    /// allowed for the search.
    Curve,
    /// Experiments that would distinguish the causes.
    Experiments,
    /// Other set-ups than the scenario's.
    SetUps,
}

/// Progress of the work.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Progress {
    /// Stage of the work.
    pub stage: Stage,
    /// Simulations made.
    pub predictions: usize,
    /// Simulations allowed.
    pub max_predictions: usize,
}

/// Data or a model that cannot be used.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum DiagnoseError {
    /// Not one measured output per channel of the model.
    #[error("the model predicts {expected} channels, the data have {found} outputs")]
    ChannelCount {
        /// Of the model.
        expected: usize,
        /// Of the data.
        found: usize,
    },
    /// Columns of unequal length.
    #[error("{what} has {found} samples, the time base has {expected}")]
    Length {
        /// The column.
        what: String,
        /// Of the time base.
        expected: usize,
        /// Of the column.
        found: usize,
    },
    /// A sample that is said to be valid and is not a number.
    #[error("output {output} is not finite at sample {sample}, which is marked as valid")]
    NotFinite {
        /// Counted from 1.
        output: usize,
        /// Counted from 0.
        sample: usize,
    },
    /// Fewer than [`MIN_SAMPLES`].
    #[error("output {output} has {found} valid samples; a diagnosis needs at least {MIN_SAMPLES}")]
    TooFewSamples {
        /// Counted from 1.
        output: usize,
        /// Valid ones.
        found: usize,
    },
    /// Gaps leave no rows for fitting, choosing or testing.
    #[error(
        "output {output} has too few stretches without gaps: {found} samples are left for {part}"
    )]
    TooFewRows {
        /// Counted from 1.
        output: usize,
        /// Which part of the data.
        part: &'static str,
        /// Rows left.
        found: usize,
    },
    /// Trajectories that are empty, overlap or lie outside the data.
    #[error("trajectories must be in order, within the data, not empty, and must not overlap")]
    Trajectories,
    /// A residual so large that the unit must be wrong.
    #[error("channel \"{channel}\": {suspicion}")]
    Unit {
        /// The channel.
        channel: String,
        /// The factor that would fit.
        suspicion: UnitSuspicion,
    },
    /// Nothing fits as it is, and much does in another set-up.
    #[error("{told}{}", beside(.otherwise.as_deref()))]
    SetUp {
        /// What leaves least, a set-up or a unit, and how well it fits.
        told: String,
        /// The other, unless it leaves far more.
        otherwise: Option<String>,
    },
    /// The nominal model itself cannot be run.
    #[error("the nominal model cannot be simulated: {0}")]
    Nominal(#[from] PredictError),
}

fn beside(otherwise: Option<&str>) -> String {
    otherwise.map_or_else(String::new, |told| format!(" Else: {told}"))
}

/// The diagnosis with what is needed to draw and to extend.
#[derive(Debug, Clone)]
pub struct Answer {
    /// What is written.
    pub diagnosis: Diagnosis,
    /// The effects named, in the order of their gain.
    pub effects: Vec<Effect>,
    /// Nominal parameters after the fit with these effects.
    pub nominal: Vec<f64>,
    /// Prediction of the nominal model as the scenario has it.
    pub before: Columns,
    /// Prediction with the effects.
    pub after: Columns,
    /// Samples of each channel that served for the final test.
    pub test_rows: Vec<Vec<usize>>,
}

/// Diagnoses what the model gets wrong about the data.
///
/// # Errors
/// Data that do not fit the model or do not suffice; a nominal model that cannot be simulated.
pub fn diagnose(
    model: &dyn Model,
    data: &Observation,
    options: &Options,
    progress: &(dyn Fn(Progress) + Sync),
) -> Result<Answer, DiagnoseError> {
    explain(model, data, options, progress, Part::all(options))
}

/// As [`diagnose`], as a part of a larger search.
pub(crate) fn explain(
    model: &dyn Model,
    data: &Observation,
    options: &Options,
    progress: &(dyn Fn(Progress) + Sync),
    part: Part,
) -> Result<Answer, DiagnoseError> {
    let begun = Instant::now();
    data.check(model.channels().len())?;
    let problem = problem::Problem::new(model, data, options, progress).within(part);
    problem.split.check()?;
    problem.report(Stage::Nominal);
    let before = problem.predict_whole(&problem.start())?;
    if part.has_units {
        check_units(model, data, &before)
            .inspect_err(|_| problem.report(Stage::SetUps))
            .map_err(|error| clock_or_unit(model, data, &before, error))?;
    }
    let mut answer = match gate::unexcited(&problem, &before) {
        Some(missing) => conclude::not_excited(&problem, before, missing),
        None => {
            let outcome = search::search(&problem)?;
            conclude::conclude(&problem, before, outcome)?
        }
    };
    problem.report(Stage::SetUps);
    if let Some(told) = set_up_doubt(model, data, &answer.after) {
        // Causes in a set-up that is not the machine's are none.
        answer.unname(problem.start().nominal);
        answer.diagnosis.reason = format!("{told} Until then no cause is named.");
        answer.diagnosis.set_up = Some(told);
    }
    answer.diagnosis.work = Work {
        predictions: problem.predictions(),
        seconds: begun.elapsed().as_secs_f64(),
    };
    Ok(answer)
}

impl Answer {
    /// Takes names away from what was found: it is told as what comes nearest, and the model is as
    /// the scenario has it, with these nominal numbers.
    fn unname(&mut self, nominal: Vec<f64>) {
        let found = &mut self.diagnosis;
        found.verdict = Verdict::UnknownCause;
        found.nearest = std::mem::take(&mut found.causes);
        found.alternatives.clear();
        found.further.clear();
        found.runner_up = None;
        found.experiments.clear();
        found.doubts.clear();
        found.curve = None;
        found.nominal.clear();
        found.at_end = None;
        // What follows is of the model in the answer.
        found.changes.clear();
        found.ceiling = answer::Ceiling::default();
        found.unexplained_fraction = 1.0;
        for errors in found.channels.values_mut() {
            errors.after = errors.before;
        }
        self.nominal = nominal;
        self.effects.clear();
        self.after.clone_from(&self.before);
    }
}

/// A factor on drive forces may be what a clock does to them.
pub(crate) fn clock_or_unit(
    model: &dyn Model,
    data: &Observation,
    before: &Columns,
    error: DiagnoseError,
) -> DiagnoseError {
    let mut in_units = before.clone();
    let rows = model.channels().iter().zip(&data.outputs);
    for ((spec, output), simulated) in rows.zip(&mut in_units) {
        if let Some(found) = wrong_unit(spec, output, simulated) {
            simulated.iter_mut().for_each(|x| *x /= found.factor);
        }
    }
    set_up::or_units(model, data, [before, &in_units], error)
}

/// Refuses channels with a huge residual that another unit would remove.
pub(crate) fn check_units(
    model: &dyn Model,
    data: &Observation,
    before: &Columns,
) -> Result<(), DiagnoseError> {
    let rows = model.channels().iter().zip(&data.outputs).zip(before);
    for ((spec, output), simulated) in rows {
        if let Some(suspicion) = wrong_unit(spec, output, simulated) {
            return Err(DiagnoseError::Unit {
                channel: spec.name.clone(),
                suspicion,
            });
        }
    }
    Ok(())
}

/// Another unit of a channel that would remove a huge residual.
fn wrong_unit(spec: &ChannelSpec, output: &Output, simulated: &[f64]) -> Option<UnitSuspicion> {
    let measured = output.values.iter().zip(&output.valid);
    let measured: Vec<f64> = measured
        .map(|(value, valid)| if *valid { *value } else { 0.0 })
        .collect();
    unit_suspicion(&Pair {
        spec,
        measured: &measured,
        valid: &output.valid,
        simulated,
        noise: output.noise,
    })
}

#[cfg(test)]
mod tests;
