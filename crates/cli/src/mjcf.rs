//! `truecut export-mjcf`: the robot of a scenario as a MuJoCo model.

use std::io::{self, Write};

use truecut_scenario::Scenario;

use crate::args::ExportArguments;
use crate::exit_status::ExitStatus;
use crate::failure::Failure;

/// Writes the model.
pub fn export(arguments: &ExportArguments) -> Result<ExitStatus, Failure> {
    let scenario = Scenario::load(&arguments.scenario, &arguments.set)?;
    let mjcf =
        truecut_sim::export_mjcf(&scenario).map_err(|error| Failure::sim(&scenario, error))?;
    Failure::if_read(&arguments.output)?;
    // The path was typed by hand; a missing folder is likely a typing error.
    truecut_files::write_whole(&arguments.output, |file| file.write_all(mjcf.as_bytes()))
        .map_err(|error: io::Error| Failure::at(&arguments.output, error))?;
    crate::print(&format!("{}\n", arguments.output.display()))
}
