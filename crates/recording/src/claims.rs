//! Claims: bounds on metrics, with reasons, and whether they hold of a recording.

use serde::{Deserialize, Serialize};

use crate::metrics::{Metric, MetricError, MetricSpec};
use crate::recording::{Header, Outcome, Recording};
use crate::unit::{Unit, UserUnit};

/// Another run, to whose metric this one's is compared.
#[derive(Clone, Debug, PartialEq, Eq, Default)]
pub struct RunReference {
    /// Its scenario file as written, `None` for the scenario that makes the claim.
    pub scenario: Option<String>,
    /// Keys and values that are changed in it, as written.
    pub overrides: Vec<(String, String)>,
}

impl std::fmt::Display for RunReference {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter.write_str(self.scenario.as_deref().unwrap_or("this scenario"))?;
        self.overrides
            .iter()
            .try_for_each(|(key, value)| write!(formatter, " with {key} = {value}"))
    }
}

/// What must hold of a recording.
#[derive(Clone, Debug, PartialEq)]
pub struct ClaimSpec {
    /// A short sentence: `sticks to the end`.
    pub name: String,
    /// The number that is bounded.
    pub metric: MetricSpec,
    /// The unit in which the bounds were written; they are kept in SI.
    pub unit: UserUnit,
    /// Not less than this, SI.
    pub min: Option<f64>,
    /// Not more than this, SI.
    pub max: Option<f64>,
    /// Why it must hold.
    pub reason: String,
    /// If given, the metric is divided by that run's, and the bounds are on the ratio.
    pub relative_to: Option<RunReference>,
}

/// Whether a claim holds. Numbers are SI; `shown` has them in the claim's own unit.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ClaimResult {
    /// The claim's name.
    pub name: String,
    /// How the number was taken.
    pub metric: String,
    /// The number, which may be infinite (a depth without limit); `None` if there is none, `note`
    /// says why. In JSON it is `null` beside a `value_status` then.
    #[serde(flatten, with = "crate::any_float::option")]
    pub value: Option<f64>,
    /// Its unit, SI.
    pub unit: Unit,
    /// The lower bound.
    pub min: Option<f64>,
    /// The upper bound.
    pub max: Option<f64>,
    /// Whether the number exists and lies within the bounds, ends included.
    pub holds: bool,
    /// Why it must hold.
    pub reason: String,
    /// For a reader: `0.0190 mm, at most 0.0500 mm`.
    pub shown: String,
    /// Why there is no number, or why a number within the bounds does not count.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub note: Option<String>,
}

impl ClaimSpec {
    /// Whether the claim can be judged on a recording with these channels: before the run, so that
    /// a slip in the scenario does not cost one. Scalars are known only after it.
    ///
    /// # Errors
    /// No bound, bounds the wrong way round or not numbers, an unknown channel, a unit of another
    /// dimension.
    pub fn check(&self, header: &Header) -> Result<(), ClaimError> {
        let fault = |fault| ClaimError {
            claim: self.name.clone(),
            fault,
        };
        if self.min.is_none() && self.max.is_none() {
            return Err(fault(ClaimFault::NoBound));
        }
        if [self.min, self.max].into_iter().flatten().any(f64::is_nan) {
            return Err(fault(ClaimFault::NanBound));
        }
        if let (Some(min), Some(max)) = (self.min, self.max)
            && min > max
        {
            return Err(fault(ClaimFault::EmptyBounds {
                min: self.unit.show(min),
                max: self.unit.show(max),
            }));
        }
        let unit = self
            .metric
            .check(header)
            .map_err(|error| fault(error.into()))?;
        match (&self.relative_to, unit) {
            (Some(_), _) => self.check_unit(Unit::One),
            (None, Some(unit)) => self.check_unit(unit),
            (None, None) => Ok(()),
        }
    }

    fn check_unit(&self, unit: Unit) -> Result<(), ClaimError> {
        if self.unit.unit == unit {
            return Ok(());
        }
        let accepted: Vec<&str> = unit.accepted_symbols().collect();
        let fault = ClaimFault::Dimension {
            metric: self.metric_label(),
            written: self.unit.symbol.clone(),
            accepted: accepted.join(", "),
        };
        Err(ClaimError {
            claim: self.name.clone(),
            fault,
        })
    }

    fn metric_label(&self) -> String {
        match &self.relative_to {
            Some(reference) => format!("{} relative to {reference}", self.metric),
            None => self.metric.to_string(),
        }
    }

    /// Judges the claim. `reference` is the recording of [`ClaimSpec::relative_to`]. A number that
    /// does not exist, or that comes from a run that diverged, makes the claim fail with a note: it
    /// never holds by default.
    ///
    /// # Errors
    /// As [`ClaimSpec::check`]; an unknown scalar; a reference that is needed but not given.
    pub fn evaluate(
        &self,
        recording: &Recording,
        reference: Option<&Recording>,
    ) -> Result<ClaimResult, ClaimError> {
        self.check(&recording.header)?;
        let fault = |fault| ClaimError {
            claim: self.name.clone(),
            fault,
        };
        let own = self
            .metric
            .evaluate(recording)
            .map_err(|error| fault(error.into()))?;
        let metric = match (&self.relative_to, reference) {
            (None, _) => own,
            (Some(wanted), None) => return Err(fault(ClaimFault::NoReference(wanted.clone()))),
            (Some(_), Some(other)) => ratio(
                own,
                self.metric
                    .evaluate(other)
                    .map_err(|error| fault(error.into()))?,
            ),
        };
        self.check_unit(metric.unit)?;
        let outcomes = [
            Some(&recording.outcome),
            reference.map(|other| &other.outcome),
        ];
        let diverged = outcomes
            .into_iter()
            .flatten()
            .find(|outcome| !outcome.reached_end());
        Ok(self.judge(metric, diverged))
    }

    fn judge(&self, metric: Metric, diverged: Option<&Outcome>) -> ClaimResult {
        // Written so that a NaN fails both.
        let above = self.min.is_none_or(|min| metric.value >= min);
        let below = self.max.is_none_or(|max| metric.value <= max);
        let value = (!metric.value.is_nan()).then_some(metric.value);
        let note = metric
            .note
            .or_else(|| diverged.map(|outcome| format!("the run {outcome}")));
        ClaimResult {
            name: self.name.clone(),
            metric: self.metric_label(),
            value,
            unit: metric.unit,
            min: self.min,
            max: self.max,
            holds: value.is_some() && above && below && diverged.is_none(),
            reason: self.reason.clone(),
            shown: self.show(value),
            note,
        }
    }

    fn show(&self, value: Option<f64>) -> String {
        let value = value.map_or_else(|| "no value".to_owned(), |value| self.unit.show(value));
        match (self.min, self.max) {
            (Some(min), Some(max)) => format!(
                "{value}, {} to {}",
                self.unit.show(min),
                self.unit.show(max)
            ),
            (Some(min), None) => format!("{value}, at least {}", self.unit.show(min)),
            (None, Some(max)) => format!("{value}, at most {}", self.unit.show(max)),
            (None, None) => value,
        }
    }
}

fn ratio(own: Metric, other: Metric) -> Metric {
    let value = own.value / other.value;
    let note = own
        .note
        .or_else(|| other.note.map(|note| format!("the reference run: {note}")))
        .or_else(|| {
            (!value.is_finite()).then(|| {
                format!(
                    "the reference run's value is {} {}",
                    other.value, other.unit
                )
            })
        });
    Metric {
        // What is divided by nothing does not exist.
        value: if value.is_finite() { value } else { f64::NAN },
        unit: Unit::One,
        note,
    }
}

/// A claim that cannot be judged.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("claim \"{claim}\": {fault}")]
pub struct ClaimError {
    /// The claim's name.
    pub claim: String,
    /// What is wrong with it.
    pub fault: ClaimFault,
}

/// What can be wrong with a claim.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ClaimFault {
    /// Neither `min` nor `max`.
    #[error("a claim needs min, max or both")]
    NoBound,
    /// A bound that nothing can meet.
    #[error("a bound is not a number")]
    NanBound,
    /// Bounds that nothing can meet.
    #[error("min {min} is above max {max}")]
    EmptyBounds {
        /// As shown.
        min: String,
        /// As shown.
        max: String,
    },
    /// The metric cannot be taken.
    #[error(transparent)]
    Metric(#[from] MetricError),
    /// The unit does not fit.
    #[error("unit \"{written}\" does not fit {metric}; accepted: {accepted}")]
    Dimension {
        /// How the number is taken.
        metric: String,
        /// The claim's unit.
        written: String,
        /// Units that would do.
        accepted: String,
    },
    /// The other run is missing.
    #[error("the recording of {0} is needed to judge it")]
    NoReference(RunReference),
}

#[cfg(test)]
mod tests;
