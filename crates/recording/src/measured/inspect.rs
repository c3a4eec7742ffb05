//! What is in a table, before anything is done to it: rate, gaps and jitter of its times; range,
//! missing values and what stands still in its columns.

use super::clocks::{HEADER_STAMP, LOG_TIME, delay_s, delays_s};
use super::resample::JITTER;
use super::times::{is_later, median_step_s, not_taken_for_times, over_frequencies, time_column};
use super::{Table, TimeBase};
use crate::unit::UserUnit;

/// Shortest run of one value that is told as standing still, rows.
const STILL_ROWS: usize = 10;
/// Shortest run at a column's largest or smallest value that counts as the end of a range, rows.
const END_ROWS: usize = 3;
/// What is in a table.
#[derive(Clone, Debug, PartialEq)]
pub struct TableFacts {
    /// The file, or the topic of a log.
    pub source: String,
    /// How many rows it has.
    pub rows: usize,
    /// Its times; `None` where no column has any.
    pub time: Option<TimeFacts>,
    /// The columns, without that of the times.
    pub columns: Vec<ColumnFacts>,
    /// What the reader found or did.
    pub notes: Vec<String>,
}

/// What the times of a table are like.
#[derive(Clone, Debug, PartialEq)]
pub struct TimeFacts {
    /// The column, and the unit that its values seem to have.
    pub base: (String, UserUnit),
    /// Why the unit is a guess; `None` where the file says it.
    pub guessed: Option<&'static str>,
    /// First and last time, s.
    pub span_s: [f64; 2],
    /// One over the median interval, 1/s.
    pub rate_hz: f64,
    /// Standard deviation of the intervals that are no gaps, s.
    pub jitter_s: f64,
    /// Intervals longer than 1.8 of the median, longest first.
    pub gaps: Vec<Gap>,
    /// Rows that the gaps seem to have lost.
    pub lost_rows: usize,
    /// Rows whose time is not after the one before, or no number, and the first of them.
    pub not_rising: Option<(usize, String)>,
    /// Median and largest time from a message's stamp until it was written down, s; of logs.
    pub delay_s: Option<[f64; 2]>,
}

/// A gap between two rows.
#[derive(Clone, Debug, PartialEq)]
pub struct Gap {
    /// Time before it, s.
    pub from_s: f64,
    /// Its length, s.
    pub length_s: f64,
}

/// What the values of a column are like.
#[derive(Clone, Debug, PartialEq)]
pub struct ColumnFacts {
    /// Its name.
    pub name: String,
    /// Its unit, where the file gives it.
    pub unit: Option<String>,
    /// Cells without a number.
    pub missing: usize,
    /// Smallest and largest value; `None` without a number.
    pub range: Option<[f64; 2]>,
    /// Longest run of one value, if it is one: first row, counted from 1, rows and value.
    pub still: Option<(usize, usize, f64)>,
    /// Rows at the smallest and at the largest value, in runs of three and more.
    pub at_ends: [usize; 2],
}

impl ColumnFacts {
    /// Whether every value is the same.
    pub fn is_constant(&self) -> bool {
        self.range.is_some_and(|[low, high]| low == high)
    }
}

/// What is in a table.
pub fn facts(table: &Table) -> TableFacts {
    let time = time_column(table);
    let clocks = [LOG_TIME, HEADER_STAMP];
    let is_clock = |name: &str| {
        time.as_ref().is_some_and(|(found, ..)| found == name) || clocks.contains(&name)
    };
    let is_left_aside = |name: &str| table.unusable.contains_key(name);
    let columns =
        (table.columns.iter()).filter(|one| !is_clock(&one.name) && !is_left_aside(&one.name));
    TableFacts {
        source: table.source.clone(),
        rows: table.rows(),
        columns: columns
            .map(|one| column_facts(&one.name, &one.values, table.units.get(&one.name)))
            .collect(),
        time: time.and_then(|(name, unit, guessed)| {
            let found = time_facts(table, name, unit)?;
            Some(TimeFacts { guessed, ..found })
        }),
        notes: (table.notes.iter().cloned())
            .chain(not_taken_for_times(table))
            .chain(over_frequencies(table))
            .collect(),
    }
}

impl TimeFacts {
    /// As a mapping takes it.
    pub fn time_base(&self) -> TimeBase {
        let (column, unit) = self.base.clone();
        TimeBase::Column { column, unit }
    }
}

fn time_facts(table: &Table, name: String, unit: UserUnit) -> Option<TimeFacts> {
    let column = table.column(&name).ok()?;
    let time_s: Vec<f64> = column.iter().map(|value| value * unit.si_factor).collect();
    let falls = |row: &usize| !is_later(time_s[row - 1], time_s[*row]);
    let mut falling = (1..time_s.len()).filter(falls);
    let first = falling.next();
    let not_rising = first.map(|row| (1 + falling.count(), table.place(row)));
    let (first_s, last_s) = (*time_s.first()?, *time_s.last()?);
    if time_s.len() < 2 {
        return None;
    }
    let median_s = median_step_s(&time_s)?;
    let (mut gaps, mut steady, mut lost_rows) = (Vec::new(), Vec::new(), 0);
    for pair in time_s.windows(2) {
        let length_s = pair[1] - pair[0];
        if length_s > JITTER * median_s {
            let from_s = pair[0];
            gaps.push(Gap { from_s, length_s });
            let steps = (length_s / median_s).round() as usize;
            lost_rows = steps.saturating_sub(1).saturating_add(lost_rows);
        } else if length_s.is_finite() {
            steady.push(length_s);
        }
    }
    gaps.sort_by(|a, b| b.length_s.total_cmp(&a.length_s));
    let delays = delays_s(table);
    let largest = delays.map(|delays| delays.into_iter().fold(f64::NEG_INFINITY, f64::max));
    Some(TimeFacts {
        base: (name, unit),
        guessed: None,
        span_s: [first_s, last_s],
        rate_hz: 1.0 / median_s,
        jitter_s: deviation(&steady),
        gaps,
        lost_rows,
        not_rising,
        delay_s: delay_s(table)
            .zip(largest)
            .map(|(median, largest)| [median, largest]),
    })
}

fn deviation(values: &[f64]) -> f64 {
    if values.is_empty() {
        return 0.0;
    }
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    let squares = values.iter().map(|value| (value - mean).powi(2));
    (squares.sum::<f64>() / values.len() as f64).sqrt()
}

/// What a column holds.
pub fn column_facts(name: &str, values: &[f64], unit: Option<&String>) -> ColumnFacts {
    let finite = values.iter().copied().filter(|value| value.is_finite());
    let (mut low, mut high, mut numbers) = (f64::INFINITY, f64::NEG_INFINITY, 0);
    for value in finite {
        (low, high, numbers) = (low.min(value), high.max(value), numbers + 1);
    }
    let varies = low < high;
    let (mut still, mut at_ends): (Option<(usize, usize, f64)>, _) = (None, [0, 0]);
    for (first, rows, value) in runs(values) {
        let is_end = value == low || value == high;
        if varies && is_end && rows >= END_ROWS {
            at_ends[usize::from(value == high)] += rows;
        }
        let longest = still.is_none_or(|(_, longest, _)| rows > longest);
        if varies && rows >= STILL_ROWS && longest {
            still = Some((first + 1, rows, value));
        }
    }
    ColumnFacts {
        name: name.to_owned(),
        unit: unit.cloned(),
        missing: values.len() - numbers,
        range: (numbers > 0).then_some([low, high]),
        still,
        at_ends,
    }
}

/// Runs of one value: first row, rows and value.
fn runs(values: &[f64]) -> Vec<(usize, usize, f64)> {
    let mut runs: Vec<(usize, usize, f64)> = Vec::new();
    for (row, value) in values.iter().enumerate() {
        match runs.last_mut() {
            Some((first, rows, before)) if before == value && *first + *rows == row => *rows += 1,
            _ if value.is_finite() => runs.push((row, 1, *value)),
            _ => {}
        }
    }
    runs
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measured::Column;

    fn table(columns: Vec<(&str, Vec<f64>)>) -> Table {
        let column = |(name, values): (&str, Vec<f64>)| Column {
            name: name.into(),
            values,
        };
        Table {
            source: "bench.csv".into(),
            columns: columns.into_iter().map(column).collect(),
            ..Table::default()
        }
    }

    /// Times in ms with a gap of seven rows, a sine that a sensor clips at 0.9, stands still for
    /// twenty rows, and lacks three numbers.
    #[test]
    fn what_was_put_in_is_found() {
        let rows = 0..1000_u32;
        let place = |k: u32| if k < 400 { k } else { k + 7 };
        let time: Vec<f64> = rows.clone().map(|k| 2.0 * f64::from(place(k))).collect();
        let mut force: Vec<f64> = (time.iter())
            .map(|t| (t * 1e-3 * 3.0).sin().min(0.9))
            .collect();
        for value in &mut force[600..620] {
            *value = 0.25;
        }
        for row in [3, 90, 700] {
            force[row] = f64::NAN;
        }
        let clipped = force.iter().filter(|value| **value == 0.9).count();
        let found = facts(&table(vec![("time_ms", time), ("force_n", force)]));
        let time = found.time.unwrap();
        assert_eq!(time.base.1.symbol, "ms");
        assert!((time.rate_hz - 500.0).abs() < 1e-9 && time.jitter_s < 1e-12);
        assert_eq!((time.gaps.len(), time.lost_rows), (1, 7));
        assert!((time.gaps[0].length_s - 0.016).abs() < 1e-12);
        assert_eq!(time.not_rising, None);
        let [force] = &found.columns[..] else {
            panic!("one column")
        };
        assert_eq!(force.missing, 3);
        assert!(clipped > 100, "{clipped}");
        assert_eq!(force.at_ends, [0, clipped]);
        let (_, rows, value) = force.still.unwrap();
        assert!(rows > 20 && value == 0.9);
    }

    /// Stamps in common, and one that nobody set among real ones: what rises is told, what does not
    /// is counted.
    #[test]
    fn stamps_in_common_are_no_gaps_without_end() {
        let pairs: Vec<f64> = (0..100).map(|k| f64::from(k / 3) * 0.01).collect();
        let time = facts(&table(vec![("time_s", pairs), ("x", vec![0.0; 100])])).time;
        let time = time.unwrap();
        assert!((time.rate_hz - 100.0).abs() < 1e-6 && time.gaps.is_empty());
        assert_eq!(time.not_rising.unwrap().0, 66);
        let mut unset = vec![0.0; 60];
        unset.extend((0..40).map(|k| 1.7e9 + f64::from(k) * 0.01));
        let time = facts(&table(vec![("time_s", unset), ("x", vec![0.0; 100])])).time;
        assert!((time.unwrap().rate_hz - 100.0).abs() < 1e-3);
    }

    #[test]
    fn times_are_found_by_name_or_because_they_rise_evenly() {
        let even: Vec<f64> = (0..50).map(|k| f64::from(k) * 0.01).collect();
        let uneven: Vec<f64> = even.iter().map(|t| t * t).collect();
        let found = |name: &str, values: &[f64]| {
            let facts = facts(&table(vec![
                ("x", uneven.clone()),
                (name, values.to_owned()),
            ]));
            facts.time.map(|time| time.base.0)
        };
        assert_eq!(found("Time [s]", &even).as_deref(), Some("Time [s]"));
        assert_eq!(found("axis", &even).as_deref(), Some("axis"));
        assert_eq!(found("axis", &uneven), None);
        let stamps: Vec<f64> = even.iter().map(|t| 1.7e18 + t * 1e9).collect();
        let unit = facts(&table(vec![("stamp", stamps)])).time.unwrap().base.1;
        assert_eq!(unit.symbol, "ns");
    }

    /// What the file does not say of its times is a guess: whole numbers with steps of 4 are ms,
    /// and a column called `t` with rows in common goes before one that rises from row to row.
    #[test]
    fn units_of_times_that_the_file_does_not_say_are_guesses() {
        let time = |name: &str, values: Vec<f64>| {
            let even = (0..values.len()).map(|k| 1.0 + k as f64 * 1e-3).collect();
            let found = facts(&table(vec![(name, values), ("q", even)]))
                .time
                .unwrap();
            (found.base.0, found.base.1.symbol, found.guessed.is_some())
        };
        let steps = |by: f64| (0..500).map(|k| f64::from(k) * by).collect::<Vec<f64>>();
        let told = |name: &str, unit: &str, guessed| (name.to_owned(), unit.to_owned(), guessed);
        assert_eq!(time("t", steps(4.0)), told("t", "ms", true));
        assert_eq!(time("t_s", steps(4.0)), told("t_s", "s", false));
        assert_eq!(time("t", steps(0.004)), told("t", "s", true));
        let cut = steps(0.01).iter().map(|t| (t * 100.0).trunc()).collect();
        assert_eq!(time("t", cut), told("t", "s", true));
    }

    #[test]
    fn a_column_that_is_called_time_and_does_not_rise_is_told() {
        let rising: Vec<f64> = (0..50).map(f64::from).collect();
        let falling: Vec<f64> = rising.iter().map(|t| 50.0 - t).collect();
        let notes =
            |t: &Vec<f64>| facts(&table(vec![("t_s", t.clone()), ("q", rising.clone())])).notes;
        assert!(notes(&rising).is_empty());
        let [told] = &notes(&falling)[..] else {
            panic!("one note");
        };
        let expected =
            "\"t_s\" is called as times are, but does not rise: 49 comes after 50 at row 2";
        assert!(told.starts_with(expected), "{told}");
    }
}
