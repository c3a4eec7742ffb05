//! `truecut export-mjcf`: the robot of a scenario as a MuJoCo model.

use truecut_scenario::Scenario;

use crate::args::ExportArguments;
use crate::failure::Failure;
use crate::outputs::write_file;
use crate::verdict::Verdict;

/// Writes the model.
pub fn export(arguments: &ExportArguments) -> Result<Verdict, Failure> {
    let scenario = Scenario::load(&arguments.scenario, &arguments.set)?;
    let mjcf =
        truecut_sim::export_mjcf(&scenario).map_err(|error| Failure::sim(&scenario, error))?;
    write_file(&arguments.output, mjcf.as_bytes())?;
    crate::print(&format!("{}\n", arguments.output.display()))
}
