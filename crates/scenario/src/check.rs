//! Collects the faults that are found while tables are turned into their typed form.

use crate::document::{Document, Fault};

/// Faults found so far, and the document that they are about.
pub(crate) struct Check<'a> {
    document: &'a Document,
    faults: Vec<Fault>,
}

impl<'a> Check<'a> {
    pub fn new(document: &'a Document) -> Check<'a> {
        Check {
            document,
            faults: Vec::new(),
        }
    }

    pub fn document(&self) -> &'a Document {
        self.document
    }

    /// Records a fault.
    pub fn refuse(&mut self, fault: Fault) {
        self.faults.push(fault);
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

    pub fn into_faults(self) -> Vec<Fault> {
        self.faults
    }
}
