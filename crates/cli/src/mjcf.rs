//! `truecut export-mjcf`: the robot of a scenario as a MuJoCo model.

use truecut_scenario::Scenario;

use crate::args::ExportArguments;
use crate::exit_status::ExitStatus;
use crate::failure::Failure;

/// Writes the model.
pub fn export(arguments: &ExportArguments) -> Result<ExitStatus, Failure> {
    let scenario = Scenario::load(&arguments.scenario, &arguments.set)?;
    let mjcf =
        truecut_sim::export_mjcf(&scenario).map_err(|error| Failure::sim(&scenario, error))?;
    Failure::if_same(&arguments.output, &arguments.scenario)?;
    // The path was typed by hand; a missing folder is likely a typing error.
    std::fs::write(&arguments.output, mjcf.as_bytes())
        .map_err(|error| Failure::at(&arguments.output, error))?;
    crate::print(&format!("{}\n", arguments.output.display()))
}
