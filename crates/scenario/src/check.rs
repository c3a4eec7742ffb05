//! Collects the faults that are found while tables are turned into their typed form.

use std::fmt::Display;

use truecut_recording::UserUnit;

use crate::document::Document;
use crate::fault::Fault;
use crate::units::from_rpm;

/// Fastest rim or belt of any tool, m/s: grinding wheels in laboratories (W. König, F. Ferlemann,
/// "CBN grinding at five hundred m/s", Grinding and Metrology, 1991).
const FASTEST_RIM_M_PER_S: f64 = 500.0;

/// Faults found so far, and the document that they are about.
pub(crate) struct Check<'a> {
    document: &'a Document,
    faults: Vec<Fault>,
    /// Units of thresholds, by the path of the table that holds the threshold: whether they fit is
    /// seen once the channels are known.
    pub thresholds: Vec<(String, UserUnit)>,
}

impl<'a> Check<'a> {
    pub fn new(document: &'a Document) -> Check<'a> {
        Check {
            document,
            faults: Vec::new(),
            thresholds: Vec::new(),
        }
    }

    pub fn document(&self) -> &'a Document {
        self.document
    }

    /// Records a fault.
    pub fn refuse(&mut self, fault: Fault) {
        self.faults.push(fault);
    }

    /// Records a fault in the value of `key` in `table`; the message goes on behind the key with
    /// what the value `is` and what it must be.
    pub fn wrong(&mut self, table: &str, key: &str, is: impl Display, label: impl Into<String>) {
        let path = format!("{table}.{key}");
        let message = format!("`{path}` {is}");
        self.refuse(Fault::value(&path, message, label));
    }

    /// Records a fault for each of `keys` in `table` that is written although `because` makes it
    /// meaningless: every parameter in a scenario changes its run.
    pub fn ignored(&mut self, table: &str, keys: &[&str], because: &str) {
        for key in keys {
            let path = format!("{table}.{key}");
            if self.document.has(&path) {
                let message = format!("`{path}` has no effect: {because}");
                let fault = Fault::key(&path, message, "has no effect here");
                self.refuse(fault.with_help("remove the key, or choose what makes use of it"));
            }
        }
    }

    /// The value, or a fault that says who needs it.
    pub fn needed<T>(&mut self, table: &str, key: &str, value: Option<T>, who: &str) -> Option<T> {
        if value.is_none() {
            let path = format!("{table}.{key}");
            let message = format!("missing key `{key}` in [{table}]: {who} needs it");
            self.refuse(Fault::key(
                &path,
                message,
                format!("`{key}` is missing here"),
            ));
        }
        value
    }

    /// Records a fault for each table of a list whose name one before it has already.
    pub fn names_differ<'n>(&mut self, list: &str, names: impl Iterator<Item = &'n String>) {
        let mut seen: Vec<&String> = Vec::new();
        for (index, name) in names.enumerate() {
            if let Some(earlier) = seen.iter().position(|known| *known == name) {
                let message = format!("is \"{name}\", which `{list}.{earlier}` is already");
                self.wrong(&format!("{list}.{index}"), "name", message, "given twice");
            }
            seen.push(name);
        }
    }

    /// Records a fault where a tool of this radius, m, turns faster than any rim holds.
    pub fn rim(&mut self, table: &str, key: &str, rpm: f64, radius_m: f64) {
        let fastest_rpm = FASTEST_RIM_M_PER_S / radius_m / from_rpm(1.0);
        if rpm.abs() > fastest_rpm {
            let message = format!(
                "is {rpm}, but must be at most {fastest_rpm:.0} rpm in size: the rim of a tool of {:.3} mm is at \
                 {FASTEST_RIM_M_PER_S} m/s then, and none is faster",
                2e3 * radius_m
            );
            self.wrong(table, key, message, "faster than any rim holds");
        }
    }

    /// As [`Self::rim`], of a belt.
    pub fn belt(&mut self, table: &str, key: &str, m_per_s: f64) {
        if m_per_s.abs() > FASTEST_RIM_M_PER_S {
            let message = format!(
                "is {m_per_s}, but must be at most {FASTEST_RIM_M_PER_S} m/s in size: no belt is faster"
            );
            self.wrong(table, key, message, "faster than any belt");
        }
    }

    /// A direction of any length as a unit vector, or a fault where it has none. `path` is its key.
    pub fn direction(&mut self, path: &str, vector: [f64; 3]) -> Option<[f64; 3]> {
        let length = vector.iter().map(|x| x * x).sum::<f64>().sqrt();
        if length == 0.0 {
            let message =
                format!("`{path}` is [0, 0, 0], but must have a length: it is a direction");
            self.refuse(Fault::value(path, message, "no direction"));
            return None;
        }
        Some(vector.map(|x| x / length))
    }

    pub fn into_faults(self) -> Vec<Fault> {
        self.faults
    }
}
