//! What a run comes to, for people and for other programs.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use crate::any_float::NumberStatus;
use crate::claims::ClaimResult;
use crate::recording::{Outcome, Recording};
use crate::unit::Unit;

/// The content of `summary.json`. All numbers are SI; one that is missing or infinite is `null`,
/// and a status says which.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Summary {
    /// The scenario's name.
    pub scenario: String,
    /// How the run ended.
    pub outcome: Outcome,
    /// The run's scalars, and the metric of each claim under the name that the claim gives it.
    pub metrics: BTreeMap<String, Option<f64>>,
    /// Of each metric that is `null`: whether it is missing or infinite.
    #[serde(default)]
    pub metric_status: BTreeMap<String, NumberStatus>,
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
        let scalars = recording
            .scalars
            .iter()
            .map(|s| (s.name.clone(), s.value, s.unit));
        let judged = claims.iter().map(|claim| {
            let value = claim.value.unwrap_or(f64::NAN);
            (claim.metric.clone(), value, claim.unit)
        });
        let all: Vec<_> = judged.chain(scalars).collect();
        Summary {
            scenario: recording.header.scenario_name.clone(),
            outcome: recording.outcome.clone(),
            metrics: all
                .iter()
                .map(|(name, value, _)| (name.clone(), Some(*value).filter(|v| v.is_finite())))
                .collect(),
            metric_status: all
                .iter()
                .filter_map(|(name, value, _)| Some((name.clone(), NumberStatus::of(*value)?)))
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
            Scalar::new("milling.stability_depth", Unit::Metre, f64::INFINITY, ""),
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
        for (name, status) in [
            ("chamfer.first_slip_depth", "missing"),
            ("milling.stability_depth", "infinite"),
        ] {
            assert!(json["metrics"][name].is_null());
            assert_eq!(json["metric_status"][name], status);
        }
        assert_eq!(json["metric_status"].as_object().unwrap().len(), 2);
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
