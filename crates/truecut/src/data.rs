//! Measured data that a scenario names.

use std::path::Path;

use truecut_recording::Measured;
use truecut_recording::measured::{ChannelMapping, DataError, TimeBase, measured_of as map};
use truecut_scenario::{DataSpec, Scenario};
use truecut_sim::run::RunError;
use truecut_telemetry::read_tables;

use crate::saturated;

/// The data that a replay is driven by, from the file that the scenario names; `None` for scenarios
/// that replay nothing. What [`Run::read_data`](crate::Run::read_data) takes.
///
/// # Errors
/// No file named; a file that cannot be read, or that does not have what the scenario says.
pub fn replayed(scenario: &Scenario) -> Result<Option<Measured>, RunError> {
    replayed_from(scenario, None)
}

/// As [`replayed`], from `file` if one is given.
///
/// # Errors
/// As [`replayed`]; a file for a scenario that replays nothing.
pub fn replayed_from(
    scenario: &Scenario,
    file: Option<&Path>,
) -> Result<Option<Measured>, RunError> {
    let replays = scenario.process.facts().replays;
    let Some(data) = scenario.data.as_ref().filter(|_| replays) else {
        return match file {
            Some(_) => Err(with_help(
                format!("{} replays nothing", scenario.path().display()),
                "leave out --data, or use a scenario with [process.replay]",
            )),
            None => Ok(None),
        };
    };
    load(scenario, data, file).map(Some)
}

/// The data that a scenario is compared with, from `file` or from the file that it names.
///
/// # Errors
/// A scenario without `[data]`; no file named; a file that cannot be read, or that does not have
/// what the scenario says.
pub fn measured(scenario: &Scenario, file: Option<&Path>) -> Result<Measured, RunError> {
    let Some(data) = &scenario.data else {
        let text = format!("{}: there is no [data] table", scenario.path().display());
        let help = "add [data] with one [[data.channel]] for each column: it says which is which, \
                    and in which unit";
        return Err(with_help(text, help));
    };
    load(scenario, data, file)
}

/// Whether a scenario replays data of which it names no file.
pub fn is_left_open(scenario: &Scenario) -> bool {
    let data = scenario.data.as_ref();
    scenario.process.facts().replays && data.is_some_and(|data| data.file.is_none())
}

fn with_help(message: String, help: &str) -> RunError {
    RunError::Data {
        message,
        help: Some(help.to_owned()),
    }
}

fn load(scenario: &Scenario, data: &DataSpec, file: Option<&Path>) -> Result<Measured, RunError> {
    let Some(path) = file.or(data.file.as_deref()) else {
        let message = "the scenario names no file of measured data: write data.file, or run it \
                       with --data FILE";
        return Err(scenario.problem("data", message).into());
    };
    // An error in a file that the scenario names is reported at the key of the scenario that asks
    // for what is wrong there.
    let failed = |key: &str, message: String| match file {
        Some(_) => RunError::Data {
            message,
            help: None,
        },
        None => scenario.problem(key, message).into(),
    };
    let tables =
        read_tables(path, data.header).map_err(|error| failed("data.file", error.to_string()))?;
    let mut measured = map(&tables, &data.mapping)
        .map_err(|error| failed(&key(scenario, data, &error), error.to_string()))?;
    let saturated = saturated::notes(&tables, &data.mapping.channels);
    measured.notes.extend(saturated);
    Ok(measured)
}

/// The key of the scenario that asks for what the data do not have.
fn key(scenario: &Scenario, data: &DataSpec, error: &DataError) -> String {
    let (DataError::NoColumn { column, .. } | DataError::Channel { column, .. }) = error else {
        return "data.file".to_owned();
    };
    if matches!(&data.mapping.time, TimeBase::Column { column: time, .. } if time == column) {
        // What is wrong with a column that is there is its unit.
        let of_unit = matches!(error, DataError::Channel { .. });
        let is_said = of_unit && scenario.gives("data.time_unit");
        let key = if is_said {
            "data.time_unit"
        } else {
            "data.time"
        };
        return key.to_owned();
    }
    let mut channels = data.mapping.channels.iter();
    let names = |one: &ChannelMapping| {
        one.source() == *column || one.terms.iter().any(|term| term.column == *column)
    };
    let Some(index) = channels.position(names) else {
        return "data.file".to_owned();
    };
    let table = format!("data.channel.{index}");
    match scenario.gives(&format!("{table}.sum")) {
        true => format!("{table}.sum"),
        false => format!("{table}.column"),
    }
}
