//! What changed. Serialised as `between.json`.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};
use truecut_scenario::effect::Effect;

use crate::diagnose::{
    Cause, Ceiling, Change, ChannelErrors, Evidence, SmallestSeen, UnknownCurve, Work,
};
use crate::model::Columns;

/// Version of the layout.
pub(super) const VERSION: u32 = 1;

/// The verdict.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// The recordings differ by noise.
    #[default]
    NothingChanged,
    /// The changes are named.
    Changed,
    /// Something changed, and several causes explain it equally well; or something is there of
    /// which the first recording does not show whether it was there before.
    Ambiguous,
    /// Something changed that no known effect explains.
    UnknownChange,
    /// The recordings do not excite any output beyond noise.
    NotIdentifiable,
    /// Something changed, and no fit of it converged.
    FitFailed,
}

/// A parameter of an effect before and after. SI, in the unit named.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ChangedParameter {
    /// In the first recording.
    pub before: f64,
    /// In the second.
    pub after: f64,
    /// What was added; of a parameter that only shapes the effect, its value.
    pub change: f64,
    /// Lower end of the 95 % interval of the change; null where the data do not bound it.
    pub low: Option<f64>,
    /// Upper end.
    pub high: Option<f64>,
    /// Symbol of the unit.
    pub unit: String,
}

/// An effect that changed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Changed {
    /// Name of the kind.
    pub kind: String,
    /// `joint1`, an axis, a channel; null where there is only one.
    pub target: Option<String>,
    /// By key of the scenario.
    pub parameters: BTreeMap<String, ChangedParameter>,
    /// Evidence for the change.
    pub evidence: Evidence,
}

/// Another set of changes.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Rival {
    /// All of them.
    pub changes: Vec<Changed>,
    /// As of an alternative of a diagnosis.
    pub angle_deg: f64,
    /// How much larger its Bayesian information criterion is.
    pub criterion_difference: f64,
}

/// One of the two.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Recording {
    /// The earlier.
    First,
    /// The later.
    Second,
    /// Either: their difference does not show which.
    OneOfBoth,
}

/// Something that sets in within a recording, and may stop again.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Event {
    /// The recording.
    pub recording: Recording,
    /// Where and when, in seconds of that recording; of either, in seconds of the first.
    #[serde(flatten)]
    pub change: Change,
}

/// How the two were compared.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Compared {
    /// Whether the second recording repeats the motion of the first, so that their difference was
    /// explained.
    pub repeated: bool,
    /// By so much the motion comes later in the second file, s.
    pub later_s: Option<f64>,
    /// Part of their deviation by which inputs differ.
    pub unlike: Option<f64>,
}

/// The whole answer.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Changes {
    /// Of this layout.
    pub version: u32,
    /// Name of the scenario.
    pub scenario: String,
    /// Name of the first recording's data.
    pub first: String,
    /// Of the second's.
    pub second: String,
    /// How they were compared.
    pub compared: Compared,
    /// The verdict.
    pub verdict: Verdict,
    /// One sentence.
    pub reason: String,
    /// What changed, the strongest first.
    pub changes: Vec<Changed>,
    /// What happens within one recording, and is no change from the one to the other.
    #[serde(default)]
    pub events: Vec<Event>,
    /// Equally good explanations; empty for verdicts other than `ambiguous`.
    pub alternatives: Vec<Rival>,
    /// The next best explanation, if any was fitted.
    pub runner_up: Option<Rival>,
    /// Further explanations that the data do not exclude.
    pub further: Vec<String>,
    /// A change without a name, as a curve.
    pub curve: Option<UnknownCurve>,
    /// What the model lacks in both recordings, as far as the first shows it: no change.
    pub shared: Vec<Cause>,
    /// Where an effect is there in the second recording, and the first does not show whether it was
    /// there before.
    pub undecided: Vec<String>,
    /// Part of what differs beyond noise that the changes leave unexplained.
    pub unexplained_fraction: f64,
    /// Errors by channel, of the difference, or of both recordings.
    pub channels: BTreeMap<String, ChannelErrors>,
    /// Changes that would have been seen.
    pub smallest_seen: Vec<SmallestSeen>,
    /// Shortcomings of the recordings.
    pub missing: Vec<String>,
    /// What is to be doubted.
    pub doubts: Vec<String>,
    /// What any model could still gain.
    pub ceiling: Ceiling,
    /// Work done.
    pub work: Work,
}

/// The answer with what is needed to draw and to extend.
#[derive(Debug, Clone)]
pub struct Answer {
    /// What is written.
    pub changes: Changes,
    /// Effects of the first recording.
    pub before: Vec<Effect>,
    /// Of the second.
    pub after: Vec<Effect>,
    /// Numbers of the scenario, refitted to the first recording.
    pub nominal: Vec<f64>,
    /// Prediction of what is explained, without a change.
    pub unchanged: Columns,
    /// With the changes.
    pub changed: Columns,
}
