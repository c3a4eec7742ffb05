//! `truecut data`: what is in a file of measured data.

use serde::Serialize;
use truecut::inspect::{Inspected, InspectedTable, inspect};
use truecut_recording::measured::{ColumnFacts, TimeFacts};
use truecut_recording::{short_number, significant};
use truecut_scenario::harmless_text;

use crate::args::DataArguments;
use crate::exit_status::ExitStatus;
use crate::failure::Failure;
use crate::text::{self, Align, headed, table};

/// Gaps that are listed.
const LISTED: usize = 3;

/// Prints the report.
pub fn data(arguments: &DataArguments) -> Result<ExitStatus, Failure> {
    let found = inspect(&arguments.file, !arguments.no_header)?;
    if arguments.json {
        return crate::print(&text::json(&Told::of(&found))?);
    }
    if arguments.toml {
        return crate::print(&found.suggested);
    }
    crate::print(&printed(&found))
}

fn printed(found: &Inspected) -> String {
    let mut text = String::new();
    for one in &found.tables {
        text.push_str(&harmless_text(&of_table(one)));
        text.push('\n');
    }
    for (topic, why) in &found.unread {
        text.push_str(&harmless_text(&format!("{topic}: not read: {why}\n\n")));
    }
    // It has no control characters: they are escaped in it.
    text.push_str("For a scenario:\n\n");
    text.push_str(&found.suggested);
    text
}

fn of_table(one: &InspectedTable) -> String {
    let facts = &one.facts;
    let mut text = format!("{}: {} rows\n", facts.source, facts.rows);
    for note in &facts.notes {
        text.push_str(&format!("  {note}\n"));
    }
    match &facts.time {
        Some(time) => text.push_str(&of_time(time)),
        None => text.push_str("  no column of times: give `rate_hz`\n"),
    }
    let head = ["column", "unit", "smallest", "largest", "to note"];
    let columns = facts.columns.iter().zip(&one.spikes);
    let rows = headed(
        &head,
        columns.map(|(column, spikes)| of_column(column, *spikes)),
    );
    let aligned = [
        Align::Left,
        Align::Left,
        Align::Right,
        Align::Right,
        Align::Left,
    ];
    text.push_str(&table(&aligned, &rows));
    text
}

fn of_time(time: &TimeFacts) -> String {
    let [first, last] = time.span_s;
    let (name, unit) = &time.base;
    let guessed = time
        .guessed
        .map_or_else(String::new, |why| format!(" (a guess, {why})"));
    let mut text = format!(
        "  times: {name} [{}]{guessed}, {} s from {} s on; {} Hz in the median, jitter {} s\n",
        unit.symbol,
        significant(last - first, 5),
        short(first),
        significant(time.rate_hz, 6),
        significant(time.jitter_s, 2)
    );
    if let Some((rows, place)) = &time.not_rising {
        text.push_str(&format!(
            "  {rows} times do not rise; the first is at {place}\n"
        ));
    }
    if let Some(longest) = time.gaps.first() {
        let listed: Vec<String> = (time.gaps.iter().take(LISTED))
            .map(|gap| {
                format!(
                    "{} s after {} s",
                    significant(gap.length_s, 3),
                    short(gap.from_s)
                )
            })
            .collect();
        text.push_str(&format!(
            "  {} gaps, some {} rows lost, the longest {} s: {}\n",
            time.gaps.len(),
            time.lost_rows,
            significant(longest.length_s, 3),
            listed.join(", ")
        ));
    }
    text
}

/// A number without an exponent where it is a time since 1970.
fn short(value: f64) -> String {
    match value.abs() >= 1e6 {
        true => format!("{value:.6}"),
        false => short_number(value),
    }
}

fn of_column(column: &ColumnFacts, spikes: usize) -> Vec<String> {
    let [low, high] = match column.range {
        Some(range) => range.map(|value| significant(value, 5)),
        None => ["none".to_owned(), "none".to_owned()],
    };
    let mut told: Vec<String> = Vec::new();
    if column.missing > 0 {
        told.push(format!("{} missing", column.missing));
    }
    if column.is_constant() {
        told.push("never changes".to_owned());
    }
    let [at_low, at_high] = column.at_ends;
    if at_low > 0 {
        told.push(format!("{at_low} rows stay at the smallest: saturated?"));
    }
    if at_high > 0 {
        told.push(format!("{at_high} rows stay at the largest: saturated?"));
    }
    if let Some((first, rows, value)) = column.still {
        told.push(format!(
            "stuck at {} for {rows} rows from row {first} on",
            short_number(value)
        ));
    }
    if spikes > 0 {
        told.push(format!("{spikes} spikes"));
    }
    let unit = column.unit.clone().unwrap_or_default();
    vec![column.name.clone(), unit, low, high, told.join("; ")]
}

/// The report as JSON; times in s, values as in the file.
#[derive(Serialize)]
struct Told<'a> {
    tables: Vec<TableTold<'a>>,
    unread: Vec<UnreadTold<'a>>,
    suggested: &'a str,
}

#[derive(Serialize)]
struct UnreadTold<'a> {
    topic: &'a str,
    reason: &'a str,
}

#[derive(Serialize)]
struct TableTold<'a> {
    source: &'a str,
    rows: usize,
    notes: &'a [String],
    time: Option<TimeTold<'a>>,
    columns: Vec<ColumnTold<'a>>,
}

#[derive(Serialize)]
struct TimeTold<'a> {
    column: &'a str,
    unit: &'a str,
    unit_guessed: Option<&'a str>,
    from_s: f64,
    to_s: f64,
    rate_hz: f64,
    jitter_s: f64,
    gaps: usize,
    longest_gap_s: Option<f64>,
    lost_rows: usize,
    not_rising: usize,
    delay_s: Option<[f64; 2]>,
}

#[derive(Serialize)]
struct ColumnTold<'a> {
    name: &'a str,
    unit: Option<&'a str>,
    missing: usize,
    smallest: Option<f64>,
    largest: Option<f64>,
    at_smallest: usize,
    at_largest: usize,
    stuck_rows: usize,
    spikes: usize,
}

impl<'a> Told<'a> {
    fn of(found: &'a Inspected) -> Told<'a> {
        let unread = found.unread.iter();
        Told {
            tables: found.tables.iter().map(TableTold::of).collect(),
            unread: unread
                .map(|(topic, reason)| UnreadTold { topic, reason })
                .collect(),
            suggested: &found.suggested,
        }
    }
}

impl<'a> TableTold<'a> {
    fn of(one: &'a InspectedTable) -> TableTold<'a> {
        let facts = &one.facts;
        let columns = facts.columns.iter().zip(&one.spikes);
        TableTold {
            source: &facts.source,
            rows: facts.rows,
            notes: &facts.notes,
            time: facts.time.as_ref().map(TimeTold::of),
            columns: columns
                .map(|(column, spikes)| ColumnTold::of(column, *spikes))
                .collect(),
        }
    }
}

impl<'a> TimeTold<'a> {
    fn of(time: &'a TimeFacts) -> TimeTold<'a> {
        TimeTold {
            column: &time.base.0,
            unit: &time.base.1.symbol,
            unit_guessed: time.guessed,
            from_s: time.span_s[0],
            to_s: time.span_s[1],
            rate_hz: time.rate_hz,
            jitter_s: time.jitter_s,
            gaps: time.gaps.len(),
            longest_gap_s: time.gaps.first().map(|gap| gap.length_s),
            lost_rows: time.lost_rows,
            not_rising: time.not_rising.as_ref().map_or(0, |(rows, _)| *rows),
            delay_s: time.delay_s,
        }
    }
}

impl<'a> ColumnTold<'a> {
    fn of(column: &'a ColumnFacts, spikes: usize) -> ColumnTold<'a> {
        ColumnTold {
            name: &column.name,
            unit: column.unit.as_deref(),
            missing: column.missing,
            smallest: column.range.map(|range| range[0]),
            largest: column.range.map(|range| range[1]),
            at_smallest: column.at_ends[0],
            at_largest: column.at_ends[1],
            stuck_rows: column.still.map_or(0, |(_, rows, _)| rows),
            spikes,
        }
    }
}
