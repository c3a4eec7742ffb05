//! The shipped dialects under the contract tests, on both arms that are written for.

#[path = "../../tests/assets/mod.rs"]
mod assets;

use super::contract::{Subject, names_are_unique};
use super::{DIALECTS, Dialect, Options, jbi::Jbi, rapid::Rapid};
use crate::dialect_contract;
use serde_json::json;

fn subject(dialect: &'static dyn Dialect, robot: &str) -> Subject {
    Subject {
        dialect,
        robot: assets::robot(robot),
        options: options(dialect),
    }
}

/// Options with which each of the shipped dialects writes.
fn options(dialect: &dyn Dialect) -> Options {
    let options = match dialect.name() {
        "jbi" => json!({ "date": "2026-01-31 12:00", "tool_number": 3 }),
        "rapid" => json!({ "tool_name": "wheel", "zone": "z5" }),
        other => panic!("no options for {other}: add it here and below"),
    };
    options.as_object().unwrap().clone()
}

dialect_contract!(jbi_hp20, subject(&Jbi, "hp20"));
dialect_contract!(jbi_irb6600, subject(&Jbi, "irb6600_175_255"));
dialect_contract!(rapid_hp20, subject(&Rapid, "hp20"));
dialect_contract!(rapid_irb6600, subject(&Rapid, "irb6600_175_255"));

#[test]
fn names_and_endings_belong_to_one_dialect_each() {
    names_are_unique(DIALECTS);
}

/// A room of a dialect, `src/program/<name>/dialect.rs`, that is not in the list would be read by
/// nobody.
#[test]
fn every_room_of_a_dialect_is_registered_and_tested() {
    let rooms = concat!(env!("CARGO_MANIFEST_DIR"), "/src/program");
    let rooms = std::fs::read_dir(rooms).unwrap().map(|room| room.unwrap());
    let rooms = rooms.filter(|room| room.path().join("dialect.rs").exists());
    let mut found: Vec<String> = rooms
        .map(|room| room.file_name().into_string().unwrap())
        .collect();
    found.sort();
    let mut registered: Vec<&str> = DIALECTS.iter().map(|dialect| dialect.name()).collect();
    registered.sort_unstable();
    assert_eq!(found, registered);
    for dialect in DIALECTS {
        assert!(dialect.check(&options(*dialect)).is_ok());
    }
}
