//! The `[sweep]` table: the same scenario at many values of some of its keys.

use schemars::JsonSchema;
use serde::Deserialize;
use truecut_recording::nearest;

use crate::check::Check;
use crate::claim::check_bounds;
use crate::fault::Fault;
use crate::metric::MetricTable;
use crate::sweep_check::{
    check_count, check_key, check_keys_differ, check_names_differ, check_rising,
};
use crate::sweep_sample::{Drawn, SampleTable};
pub use crate::sweep_spec::{BisectSpec, SweepAxis, SweepClaim, SweepColumn, SweepSpec};
use crate::uncertain::UncertainSpec;
use crate::units::key_unit;

/// How values are spaced between the ends of an axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
enum Spacing {
    /// Equal differences.
    #[default]
    Linear,
    /// Equal ratios.
    Log,
}

/// The same scenario at many values of its keys.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct SweepTable {
    /// Keys and their values: at most two of which all combinations are rows, or any number
    /// between whose ends `sample` draws.
    axis: Option<Vec<AxisTable>>,
    /// Rows that are drawn, in place of all combinations.
    sample: Option<SampleTable>,
    /// Search for a threshold in each row.
    bisect: Option<BisectTable>,
    /// What to tabulate for each row.
    column: Option<Vec<ColumnTable>>,
    /// What must hold of every row.
    claim: Option<Vec<SweepClaim>>,
}

/// A key and its values: either `values`, or `from`, `to` and, where no rows are drawn, `steps`.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct AxisTable {
    /// Dotted key, as for --set.
    key: String,
    /// Values in the unit of the key.
    #[schemars(extend("minItems" = 1, "maxItems" = 1000))]
    values: Option<Vec<f64>>,
    /// First value.
    from: Option<f64>,
    /// Last value.
    to: Option<f64>,
    /// Number of values, both ends included; not beside `[sweep.sample]`.
    #[schemars(range(min = 2, max = 1000), extend("x-rule" = "both ends are included"))]
    steps: Option<u32>,
    /// How the values are spaced. Default: "linear".
    spacing: Option<Spacing>,
}

/// Search for the smallest value of a key at which a metric is at most a limit.
#[derive(Debug, Deserialize, JsonSchema)]
#[schemars(deny_unknown_fields)]
struct BisectTable {
    /// Name of the result's column. Default: "threshold".
    name: Option<String>,
    /// Dotted key, as for --set.
    key: String,
    /// Lower end of the search, in the unit of the key.
    from: f64,
    /// Upper end of the search, in the unit of the key.
    to: f64,
    /// Width of the final interval relative to the value. Default: 0.002.
    #[schemars(extend(
        "minimum" = 1e-9,
        "exclusiveMaximum" = 1.0,
        "x-rule" = "the search ends at this relative width"
    ))]
    tolerance: Option<f64>,
    #[serde(flatten)]
    metric: MetricTable,
    /// Limit of the metric, in `unit`.
    limit: f64,
    /// Unit of the limit; must fit the metric.
    unit: String,
}

/// A number to tabulate for each row.
#[derive(Debug, Deserialize, JsonSchema)]
#[schemars(deny_unknown_fields)]
struct ColumnTable {
    /// Name of the column.
    name: String,
    #[serde(flatten)]
    metric: MetricTable,
    /// Unit in which the number is shown; must fit the metric.
    unit: String,
}

/// Relative width at which the search for a threshold ends where a scenario does not give it.
const DEFAULT_TOLERANCE: f64 = 0.002;

impl SweepTable {
    pub(crate) fn resolve(self, uncertain: &[UncertainSpec], check: &mut Check) -> SweepSpec {
        let axes = self.axis.unwrap_or_default().into_iter().enumerate();
        let is_sampled = self.sample.is_some();
        let axes: Vec<SweepAxis> = match self.sample {
            Some(sample) => {
                let drawn = axes.filter_map(|(index, axis)| axis.drawn(index, check));
                let drawn = drawn.collect();
                sample.resolve(drawn, uncertain, check)
            }
            None => axes
                .filter_map(|(index, axis)| axis.resolve(index, check))
                .collect(),
        };
        let bisect = self.bisect.and_then(|bisect| bisect.resolve(check));
        let columns = self.column.unwrap_or_default().into_iter().enumerate();
        let columns: Vec<SweepColumn> = columns
            .filter_map(|(index, column)| column.resolve(index, check))
            .collect();
        let is_swept = ["sweep.axis", "sweep.bisect", "sweep.sample.uncertain"];
        if !is_swept.iter().any(|key| check.document().has(key)) {
            let message = "[sweep] has neither [[sweep.axis]] nor [sweep.bisect]".to_owned();
            check.refuse(Fault::key("sweep", message, "nothing is swept"));
        }
        check_keys_differ(&axes, bisect.as_ref(), check);
        if !is_sampled {
            check_count(&axes, check);
        }
        if !check.document().has("sweep.column") && !check.document().has("sweep.bisect") {
            let message =
                "[sweep] has neither [[sweep.column]] nor [sweep.bisect]: its rows would be empty";
            check.refuse(Fault::key(
                "sweep",
                message.to_owned(),
                "nothing is tabulated",
            ));
        }
        check_names_differ(&axes, bisect.as_ref(), &columns, check);
        let known: Vec<String> = bisect
            .iter()
            .map(|bisect| bisect.name.clone())
            .chain(columns.iter().map(|column| column.name.clone()))
            .collect();
        let claims = self.claim.unwrap_or_default();
        check.names_differ("sweep.claim", claims.iter().map(|one| &one.name));
        for (index, claim) in claims.iter().enumerate() {
            check_claim(claim, index, &known, check);
        }
        SweepSpec {
            axes,
            is_sampled,
            bisect,
            columns,
            claims,
        }
    }
}

impl AxisTable {
    fn resolve(self, index: usize, check: &mut Check) -> Option<SweepAxis> {
        let table = format!("sweep.axis.{index}");
        check_key(&self.key, &format!("{table}.key"), check);
        if let Some(values) = self.listed(&table, check) {
            let unit = key_unit(&self.key);
            return Some(SweepAxis {
                key: self.key,
                values,
                unit,
            });
        }
        let steps = check.needed(&table, "steps", self.steps, NOT_LISTED);
        let (from, to, spacing) = self.ends(&table, check)?;
        let steps = steps?;
        let values = (0..steps).map(|step| {
            let share = f64::from(step) / f64::from(steps - 1);
            match spacing {
                Spacing::Linear => from + share * (to - from),
                Spacing::Log => from * (to / from).powf(share),
            }
        });
        let unit = key_unit(&self.key);
        Some(SweepAxis {
            key: self.key,
            values: values.collect(),
            unit,
        })
    }

    /// What the values of an axis are drawn from.
    fn drawn(self, index: usize, check: &mut Check) -> Option<(String, Drawn)> {
        let table = format!("sweep.axis.{index}");
        check_key(&self.key, &format!("{table}.key"), check);
        if let Some(values) = self.listed(&table, check) {
            return Some((self.key, Drawn::Among(values)));
        }
        check.ignored(&table, &["steps"], SampleTable::BECAUSE);
        let (from, to, spacing) = self.ends(&table, check)?;
        let drawn = match spacing {
            Spacing::Linear => Drawn::Even(from, to),
            Spacing::Log => Drawn::Log(from, to),
        };
        Some((self.key, drawn))
    }

    /// The values, if they are listed.
    fn listed(&self, table: &str, check: &mut Check) -> Option<Vec<f64>> {
        let values = self.values.clone()?;
        let because = "`values` already lists the values";
        check.ignored(table, &["from", "to", "steps", "spacing"], because);
        Some(values)
    }

    /// First and last value, and what lies between.
    fn ends(&self, table: &str, check: &mut Check) -> Option<(f64, f64, Spacing)> {
        let from = check.needed(table, "from", self.from, NOT_LISTED);
        let to = check.needed(table, "to", self.to, NOT_LISTED);
        let (from, to) = (from?, to?);
        check_rising(table, from, to, check);
        let spacing = self.spacing.unwrap_or_default();
        if spacing == Spacing::Log && from <= 0.0 {
            let message = format!("is {from}, but must be greater than 0: equal ratios");
            check.wrong(table, "from", message, "not positive");
        }
        Some((from, to, spacing))
    }
}

/// Who needs `from`, `to` and `steps`.
const NOT_LISTED: &str = "an axis without `values`";

impl BisectTable {
    fn resolve(self, check: &mut Check) -> Option<BisectSpec> {
        let table = "sweep.bisect";
        check_key(&self.key, &format!("{table}.key"), check);
        check_rising(table, self.from, self.to, check);
        let (metric, unit) = self.metric.with_unit(&self.unit, table, check)?;
        Some(BisectSpec {
            name: self.name.unwrap_or_else(|| "threshold".into()),
            key_unit: key_unit(&self.key),
            key: self.key,
            from: self.from,
            to: self.to,
            tolerance: self.tolerance.unwrap_or(DEFAULT_TOLERANCE),
            metric,
            limit: self.limit * unit.si_factor,
            unit,
        })
    }
}

impl ColumnTable {
    fn resolve(self, index: usize, check: &mut Check) -> Option<SweepColumn> {
        let table = format!("sweep.column.{index}");
        let (metric, unit) = self.metric.with_unit(&self.unit, &table, check)?;
        Some(SweepColumn {
            name: self.name,
            metric,
            unit,
        })
    }
}

/// A claim has bounds, on columns of the sweep.
fn check_claim(claim: &SweepClaim, index: usize, known: &[String], check: &mut Check) {
    let table = format!("sweep.claim.{index}");
    check_bounds(&table, claim.min, claim.max, check);
    let named = [
        ("column", Some(&claim.column)),
        ("over", claim.over.as_ref()),
    ];
    for (key, name) in named {
        if let Some(name) = name.filter(|name| !known.contains(name)) {
            let near = nearest(name, known.iter().map(String::as_str));
            let near = near.map(|near| format!("; did you mean \"{near}\"?"));
            let message = format!(
                "is \"{name}\", but no column of the sweep has that name{}",
                near.unwrap_or_default()
            );
            check.wrong(&table, key, message, "no such column");
        }
    }
}
