//! What a run comes to, for people and for other programs.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use crate::claims::ClaimResult;
use crate::recording::{Outcome, Recording};
use crate::unit::Unit;

/// The content of `summary.json`. All numbers are SI; one that does not exist is `null`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Summary {
    /// The scenario's name.
    pub scenario: String,
    /// How the run ended.
    pub outcome: Outcome,
    /// The run's scalars, and the metric of each claim under the name that the claim gives it.
    pub metrics: BTreeMap<String, Option<f64>>,
    /// The unit of each metric.
    pub units: BTreeMap<String, Unit>,
    /// The claims, in the scenario's order.
    pub claims: Vec<ClaimResult>,
    /// What a reader should know.
    pub notes: Vec<String>,
}

impl Summary {
    /// Collects what a run comes to.
    pub fn new(recording: &Recording, claims: &[ClaimResult]) -> Summary {
        let finite = |value: f64| value.is_finite().then_some(value);
        let scalars = recording
            .scalars
            .iter()
            .map(|s| (s.name.clone(), finite(s.value), s.unit));
        let judged = claims
            .iter()
            .map(|claim| (claim.metric.clone(), claim.value, claim.unit));
        let all: Vec<_> = judged.chain(scalars).collect();
        Summary {
            scenario: recording.header.scenario_name.clone(),
            outcome: recording.outcome.clone(),
            metrics: all
                .iter()
                .map(|(name, value, _)| (name.clone(), *value))
                .collect(),
            units: all
                .iter()
                .map(|(name, _, unit)| (name.clone(), *unit))
                .collect(),
            claims: claims.to_vec(),
            notes: recording.header.notes.clone(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{ClaimSpec, MetricSpec, Scalar, UserUnit};

    #[test]
    fn the_json_has_the_agreed_keys() {
        let mut recording = Recording::default();
        recording.header.scenario_name = "Test D".into();
        recording.scalars = vec![
            Scalar::new("chamfer.width_spread", Unit::Metre, 1.9e-5, ""),
            Scalar::new("chamfer.first_slip_depth", Unit::Metre, f64::NAN, ""),
        ];
        let claim = ClaimSpec {
            name: "even width".into(),
            metric: MetricSpec::Scalar {
                name: "chamfer.width_spread".into(),
            },
            unit: UserUnit::parse("mm").unwrap(),
            min: None,
            max: Some(5e-5),
            reason: "published result".into(),
            relative_to: None,
        };
        let result = claim.evaluate(&recording, None).unwrap();
        let summary = Summary::new(&recording, &[result]);
        let json = serde_json::to_value(&summary).unwrap();
        assert_eq!(json["scenario"], "Test D");
        assert_eq!(json["outcome"], "completed");
        assert_eq!(json["metrics"]["chamfer.width_spread"], 1.9e-5);
        assert!(json["metrics"]["chamfer.first_slip_depth"].is_null());
        assert_eq!(json["units"]["chamfer.width_spread"], "m");
        let claim = &json["claims"][0];
        assert_eq!(claim["name"], "even width");
        assert_eq!(claim["metric"], "chamfer.width_spread");
        assert_eq!(
            (&claim["value"], &claim["max"]),
            (&1.9e-5.into(), &5e-5.into())
        );
        assert!(claim["min"].is_null() && claim["holds"] == true);
        assert_eq!(serde_json::from_value::<Summary>(json).unwrap(), summary);
    }
}
