//! Result of a diagnosis. Serialised as `diagnosis.json`.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};
use truecut_recording::Unit;
use truecut_scenario::effect::Target;

use super::floor::NoiseSource;
use super::problem::{Found, Point, Problem};
use super::race::FitTrial;
use crate::model::Candidate;

/// Version of the layout.
pub(super) const VERSION: u32 = 3;

/// The verdict.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// The model explains the data up to noise.
    #[default]
    NothingBeyondNoise,
    /// The causes are named.
    Named,
    /// Several causes explain the data equally well.
    Ambiguous,
    /// There is a discrepancy that no known effect explains.
    UnknownCause,
    /// The experiment does not excite any output beyond noise.
    NotIdentifiable,
    /// There is a discrepancy, and no fit of it converged.
    FitFailed,
}

/// One parameter of a cause. SI, in the unit named.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Parameter {
    /// Estimate.
    pub value: f64,
    /// Lower end of the 95 % interval; null where the data do not bound it.
    pub low: Option<f64>,
    /// Upper end.
    pub high: Option<f64>,
    /// Symbol of the unit.
    pub unit: String,
}

/// Evidence for a cause.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Evidence {
    /// Fall of minus twice the log-likelihood when the effect joins the others.
    pub likelihood_gain: f64,
    /// Decimal logarithm of the odds that it is there rather than not, by Schwarz's criterion.
    pub log10_odds: f64,
    /// The same on validation blocks, whitened, in standard errors.
    pub validation_t: f64,
    /// Largest relative fall of a channel's rms on validation blocks.
    pub practical_gain: f64,
}

/// An effect that explains the discrepancy.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Cause {
    /// Name of the kind.
    pub kind: String,
    /// `joint1`, an axis, a channel; null where there is only one.
    pub target: Option<String>,
    /// By key of the scenario.
    pub parameters: BTreeMap<String, Parameter>,
    /// Its evidence.
    pub evidence: Evidence,
}

/// Another set of causes.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Alternative {
    /// Its effects, all of them.
    pub causes: Vec<Cause>,
    /// Angle between its signature and that of the causes named, whitened, less what nominal
    /// parameters can do.
    pub angle_deg: f64,
    /// How much worse it predicts the validation blocks, in standard errors; negative where it
    /// predicts them better.
    pub behind_t: f64,
    /// How much larger its Bayesian information criterion is.
    pub criterion_difference: f64,
}

/// Errors of a channel on the test part, rms, in the channel's unit.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ChannelErrors {
    /// Of the nominal model as the scenario has it.
    pub before: f64,
    /// Of the nominal model with parameters refitted within their uncertainty.
    pub refitted: f64,
    /// Of the extended model.
    pub after: f64,
    /// The noise, from [`ChannelErrors::noise_source`]; a bound is what a flexible predictor leaves
    /// of the residual.
    pub noise_floor: f64,
    /// Where the noise is known from.
    pub noise_source: NoiseSource,
    /// The noise if it has no memory, from differences in time: where the source is a bound, the
    /// least that it can be.
    pub noise_without_memory: f64,
    /// Symbol of the unit.
    pub unit: String,
}

/// A nominal parameter.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Nominal {
    /// Its key.
    pub key: String,
    /// As the scenario has it, SI.
    pub before: f64,
    /// Refitted, with the effects named.
    pub after: Parameter,
}

/// The smallest effect of a kind that would have been seen.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SmallestSeen {
    /// Name of the kind.
    pub kind: String,
    /// As in [`Cause`].
    pub target: Option<String>,
    /// Key of the size.
    pub parameter: String,
    /// The distance from the neutral value that would be detected with 95 % probability; null where
    /// no size within reach would.
    pub size: Option<f64>,
    /// Symbol of the unit.
    pub unit: String,
}

/// A signal that the residual of a channel is correlated with.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct CorrelatedSignal {
    /// What: `velocity of joint1.position`, `a line at 12.5 Hz`.
    pub signal: String,
    /// Channel whose residual follows it.
    pub channel: String,
    /// Part of the whitened variance that it explains, cross-validated.
    pub fraction: f64,
    /// In standard errors.
    pub t: f64,
}

/// A law without a name: what a joint does beyond the causes, over its position or speed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct UnknownCurve {
    /// Name of the effect that carries it.
    pub kind: String,
    /// `joint1`.
    pub target: String,
    /// Places, in `x_unit`, evenly over the range of the data.
    pub x: Vec<f64>,
    /// Symbol of the unit.
    pub x_unit: String,
    /// Force or torque there, in `unit`.
    pub value: Vec<f64>,
    /// Lower end of its 95 % interval, place by place; null where the data do not bound it.
    pub low: Vec<Option<f64>>,
    /// Upper end.
    pub high: Vec<Option<f64>>,
    /// Symbol of the unit.
    pub unit: String,
    /// Decimal logarithm of the odds against the model without it, by Schwarz's criterion.
    pub log10_odds: f64,
}

/// What is measured changes over time, as no cause in the machine does by itself.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Change {
    /// Channel in which it is seen.
    pub channel: String,
    /// From about when, in seconds of the data; null if it changes all the time.
    pub from_s: Option<f64>,
    /// Until about when; null if it stays, or changes all the time.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub until_s: Option<f64>,
    /// What changes: the law whose trace it has.
    pub what: String,
}

/// What any model could still gain.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Ceiling {
    /// Part of the whitened variance left that a flexible predictor explains on blocks it was not
    /// fitted to.
    pub fraction: f64,
    /// In standard errors.
    pub t: f64,
    /// What the residual follows, strongest first.
    pub correlated_signals: Vec<CorrelatedSignal>,
}

/// An experiment that would distinguish causes.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Proposal {
    /// The change of the experiment.
    pub description: String,
    /// Keys of the scenario and their values as written.
    pub overrides: Vec<(String, String)>,
    /// Whitened distance between the predictions of the causes and of the first alternative.
    pub separation: f64,
    /// The same in the data at hand.
    pub separation_now: f64,
}

/// One fit of the search.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FitRecord {
    /// Kinds and targets fitted together.
    pub effects: Vec<String>,
    /// Whether it ended at a minimum.
    pub converged: bool,
    /// Steps.
    pub iterations: usize,
    /// Why the simulation could not be run, if so.
    pub failure: Option<String>,
}

/// Work done.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Work {
    /// Simulations.
    pub predictions: usize,
    /// Wall time.
    pub seconds: f64,
}

/// The whole answer.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Diagnosis {
    /// Of this layout.
    pub version: u32,
    /// Name of the scenario.
    pub scenario: String,
    /// Name of the data.
    pub data: String,
    /// The verdict.
    pub verdict: Verdict,
    /// One sentence.
    pub reason: String,
    /// Effects that explain the discrepancy, the strongest first. With `unknown_cause`, those that
    /// explain a part.
    pub causes: Vec<Cause>,
    /// Another set-up that explains far more than any causes do, and how much.
    #[serde(default)]
    pub set_up: Option<String>,
    /// Which size lies at an end of its range, so that none of the effects known fits.
    #[serde(default)]
    pub at_end: Option<String>,
    /// Effects that come nearest and are not named, in a set-up that is not the machine's.
    #[serde(default)]
    pub nearest: Vec<Cause>,
    /// What has no name, as a curve, with `unknown_cause`; null where none predicts it.
    #[serde(default)]
    pub curve: Option<UnknownCurve>,
    /// Equally good explanations; empty for verdicts other than `ambiguous`.
    pub alternatives: Vec<Alternative>,
    /// Further explanations that the data do not exclude, less likely than those.
    #[serde(default)]
    pub further: Vec<String>,
    /// The next best explanation, if any was fitted.
    pub runner_up: Option<Alternative>,
    /// Part of the discrepancy beyond noise that the causes leave unexplained.
    pub unexplained_fraction: f64,
    /// Errors by channel.
    pub channels: BTreeMap<String, ChannelErrors>,
    /// Nominal parameters.
    pub nominal: Vec<Nominal>,
    /// Detectable sizes of other effects.
    pub smallest_seen: Vec<SmallestSeen>,
    /// What changes over time.
    #[serde(default)]
    pub changes: Vec<Change>,
    /// Shortcomings of the experiment.
    pub missing: Vec<String>,
    /// What is to be doubted about the causes.
    pub doubts: Vec<String>,
    /// What any model could still gain.
    pub ceiling: Ceiling,
    /// The best experiment first.
    pub experiments: Vec<Proposal>,
    /// All fits of the search.
    pub fits: Vec<FitRecord>,
    /// Work done.
    pub work: Work,
}

/// A channel whose error falls below this part of what it was is explained for the most part.
const MOSTLY: f64 = 0.5;

impl Diagnosis {
    /// The channel whose error the causes take away most of, where they leave much of what stands
    /// out of the noise: a small part of that may be most of what one sees.
    pub fn most_fallen(&self) -> Option<(&str, &ChannelErrors)> {
        if self.unexplained_fraction <= MOSTLY {
            return None;
        }
        let part = |errors: &ChannelErrors| errors.after / errors.refitted;
        let fallen = (self.channels.iter()).filter(|(_, errors)| part(errors) < MOSTLY);
        let most = fallen.min_by(|a, b| part(a.1).total_cmp(&part(b.1)))?;
        Some((most.0.as_str(), most.1))
    }
}

impl FitRecord {
    pub(super) fn new(problem: &Problem, trial: &FitTrial) -> FitRecord {
        let end = trial.end.as_ref();
        FitRecord {
            effects: names(problem, &trial.start),
            converged: end.is_ok_and(|fit| fit.converged),
            iterations: end.map_or(trial.iterations, |fit| fit.iterations),
            failure: end.err().map(ToString::to_string),
        }
    }
}

/// Kinds and targets of a point's effects, in words.
pub(super) fn names(problem: &Problem, point: &Point) -> Vec<String> {
    let name = |found: &Found| {
        let candidate = &problem.candidates[found.candidate];
        match target_name(candidate) {
            Some(target) => format!("{} {target}", candidate.kind.name()),
            None => candidate.kind.name().to_string(),
        }
    };
    point.effects.iter().map(name).collect()
}

/// The name of a target as channels and answers have it.
pub(crate) fn target_name(candidate: &Candidate) -> Option<String> {
    match &candidate.target {
        Target::Whole => None,
        Target::Joint(index) => Some(format!("joint{}", index + 1)),
        Target::Axis(index) => Some(
            ["x", "y", "z"]
                .get(*index)
                .map_or_else(|| format!("axis{}", index + 1), ToString::to_string),
        ),
        Target::Channel(name) => Some(name.clone()),
    }
}

/// Key and unit of a candidate's parameter.
pub(super) fn key_and_unit(
    problem: &Problem,
    candidate: usize,
    parameter: usize,
) -> (String, String) {
    let info = &problem.infos(candidate)[parameter];
    let candidate = &problem.candidates[candidate];
    let (key, unit) = match candidate.rotary {
        true => (info.rotary_key, info.rotary_unit),
        false => (info.key, info.unit),
    };
    // A sensor's offset and drift are in the unit of its channel.
    let of_channel = matches!(info.key, "offset" | "amplitude") && unit == Unit::One;
    let unit = match &candidate.target {
        Target::Channel(name) if of_channel => {
            let spec = problem
                .model
                .channels()
                .iter()
                .find(|spec| spec.name == *name);
            spec.map_or(unit, |spec| spec.unit)
        }
        _ => unit,
    };
    (key.to_string(), unit.to_string())
}
