//! The messages of a topic as a table.

use std::collections::{BTreeMap, HashMap};

use truecut_recording::measured::{Column, HEADER_STAMP, LOG_TIME, Table};
use truecut_recording::significant;

use super::layout::Layout;
use super::message::{Take, read};
use crate::error::Reason;

/// Most columns of a topic.
const MOST_COLUMNS: usize = 4096;
/// Cells that may be empty beside each that holds a number, and so many at least: fields that come
/// and go make tables far larger than their file.
const MOST_EMPTY: (usize, usize) = (16, 1_000_000);
const NS_PER_S: i64 = 1_000_000_000;

/// A topic with the messages read so far.
pub(super) struct Topic {
    pub name: String,
    /// Type of its messages.
    pub kind: String,
    layout: Layout,
    log_ns: Vec<i64>,
    rows: Rows,
}

/// What messages hold, column by column.
#[derive(Default)]
struct Rows {
    /// How many are complete.
    complete: usize,
    names: Vec<String>,
    columns: Vec<Vec<f64>>,
    index: HashMap<String, usize>,
    units: BTreeMap<String, String>,
    /// Stamps, ns since 1970; `None` of messages without.
    stamps: Vec<Option<i64>>,
    stamp: Option<i64>,
    /// Where the next number is, if this message has the fields of the one before.
    next: usize,
    numbers: usize,
    too_long: Vec<String>,
    has_too_many: bool,
}

impl Take for Rows {
    fn number(&mut self, path: &str, value: f64, unit: Option<&'static str>) {
        let is_next = self.names.get(self.next).is_some_and(|name| name == path);
        let place = match is_next {
            true => self.next,
            false => match self.index.get(path) {
                Some(place) => *place,
                None if self.names.len() == MOST_COLUMNS => {
                    self.has_too_many = true;
                    return;
                }
                None => self.new_column(path, unit),
            },
        };
        let column = &mut self.columns[place];
        // A list of names may name one twice; the first counts.
        if column.len() <= self.complete {
            column.resize(self.complete, f64::NAN);
            column.push(value);
            self.numbers += 1;
        }
        self.next = place + 1;
    }

    fn stamp(&mut self, seconds: i32, nanoseconds: u32) {
        let ns = i64::from(seconds) * NS_PER_S + i64::from(nanoseconds);
        self.stamp.get_or_insert(ns);
    }

    fn too_long(&mut self, path: &str) {
        if !self.too_long.iter().any(|one| one == path) {
            self.too_long.push(path.to_owned());
        }
    }
}

impl Rows {
    fn new_column(&mut self, path: &str, unit: Option<&'static str>) -> usize {
        let place = self.names.len();
        self.names.push(path.to_owned());
        self.index.insert(path.to_owned(), place);
        self.columns.push(Vec::new());
        if let Some(unit) = unit {
            self.units.insert(path.to_owned(), unit.to_owned());
        }
        place
    }

    fn complete(&mut self) {
        self.complete += 1;
        self.next = 0;
        self.stamps.push(self.stamp.take());
    }
}

impl Topic {
    pub fn new(name: String, kind: String, layout: Layout) -> Topic {
        Topic {
            name,
            kind,
            layout,
            log_ns: Vec::new(),
            rows: Rows::default(),
        }
    }

    pub fn rows(&self) -> usize {
        self.log_ns.len()
    }

    /// Time at which the first message was written down, ns.
    pub fn first_ns(&self) -> Option<i64> {
        self.log_ns.iter().min().copied()
    }

    /// Reads a message that was written down at this time, ns since 1970.
    pub fn take(&mut self, log_ns: u64, bytes: &[u8]) -> Result<(), Reason> {
        let failed = |rows: &Rows, what: &str| {
            let (name, number) = (&self.name, rows.complete + 1);
            Reason::Damaged(format!("topic {name}, message {number}: {what}"))
        };
        let read = read(&self.layout, bytes, &self.name, &mut self.rows);
        read.map_err(|error| failed(&self.rows, &error))?;
        if self.rows.has_too_many {
            let text = format!("more than {MOST_COLUMNS} different fields");
            return Err(failed(&self.rows, &text));
        }
        let ns = i64::try_from(log_ns).map_err(|_| failed(&self.rows, "its time is no time"))?;
        self.log_ns.push(ns);
        self.rows.complete();
        let cells = self.rows.complete.saturating_mul(self.rows.names.len());
        let (factor, least) = MOST_EMPTY;
        if cells > least.max(factor * self.rows.numbers) {
            return Err(failed(
                &self.rows,
                "its fields differ from message to message",
            ));
        }
        Ok(())
    }

    /// The table, in the order of the log's times, which count from `origin_ns` on.
    pub fn table(self, origin_ns: i64) -> Table {
        let Topic {
            name, kind, rows, ..
        } = self;
        let complete = rows.complete;
        let seconds = |ns: i64| ns.saturating_sub(origin_ns) as f64 * 1e-9;
        let log: Vec<f64> = self.log_ns.iter().map(|ns| seconds(*ns)).collect();
        let mut columns = vec![Column {
            name: LOG_TIME.to_owned(),
            values: log,
        }];
        let mut notes = Vec::new();
        let is_stamped = rows.stamps.iter().flatten().any(|ns| *ns != 0);
        if is_stamped {
            let stamp = |ns: &Option<i64>| ns.map_or(f64::NAN, seconds);
            let values: Vec<f64> = rows.stamps.iter().map(stamp).collect();
            notes.push(delays(&name, &kind, &columns[0].values, &values));
            columns.push(Column {
                name: HEADER_STAMP.to_owned(),
                values,
            });
        } else if rows.stamps.iter().any(Option::is_some) {
            notes.push(format!("{name} ({kind}): its header stamps are not set"));
        } else {
            notes.push(format!(
                "{name} ({kind}): it has no header, and the log's times alone"
            ));
        }
        for path in &rows.too_long {
            notes.push(format!("{path} is a long list, and left out"));
        }
        for (name, mut values) in rows.names.into_iter().zip(rows.columns) {
            values.resize(complete, f64::NAN);
            columns.push(Column { name, values });
        }
        sort(&mut columns);
        Table {
            source: name,
            columns,
            units: rows.units,
            notes,
            ..Table::default()
        }
    }
}

/// What lies between the two clocks, for a reader.
fn delays(name: &str, kind: &str, log_s: &[f64], stamp_s: &[f64]) -> String {
    let mut delays: Vec<f64> = log_s
        .iter()
        .zip(stamp_s)
        .map(|(log, stamp)| log - stamp)
        .collect();
    delays.retain(|delay| delay.is_finite());
    delays.sort_by(f64::total_cmp);
    let at = |share: f64| delays[((delays.len() - 1) as f64 * share) as usize];
    format!(
        "{name} ({kind}): written down {} s after its header's stamp in the median, {} to {} s",
        significant(at(0.5), 4),
        significant(at(0.0), 4),
        significant(at(1.0), 4)
    )
}

/// Rows in the order of the first column; those of a file nearly always are.
fn sort(columns: &mut [Column]) {
    let Some(times) = columns.first().map(|column| &column.values) else {
        return;
    };
    if times.is_sorted() {
        return;
    }
    let mut order: Vec<usize> = (0..times.len()).collect();
    order.sort_by(|a, b| times[*a].total_cmp(&times[*b]));
    for column in columns {
        column.values = order.iter().map(|row| column.values[*row]).collect();
    }
}
