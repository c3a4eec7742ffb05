//! The shipped dialects under the contract tests.

#[path = "../../tests/assets/mod.rs"]
mod assets;

use serde_json::Value;

use super::contract::{Subject, names_are_unique};
use super::{DIALECTS, Dialect};

/// A dialect on one of the arms that are written for.
pub fn subject(robot: &str, dialect: &'static dyn Dialect, options: Value) -> Subject {
    Subject {
        dialect,
        robot: assets::robot(robot),
        options: options.as_object().expect("a table of options").clone(),
    }
}

#[test]
fn names_and_endings_belong_to_one_dialect_each() {
    names_are_unique(DIALECTS);
}
