//! What must hold of the keys, the names and the size of a sweep.

use crate::check::Check;
use crate::fault::{Fault, split_path};
use crate::schema::is_number;
use crate::structure::leaf_schema;
use crate::sweep_spec::{BisectSpec, SweepAxis, SweepColumn};

/// Whether `key` is a number of the scenario that can be changed from outside; else a fault at
/// `at`.
pub(crate) fn check_key(key: &str, at: &str, check: &mut Check) -> bool {
    let path = split_path(key);
    let own = |part: &String| matches!(part.as_str(), "robot" | "run" | "process" | "effect");
    if !path.first().is_some_and(own) {
        let message =
            format!("`{at}` is \"{key}\", but must be a key below robot, run, process or effect");
        check.refuse(Fault::value(at, message, "cannot be changed"));
        return false;
    }
    match leaf_schema(check.document().schema(), &path) {
        Err(fault) => {
            let message = format!("`{at}` is \"{key}\": {}", fault.message);
            check.refuse(Fault {
                help: fault.help,
                ..Fault::value(at, message, fault.label)
            });
            false
        }
        Ok(leaf) if !is_number(leaf) => {
            let message = format!("`{at}` is \"{key}\", which is not a number");
            check.refuse(Fault::value(at, message, "not a number"));
            false
        }
        Ok(_) => true,
    }
}

pub(crate) fn check_keys_differ(
    axes: &[SweepAxis],
    bisect: Option<&BisectSpec>,
    check: &mut Check,
) {
    let bisect = bisect.map(|bisect| ("sweep.bisect.key".to_owned(), &bisect.key));
    let axes = axes.iter().enumerate();
    let keys: Vec<(String, &String)> = axes
        .map(|(index, axis)| (format!("sweep.axis.{index}.key"), &axis.key))
        .chain(bisect)
        .collect();
    for (index, (at, key)) in keys.iter().enumerate() {
        if keys[..index].iter().any(|(_, earlier)| earlier == key) {
            let message = format!("`{at}` is \"{key}\", which is swept already");
            check.refuse(Fault::value(at, message, "swept twice"));
        }
    }
}

/// Most rows of a sweep.
pub(crate) const MOST_ROWS: usize = 100_000;

/// Most axes of which all combinations are taken: a figure shows two.
const MOST_COMBINED: usize = 2;

pub(crate) fn check_count(axes: &[SweepAxis], check: &mut Check) {
    if axes.len() > MOST_COMBINED {
        let message = format!(
            "{} axes are combined, but a sweep combines at most {MOST_COMBINED}",
            axes.len()
        );
        let fault = Fault::key("sweep.axis.2", message, "one axis too many");
        check.refuse(fault.with_help("[sweep.sample] draws rows over any number of axes"));
    }
    let counts = axes.iter().map(|axis| axis.values.len());
    let rows = counts.fold(1, usize::saturating_mul);
    if rows > MOST_ROWS {
        let message = format!(
            "the axes give {rows} combinations, but a sweep has at most {MOST_ROWS}: each is a run"
        );
        check.refuse(Fault::key("sweep.axis.0", message, "too many runs"));
    }
}

/// Name of the column that every sweep's table has beside its own.
const OUTCOME: &str = "outcome";

/// Claims and readers of the table find a column by its name.
pub(crate) fn check_names_differ(
    axes: &[SweepAxis],
    bisect: Option<&BisectSpec>,
    columns: &[SweepColumn],
    check: &mut Check,
) {
    let mut known: Vec<&str> = axes.iter().map(|axis| axis.key.as_str()).collect();
    known.push(OUTCOME);
    let bisect = bisect.map(|bisect| ("sweep.bisect.name".to_owned(), bisect.name.as_str()));
    let columns = columns.iter().enumerate();
    let columns =
        columns.map(|(index, column)| (format!("sweep.column.{index}.name"), column.name.as_str()));
    for (at, name) in bisect.into_iter().chain(columns) {
        if known.contains(&name) {
            let message = format!("`{at}` is \"{name}\", but the table has such a column already");
            check.refuse(Fault::value(&at, message, "named twice"));
        }
        known.push(name);
    }
}

pub(crate) fn check_rising(table: &str, from: f64, to: f64, check: &mut Check) {
    if from >= to {
        let message = format!("is {to}, but must be greater than from = {from}");
        check.wrong(table, "to", message, "not above from");
    }
}
