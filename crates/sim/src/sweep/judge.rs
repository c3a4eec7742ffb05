//! The claims of a sweep, over all rows.

use truecut_recording::{ClaimResult, Unit, UserUnit, short_number};
use truecut_scenario::{Scenario, SweepClaim};

use super::table::SweepTable;

/// Bounds of a claim, SI.
struct Bounds {
    min: Option<f64>,
    max: Option<f64>,
}

impl Bounds {
    fn of(claim: &SweepClaim, unit: &UserUnit) -> Bounds {
        let si = |bound: Option<f64>| bound.map(|bound| bound * unit.si_factor);
        Bounds {
            min: si(claim.min),
            max: si(claim.max),
        }
    }

    /// How far a value is outside; a value that does not exist is outside of everything.
    fn excess(&self, value: f64) -> f64 {
        let below = self.min.map_or(f64::NEG_INFINITY, |min| min - value);
        let above = self.max.map_or(f64::NEG_INFINITY, |max| value - max);
        if value.is_nan() {
            f64::INFINITY
        } else {
            below.max(above)
        }
    }

    fn show(&self, unit: &UserUnit) -> String {
        match (self.min, self.max) {
            (Some(min), Some(max)) => format!("{} to {}", unit.show(min), unit.show(max)),
            (Some(min), None) => format!("at least {}", unit.show(min)),
            (None, Some(max)) => format!("at most {}", unit.show(max)),
            (None, None) => String::new(),
        }
    }
}

impl SweepTable {
    /// The sweep's claims, judged over all rows; the value shown is that of the worst row.
    pub fn claims(&self, scenario: &Scenario) -> Vec<ClaimResult> {
        let claims = scenario.sweep.iter().flat_map(|sweep| &sweep.claims);
        claims.map(|claim| self.judge(claim)).collect()
    }

    fn judge(&self, claim: &SweepClaim) -> ClaimResult {
        let (unit, values) = self.judged_values(claim);
        let bounds = Bounds::of(claim, &unit);
        if let Some(least) = claim.share {
            let within = values.iter().filter(|value| bounds.excess(**value) <= 0.0);
            let within = within.count();
            return judge_share(claim, least, &bounds.show(&unit), within, values.len());
        }
        let row = (0..values.len()).max_by(|a, b| {
            bounds
                .excess(values[*a])
                .total_cmp(&bounds.excess(values[*b]))
                .then(b.cmp(a))
        });
        let worst = row.map(|row| values[row]).filter(|value| !value.is_nan());
        let row_name = row.map_or_else(|| "no row".to_owned(), |row| self.row_name(row));
        let run = row.and_then(|row| self.faults[row].as_ref());
        let why = run.map_or("the row has no value", |run| run.why.as_str());
        let note = worst.is_none().then(|| why.to_owned());
        let value = worst.map_or_else(|| "no value".to_owned(), |value| unit.show(value));
        ClaimResult {
            name: claim.name.clone(),
            metric: bounded(claim),
            value: worst,
            unit: unit.unit,
            min: bounds.min,
            max: bounds.max,
            holds: worst.is_some_and(|value| bounds.excess(value) <= 0.0),
            reason: claim.reason.clone(),
            shown: format!("worst row {value} at {row_name}, {}", bounds.show(&unit)),
            note,
        }
    }

    /// What a claim bounds, row by row, SI, and the unit in which it is written.
    fn judged_values(&self, claim: &SweepClaim) -> (UserUnit, Vec<f64>) {
        let column = self.index(&claim.column);
        let over = claim.over.as_ref().map(|name| self.index(name));
        let value = |row: &Vec<f64>| -> f64 {
            let si = |index: Option<usize>| {
                index.map_or(f64::NAN, |index| {
                    row[index] * self.columns[index].unit.si_factor
                })
            };
            // What is divided by nothing does not exist.
            let ratio = |over| Some(si(column) / si(over)).filter(|ratio| ratio.is_finite());
            over.map_or(si(column), |over| ratio(over).unwrap_or(f64::NAN))
        };
        let unit = match (column, over) {
            (Some(index), None) => self.columns[index].unit.clone(),
            _ => UserUnit::from(Unit::One),
        };
        (unit, self.rows.iter().map(value).collect())
    }
}

/// What a claim bounds.
fn bounded(claim: &SweepClaim) -> String {
    match &claim.over {
        Some(over) => format!("{} / {over}", claim.column),
        None => claim.column.clone(),
    }
}

/// A claim of which a share of the rows is enough: that share is its value.
fn judge_share(
    claim: &SweepClaim,
    least: f64,
    bounds: &str,
    within: usize,
    count: usize,
) -> ClaimResult {
    let share = (count > 0).then(|| within as f64 / count as f64);
    ClaimResult {
        name: claim.name.clone(),
        metric: format!("share of rows with {} {bounds}", bounded(claim)),
        value: share,
        unit: Unit::One,
        min: Some(least),
        max: None,
        holds: share.is_some_and(|share| share >= least),
        reason: claim.reason.clone(),
        shown: format!(
            "{within} of {count} rows {bounds}, at least {} %",
            short_number(100.0 * least)
        ),
        note: share.is_none().then(|| "there is no row".to_owned()),
    }
}
