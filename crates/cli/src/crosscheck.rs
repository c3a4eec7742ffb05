//! `truecut crosscheck`: the same scenario here and in MuJoCo.

use std::path::{Path, PathBuf};
use std::process::Command;

use truecut::data;
use truecut::outputs::{COMPARISON, MODEL, Outputs, write_file};
use truecut_scenario::Scenario;
use truecut_sim::run::{Claims, Run};

use crate::args::CrosscheckArguments;
use crate::exit_status::ExitStatus;
use crate::failure::Failure;
use crate::progress::Progress;
use crate::text;

/// The script of the cross-check, relative to the repository's root.
const SCRIPT: &str = "tests/crosscheck/truecut_reference/run.py";

/// The script's exit code if the engines disagree.
const DISAGREES: i32 = 4;

/// Runs every scenario here, then in MuJoCo, one after the other. Sweeps are skipped and listed.
pub fn crosscheck(arguments: &CrosscheckArguments) -> Result<ExitStatus, Failure> {
    let scenarios = arguments.load()?;
    let (sweeps, single): (Vec<_>, Vec<_>) = scenarios.iter().partition(|s| s.sweep.is_some());
    if let ([first, ..], []) = (sweeps.as_slice(), single.as_slice()) {
        let text = "a sweep cannot be cross-checked: only single runs can";
        return Err(first.problem("sweep", text).into());
    }
    for sweep in sweeps {
        crate::print(&format!(
            "{}: left out, a sweep cannot be cross-checked\n",
            sweep.path().display()
        ))?;
    }
    let mut all = ExitStatus::Good;
    for scenario in single {
        all = all.and(crosscheck_one(scenario, &arguments.out)?);
    }
    Ok(all)
}

fn crosscheck_one(scenario: &Scenario, out: &Path) -> Result<ExitStatus, Failure> {
    let script = upwards(SCRIPT, scenario).ok_or_else(|| {
        let text = format!("{SCRIPT} is not found above this folder or above the scenario");
        Failure::with_help(
            text,
            "the cross-check runs from a copy of the project's repository",
        )
    })?;
    let python = python(scenario)?;
    let outputs = Outputs::prepare(out, scenario, false)?;
    let finished = Progress::of_one("running", |progress| {
        let run = Run {
            read_data: Some(data::replayed),
            claims: Claims::Check,
            sinks: outputs.sinks(),
            progress,
            ..Run::of(scenario)
        };
        run.execute()
    });
    let recording = finished?.recording;
    outputs.finish(&recording, &[])?;
    if !recording.outcome.reached_end() {
        let outcome = text::outcome(&recording.outcome);
        crate::print(&format!("{}\n  {outcome}\n", scenario.name))?;
        return Ok(ExitStatus::of_outcome(&recording.outcome));
    }
    let mjcf = truecut_sim::export_mjcf(scenario).map_err(|error| Failure::sim(scenario, error))?;
    write_file(&outputs.path(MODEL), mjcf.as_bytes())?;
    let mut command = Command::new(&python);
    command.arg(script).arg(scenario.path());
    command.arg("--mjcf").arg(outputs.path(MODEL));
    command.arg("--recording").arg(outputs.recording());
    command.arg("--out").arg(outputs.path(COMPARISON));
    for (key, value) in scenario.overrides() {
        command
            .arg("--set")
            .arg(format!("{key}={}", as_json(&value)));
    }
    let status = command
        .status()
        .map_err(|error| Failure::at(&python, error))?;
    match status.code() {
        Some(0) => Ok(ExitStatus::Good),
        Some(DISAGREES) => Ok(ExitStatus::Disagrees),
        _ => Err(Failure::message(format!(
            "the cross-check of {} ended with {status}",
            scenario.path().display()
        ))),
    }
}

/// The interpreter in `TRUECUT_PYTHON`, or that of the repository's virtual environment.
fn python(scenario: &Scenario) -> Result<PathBuf, Failure> {
    if let Some(given) = std::env::var_os("TRUECUT_PYTHON") {
        return Ok(PathBuf::from(given));
    }
    upwards(".venv/bin/python", scenario).ok_or_else(|| {
        let help = "`python3 tests/run.py` makes .venv; or name an interpreter in TRUECUT_PYTHON";
        Failure::with_help("there is no Python with MuJoCo: no .venv/bin/python", help)
    })
}

/// A file of the repository, searched upwards from the current folder and from the scenario's.
fn upwards(file: &str, scenario: &Scenario) -> Option<PathBuf> {
    let starts = [
        std::env::current_dir().ok(),
        scenario.folder().canonicalize().ok(),
    ];
    let folders: Vec<PathBuf> = starts.into_iter().flatten().collect();
    folders
        .iter()
        .flat_map(|start| start.ancestors())
        .map(|folder| folder.join(file))
        .find(|candidate| candidate.is_file())
}

/// The value of an override as JSON, which the cross-check reads.
fn as_json(value: &str) -> String {
    let parsed = format!("value = {value}").parse::<toml::Table>();
    let json = parsed
        .ok()
        .and_then(|table| serde_json::to_value(table.get("value")?).ok());
    json.unwrap_or_else(|| serde_json::Value::from(value))
        .to_string()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn overrides_keep_their_type() {
        assert_eq!(as_json("300"), "300");
        assert_eq!(as_json("0.15"), "0.15");
        assert_eq!(as_json("true"), "true");
        assert_eq!(as_json("[1, 2.5]"), "[1,2.5]");
        assert_eq!(as_json("forward"), "\"forward\"");
        assert_eq!(as_json("\"forward\""), "\"forward\"");
    }
}
