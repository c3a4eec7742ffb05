//! Measured data of a scenario, from its file to channels.

use std::path::Path;

use truecut_recording::measured::{Measured, measured};
use truecut_scenario::Scenario;
use truecut_telemetry::read_table;

use crate::failure::Failure;

/// The data of a scenario, from `file` or else from the file that the scenario names.
pub fn load(scenario: &Scenario, file: Option<&Path>) -> Result<Measured, Failure> {
    let Some(data) = &scenario.data else {
        let text = format!("{}: there is no [data] table", scenario.path().display());
        let help = "add [data] with one [[data.channel]] for each column: it says which is which, and in which unit";
        return Err(Failure::with_help(text, help));
    };
    let Some(file) = file.or(data.file.as_deref()) else {
        return Err(scenario
            .problem("data", "no measured file: give data.file, or --data FILE")
            .into());
    };
    let table =
        read_table(file, data.header).map_err(|error| Failure::message(error.to_string()))?;
    measured(&table, &data.mapping).map_err(|error| {
        let help = format!("as mapped by [data] in {}", scenario.path().display());
        Failure::with_help(error.to_string(), help)
    })
}
