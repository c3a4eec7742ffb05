//! Files of a planned motion.

use std::path::PathBuf;

use truecut::Staged;
use truecut::outputs::write_file;
use truecut_discrepancy::excite::Excitation;
use truecut_plan::program::ProgramFile;
use truecut_recording::Role;
use truecut_scenario::{MOTION_TIME, MotionColumn, PlannedMotion, Scenario};

use crate::failure::Failure;
use crate::text::json;

const MOTION: &str = "motion.csv";
const SCENARIO: &str = "excited.toml";
const REPORT: &str = "excitation.json";

/// Writes the motion, its scenario, the program and the report; all of them or none.
pub fn write(
    scenario: &Scenario,
    planned: &Excitation,
    programs: Vec<ProgramFile>,
    staged: &Staged,
) -> Result<Vec<PathBuf>, Failure> {
    for name in [MOTION, SCENARIO, REPORT] {
        Failure::if_read(&staged.folder().join(name))?;
    }
    let motion = table(planned).map_err(|error| Failure::at(&staged.path(MOTION), error))?;
    write_file(&staged.path(MOTION), &motion)?;
    let text = scenario.excited_text(staged.folder(), &replayed(planned));
    write_file(&staged.path(SCENARIO), text.as_bytes())?;
    write_file(&staged.path(REPORT), json(&planned.report)?.as_bytes())?;
    let mut names = vec![MOTION, SCENARIO];
    for one in &programs {
        write_file(&staged.path(&one.name), one.text.as_bytes())?;
        names.push(&one.name);
    }
    // The report says that the others are whole.
    names.push(REPORT);
    staged.publish(&names)?;
    Ok(names
        .iter()
        .map(|name| staged.folder().join(name))
        .collect())
}

/// One row a sample: time, what moves, what the scenario predicts of the outputs. SI.
fn table(planned: &Excitation) -> csv::Result<Vec<u8>> {
    let mut out = csv::Writer::from_writer(Vec::new());
    let inputs = planned.inputs.iter().map(|(_, spec)| spec.name.as_str());
    let outputs = planned.outputs.iter().map(|(spec, ..)| spec.name.as_str());
    out.write_record([MOTION_TIME].into_iter().chain(inputs).chain(outputs))?;
    for (row, time) in planned.time_s.iter().enumerate() {
        let moves = planned
            .inputs
            .iter()
            .map(|(joint, _)| planned.motion.position[*joint][row]);
        let predicted = planned.outputs.iter().map(|(.., values)| values[row]);
        let cells = [*time].into_iter().chain(moves).chain(predicted);
        out.write_record(cells.map(|value| format!("{value:.10}")))?;
    }
    out.into_inner().map_err(|error| error.into_error().into())
}

/// The motion as a replay has it in the place of its data.
fn replayed(planned: &Excitation) -> PlannedMotion {
    let inputs = planned
        .inputs
        .iter()
        .map(|(_, spec)| (spec, Role::Input, None));
    let outputs = planned
        .outputs
        .iter()
        .map(|(spec, noise, _)| (spec, Role::Output, *noise));
    let column =
        |(spec, role, noise): (&truecut_recording::ChannelSpec, Role, Option<f64>)| MotionColumn {
            channel: spec.name.clone(),
            unit: spec.unit.to_string(),
            role,
            noise,
        };
    PlannedMotion {
        file: MOTION.to_owned(),
        columns: inputs.chain(outputs).map(column).collect(),
        rotary: planned.rotary.clone(),
        start: planned.motion.position.iter().map(|q| q[0]).collect(),
    }
}
