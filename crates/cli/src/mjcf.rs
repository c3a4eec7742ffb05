//! `truecut export-mjcf`: the robot of a scenario as a MuJoCo model.

use truecut_scenario::Scenario;

use crate::args::ExportArguments;
use crate::failure::Failure;
use crate::verdict::Verdict;

/// Writes the model.
pub fn export(arguments: &ExportArguments) -> Result<Verdict, Failure> {
    let scenario = Scenario::load(&arguments.scenario, &arguments.set)?;
    let mjcf =
        truecut_sim::export_mjcf(&scenario).map_err(|error| Failure::sim(&scenario, error))?;
    // The file was named by hand; a folder that is not there is a slip in it.
    std::fs::write(&arguments.output, mjcf.as_bytes())
        .map_err(|error| Failure::message(format!("{}: {error}", arguments.output.display())))?;
    crate::print(&format!("{}\n", arguments.output.display()))
}
