//! Measured data of a scenario.

use std::path::Path;

use truecut_recording::Measured;
use truecut_recording::measured::measured as map;
use truecut_scenario::{DataSpec, ProcessSpec, Scenario};
use truecut_telemetry::read_table;

use crate::failure::Failure;

/// The data that a replay is driven by: from `file`, else from the file that the scenario names. `None` for
/// scenarios that replay nothing.
pub fn measured(scenario: &Scenario, file: Option<&Path>) -> Result<Option<Measured>, Failure> {
    let replays = matches!(scenario.process, ProcessSpec::Replay(_));
    let Some(data) = scenario.data.as_ref().filter(|_| replays) else {
        return match file {
            Some(_) => Err(Failure::with_help(
                format!("{} replays nothing", scenario.path().display()),
                "leave out --data, or use a scenario with [process.replay]",
            )),
            None => Ok(None),
        };
    };
    load(scenario, data, file).map(Some)
}

/// The data that a scenario is held against.
pub fn needed(scenario: &Scenario, file: Option<&Path>) -> Result<Measured, Failure> {
    let Some(data) = &scenario.data else {
        let text = format!("{}: there is no [data] table", scenario.path().display());
        let help = "add [data] with one [[data.channel]] for each column: it says which is which, and in which unit";
        return Err(Failure::with_help(text, help));
    };
    load(scenario, data, file)
}

fn load(scenario: &Scenario, data: &DataSpec, file: Option<&Path>) -> Result<Measured, Failure> {
    let Some(path) = file.or(data.file.as_deref()) else {
        let message = "the scenario names no file of measured data: write data.file, or run it with --data FILE";
        return Err(scenario.problem("data", message).into());
    };
    // A fault of a file that the scenario names is one of the scenario, at that key.
    let failed = |message: String| match file {
        Some(_) => Failure::message(message),
        None => scenario.problem("data.file", message).into(),
    };
    let table = read_table(path, data.header).map_err(|error| failed(error.to_string()))?;
    let measured = map(&table, &data.mapping).map_err(|error| failed(error.to_string()))?;
    Ok(measured)
}

/// Whether a scenario replays data that only the command line can name.
pub fn is_left_open(scenario: &Scenario) -> bool {
    let data = scenario.data.as_ref();
    matches!(scenario.process, ProcessSpec::Replay(_))
        && data.is_some_and(|data| data.file.is_none())
}
