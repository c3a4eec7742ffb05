//! `truecut identify`: joint stiffness and modes from measurements of the arm itself.

mod figures;
mod files;
mod text;

use std::path::Path;

use truecut::outputs::write_file;
use truecut_discrepancy::identify::frf::{Frf, frf};
use truecut_discrepancy::identify::impact::impact;
use truecut_discrepancy::identify::modes::{ModesReport, against_model};
use truecut_discrepancy::identify::readings::readings;
use truecut_discrepancy::identify::stiffness::{self, StiffnessReport};
use truecut_discrepancy::identify::tool::{ToolError, doubt_of_units, tool_modes};
use truecut_discrepancy::identify::{IdentifyError, modal};
use truecut_recording::measured::Table;
use truecut_scenario::Identification;
use truecut_scenario::identification::{ModesSpec, StiffnessSpec};
use truecut_sim::elastic::ElasticArm;
use truecut_telemetry::read_table;

use crate::args::IdentifyArguments;
use crate::exit_status::ExitStatus;
use crate::failure::Failure;
use crate::page::{self, Page};

/// Runs the identification, prints it and writes reports and figures.
pub fn identify(arguments: &IdentifyArguments) -> Result<ExitStatus, Failure> {
    let file = Identification::load(&arguments.file)?;
    let arm =
        ElasticArm::load(&file.robot).map_err(|error| Failure::identified_arm(&file, error))?;
    // Everything is read and fitted before anything is written.
    let stiffness = (file.stiffness.as_ref())
        .map(|spec| of_stiffness(&file, spec, &arm))
        .transpose()?;
    let modes = (file.modes.as_ref())
        .map(|spec| of_modes(&file, spec, &arm, stiffness.as_ref()))
        .transpose()?;
    let folder = arguments.out.join(file.stem());
    let mut text = format!("{}\n", file.name);
    let mut page = Page::new("identify", &file.name);
    if let Some(report) = &stiffness {
        let written = files::stiffness(&folder, report)?;
        text.push_str(&text::stiffness(report, &written));
        page.told(&text::stiffness(report, &[]));
        page.figures("Stiffness", [figures::stiffness(report)]);
    }
    if let Some(report) = &modes {
        let written = files::modes(&folder, report)?;
        text.push_str(&text::modes(report, &written));
        page.told(&text::modes(report, &[]));
        page.figures("Modes", [figures::modes(report)]);
    }
    page.text(page::repeat(
        "truecut identify",
        &format!("{}.toml", file.stem()),
    ));
    let html = folder.join("identify.html");
    write_file(&html, page.html().as_bytes())?;
    text.push_str(&format!("  {}   (all of it as a page)\n\n", html.display()));
    crate::print(&text)
}

fn of_stiffness(
    file: &Identification,
    spec: &StiffnessSpec,
    arm: &ElasticArm,
) -> Result<StiffnessReport, Failure> {
    let table = table(file, &spec.file, spec.header, "stiffness")?;
    readings(&table, spec, arm)
        .and_then(|readings| stiffness::identify(&readings, spec, arm))
        .map_err(|error| refused(file, &error))
}

fn of_modes(
    file: &Identification,
    spec: &ModesSpec,
    arm: &ElasticArm,
    stiffness: Option<&StiffnessReport>,
) -> Result<ModesReport, Failure> {
    let (frfs, shift) = frfs(file, spec)?;
    let Some(fit) = modal::fit(&frfs, spec.band_hz, spec.count, shift) else {
        let [low, high] = spec.band_hz;
        let message = format!(
            "no mode stands out of the FRFs from {low} to {high} Hz; is it the right band, and \
             the right unit?"
        );
        return Err(file.problem("modes.band_hz", message).into());
    };
    let report_of = |arm: &ElasticArm| {
        against_model(&frfs, &fit, arm, spec.axes, spec.band_hz)
            .map_err(|error| Failure::identified_arm(file, error))
    };
    let mut report = report_of(arm)?;
    if spec.tool_modes {
        let found = tool_modes(&frfs, &keys(spec), &fit, arm, spec.axes);
        report.tool = found.map_err(|error| match error {
            ToolError::Data(error) => refused(file, &error),
            ToolError::Arm(error) => Failure::identified_arm(file, error),
        })?;
        let doubt = frfs.first();
        let doubt = doubt.and_then(|frf| doubt_of_units(&report.tool, frf.kind));
        report.notes.extend(doubt);
    }
    if let Some(updated) = stiffness.and_then(StiffnessReport::updated) {
        report.add_identified(&report_of(&arm.with_stiffness(&updated))?);
    }
    Ok(report)
}

/// Keys of the FRFs, in their order.
fn keys(spec: &ModesSpec) -> Vec<String> {
    let ready = (0..spec.frfs.len()).map(|index| format!("modes.frf.{index}"));
    let struck = (0..spec.impacts.len()).map(|index| format!("modes.impact.{index}"));
    ready.chain(struck).collect()
}

/// All FRFs, and the decay rate that an exponential window has added to them, 1/s.
fn frfs(file: &Identification, spec: &ModesSpec) -> Result<(Vec<Frf>, f64), Failure> {
    let mut frfs: Vec<Frf> = Vec::new();
    let mut shifts = Vec::new();
    for (index, one) in spec.frfs.iter().enumerate() {
        let key = format!("modes.frf.{index}");
        let table = table(file, &one.file, one.header, &key)?;
        let found = frf(&table, one, spec.band_hz, &key);
        frfs.push(found.map_err(|error| refused(file, &error))?);
        shifts.push(0.0);
    }
    for (index, one) in spec.impacts.iter().enumerate() {
        let key = format!("modes.impact.{index}");
        let table = table(file, &one.file, one.header, &key)?;
        let found = impact(&table, one, spec.band_hz, &key);
        frfs.push(found.map_err(|error| refused(file, &error))?);
        shifts.push(one.exponential_s.map_or(0.0, |tau| 1.0 / tau));
    }
    let shift = shifts.first().copied().unwrap_or(0.0);
    if shifts.iter().any(|one| *one != shift) {
        let message =
            "all FRFs share their poles, so that all must have the same exponential_s, or none";
        return Err(file.problem("modes", message).into());
    }
    Ok((frfs, shift))
}

/// The table of a file; an error in it is reported at the key that names the file.
fn table(file: &Identification, path: &Path, header: bool, key: &str) -> Result<Table, Failure> {
    read_table(path, header).map_err(|error| {
        file.problem(&format!("{key}.file"), error.to_string())
            .into()
    })
}

fn refused(file: &Identification, error: &IdentifyError) -> Failure {
    file.problem(&error.key, error.message.clone()).into()
}
