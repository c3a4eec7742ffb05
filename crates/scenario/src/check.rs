//! Collects the faults that are found while tables are turned into their typed form.

use std::fmt::Display;

use truecut_recording::UserUnit;

use crate::document::Document;
use crate::fault::Fault;

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
