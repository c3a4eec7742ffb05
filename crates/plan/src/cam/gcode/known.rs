//! Which axes have a place that the file says.

use std::collections::{BTreeMap, BTreeSet};

/// Axes whose place is not known: X, Y, Z at the start, where a control stands somewhere, and those
/// that the machine moved in its own coordinates. A, B, C count as 0 until they are given: most
/// machines do not have them.
pub(super) struct Unknown {
    axes: BTreeSet<char>,
    /// Of A, B, C those that the file has given.
    rotary: BTreeSet<char>,
}

impl Unknown {
    pub fn new() -> Self {
        Self {
            axes: "XYZ".chars().collect(),
            rotary: BTreeSet::new(),
        }
    }

    pub fn is_empty(&self) -> bool {
        self.axes.is_empty()
    }

    /// The axes, for messages.
    pub fn names(&self) -> String {
        let names: Vec<String> = self.axes.iter().map(char::to_string).collect();
        names.join(", ")
    }

    /// A block says places; a step from a place that is not known leads to another.
    pub fn say(&mut self, values: &BTreeMap<char, f64>, incremental: bool, aims: bool) {
        if !incremental {
            self.axes.retain(|axis| !values.contains_key(axis));
        }
        if aims {
            self.axes.retain(|axis| "XYZ".contains(*axis));
        }
        let given = "ABC".chars().filter(|axis| values.contains_key(axis));
        self.rotary.extend(given);
    }

    /// The machine moves the axes that a block names; without any, all.
    pub fn lose(&mut self, values: &BTreeMap<char, f64>) {
        let named = "XYZABC".chars().filter(|axis| values.contains_key(axis));
        let mut moved: BTreeSet<char> = named.collect();
        if moved.is_empty() {
            moved = "XYZ".chars().chain(self.rotary.iter().copied()).collect();
        }
        self.axes.extend(moved);
    }
}
