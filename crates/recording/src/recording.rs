//! A recording: named channels with units on one time base, and what was computed from the run.

use serde::{Deserialize, Serialize};

use crate::names::nearest;
use crate::scene::Scene;
use crate::unit::{Unit, significant, suggestion};

/// Name, unit and meaning of one channel.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct ChannelSpec {
    /// `tool.displacement_y`: what, then which quantity and axis.
    pub name: String,
    /// Unit of its values.
    pub unit: Unit,
    /// One line for a reader who does not know the program.
    pub description: String,
}

impl ChannelSpec {
    /// A channel.
    pub fn new(name: impl Into<String>, unit: Unit, description: impl Into<String>) -> ChannelSpec {
        ChannelSpec {
            name: name.into(),
            unit,
            description: description.into(),
        }
    }
}

/// A named result that the run computed, e.g. `chamfer.width_spread`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Scalar {
    /// Its name.
    pub name: String,
    /// Unit of `value`.
    pub unit: Unit,
    /// SI; NaN if the run gave none.
    #[serde(flatten, with = "crate::any_float::value")]
    pub value: f64,
    /// One line.
    pub description: String,
}

impl Scalar {
    /// A scalar.
    pub fn new(
        name: impl Into<String>,
        unit: Unit,
        value: f64,
        description: impl Into<String>,
    ) -> Scalar {
        Scalar {
            name: name.into(),
            unit,
            value,
            description: description.into(),
        }
    }
}

/// Something along a line, e.g. chamfer width around the rim.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Profile {
    /// Its name: `chamfer.width`.
    pub name: String,
    /// One line.
    pub description: String,
    /// What the axis is: `rim_angle`.
    pub axis_name: String,
    /// Unit of `axis`.
    pub axis_unit: Unit,
    /// Places, ascending, SI.
    #[serde(flatten, with = "crate::any_float::axis")]
    pub axis: Vec<f64>,
    /// Unit of `values`.
    pub unit: Unit,
    /// One for each place, SI.
    #[serde(flatten, with = "crate::any_float::values")]
    pub values: Vec<f64>,
}

/// What is known of a recording before its first row.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct Header {
    /// The scenario's name.
    pub scenario_name: String,
    /// The whole scenario file, with overrides applied, so that the recording can be run again.
    pub scenario_text: String,
    /// The channels, in the order of the columns.
    pub channels: Vec<ChannelSpec>,
    /// What can be seen.
    pub scene: Scene,
    /// What a reader should know: assumptions made, branches merged.
    pub notes: Vec<String>,
}

impl Header {
    /// The column of a channel.
    ///
    /// # Errors
    /// A channel that is not there; the nearest one is named.
    pub fn index_of(&self, name: &str) -> Result<usize, UnknownName> {
        self.channels
            .iter()
            .position(|channel| channel.name == name)
            .ok_or_else(|| {
                UnknownName::new(
                    "channel",
                    name,
                    self.channels.iter().map(|channel| channel.name.as_str()),
                )
            })
    }

    /// Name, unit and meaning of a channel.
    ///
    /// # Errors
    /// As [`Header::index_of`].
    pub fn channel(&self, name: &str) -> Result<&ChannelSpec, UnknownName> {
        Ok(&self.channels[self.index_of(name)?])
    }
}

/// How the run ended.
#[derive(Clone, Debug, PartialEq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Outcome {
    /// It ran to its end.
    #[default]
    Completed,
    /// It ran to its end, but more was asked of a drive than it gives: the real arm would not have
    /// followed. All that was recorded is there.
    Overloaded {
        /// When most was asked.
        time_s: f64,
        /// The joint whose drive it is.
        joint: String,
        /// Largest torque or force over the drive's limit.
        #[serde(flatten, with = "crate::any_float::share")]
        share: f64,
        /// The limit with its unit.
        limit: String,
    },
    /// It ran to its end, but with masses or inertias that no arm has: its numbers say nothing of
    /// the real one. All that was recorded is there.
    Placeholders {
        /// What they are told by.
        signs: String,
    },
    /// It ran to its end, but left what its model describes: its numbers say nothing of the real
    /// process. All that was recorded is there.
    BeyondModel {
        /// What left it.
        quantity: String,
        /// Its value, SI.
        #[serde(flatten, with = "crate::any_float::value")]
        value: f64,
        /// The bound, SI.
        #[serde(flatten, with = "crate::any_float::limit")]
        limit: f64,
        /// What ends there.
        rule: String,
    },
    /// It was stopped from outside; what was recorded until then is there. Readers find the same of
    /// a stream without an end mark: its program was killed while it ran.
    Interrupted,
    /// It went out of bounds and was stopped; what was recorded until then is there.
    Diverged {
        /// When.
        time_s: f64,
        /// What went out of bounds.
        quantity: String,
        /// To which value, SI.
        #[serde(flatten, with = "crate::any_float::value")]
        value: f64,
        /// The bound, SI.
        #[serde(flatten, with = "crate::any_float::limit")]
        limit: f64,
        /// The rule that was broken.
        rule: String,
    },
    /// It was stopped, since the tool vibrates so strongly that the cut's law ends; what was
    /// recorded until then is there.
    Chatter {
        /// When.
        time_s: f64,
        /// Half of the way between the extremes of the tool's motion, m.
        #[serde(flatten, with = "crate::any_float::amplitude")]
        amplitude_m: f64,
        /// The rule of the cut that was broken.
        rule: String,
    },
}

impl Outcome {
    /// Whether the run came to its end, so that numbers over the whole of it exist.
    pub fn reached_end(&self) -> bool {
        matches!(self, Outcome::Completed) || self.fails_at_its_end()
    }

    /// Whether the run came to its end and fails all the same, whatever its claims say.
    pub fn fails_at_its_end(&self) -> bool {
        matches!(
            self,
            Outcome::Overloaded { .. } | Outcome::Placeholders { .. } | Outcome::BeyondModel { .. }
        )
    }
}

impl std::fmt::Display for Outcome {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Outcome::Completed => formatter.write_str("completed"),
            Outcome::Interrupted => formatter.write_str("was interrupted"),
            Outcome::Placeholders { signs } => write!(
                formatter,
                "rests on placeholders: {signs}; give the arm's own values in robot.toml, or \
                 estimate them with `truecut robot init`"
            ),
            Outcome::BeyondModel {
                quantity,
                value,
                limit,
                rule,
            } => {
                write!(
                    formatter,
                    "is beyond the model: {quantity} is {}, but must be at most {}: {rule}",
                    significant(*value, 4),
                    significant(*limit, 4)
                )
            }
            Outcome::Overloaded {
                time_s,
                joint,
                share,
                limit,
            } => {
                write!(
                    formatter,
                    "overloaded a drive: joint `{joint}` is asked for {} times what it gives \
                     (limit {limit}, most at {time_s:.4} s); the real arm would not hold",
                    significant(*share, 3)
                )
            }
            Outcome::Diverged {
                time_s,
                quantity,
                value,
                limit,
                rule,
            } => {
                write!(
                    formatter,
                    "diverged at {time_s:.4} s: {quantity} = {}, limit {} ({rule})",
                    six_decimals(*value),
                    six_decimals(*limit)
                )
            }
            Outcome::Chatter {
                time_s,
                amplitude_m,
                rule,
            } => {
                write!(
                    formatter,
                    "ended in chatter at {time_s:.4} s: amplitude {:.3} mm ({rule})",
                    1e3 * amplitude_m
                )
            }
        }
    }
}

/// A number with six decimals, with an exponent where that would take a line of digits.
fn six_decimals(value: f64) -> String {
    match value.abs() {
        size if size.is_finite() && size >= 1e9 => significant(value, 7),
        _ => format!("{value:.6}"),
    }
}

/// A run, or a measurement: every channel has one value for every time.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct Recording {
    /// What was known before the first row.
    pub header: Header,
    /// Ascending times.
    pub time_s: Vec<f64>,
    /// One column for each channel, as long as `time_s`, SI.
    pub columns: Vec<Vec<f64>>,
    /// Results along a line.
    pub profiles: Vec<Profile>,
    /// Single results.
    pub scalars: Vec<Scalar>,
    /// How it ended.
    pub outcome: Outcome,
}

impl Recording {
    /// The values of a channel, SI, one for each of [`Recording::time_s`].
    ///
    /// # Errors
    /// A channel that is not there; the nearest one is named.
    pub fn channel(&self, name: &str) -> Result<&[f64], UnknownName> {
        Ok(&self.columns[self.header.index_of(name)?])
    }

    /// A single result.
    ///
    /// # Errors
    /// A scalar that is not there; the nearest one is named.
    pub fn scalar(&self, name: &str) -> Result<&Scalar, UnknownName> {
        self.scalars
            .iter()
            .find(|scalar| scalar.name == name)
            .ok_or_else(|| {
                UnknownName::new(
                    "scalar",
                    name,
                    self.scalars.iter().map(|scalar| scalar.name.as_str()),
                )
            })
    }

    /// A result along a line.
    ///
    /// # Errors
    /// A profile that is not there; the nearest one is named.
    pub fn profile(&self, name: &str) -> Result<&Profile, UnknownName> {
        self.profiles
            .iter()
            .find(|profile| profile.name == name)
            .ok_or_else(|| {
                UnknownName::new(
                    "profile",
                    name,
                    self.profiles.iter().map(|profile| profile.name.as_str()),
                )
            })
    }
}

/// A channel, scalar or profile that does not exist.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("unknown {kind} \"{name}\"{}{}", suggestion(.nearest.as_deref()), listed(.nearest.as_deref(), .known))]
pub struct UnknownName {
    /// `channel`, `scalar` or `profile`.
    pub kind: &'static str,
    /// As asked for.
    pub name: String,
    /// The nearest one that exists.
    pub nearest: Option<String>,
    /// All that exist.
    pub known: Vec<String>,
}

/// What there is to choose from, where nothing near was meant.
fn listed(nearest: Option<&str>, known: &[String]) -> String {
    if nearest.is_some() || known.is_empty() {
        return String::new();
    }
    format!("; known: {}", known.join(", "))
}

impl UnknownName {
    /// An unknown name among those that exist.
    pub fn new<'a>(
        kind: &'static str,
        name: &str,
        existing: impl IntoIterator<Item = &'a str>,
    ) -> UnknownName {
        let known: Vec<&str> = existing.into_iter().collect();
        UnknownName {
            kind,
            name: name.to_owned(),
            nearest: nearest(name, known.iter().copied()).map(str::to_owned),
            known: known.into_iter().map(str::to_owned).collect(),
        }
    }
}
