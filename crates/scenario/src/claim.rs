//! The `[[claim]]` tables: bounds on metrics, with reasons.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::Deserialize;
use truecut_recording::{ClaimSpec, RunReference};

use crate::check::Check;
use crate::fault::Fault;
use crate::metric::MetricTable;
use crate::written::Written;

/// What must hold of the run.
#[derive(Debug, Deserialize, JsonSchema)]
#[schemars(deny_unknown_fields)]
pub(crate) struct ClaimTable {
    /// A short sentence.
    name: String,
    #[serde(flatten)]
    metric: MetricTable,
    /// Lower bound, in `unit`. At least one of min and max is needed.
    min: Option<f64>,
    /// Upper bound, in `unit`. At least one of min and max is needed.
    max: Option<f64>,
    /// Unit of the bounds; must fit the metric. "1" for ratios.
    unit: String,
    /// Why it must hold.
    reason: String,
    /// Another run, by whose metric this one's is divided.
    relative_to: Option<ReferenceTable>,
}

/// Another run.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct ReferenceTable {
    /// Its scenario file, relative to this one. Default: this scenario.
    scenario: Option<String>,
    /// Keys that are changed in it, as with --set.
    set: Option<BTreeMap<String, Written>>,
}

impl ClaimTable {
    /// The claims of a scenario; those without a fault.
    pub(crate) fn resolve_all(tables: Option<Vec<Self>>, check: &mut Check) -> Vec<ClaimSpec> {
        let tables = tables.unwrap_or_default();
        // Reports know them by their names.
        check.names_differ("claim", tables.iter().map(|one| &one.name));
        let tables = tables.into_iter().enumerate();
        tables
            .filter_map(|(index, one)| one.resolve(&format!("claim.{index}"), check))
            .collect()
    }

    /// `table` is the dotted path of this table. `None` after recording a fault.
    fn resolve(self, table: &str, check: &mut Check) -> Option<ClaimSpec> {
        check_bounds(table, self.min, self.max, check);
        let relative_to = self
            .relative_to
            .map(|reference| reference.resolve(table, check));
        let (metric, unit) = self.metric.with_unit(&self.unit, table, check)?;
        let si = |bound: Option<f64>| bound.map(|bound| bound * unit.si_factor);
        Some(ClaimSpec {
            name: self.name,
            metric,
            min: si(self.min),
            max: si(self.max),
            unit,
            reason: self.reason,
            relative_to,
        })
    }
}

/// Bounds must exist and leave something between them.
pub(crate) fn check_bounds(table: &str, min: Option<f64>, max: Option<f64>, check: &mut Check) {
    match (min, max) {
        (None, None) => {
            let message = format!("missing key in [{table}]: a claim needs `min`, `max` or both");
            let label = "neither min nor max";
            check.refuse(Fault::key(&format!("{table}.min"), message, label));
        }
        (Some(min), Some(max)) if min > max => {
            let message = format!("is {max}, but must be at least min = {min}");
            check.wrong(table, "max", message, "nothing lies between the bounds");
        }
        _ => {}
    }
}

impl ReferenceTable {
    fn resolve(self, claim: &str, check: &mut Check) -> RunReference {
        let table = format!("{claim}.relative_to");
        let set = self.set.unwrap_or_default();
        if self.scenario.is_none() && set.is_empty() {
            let message = format!("`{table}` is this very run: it needs `scenario`, `set` or both");
            check.refuse(Fault::key(&table, message, "the ratio would always be 1"));
        }
        let overrides = set.iter().map(|(key, value)| (key.clone(), value.text()));
        RunReference {
            scenario: self.scenario,
            overrides: overrides.collect(),
        }
    }
}
