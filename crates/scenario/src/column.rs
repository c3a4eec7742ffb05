//! What tables about columns of measured files share: units, factors and times.

use std::collections::BTreeMap;

use truecut_recording::measured::{Term, TimeBase};
use truecut_recording::{Unit, UserUnit};

use crate::check::Check;
use crate::fault::Fault;

/// Reads the unit written at `table.key`; `None` after recording a fault.
pub(crate) fn read_unit(text: &str, table: &str, key: &str, check: &mut Check) -> Option<UserUnit> {
    match UserUnit::parse(text) {
        Ok(unit) => Some(unit),
        Err(error) => {
            let path = format!("{table}.{key}");
            let message = format!("`{path}`: {error}");
            check.refuse(Fault::value(&path, message, "unknown unit"));
            None
        }
    }
}

/// Reads a unit of one of the dimensions `wanted`; `None` after recording a fault.
pub(crate) fn read_unit_of(
    wanted: &[Unit],
    text: &str,
    table: &str,
    key: &str,
    check: &mut Check,
) -> Option<UserUnit> {
    let unit = read_unit(text, table, key, check)?;
    if wanted.contains(&unit.unit) {
        return Some(unit);
    }
    let accepted: Vec<&str> = (wanted.iter())
        .flat_map(|unit| unit.accepted_symbols())
        .collect();
    let message = format!(
        "is \"{}\", but must be one of {}",
        unit.symbol,
        accepted.join(", ")
    );
    check.wrong(table, key, message, "wrong dimension");
    None
}

/// Refuses a factor of zero on a column, at its key.
pub(crate) fn check_scale(table: &str, key: &str, scale: f64, check: &mut Check) {
    if scale == 0.0 {
        let message = "is 0, but must not be: nothing of the column would be left";
        check.wrong(table, key, message, "must not be 0");
    }
}

/// The columns that a table names: one by `column`, or several with their factors by `sum`; `None`
/// after recording a fault.
pub(crate) fn terms(
    column: Option<String>,
    sum: Option<BTreeMap<String, f64>>,
    table: &str,
    check: &mut Check,
) -> Option<Vec<Term>> {
    match (column, sum) {
        (Some(column), None) => Some(vec![column.as_str().into()]),
        (None, Some(sum)) if sum.is_empty() => {
            let message = "is empty, but must name a column: nothing would be measured";
            check.wrong(table, "sum", message, "no column");
            None
        }
        (None, Some(sum)) => {
            for (column, factor) in &sum {
                check_scale(&format!("{table}.sum"), column, *factor, check);
            }
            let term = |(column, factor)| Term { column, factor };
            Some(sum.into_iter().map(term).collect())
        }
        (Some(_), Some(_)) => {
            let because =
                format!("`{table}.column` names the column; a column of a sum stands in `sum`");
            check.ignored(table, &["sum"], &because);
            None
        }
        (None, None) => {
            let why = ["it reads a column", "neither column nor sum"];
            let help = "name the column, or several with their factors by `sum`";
            missing(table, "column", why, help, check);
            None
        }
    }
}

/// Refuses a table in which neither a key nor what may stand in its place is given.
fn missing(table: &str, key: &str, [need, neither]: [&str; 2], help: &str, check: &mut Check) {
    let message = format!("missing key `{key}` in [{table}]: {need}");
    let fault = Fault::key(&format!("{table}.{key}"), message, neither);
    check.refuse(fault.with_help(help));
}

/// The times of the rows by the keys `time`, `time_unit` and `rate_hz` of a table; `None` after
/// recording a fault.
pub(crate) fn time_base(
    time: Option<&str>,
    time_unit: Option<&str>,
    rate_hz: Option<f64>,
    table: &str,
    check: &mut Check,
) -> Option<TimeBase> {
    match (time, rate_hz) {
        (Some(column), None) => {
            let unit = time_unit.unwrap_or("s");
            let unit = read_unit_of(&[Unit::Second], unit, table, "time_unit", check)?;
            let column = column.to_owned();
            Some(TimeBase::Column { column, unit })
        }
        (None, Some(hz)) => {
            check.ignored(table, &["time_unit"], "there is no column of times");
            Some(TimeBase::Rate { hz })
        }
        (Some(_), Some(_)) => {
            let because = format!("`{table}.time` gives the times");
            check.ignored(table, &["rate_hz"], &because);
            None
        }
        (None, None) => {
            let why = ["the samples need times", "neither time nor rate_hz"];
            let help = "name the column of the times, or give rate_hz";
            missing(table, "time", why, help, check);
            None
        }
    }
}
