//! Which column of a table has its times, and in what unit.

use super::clocks::{HEADER_STAMP, LOG_TIME};
use super::resample::median_interval_s;
use super::time_unit::{named_unit, unit_of_times};
use super::{Column, Table, TimeBase};
use crate::unit::{Unit, UserUnit, short_number};

/// Names of columns of times, without what stands behind them.
const TIME_NAMES: [&str; 10] = [
    "t",
    "time",
    "timestamp",
    "stamp",
    "zeit",
    "zeitstempel",
    "datetime",
    "date",
    "epoch",
    "ipoc",
];

/// Part by which a rate that is given may miss that of the file's own times: clocks of drives
/// differ by less, and rates are rounded.
const RATE_TOLERANCE: f64 = 0.02;

/// A column, its unit, and why that is a guess.
type Times = (String, UserUnit, Option<&'static str>);

/// The column of the times and their unit: by its name, else the first that rises evenly.
pub(super) fn time_column(table: &Table) -> Option<Times> {
    let has = |name: &str| table.columns.iter().any(|one| one.name == name);
    for clock in [HEADER_STAMP, LOG_TIME] {
        if has(clock) {
            return Some((clock.to_owned(), Unit::Second.into(), None));
        }
    }
    let even = || {
        let mut columns = table.columns.iter();
        columns.find(|one| rises_evenly(one) && !is_of_another_kind(table, &one.name))
    };
    named_times(table).or_else(|| {
        let column = even()?;
        let (unit, guessed) = time_unit(table, &column.name, &column.values);
        Some((column.name.clone(), unit, guessed))
    })
}

/// The column that is called so, with its unit.
fn named_times(table: &Table) -> Option<Times> {
    // Rows that share a stamp are told of; they make the column no other one.
    let mut columns = table.columns.iter();
    let column =
        columns.find(|one| is_called_time(&one.name) && rises(&one.values, 0.01, |a, b| a <= b))?;
    let (unit, guessed) = time_unit(table, &column.name, &column.values);
    Some((column.name.clone(), unit, guessed))
}

/// That a column is called like times, and why it was not taken for them.
pub(super) fn not_taken_for_times(table: &Table) -> Option<String> {
    let is_known = |name: &str| [HEADER_STAMP, LOG_TIME].contains(&name) || is_called_time(name);
    if time_column(table).is_some_and(|(name, ..)| is_known(&name)) {
        return None;
    }
    let column = table.columns.iter().find(|one| is_called_time(&one.name))?;
    let values = &column.values;
    let row = (1..values.len()).find(|row| !is_later(values[row - 1], values[*row]))?;
    Some(format!(
        "\"{}\" is called as times are, but does not rise: {} comes after {} at {}",
        column.name,
        values[row],
        values[row - 1],
        table.place(row)
    ))
}

fn rises_evenly(column: &Column) -> bool {
    rises(&column.values, 0.0, is_later) && is_even(&column.values)
}

/// Whether a column is no time by its unit, or by its name: lines of a spectrum rise evenly, too.
fn is_of_another_kind(table: &Table, name: &str) -> bool {
    let unit = table
        .units
        .get(name)
        .and_then(|text| UserUnit::parse(text).ok());
    let is_other = unit.is_some_and(|unit| ![Unit::Second, Unit::One].contains(&unit.unit));
    is_other || is_called_frequency(name)
}

/// `f_hz`, `Freq`, `Frequency [Hz]`, `frequenz (Hz)`, `f`.
fn is_called_frequency(name: &str) -> bool {
    let lower = name.to_lowercase();
    let bare = bare_name(name);
    let ends = ["hz", "[hz]", "(hz)"];
    bare == "f"
        || bare.starts_with("freq")
        || bare.starts_with("fréq")
        || bare.starts_with("frec")
        || ends.iter().any(|end| lower.ends_with(end))
}

/// That a table without times is over frequencies, and what reads it.
pub(super) fn over_frequencies(table: &Table) -> Option<String> {
    if time_column(table).is_some() {
        return None;
    }
    let mut columns = table.columns.iter();
    let column = columns.find(|one| is_called_frequency(&one.name) && rises_evenly(one))?;
    Some(format!(
        "\"{}\" is called as frequencies are, and no other column rises as times do: a frequency response is read by \
         truecut identify, [[modes.frf]]",
        column.name
    ))
}

fn is_called_time(name: &str) -> bool {
    TIME_NAMES.contains(&bare_name(name).as_str())
}

/// A column's name without its unit and what it is part of: `Time [ms]`, `drive.t_s` and `time (s)`
/// are `time`, `t` and `time`.
fn bare_name(name: &str) -> String {
    let lower = name.to_lowercase();
    let bare = lower.split(['[', '(']).next().unwrap_or_default().trim();
    let bare = bare.rsplit('.').next().unwrap_or(bare);
    let without = ["_s", "_ms", "_us", "_ns"].iter();
    let bare = without.fold(bare, |bare, end| bare.strip_suffix(end).unwrap_or(bare));
    bare.to_owned()
}

/// The unit of times, and why it is a guess where the file does not say it.
fn time_unit(table: &Table, name: &str, values: &[f64]) -> (UserUnit, Option<&'static str>) {
    let written = table
        .units
        .get(name)
        .and_then(|text| UserUnit::parse(text).ok());
    if let Some(unit) = written.filter(|unit| unit.unit == Unit::Second) {
        return (unit, None);
    }
    let by_name = named_unit(name);
    let largest = values.iter().copied().fold(0.0, f64::max);
    // Counted from 1970; nobody measures for 3000 years.
    let (by_size, why) = match largest {
        large if large > 1e17 => ("ns", "by its size, as counted from 1970"),
        large if large > 1e14 => ("us", "by its size, as counted from 1970"),
        large if large > 1e11 => ("ms", "by its size, as counted from 1970"),
        _ if counts_slowly(values) => ("ms", "whole numbers that are farther apart than 1"),
        _ if median_step_s(values).is_some_and(|step_s| step_s > SLOW_S) => ("s", IS_SLOW),
        _ => ("s", "for want of another"),
    };
    let unit = UserUnit::parse(by_name.unwrap_or(by_size)).unwrap_or_else(|_| Unit::Second.into());
    (unit, by_name.is_none().then_some(why))
}

/// Rows that are this far apart are rare of a machine that is measured: perhaps they are not.
const SLOW_S: f64 = 0.1;
const IS_SLOW: &str =
    "for want of another: if they are milliseconds, rows come a thousand times as often";

/// Whether times are whole numbers that in seconds would be less than one row a second: a logger
/// that slow is rare, and one that counts milliseconds is not.
fn counts_slowly(values: &[f64]) -> bool {
    let whole = values.iter().all(|value| value.fract() == 0.0);
    whole && median_step_s(values).is_some_and(|step| step > 1.0)
}

/// Whether values rise from row to row, as `rise` says of two, but for a share of the rows.
fn rises(values: &[f64], but_for: f64, rise: impl Fn(f64, f64) -> bool) -> bool {
    let falls = values
        .windows(2)
        .filter(|pair| !rise(pair[0], pair[1]))
        .count();
    values.len() > 1 && falls as f64 <= but_for * values.len() as f64
}

/// Whether the second is the later; what is no number is not.
pub(super) fn is_later(first: f64, second: f64) -> bool {
    first < second
}

/// Whether most steps are about the median one.
fn is_even(values: &[f64]) -> bool {
    let median = median_interval_s(values);
    let near = |pair: &&[f64]| ((pair[1] - pair[0]) / median - 1.0).abs() < 0.5;
    let near = values.windows(2).filter(near).count();
    near as f64 > 0.9 * (values.len() - 1) as f64
}

/// Median time from a row to a later one: rows may have stamps in common. `None` where none rises.
pub(super) fn median_step_s(time_s: &[f64]) -> Option<f64> {
    let steps = time_s.windows(2).map(|pair| pair[1] - pair[0]);
    let mut steps: Vec<f64> = steps
        .filter(|step| *step > 0.0 && step.is_finite())
        .collect();
    let middle = steps.len() / 2;
    (middle < steps.len()).then(|| *steps.select_nth_unstable_by(middle, f64::total_cmp).1)
}

/// What is to be known of the times of a table: a unit that the file alone says, or a rate that it
/// speaks against.
pub fn time_note(table: &Table, time: &TimeBase, is_unit_said: bool) -> Option<String> {
    match time {
        TimeBase::Rate { hz } => rate_note(table, *hz),
        TimeBase::Column { column, unit } => {
            let found = unit_of_times(table, column, unit, is_unit_said).ok()?;
            (found.si_factor != unit.si_factor).then(|| {
                format!(
                    "times are in {}, as the file says of `{column}`",
                    found.symbol
                )
            })
        }
    }
}

/// That rows are taken at a rate which a column of times speaks against.
fn rate_note(table: &Table, hz: f64) -> Option<String> {
    let (name, unit, guessed) = named_times(table)?;
    let step_s = median_step_s(table.column(&name).ok()?)? * unit.si_factor;
    let own_hz = 1.0 / step_s;
    if guessed.is_some() || (own_hz / hz - 1.0).abs() < RATE_TOLERANCE {
        return None;
    }
    Some(format!(
        "rows are taken at rate_hz = {} Hz, but the file has times in the column `{name}`, and by these the rate is {} \
         Hz: speeds and frequencies are {} times too large if those are right; take them with time = \"{name}\"",
        short_number(hz),
        short_number(own_hz),
        short_number(hz / own_hz)
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Lines of a spectrum are no milliseconds; nor is what the file gives another unit.
    #[test]
    fn frequencies_are_no_times() {
        let over = |name: &str, unit: Option<&str>| {
            let column = |name: &str, values| Column {
                name: name.into(),
                values,
            };
            let lines: Vec<f64> = (0..300).map(|k| 200.0 + 2.0 * f64::from(k)).collect();
            let real = lines.iter().map(|f| (0.1 * f).sin()).collect();
            let table = Table {
                source: "frf.csv".into(),
                columns: vec![column(name, lines), column("xx_re", real)],
                units: unit
                    .map(|unit| (name.to_owned(), unit.to_owned()))
                    .into_iter()
                    .collect(),
                ..Table::default()
            };
            (
                time_column(&table).is_some(),
                over_frequencies(&table).is_some(),
            )
        };
        for name in [
            "f_hz",
            "Freq",
            "Frequency [Hz]",
            "frequenz",
            "f",
            "line(Hz)",
        ] {
            assert_eq!(over(name, None), (false, true), "{name}");
        }
        assert_eq!(over("x", Some("mm")), (false, false));
        assert_eq!(over("lines", Some("Hz")), (false, false));
        for name in ["sample", "n", "t_ms", "force"] {
            assert_eq!(over(name, None), (true, false), "{name}");
        }
    }

    /// A rate that is twice that of the times beside it is told; the same, and one that is rounded,
    /// is not; nor is one that only a guess speaks against.
    #[test]
    fn a_rate_that_times_speak_against_is_told() {
        let told = |name: &str, hz: f64| {
            let values = (0..300).map(|k| f64::from(k) * 0.004).collect();
            let table = Table {
                source: "bench.csv".into(),
                columns: vec![Column {
                    name: name.into(),
                    values,
                }],
                ..Table::default()
            };
            time_note(&table, &TimeBase::Rate { hz }, false)
        };
        let note = told("t_s", 500.0).unwrap();
        for words in [
            "rate_hz = 500",
            "`t_s`",
            "the rate is 250",
            "2 times too large",
        ] {
            assert!(note.contains(words), "{note}");
        }
        assert_eq!(told("t_s", 250.0), None);
        assert_eq!(told("t_s", 251.0), None);
        assert_eq!(told("t", 500.0), None);
        assert_eq!(told("force", 500.0), None);
    }
}
