//! A sweep in SI.

use schemars::JsonSchema;
use serde::Deserialize;
use truecut_recording::{MetricSpec, UserUnit};

/// A sweep: rows for all combinations of the axes' values.
#[derive(Debug, Clone, PartialEq)]
pub struct SweepSpec {
    /// Up to two keys and their values; without axes there is one row.
    pub axes: Vec<SweepAxis>,
    /// Search for a threshold in each row.
    pub bisect: Option<BisectSpec>,
    /// What to tabulate for each row.
    pub columns: Vec<SweepColumn>,
    /// What must hold of every row.
    pub claims: Vec<SweepClaim>,
}

impl SweepSpec {
    /// Metrics of the columns and of the search.
    pub fn metrics(&self) -> impl Iterator<Item = &MetricSpec> {
        self.metrics_at().map(|(_, metric, _)| metric)
    }

    /// Metrics of the columns and of the search, with their units and the paths of their tables.
    pub(crate) fn metrics_at(&self) -> impl Iterator<Item = (String, &MetricSpec, &UserUnit)> {
        let columns = self.columns.iter().enumerate();
        let columns =
            columns.map(|(index, one)| (format!("sweep.column.{index}"), &one.metric, &one.unit));
        let bisect = self.bisect.iter();
        columns.chain(bisect.map(|one| ("sweep.bisect".to_owned(), &one.metric, &one.unit)))
    }
}

/// A key and the values that it takes.
#[derive(Debug, Clone, PartialEq)]
pub struct SweepAxis {
    /// Dotted key, as for `--set`.
    pub key: String,
    /// Values, in `unit`.
    pub values: Vec<f64>,
    /// Unit of the key.
    pub unit: UserUnit,
}

/// Search for the smallest value of a key at which a metric is at most a limit.
#[derive(Debug, Clone, PartialEq)]
pub struct BisectSpec {
    /// Name of the column that holds the result.
    pub name: String,
    /// Dotted key, as for `--set`.
    pub key: String,
    /// Unit of the key, and so of `from`, `to` and the result.
    pub key_unit: UserUnit,
    /// Lower end of the search, in the unit of the key.
    pub from: f64,
    /// Upper end of the search, in the unit of the key.
    pub to: f64,
    /// Width of the final interval relative to the value.
    pub tolerance: f64,
    /// The metric.
    pub metric: MetricSpec,
    /// Limit of the metric, SI.
    pub limit: f64,
    /// Unit in which the limit was written.
    pub unit: UserUnit,
}

/// A number to tabulate for each row.
#[derive(Debug, Clone, PartialEq)]
pub struct SweepColumn {
    /// Name of the column.
    pub name: String,
    /// The number.
    pub metric: MetricSpec,
    /// Unit in which it is shown.
    pub unit: UserUnit,
}

/// A bound on a column in every row.
#[derive(Debug, Clone, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SweepClaim {
    /// A short sentence.
    pub name: String,
    /// The bounded column.
    pub column: String,
    /// The column by which it is divided. Default: none.
    pub over: Option<String>,
    /// Lower bound, in the column's unit; of the ratio if `over` is given.
    pub min: Option<f64>,
    /// Upper bound, in the column's unit; of the ratio if `over` is given.
    pub max: Option<f64>,
    /// Why it must hold.
    pub reason: String,
}
