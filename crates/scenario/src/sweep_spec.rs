//! A sweep in SI.

use schemars::JsonSchema;
use serde::Deserialize;
use truecut_recording::{MetricSpec, UserUnit};

/// A sweep: rows for all combinations of the axes' values, or rows that are drawn.
#[derive(Debug, Clone, PartialEq)]
pub struct SweepSpec {
    /// Keys and their values; without axes there is one row.
    pub axes: Vec<SweepAxis>,
    /// Whether rows are drawn: the first takes the first value of every axis, and so on. Else they
    /// are all combinations.
    pub is_sampled: bool,
    /// Search for a threshold in each row.
    pub bisect: Option<BisectSpec>,
    /// What to tabulate for each row.
    pub columns: Vec<SweepColumn>,
    /// What must hold of every row.
    pub claims: Vec<SweepClaim>,
}

impl SweepSpec {
    /// How many rows there are.
    pub fn count(&self) -> usize {
        let mut counts = self.axes.iter().map(|axis| axis.values.len());
        match self.is_sampled {
            true => counts.next().unwrap_or(0),
            false => counts.product(),
        }
    }

    /// The value of each axis in a row below [`SweepSpec::count`]; of combinations the last axis
    /// runs fastest.
    pub fn values(&self, row: usize) -> Vec<f64> {
        let mut rest = row;
        let mut value = |axis: &SweepAxis| {
            let count = axis.values.len();
            let place = if self.is_sampled { row } else { rest % count };
            rest /= count;
            axis.values[place]
        };
        let mut values: Vec<f64> = self.axes.iter().rev().map(&mut value).collect();
        values.reverse();
        values
    }

    /// Metrics of the columns and of the search.
    pub fn metrics(&self) -> impl Iterator<Item = &MetricSpec> {
        self.metrics_at().map(|(_, metric, _)| metric)
    }

    /// Metrics of the columns and of the search, with their units and the paths of their tables.
    pub fn metrics_at(&self) -> impl Iterator<Item = (String, &MetricSpec, &UserUnit)> {
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

/// A bound on a column in every row, or in a share of them.
#[derive(Debug, Clone, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SweepClaim {
    /// A short sentence.
    pub name: String,
    /// The bounded column.
    pub column: String,
    /// The column by which it is divided. Default: none.
    pub over: Option<String>,
    /// Least share of the rows that must be within the bounds. Default: every row must.
    #[schemars(extend(
        "exclusiveMinimum" = 0.0,
        "maximum" = 1.0,
        "x-rule" = "it is a share of the rows"
    ))]
    pub share: Option<f64>,
    /// Lower bound, in the column's unit; of the ratio if `over` is given.
    pub min: Option<f64>,
    /// Upper bound, in the column's unit; of the ratio if `over` is given.
    pub max: Option<f64>,
    /// Why it must hold.
    pub reason: String,
}
